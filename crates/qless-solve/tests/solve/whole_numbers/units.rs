//! A separate unit for each DOF, as in models with lengths, angles and pressures: results do not depend on units.

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
    let random = &mut Random::new(25);
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
