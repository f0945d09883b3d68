//! Checks the rows of T, G and g that a rank derived from one equation alone: put into that equation they must leave no residual.
//!
//! The check uses random u_q and u_p, and looks at the parts of T, of G and of g separately.

use qless::common::SplitMix64;

use super::rows::{PRESCRIBED_BIT, ReductionRow, SlaveRows};
use crate::distribute::Peel;
use crate::parts::TouchedDofs;
use crate::share::ShareRows;

/// For random u_q, for random u_p, and for the constant: the sum, and the sum of the absolute values of its terms.
type ResidualParts = [(f64, f64); 3];

/// The largest residual of the equation, relative to the sizes of its parts; infinite if one of them is no number.
pub(crate) fn residual(
    peel: Peel,
    rows: &ShareRows,
    touched: &TouchedDofs,
    slaves: &SlaveRows,
    made: ReductionRow,
) -> f64 {
    let range = rows.starts[peel.row()]..rows.starts[peel.row() + 1];
    let mut sums: ResidualParts = [(0.0, 0.0), (0.0, 0.0), (-rows.rhs[peel.row()], rows.rhs[peel.row()].abs())];
    for k in range {
        let of_dof = if k == peel.place(rows) {
            parts(made)
        } else {
            let given = usize::from(slaves.is_given(touched.places[k]));
            slaves.find(touched.places[k]).map_or_else(|| single(rows.dofs[k], given), parts)
        };
        for (sum, part) in sums.iter_mut().zip(of_dof) {
            *sum = (sum.0 + rows.values[k] * part.0, sum.1 + rows.values[k].abs() * part.1);
        }
    }
    let relative = |(sum, size): (f64, f64)| {
        let of_parts = if size == 0.0 { sum.abs() } else { sum.abs() / size };
        if of_parts.is_finite() { of_parts } else { f64::INFINITY }
    };
    sums.into_iter().map(relative).fold(0.0, f64::max)
}

fn single(dof: u64, part: usize) -> ResidualParts {
    let mut parts = [(0.0, 0.0); 3];
    parts[part] = (random(dof), 1.0);
    parts
}

fn parts(line: ReductionRow) -> ResidualParts {
    let mut parts = [(0.0, 0.0), (0.0, 0.0), (line.constant, line.constant.abs())];
    for (&dof, value) in line.dofs.iter().zip(line.values) {
        let part = &mut parts[usize::from(dof & PRESCRIBED_BIT != 0)];
        *part = (part.0 + value * random(dof & !PRESCRIBED_BIT), part.1 + value.abs());
    }
    parts
}

/// A number of a DOF between -1 and 1, the same on all ranks.
fn random(dof: u64) -> f64 {
    (SplitMix64::new(dof).next() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parts::NONE;
    use crate::solve::ReductionRows;

    /// `2 u0 - u1 - u2 = 3`, u2 = 0.5 u3 + 1 by another rank: what is right passes, what is off in any part does not.
    #[test]
    fn what_is_off_by_a_millionth_does_not_pass() {
        let mut rows = ShareRows::new();
        rows.push(0, 3.0, [(0, 2.0), (1, -1.0), (2, -1.0)].into_iter());
        let touched = TouchedDofs::by(&rows, &(0..4));
        let mut lines = ReductionRows::default();
        lines.push(2, 1.0, [(3, 0.5)].into_iter());
        let slaves = SlaveRows { lines, of_place: vec![NONE, NONE, 0], given: vec![false; 3] };
        let found = |constant: f64, a: f64, b: f64| {
            let mut made = ReductionRows::default();
            made.push(0, constant, [(1, a), (3, b)].into_iter());
            residual(Peel { row: 0, position: 0 }, &rows, &touched, &slaves, made.line(0))
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
