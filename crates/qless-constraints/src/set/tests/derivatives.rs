//! Checks `G = dc/du` and `H = d(G^T w)/du` with weights w.

use super::every_type::{DOFS, random, set};

type Outcome = Result<(), Box<dyn std::error::Error>>;

fn configurations() -> impl Iterator<Item = Vec<f64>> {
    // The reference configuration, one near it (where rotation vectors use series), and general ones.
    [0.0, 1e-6, 0.3, 1.0, 1.7, 3.5].into_iter().map(|size| (0..DOFS as u64).map(|j| size * random(j + 1000)).collect())
}

/// Compares every formula for a Jacobian or a Hessian, and every list of pairs, with dual numbers.
#[test]
fn formulas_agree_with_dual_numbers() -> Outcome {
    let set = set()?;
    for u in configurations() {
        set.nonlinear.batches.iter().for_each(|batch| batch.compare_with_duals(&u));
    }
    Ok(())
}

/// Central differences of c have an error of order `step^2`, plus rounding divided by the step.
#[test]
fn jacobian_is_the_difference_of_values() -> Outcome {
    let set = set()?;
    let step = 1e-5;
    for u in configurations() {
        let mut at = set.allocate();
        set.evaluate(&u, &mut at).expect("of this set");
        let (mut more, mut less) = (at.clone(), at.clone());
        for j in 0..DOFS {
            let mut v = u.clone();
            v[j] = u[j] + step;
            set.evaluate(&v, &mut more).expect("of this set");
            v[j] = u[j] - step;
            set.evaluate(&v, &mut less).expect("of this set");
            for row in 0..set.equations() {
                let exact = at.g.row(row).find(|&(col, _)| col == j).map_or(0.0, |(_, value)| value);
                let difference = (more.c[row] - less.c[row]) / (2.0 * step);
                assert!(
                    (exact - difference).abs() < 1e-8,
                    "{} DOF {j}: {exact}, {difference}",
                    set.label(row).expect("of this set")
                );
            }
        }
    }
    Ok(())
}

/// Compares all of H, including entries outside its pattern, with central differences of `G^T w`.
#[test]
fn hessian_is_the_difference_of_jacobians() -> Outcome {
    let set = set()?;
    let (step, w) = (1e-5, (0..set.equations() as u64).map(random).collect::<Vec<_>>());
    for u in configurations() {
        let mut at = set.allocate();
        set.evaluate(&u, &mut at).expect("of this set");
        set.effective_hessian(&u, &w, &mut at).expect("of this set");
        assert_eq!(Ok(&at.h), at.h.transpose().as_ref());
        let force = |v: &[f64]| {
            let mut moved = set.allocate();
            set.evaluate(v, &mut moved).expect("of this set");
            moved.g.transpose().expect("few DOFs").times(&w).expect("a weight for each row")
        };
        for j in 0..DOFS {
            let mut v = u.clone();
            v[j] = u[j] + step;
            let more = force(&v);
            v[j] = u[j] - step;
            let less = force(&v);
            let mut exact = vec![0.0; DOFS];
            at.h.row(j).for_each(|(k, value)| exact[k] = value);
            for k in 0..DOFS {
                let difference = (more[k] - less[k]) / (2.0 * step);
                assert!((exact[k] - difference).abs() < 1e-7, "H({j}, {k}): {}, {difference}", exact[k]);
            }
        }
    }
    Ok(())
}
