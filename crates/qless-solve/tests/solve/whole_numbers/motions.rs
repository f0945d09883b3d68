//! The motion that an error names is free: C vanishes on it, and `K v` is a combination of the rows of C.

use faer::Mat;
use faer::linalg::solvers::SolveLstsq;
use qless_solve::enforce::FreeMotion;

use super::Case;

/// The residuals of `K v + C^T lambda` with the best lambda, and of `C v`, and whether only free DOFs move.
pub fn felt(case: &Case, motion: &FreeMotion) -> (f64, bool) {
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
