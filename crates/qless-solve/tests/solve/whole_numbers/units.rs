//! A separate unit for each DOF, as in models with lengths, angles and pressures: results do not depend on units.

use faer::sparse::{SparseColMat, Triplet};
use qless::SystemBuilder;

use super::measure::Measure;
use super::models::{Random, model};
use super::{MODELS, Outcome, all_methods, is_of_springs, is_of_support};
use qless_solve::enforce::{Problem, Stiffness};

/// Factor by which an estimate may be wrong.
const MARGIN: f64 = 3.0;
const ROUNDING: f64 = 1e-11;
/// Exponents of the units.
const POWERS: [u64; 3] = [0, 10, 20];

#[test]
fn units_of_dofs_make_nothing_wrong_that_was_right() -> Outcome {
    let (mut right, mut refused, mut singular) = (0, 0, 0);
    let random = &mut Random(25);
    for (model, powers) in (0..3 * MODELS).map(model).flat_map(|model| POWERS.map(|power| (model.clone(), power))) {
        let Some((_, false)) = model.rank() else { continue };
        let unit = |_| 2_f64.powi(random.below(2 * powers + 1) as i32 - powers as i32);
        let units: Vec<f64> = (0..model.f.len()).map(unit).collect();
        let given = model.given_in(1.0, 1.0, &units)?;
        let problem = Problem::new(Stiffness::unsymmetric(&given.k), &given.f, &given.system)?;
        let Ok(exact) = model.solution(problem.kept()) else { continue };
        let measure = Measure::new(&model, problem.kept());
        for (method, springs, solved) in all_methods(&problem, given.system.equations()) {
            let name = format!("{}: {method}, {units:?}", model.name);
            match (&exact, solved) {
                (Some((u, _)), Ok(solution)) => {
                    let found: Vec<f64> = solution.u.iter().zip(&units).map(|(u, unit)| u / unit).collect();
                    let off = measure.off(&found, u, 1.0);
                    let allowed = (MARGIN * solution.accuracy).max(ROUNDING);
                    assert!(off <= allowed, "{name}: {off:e}, {:e}", solution.accuracy);
                    right += 1;
                }
                (Some(_), Err(error)) => {
                    assert!(springs && is_of_springs(&error), "{name}: {error}");
                    refused += 1;
                }
                (None, Ok(solution)) => {
                    panic!("{name}: u = {:?}, to {:e}", solution.u, solution.accuracy)
                }
                (None, Err(error)) => {
                    assert!(is_of_support(&error), "{name}: {error}");
                    singular += 1;
                }
            }
        }
    }
    println!("{right} right, {refused} refused, {singular} singular");
    assert!(right > 10_000 && singular > 5_000 && refused * 10 < right, "{right}, {refused}, {singular}");
    Ok(())
}

/// A free spring 0-1, and two DOFs without stiffness in units of 3e4. Springs of 1e17 in that unit leave only rounding of K.
#[test]
fn springs_hold_nothing_in_large_units_either() -> Outcome {
    let t = 1.0 / 3e4;
    let k = [(0, 0, 0.3), (0, 1, -0.3), (1, 0, -0.3), (1, 1, 0.3)].map(|(i, j, v)| Triplet::new(i, j, v));
    let k = SparseColMat::try_new_from_triplets(4, 4, &k)?;
    let mut builder = SystemBuilder::new(4);
    builder.equation([(1, 1.0), (2, t)], 0.0);
    builder.equation([(2, t), (3, 2.0 * t)], 1.0);
    let system = builder.build()?;
    let loads = [-0.3, 0.6, 0.0, -0.6 * t];
    let problem = Problem::new(&k, &loads, &system)?;
    for digits in 0..15 {
        let factor = 10_f64.powi(digits);
        for solved in [problem.penalty(factor, 1e-6), problem.augmented(factor, 1e-6)] {
            assert!(solved.as_ref().is_err_and(is_of_support), "{factor:e}: {solved:?}");
        }
    }
    Ok(())
}

/// `u = (2 / t, t)`, whatever the forces are: K has no diagonal, so that u_0 and u_1 cannot be compared.
#[test]
fn numbers_that_cannot_be_compared_are_not() -> Outcome {
    for t in [1.0, 1e2, 1e3, 1e4, 1e5] {
        let k = SparseColMat::try_new_from_triplets(2, 2, &[Triplet::new(0, 1, 3.0), Triplet::new(1, 0, 2.0)])?;
        let mut builder = SystemBuilder::new(2);
        builder.equation([(0, -3.0 * t)], -6.0);
        builder.equation([(1, -1.0 / t)], -1.0);
        let system = builder.build()?;
        let loads = [12.0 * t, 4.0 / t];
        let problem = Problem::new(&k, &loads, &system)?;
        for solved in [problem.penalty(1e6, 1e-6), problem.augmented(1e6, 1e-6)] {
            match solved {
                Ok(solution) => assert!((solution.u[0] * t - 2.0).abs() < 1e-5, "{t:e}: {:?}", solution.u),
                Err(error) => assert!(is_of_springs(&error), "{t:e}: {error}"),
            }
        }
    }
    Ok(())
}
