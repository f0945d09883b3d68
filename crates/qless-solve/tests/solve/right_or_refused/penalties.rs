//! Penalties reach the requested accuracy, or are refused with a factor that does.

use qless_solve::enforce::{EnforceError, Method, Problem};

use super::dense;
use super::models::{Kind, Lack, all_units, model, off};
use crate::linkages::Outcome;

/// From much too soft to 1e20, where `K + C^T D C` has lost K: returned solutions have the requested accuracy, and each refusal names a
/// sufficient factor.
#[test]
fn a_penalty_is_right_or_refused_with_one_that_is() -> Outcome {
    let (mut right, mut soft) = (0, 0);
    for (case, units) in all_units().enumerate() {
        let model = model(case + 60, Kind::Symmetric, Lack::Nothing, units)?;
        let problem = Problem::new(&model.k, &model.f, &model.system)?;
        let (u, _) = dense::solution(&model, problem.kept())?;
        let check = |factor: f64, accuracy: f64| -> Result<(), EnforceError> {
            let solution = problem.penalty(factor, accuracy)?;
            let error = off(&model, &solution.u, &u);
            assert!(error <= 3.0 * accuracy, "{}: {factor:e}: {error:e} of {accuracy:e}", model.name);
            Ok(())
        };
        for digits in (-2..=20).step_by(2) {
            let (factor, accuracy) = (10_f64.powi(digits), 1e-6);
            match check(factor, accuracy) {
                Ok(()) => right += 1,
                Err(EnforceError::PenaltyTooSmall { smallest: Some(smallest), cost, .. }) => {
                    assert!(smallest > factor && cost > accuracy, "{}", model.name);
                    check(smallest, accuracy)?;
                    soft += 1;
                }
                Err(other) => return Err(format!("{}: {factor:e}: {other}", model.name).into()),
            }
        }
    }
    println!("{right} right, {soft} too soft");
    assert!(right > 50 && soft > 9);
    Ok(())
}

/// An accuracy that no penalty reaches is refused without a factor; multipliers reach it.
#[test]
fn what_no_penalty_can_do_is_said() -> Outcome {
    let model = model(4, Kind::Symmetric, Lack::Nothing, super::models::PLAIN)?;
    let problem = Problem::new(&model.k, &model.f, &model.system)?;
    match problem.penalty(1e3, 1e-17) {
        Err(error @ EnforceError::PenaltyTooSmall { smallest: None, .. }) => {
            assert!(error.to_string().contains("multipliers"), "{error}");
        }
        other => return Err(format!("{other:?}").into()),
    }
    let exact = problem.lagrange()?;
    for factor in [1e-6, 1e-3, 1e14, 1e18, 1e25] {
        let solution = problem.augmented(factor, 1e-12)?;
        let error = off(&model, &solution.u, &exact.u);
        assert!(solution.imbalance <= 1e-12 && error <= 3.0 * solution.accuracy, "{factor:e}: {error:e}");
    }
    for accuracy in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(problem.penalty(1e6, accuracy), Err(EnforceError::Accuracy(_))));
    }
    let short = vec![Method::Multiplier; model.system.equations() - 1];
    assert!(matches!(problem.enforce(&short, 1e-8), Err(EnforceError::Argument(_))));
    Ok(())
}
