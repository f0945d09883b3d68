//! Parts of K without a diagonal entry: units of their DOFs cannot be compared, so that the stated accuracy holds for each DOF.

use super::measure::Measure;
use super::models::{Random, model};
use super::{MODELS, Outcome};
use qless_solve::enforce::{EnforceError, Method, Problem, Stiffness};

/// Factor by which an estimate may be wrong.
const MARGIN: f64 = 3.0;
const ROUNDING: f64 = 1e-12;
/// Largest exponent of a unit, and the first model. Regression: accuracies stated for these were entirely wrong.
const POWER: u64 = 30;
const FIRST: usize = 20_000;

/// How many were right, too soft, and refused for another reason.
#[derive(Debug, Default)]
struct Counts {
    right: usize,
    soft: usize,
    refused: usize,
}

/// Penalties on all equations, or each method in turn.
fn methods(random: &mut Random, rows: usize, turn: usize) -> (Vec<Method>, f64) {
    let (factor, accuracy) = (10_f64.powi(random.below(12) as i32), 10_f64.powi(-1 - random.below(9) as i32));
    let method = |row: usize| match if turn % 2 == 1 { (row + turn) % 4 } else { 0 } {
        0 => Method::Penalty { factor },
        1 => Method::Multiplier,
        2 => Method::Elimination,
        _ => Method::Augmented { factor },
    };
    ((0..rows).map(method).collect(), accuracy)
}

#[test]
fn accuracies_are_true_where_no_units_can_be_compared() -> Outcome {
    let mut counts = Counts::default();
    for seed in FIRST..FIRST + 33 * MODELS {
        let (mut model, random) = (model(seed), &mut Random::new(seed as u64));
        (0..model.f.len()).for_each(|i| model.k[i][i] = 0);
        let Some((_, false)) = model.rank() else { continue };
        let unit = |_| 2_f64.powi(random.below(2 * POWER + 1) as i32 - POWER as i32);
        let units: Vec<f64> = (0..model.f.len()).map(unit).collect();
        let given = model.given_in(1.0, 1.0, &units)?;
        let problem = Problem::new(Stiffness::unsymmetric(&given.k), &given.f, &given.system)?;
        let Ok(Some((right, _))) = model.solution(problem.kept()) else { continue };
        let measure = Measure::new(&model, problem.kept());
        for turn in 0..if problem.kept().is_empty() { 0 } else { 6 } {
            let (methods, accuracy) = methods(random, given.system.equations(), turn);
            match problem.enforce(&methods, accuracy) {
                Ok(solution) => {
                    let found: Vec<f64> = solution.u.iter().zip(&units).map(|(u, unit)| u / unit).collect();
                    let (off, stated) = (measure.off(&found, &right, 1.0), solution.accuracy);
                    let name = format!("{}: {methods:?}, {accuracy:e}, {units:?}", model.name);
                    assert!(off <= (MARGIN * stated).max(ROUNDING), "{name}: {off:e} of {stated:e}");
                    counts.right += 1;
                }
                Err(EnforceError::PenaltyTooSmall { .. }) => counts.soft += 1,
                Err(_) => counts.refused += 1,
            }
        }
    }
    println!("{counts:?}");
    assert!(counts.right > 40_000 && counts.refused * 1000 < counts.right, "{counts:?}");
    Ok(())
}
