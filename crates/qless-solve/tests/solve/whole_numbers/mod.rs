//! Enforcement against exact arithmetic: small models of whole numbers, about half of them singular, most of them unsymmetric or indefinite.

mod bare;
mod exact;
mod measure;
mod models;
mod motions;
mod springs;
mod units;
mod wide;

use faer::sparse::{SparseColMat, Triplet};
use qless::elimination::View;
use qless::{Elimination, Options, SystemBuilder};
use qless_solve::enforce::{EnforceError, Lu, Method, Problem, Solution, Steps, Stiffness};

use crate::linkages::Outcome;
use models::{Given, model};

/// Models per test.
const MODELS: usize = 1200;
/// `(length, force)`.
const UNITS: [(f64, f64); 5] = [(1.0, 1.0), (1e-6, 1.0), (1e6, 1e6), (1.0, 1e6), (1e6, 1e-6)];

type Solved = Result<Solution, EnforceError>;

/// The largest difference, and the largest entry of the second list.
fn off(found: &[f64], right: &[f64], unit: f64) -> (f64, f64) {
    let pairs = found.iter().zip(right);
    pairs.fold((0.0, 0.0), |(off, most), (a, b)| (off.max((a - b * unit).abs()), most.max((b * unit).abs())))
}

/// Whether the error concerns springs, which a supported model may get.
fn is_of_springs(error: &EnforceError) -> bool {
    matches!(error, EnforceError::PenaltyTooSmall { .. })
}

/// Whether the error says that the model is not determined.
fn is_of_support(error: &EnforceError) -> bool {
    matches!(error, EnforceError::Unsupported(motion) if !motion.dofs.is_empty())
}

fn all_methods(problem: &Problem, equations: usize) -> [(&'static str, bool, Solved); 5] {
    let turns =
        [Method::Penalty { factor: 1e6 }, Method::Elimination, Method::Augmented { factor: 1e3 }, Method::Multiplier];
    let mixed: Vec<Method> = (0..equations).map(|i| turns[i % 4]).collect();
    [
        ("transformation", false, problem.transformation()),
        ("lagrange", false, problem.lagrange()),
        ("penalty", true, problem.penalty(1e8, 1e-3)),
        ("augmented", true, problem.augmented(1e4, 1e-9)),
        ("mixed", true, problem.enforce(&mixed, 1e-1)),
    ]
}

/// A model in its units, with its exact solution, if there is one.
struct Case<'a> {
    name: String,
    model: &'a models::Model,
    given: &'a Given,
    problem: Problem<'a>,
    length: f64,
    force: f64,
    right: Option<(Vec<f64>, Vec<f64>)>,
}

/// Calls `check` for each model in all units; conflicts must be found. Returns how many models are determined, and how many are not.
fn for_each_case(mut check: impl FnMut(&Case) -> Outcome) -> Outcome<(usize, usize)> {
    let mut counts = (0, 0);
    for model in (0..MODELS).map(model) {
        let Some((rank, conflict)) = model.rank() else { continue };
        for (length, force) in UNITS {
            let name = format!("{}, {length:e}, {force:e}", model.name);
            let given = model.given(length, force)?;
            let problem = match Problem::new(Stiffness::unsymmetric(&given.k), &given.f, &given.system) {
                Err(EnforceError::Conflict { .. }) if conflict => continue,
                problem => problem.map_err(|error| format!("{name}: {error}"))?,
            };
            assert_eq!((problem.kept().len(), conflict), (rank, false), "{name}");
            let Ok(right) = model.solution(problem.kept()) else { continue };
            if right.is_some() {
                counts.0 += 1;
            } else {
                counts.1 += 1;
            }
            check(&Case { name, model: &model, given: &given, problem, length, force, right })?;
        }
    }
    Ok(counts)
}

#[test]
fn every_method_is_right_where_the_model_is_determined_and_refuses_it_where_not() -> Outcome {
    let (determined, singular) = for_each_case(|case| {
        for (method, springs, solved) in all_methods(&case.problem, case.given.system.equations()) {
            let name = format!("{}: {method}", case.name);
            match (&case.right, solved) {
                (Some((u, lambda)), Ok(solution)) => {
                    let (error, most) = off(&solution.u, u, case.length);
                    if !springs {
                        assert!(error <= 1e-11 * most.max(case.length), "{name}: {error:e} of {most:e}");
                        let (error, most) = off(&solution.multipliers, lambda, case.force);
                        let loads = case.given.f.iter().fold(most.max(case.force), |most, f| most.max(f.abs()));
                        assert!(error <= 1e-10 * loads, "{name}: multipliers: {error:e} of {most:e}");
                    }
                }
                (Some(_), Err(error)) => assert!(springs && is_of_springs(&error), "{name}: {error}"),
                (None, Ok(solution)) => panic!("{name}: u = {:?}, to {:e}", solution.u, solution.accuracy),
                (None, Err(EnforceError::Unsupported(motion))) => {
                    let (felt, moves) = motions::felt(case, &motion);
                    assert!(moves && felt < 1e-9, "{name}: {felt:e}: {motion:?}");
                }
                (None, Err(error)) => panic!("{name}: {error}"),
            }
        }
        Ok(())
    })?;
    assert!(determined > 2000 && singular > 1000, "{determined}, {singular}");
    Ok(())
}

fn columns(k: &SparseColMat<usize, f64>) -> (Vec<usize>, Vec<usize>, Vec<f64>) {
    let (starts, rows, values) = (k.symbolic().col_ptr(), k.symbolic().row_idx(), k.val());
    (starts.to_vec(), rows.to_vec(), values.to_vec())
}

#[test]
fn steps_are_right_where_the_model_is_determined_and_refuse_it_where_not() -> Outcome {
    let (determined, singular) = for_each_case(|case| {
        let (starts, rows, values) = columns(&case.given.k);
        let map = Elimination::new(&case.given.system, &Options::default())?;
        let mut u = vec![0.0; case.given.f.len()];
        let steps = Steps::unsymmetric(map, View::columns(&starts, &rows), Lu::default());
        let solved = steps.and_then(|mut steps| steps.solve(&values, &case.given.f, &mut u));
        match (&case.right, solved) {
            (Some((right, _)), Ok(())) => {
                let (error, most) = off(&u, right, case.length);
                assert!(error <= 1e-11 * most.max(case.length), "{}: {error:e} of {most:e}", case.name);
            }
            (Some(_), Err(error)) => return Err(format!("{}: {error}", case.name).into()),
            (None, Ok(())) => panic!("{}: u = {u:?}", case.name),
            // A solver may report a singular matrix in its own words.
            (None, Err(error)) => {
                let singular = matches!(error, EnforceError::Unsupported(_) | EnforceError::Solver(_));
                assert!(singular, "{}: {error}", case.name);
            }
        }
        Ok(())
    })?;
    assert!(determined > 2000 && singular > 1000, "{determined}, {singular}");
    Ok(())
}

/// Soft springs are refused, also if multipliers hardly move u.
#[test]
fn soft_springs_are_refused() -> Outcome {
    let entries = [(0, 0, 3.0), (0, 1, -1.0), (1, 0, -1.0), (1, 1, 2.0), (1, 2, -1.0), (2, 1, -1.0), (2, 2, 1.5)];
    let entries = entries.map(|(i, j, v)| Triplet::new(i, j, v));
    let k = SparseColMat::try_new_from_triplets(3, 3, &entries)?;
    let mut builder = SystemBuilder::new(3);
    builder.equation([(0, 1.0), (2, -2.0)], 0.5);
    let system = builder.build()?;
    let problem = Problem::new(&k, &[1.0, 2.0, -1.0], &system)?;
    for digits in 1..300 {
        let solved = problem.penalty(10_f64.powi(-digits), 1e-3);
        assert!(matches!(solved, Err(EnforceError::PenaltyTooSmall { .. })), "1e-{digits}: {solved:?}");
    }
    Ok(())
}
