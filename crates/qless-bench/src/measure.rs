//! Measures a family: every method on every system, in turns.

use qless_scenes::Scene;

use super::child;
use super::given_up::GivenUpReason;
use super::methods::BenchMethod;
use super::plan::{MeasurementPlan, Past, limit, plan};
use super::quality::Reference;
use super::run::{Done, warm};
use super::sample::{Measured, Sample};
use super::systems::{BenchCase, Family};
use crate::BenchArgs;

/// In seconds: a method that takes longer than this, or than a tenth of the limit, is measured only once.
const SLOW: f64 = 5.0;

/// Samples of a family; an error if a scene cannot be generated.
pub fn measure(family: &Family, methods: &[BenchMethod], args: &BenchArgs) -> Result<Vec<Sample>, String> {
    let mut samples: Vec<Sample> = Vec::new();
    let mut past: Vec<Option<Past>> = vec![None; methods.len()];
    for case in &family.cases {
        let scene = case.scene()?;
        let equations = scene.system.equations();
        let planned =
            |(method, past): (&BenchMethod, &Option<Past>)| plan(method, *past, equations, limit(method, args));
        let plans = methods.iter().zip(&past).map(planned).collect();
        let results = in_turns(case, &scene, methods, plans, args);
        for (k, result) in results.into_iter().enumerate() {
            past[k] = match &result {
                Ok(result) => Some(Past::Took { seconds: result.time, equations }),
                Err(GivenUpReason::Stopped { .. }) => Some(Past::Stopped { equations }),
                Err(_) => past[k],
            };
            samples.push(sample(case, &scene, &methods[k], result));
        }
    }
    Ok(samples)
}

/// The first result of a method, and the times of all its runs.
type MeasuredResult = Result<(Measured, Vec<f64>), GivenUpReason>;

fn in_turns(
    case: &BenchCase,
    scene: &Scene,
    methods: &[BenchMethod],
    plans: Vec<MeasurementPlan>,
    args: &BenchArgs,
) -> Vec<Result<Measured, GivenUpReason>> {
    let reference = Reference::new(scene);
    let mut results: Vec<Option<MeasuredResult>> = methods.iter().map(|_| None).collect();
    for _ in 0..args.runs.get() {
        for ((method, plan), result) in methods.iter().zip(&plans).zip(&mut results) {
            let again = turn(case, &reference, method, plan, result.as_ref(), limit(method, args));
            match (again, &mut *result) {
                (Some(Ok(measured)), Some(Ok((_, times)))) => times.push(measured.time),
                (Some(first), None) => *result = Some(first.map(|measured| (measured, vec![measured.time]))),
                _ => {}
            }
        }
    }
    let finish = |((method, plan), result): ((&BenchMethod, MeasurementPlan), Option<MeasuredResult>)| {
        let (measured, times) = result.unwrap_or(Err(GivenUpReason::Ended))?;
        let mut measured = summary(measured, times);
        if args.memory && matches!(plan, MeasurementPlan::Here) {
            measured.memory = child::memory(case.family, &case.size, method, limit(method, args));
        }
        Ok(measured)
    };
    methods.iter().zip(plans).zip(results).map(finish).collect()
}

/// One run; `None` if the method failed before or is too slow to repeat.
fn turn(
    case: &BenchCase,
    reference: &Reference,
    method: &BenchMethod,
    plan: &MeasurementPlan,
    before: Option<&MeasuredResult>,
    limit: f64,
) -> Option<Result<Measured, GivenUpReason>> {
    let first = match before {
        Some(Ok((_, times))) if times[0] > SLOW.min(limit / 10.0) => return None,
        Some(Err(_)) => return None,
        Some(Ok((first, _))) => Some(*first),
        None => None,
    };
    // The result is judged once; later runs only add times.
    let judge = |done: Done| Measured { time: done.time, ..first.unwrap_or_else(|| reference.judge(&done)) };
    Some(match plan {
        MeasurementPlan::Here => warm(&reference.scene.system, method).map(judge),
        MeasurementPlan::Apart => child::measure(case.family, &case.size, method, limit),
        MeasurementPlan::Nowhere(reason) => Err(reason.clone()),
    })
}

fn sample(case: &BenchCase, scene: &Scene, method: &BenchMethod, result: Result<Measured, GivenUpReason>) -> Sample {
    let equations = scene.system.equations();
    let rank = scene.truth.rank_free.unwrap_or(equations);
    let dense = method.is_dense.then_some((equations, scene.system.dofs() - scene.system.prescribed().len()));
    let result = result.map_err(|reason| reason.words(dense));
    Sample { family: case.family, size: case.size.clone(), equations, method: method.name, rank, result }
}

fn summary(measured: Measured, mut times: Vec<f64>) -> Measured {
    times.sort_by(f64::total_cmp);
    let at = |part: usize| times[(times.len() - 1) * part / 4];
    Measured { time: at(2), quartiles: (at(1), at(3)), ..measured }
}
