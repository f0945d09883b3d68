//! Derivatives by dual numbers: `c(u + e)` evaluated in numbers that carry derivatives along.

use crate::constraint::Nonlinear;
use crate::scalar::{Dual, HyperDual, Scalar};

/// Directions per evaluation: enough to use the width of the machine, few enough to stay in registers.
const WIDTH: usize = 8;
/// Equations, and DOFs, that fit on the stack.
const ROWS: usize = 8;
const DOFS: usize = 32;

/// `c`, and `dc_r / du_j` at `g[r * n + j]`, in any numbers: with bounds, if u has them.
pub fn jacobian<Q: Nonlinear, S: Scalar>(q: &Q, u: &[S], c: &mut [S], g: &mut [S]) {
    let zero = Dual::<WIDTH, S>::from(0.0);
    with_scratch(zero, u.len(), c.len(), |x, value| {
        for first in (0..u.len()).step_by(WIDTH) {
            (0..u.len()).for_each(|j| x[j] = Dual::variable(u[j], j.wrapping_sub(first)));
            q.value(x, value);
            for j in first..u.len().min(first + WIDTH) {
                (0..c.len()).for_each(|r| g[r * u.len() + j] = value[r].slope[j - first]);
            }
        }
        (0..c.len()).for_each(|r| c[r] = value[r].real);
    });
}

/// `sum_r w_r d^2 c_r / du_j du_k` for each pair.
pub fn hessian<Q: Nonlinear>(q: &Q, u: &[f64], w: &[f64], h: &mut [f64]) {
    with_scratch(HyperDual::from(0.0), u.len(), w.len(), |x, value| {
        (0..u.len()).for_each(|j| x[j] = HyperDual::from(u[j]));
        let mut slot = h.iter_mut();
        q.pairs(u.len(), &mut |j, k| {
            (x[j].first, x[k].second) = (1.0, 1.0);
            q.value(x, value);
            (x[j].first, x[k].second) = (0.0, 0.0);
            if let Some(slot) = slot.next() {
                *slot = value.iter().zip(w).map(|(c, w)| w * c.mixed).sum();
            }
        });
    });
}

/// Room for the DOFs and the equations, on the stack where they are few.
fn with_scratch<S: Copy>(zero: S, dofs: usize, rows: usize, work: impl FnOnce(&mut [S], &mut [S])) {
    if dofs <= DOFS && rows <= ROWS {
        work(&mut [zero; DOFS][..dofs], &mut [zero; ROWS][..rows]);
    } else {
        work(&mut vec![zero; dofs], &mut vec![zero; rows]);
    }
}
