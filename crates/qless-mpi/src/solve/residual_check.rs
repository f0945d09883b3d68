//! Checks the rows of T, G and g that a rank derived from one equation alone: inserted into that equation, they must leave no residual.
//!
//! The check uses random u_q and u_p, and considers the terms of T, of G and of g separately.

use qless::common::SplitMix64;

use super::rows::{PRESCRIBED_BIT, ReductionRow, SlaveRows};
use crate::components::TouchedDofs;
use crate::distribute::Peel;
use crate::share::ShareRows;

/// Three sums of terms: those of T for random u_q, those of G for random u_p, and the constants. Each comes with the sum of the absolute
/// values of its terms.
type ResidualSums = [(f64, f64); 3];

/// Inserts the row `made` into the peeled equation. Returns the largest of three residuals: that of the terms of T, of G, and of the
/// constants. Each is relative to the sum of the absolute values of its terms. Infinite if one is not a number.
pub(crate) fn residual(
    peel: Peel,
    rows: &ShareRows,
    touched: &TouchedDofs,
    slaves: &SlaveRows,
    made: ReductionRow,
) -> f64 {
    let range = rows.starts[peel.row()]..rows.starts[peel.row() + 1];
    let mut sums: ResidualSums = [(0.0, 0.0), (0.0, 0.0), (-rows.rhs[peel.row()], rows.rhs[peel.row()].abs())];
    for k in range {
        let of_dof = if k == peel.place(rows) {
            of_row(made)
        } else {
            let group = usize::from(slaves.is_prescribed[touched.places[k] as usize]);
            slaves.find(touched.places[k]).map_or_else(|| single(rows.dofs[k], group), of_row)
        };
        for (sum, term) in sums.iter_mut().zip(of_dof) {
            *sum = (sum.0 + rows.values[k] * term.0, sum.1 + rows.values[k].abs() * term.1);
        }
    }
    let relative = |(sum, size): (f64, f64)| {
        let relative = if size == 0.0 { sum.abs() } else { sum.abs() / size };
        if relative.is_finite() { relative } else { f64::INFINITY }
    };
    sums.into_iter().map(relative).fold(0.0, f64::max)
}

fn single(dof: u64, group: usize) -> ResidualSums {
    let mut sums = [(0.0, 0.0); 3];
    sums[group] = (random(dof), 1.0);
    sums
}

fn of_row(row: ReductionRow) -> ResidualSums {
    let mut sums = [(0.0, 0.0), (0.0, 0.0), (row.constant, row.constant.abs())];
    for (&dof, value) in row.dofs.iter().zip(row.values) {
        let sum = &mut sums[usize::from(dof & PRESCRIBED_BIT != 0)];
        *sum = (sum.0 + value * random(dof & !PRESCRIBED_BIT), sum.1 + value.abs());
    }
    sums
}

/// A pseudo-random number between -1 and 1 for each DOF, the same on all ranks.
fn random(dof: u64) -> f64 {
    (SplitMix64::new(dof).next() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::components::NONE;
    use crate::solve::ReductionRows;

    /// `2 u0 - u1 - u2 = 3` with u2 = 0.5 u3 + 1 from another rank: an error in T or g gives a residual.
    #[test]
    fn an_error_of_a_millionth_gives_a_residual() {
        let mut rows = ShareRows::new();
        rows.push(0, 3.0, [(0, 2.0), (1, -1.0), (2, -1.0)].into_iter());
        let touched = TouchedDofs::by(&rows, &(0..4));
        let mut reduction = ReductionRows::default();
        reduction.push(2, 1.0, [(3, 0.5)].into_iter());
        let slaves = SlaveRows { reduction, of_place: vec![NONE, NONE, 0], is_prescribed: vec![false; 3] };
        let found = |constant: f64, a: f64, b: f64| {
            let mut made = ReductionRows::default();
            made.push(0, constant, [(1, a), (3, b)].into_iter());
            residual(Peel { row: 0, position: 0 }, &rows, &touched, &slaves, made.row(0))
        };
        assert!(found(2.0, 0.5, 0.25) <= 1e-16);
        for off in [found(2.0 + 1e-6, 0.5, 0.25), found(2.0, 0.5 + 1e-6, 0.25), found(2.0, 0.5, 0.25 - 1e-6)] {
            assert!(off > 1e-8, "{off}");
        }
        for numberless in [found(f64::NAN, 0.5, 0.25), found(2.0, f64::INFINITY, 0.25), found(2.0, 0.5, f64::NAN)] {
            assert_eq!(numberless, f64::INFINITY);
        }
    }
}
