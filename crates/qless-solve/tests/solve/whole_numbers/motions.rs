//! The motion that an error names is free: C vanishes on it, and `K v` is a combination of the rows of C.

use faer::Mat;
use faer::linalg::solvers::SolveLstsq;
use qless_solve::enforce::{EnforceError, FreeMotion};

use super::{Case, Outcome, all_methods, for_each_case};

#[test]
fn motions_left_free_are_named() -> Outcome {
    let mut named = 0;
    for_each_case(|case| {
        let is_singular = case.right.is_none();
        for (method, _, solved) in all_methods(&case.problem, case.given.system.equations()) {
            match solved {
                Err(EnforceError::Unsupported(motion)) if is_singular => {
                    let (felt, moves) = felt(case, &motion);
                    assert!(moves && felt < 1e-9, "{}: {method}: {felt:e}: {motion:?}", case.name);
                    named += 1;
                }
                solved => assert!(!is_singular, "{}: {method}: {solved:?}", case.name),
            }
        }
        Ok(())
    })?;
    assert!(named > 5000, "{named}");
    Ok(())
}

/// The residuals of `K v + C^T lambda` with the best lambda, and of `C v`, and whether only free DOFs move.
fn felt(case: &Case, motion: &FreeMotion) -> (f64, bool) {
    let (model, free, kept) = (case.model, case.model.free(), case.problem.kept());
    let mut v = vec![0.0; model.f.len()];
    motion.dofs.iter().zip(&motion.motion).for_each(|(&j, &x)| v[j] = x);
    let along = |row: &[i128]| row.iter().zip(&v).map(|(a, x)| *a as f64 * x).sum::<f64>();
    let gaps = kept.iter().map(|&row| along(&model.c[row]).abs()).fold(0.0, f64::max);
    let forces = Mat::from_fn(free.len(), 1, |i, _| along(&model.k[free[i]]));
    let c = Mat::from_fn(free.len(), kept.len(), |i, r| model.c[kept[r]][free[i]] as f64);
    let rest = if kept.is_empty() { forces } else { &forces - &c * c.col_piv_qr().solve_lstsq(&forces) };
    (gaps.max(rest.norm_max()), motion.dofs.iter().all(|j| free.contains(j)))
}
