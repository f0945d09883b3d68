//! Supported models: every method agrees with a dense solution to its stated accuracy.

use qless_solve::enforce::{Method, Problem, Solution};

use super::Random;
use super::dense;
use super::models::{Kind, Lack, Model, Units, all_units, model, off};
use crate::linkages::Outcome;

/// Factor by which an estimate of an error may be wrong.
const MARGIN: f64 = 3.0;

fn mixed_rows(problem: &Problem, model: &Model, case: usize) -> Outcome<Solution> {
    let mut random = Random::new(case + 1000);
    let methods: Vec<Method> = (0..model.system.equations())
        .map(|_| match random.below(3) {
            0 => Method::Elimination,
            1 => Method::Multiplier,
            _ => Method::Augmented { factor: 1e5 },
        })
        .collect();
    Ok(problem.enforce(&methods, 1e-12)?)
}

fn check(model: &Model, case: usize) -> Outcome<f64> {
    let problem = Problem::new(&model.k, &model.f, &model.system)?;
    let (u, lambda) = dense::solution(model, problem.kept())?;
    let most = lambda.iter().fold(0.0, |most: f64, l| most.max(l.abs()));
    let methods = [
        ("transformation", problem.transformation()),
        ("lagrange", problem.lagrange()),
        ("mixed", problem.mixed(&problem.plan(3.0)?)),
        ("augmented", problem.augmented(1e6, 1e-12)),
        ("penalty", problem.penalty(1e7, 1e-1)),
    ];
    let mut stated = 0.0;
    let mixed = ("row by row", Ok(mixed_rows(&problem, model, case)?));
    for (name, solution) in methods.into_iter().chain([mixed]) {
        let solution = solution.map_err(|error| format!("{}: {name}: {error}", model.name))?;
        let error = off(model, &solution.u, &u);
        assert!(
            error <= MARGIN * solution.accuracy,
            "{}: {name}: {error:e}, {:e}, {:e}",
            model.name,
            solution.accuracy,
            solution.imbalance
        );
        assert!(solution.imbalance <= 1e-10, "{}: {name}", model.name);
        let of_lambda = solution.multipliers.iter().zip(&lambda).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
        let limit = 1e3 * solution.accuracy.max(1e-12) * most;
        assert!(of_lambda <= limit, "{}: {name}: multipliers {:e}", model.name, of_lambda / most);
        if name == "lagrange" {
            stated = solution.accuracy;
        }
    }
    Ok(stated)
}

/// Springs, trusses and beams with redundant ties and prescribed DOFs; K symmetric, unsymmetric, indefinite; in all units.
#[test]
fn all_methods_are_right_to_what_they_state() -> Outcome {
    let units: Vec<Units> = all_units().collect();
    let mut stated = Vec::new();
    for case in 0..200 {
        let kind = [Kind::Symmetric, Kind::Unsymmetric, Kind::Indefinite][case / 3 % 3];
        let units = units[case / 9 % 9];
        stated.push(check(&model(case, kind, Lack::Nothing, units)?, case)?);
    }
    stated.sort_by(f64::total_cmp);
    println!("stated accuracy: median {:.1e}, 90 % {:.1e}, worst {:.1e}", stated[100], stated[180], stated[199]);
    // Stated accuracies are not trivially large.
    assert!(stated[180] < 1e-7, "{:e}", stated[180]);
    Ok(())
}
