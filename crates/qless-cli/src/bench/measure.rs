//! One family: every method on every system, taken in turns.

use std::time::Instant;

use qless::{ConstraintSystem, analyse};
use qless_scenes::Scene;

use super::methods::Method;
use super::systems::Family;
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

/// What was found, and in what time.
#[derive(Clone, Copy)]
pub struct Measured {
    /// Median and quartiles, seconds.
    pub time: f64,
    pub quartiles: (f64, f64),
    pub rank: usize,
    pub ambiguous: bool,
    pub residual: f64,
    pub growth: f64,
}

/// Samples of a family. The error is a scene that cannot be made.
pub fn measure(family: &Family, methods: &[Method], args: &BenchArgs) -> Result<Vec<Sample>, String> {
    let mut samples: Vec<Sample> = Vec::new();
    // Time grows with the square of the equations, which is more than sparse methods need and less than dense ones.
    let mut slowest: Vec<Option<(f64, f64)>> = vec![None; methods.len()];
    for (size, scene) in &family.scenes {
        let scene = scene.as_ref().map_err(|error| format!("{} {size}: {error}", family.name))?;
        let m = scene.system.equations() as f64;
        let is_tried = |k: &usize| slowest[*k].is_none_or(|(time, before)| time * (m / before).powi(2) <= args.limit);
        let tried: Vec<usize> =
            (0..methods.len()).filter(|&k| scene.system.equations() < methods[k].most).filter(is_tried).collect();
        let mut results: Vec<Option<(Measured, Vec<f64>)>> = methods.iter().map(|_| None).collect();
        for round in 0..args.runs.get() {
            for &k in &tried {
                let is_slow = results[k].as_ref().is_some_and(|(_, times)| times[0] > args.limit / 10.0);
                if round == 0 || !is_slow {
                    let Some((measured, time)) = once(&scene.system, &methods[k]) else { continue };
                    results[k].get_or_insert((measured, Vec::new())).1.push(time);
                }
            }
        }
        for (k, result) in results.into_iter().enumerate() {
            let result = result.map(|(measured, times)| summary(measured, times));
            slowest[k] = result.map_or(slowest[k], |result| Some((result.time, m)));
            samples.push(sample(family.name, size, scene, methods[k].name, result));
        }
    }
    Ok(samples)
}

fn sample(family: &'static str, size: &str, scene: &Scene, method: &'static str, result: Option<Measured>) -> Sample {
    let equations = scene.system.equations();
    let rank = scene.truth.rank_free.unwrap_or(equations);
    Sample { family, size: size.to_owned(), equations, method, rank, result }
}

/// The whole elimination, and how good it is; none where the method fails (for want of memory).
fn once(system: &ConstraintSystem, method: &Method) -> Option<(Measured, f64)> {
    let start = Instant::now();
    let analysis = analyse(system, &method.options).ok()?;
    let reduction = analysis.reduction(system);
    let time = start.elapsed().as_secs_f64();
    let measured = Measured {
        time,
        quartiles: (time, time),
        rank: analysis.rank(),
        ambiguous: analysis.confidence.ambiguous,
        residual: analysis.residual(system, &reduction),
        growth: reduction.growth,
    };
    Some((measured, time))
}

fn summary(measured: Measured, mut times: Vec<f64>) -> Measured {
    times.sort_by(f64::total_cmp);
    let at = |part: usize| times[(times.len() - 1) * part / 4];
    Measured { time: at(2), quartiles: (at(1), at(3)), ..measured }
}
