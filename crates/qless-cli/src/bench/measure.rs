//! One family: every method on every system, taken in turns.

use qless_scenes::Scene;

use super::child;
use super::methods::Method;
use super::quality::Reference;
use super::run::{Done, warm};
use super::systems::{Case, Family};
use crate::args::BenchArgs;

/// A method on a system.
pub struct Sample {
    pub family: &'static str,
    pub size: String,
    pub equations: usize,
    pub method: &'static str,
    pub rank: usize,
    /// None where the method was given up.
    pub result: Option<Measured>,
}

/// What was found, and in what time; see [`super::quality`].
#[derive(Clone, Copy, serde::Serialize, serde::Deserialize)]
pub struct Measured {
    /// Median and quartiles, seconds.
    pub time: f64,
    pub quartiles: (f64, f64),
    pub rank: usize,
    pub ambiguous: bool,
    pub false_drops: usize,
    pub false_keeps: usize,
    pub residual: f64,
    pub growth: f64,
    /// Of the solved problem; none where it was not solved.
    pub error: Option<f64>,
    /// Bytes at the peak beyond those before; none where it was not measured.
    pub memory: Option<u64>,
}

/// Samples of a family. The error is a scene that cannot be made.
pub fn measure(family: &Family, methods: &[Method], args: &BenchArgs) -> Result<Vec<Sample>, String> {
    let mut samples: Vec<Sample> = Vec::new();
    // Time grows with the square of the equations, which is more than sparse methods need and less than dense ones.
    let mut slowest: Vec<Option<(f64, f64)>> = vec![None; methods.len()];
    for case in &family.cases {
        let scene = case.scene()?;
        let m = scene.system.equations() as f64;
        let is_tried = |k: usize| {
            let foreseen = slowest[k].map_or(0.0, |(time, before)| time * (m / before).powi(2));
            scene.system.equations() < methods[k].most && foreseen <= args.limit
        };
        let tried: Vec<bool> = (0..methods.len()).map(is_tried).collect();
        let results = in_turns(case, &scene, methods, &tried, args);
        for (k, result) in results.into_iter().enumerate() {
            slowest[k] = result.map_or(slowest[k], |result| Some((result.time, m)));
            samples.push(sample(case, &scene, methods[k].name, result));
        }
    }
    Ok(samples)
}

fn in_turns(case: &Case, scene: &Scene, methods: &[Method], tried: &[bool], args: &BenchArgs) -> Vec<Option<Measured>> {
    let reference = Reference::new(scene);
    let mut results: Vec<Option<(Measured, Vec<f64>)>> = methods.iter().map(|_| None).collect();
    for round in 0..args.runs.get() {
        for (k, method) in methods.iter().enumerate().filter(|&(k, _)| tried[k]) {
            let is_slow = |times: &[f64]| times[0] > args.limit / 10.0;
            if round > 0 && results[k].as_ref().is_none_or(|(_, times)| is_slow(times)) {
                continue;
            }
            let measured = if method.is_apart {
                child::measure(case.family, &case.size, method, args.limit)
            } else {
                let first = results[k].as_ref().map(|(first, _)| *first);
                let judge =
                    |done: Done| Measured { time: done.time, ..first.unwrap_or_else(|| reference.judge(&done)) };
                warm(&scene.system, method).map(judge)
            };
            if let Some(measured) = measured {
                results[k].get_or_insert((measured, Vec::new())).1.push(measured.time);
            }
        }
    }
    let finish = |(k, result): (usize, Option<(Measured, Vec<f64>)>)| {
        let mut measured = result.map(|(measured, times)| summary(measured, times))?;
        if args.memory && !methods[k].is_apart {
            measured.memory = child::memory(case.family, &case.size, &methods[k], args.limit);
        }
        Some(measured)
    };
    results.into_iter().enumerate().map(finish).collect()
}

fn sample(case: &Case, scene: &Scene, method: &'static str, result: Option<Measured>) -> Sample {
    let equations = scene.system.equations();
    let rank = scene.truth.rank_free.unwrap_or(equations);
    Sample { family: case.family, size: case.size.clone(), equations, method, rank, result }
}

fn summary(measured: Measured, mut times: Vec<f64>) -> Measured {
    times.sort_by(f64::total_cmp);
    let at = |part: usize| times[(times.len() - 1) * part / 4];
    Measured { time: at(2), quartiles: (at(1), at(3)), ..measured }
}
