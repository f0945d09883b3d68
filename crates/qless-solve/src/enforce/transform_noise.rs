//! Finds entries of T that are rounding, by their size in an equilibrated T:
//!
//! ```text
//! R T S has largest entries near 1 in each row and column (Ruiz 2001)        an entry of R T S above 2^-40 is no rounding
//! ```
//!
//! A factorization leaves entries of relative size `eps` where T has zeros. A master that only such entries connect to K has no stiffness.
//! The scales R and S are needed because the entries of a row may have different units.
//! some more if some entries are small.

use qless::Csr;

use super::scale::{scales, times_power};
use crate::common::ENTRY_ROUNDING;

/// Equilibrated entries up to this size are rounding: far above what `eps` becomes in thousands of steps, far below what a user means.
const NOISE: f64 = 1.0 / (1_u64 << 40) as f64;
/// Exponents of the scales R of the rows and S of the columns of T; none if no entry is small in its row.
#[derive(Debug)]
pub struct TransformNoise(Option<Vec<i32>>);

impl TransformNoise {
    pub fn new(t: &Csr) -> Self {
        let is_small = |i: usize| {
            let sizes = t.row(i).map(|(_, v)| v.abs()).filter(|v| *v > 0.0);
            let (least, most) = sizes.fold((f64::INFINITY, 0.0_f64), |(a, b), v| (a.min(v), b.max(v)));
            least < NOISE * most
        };
        let entries = (0..t.rows()).flat_map(|i| t.row(i).map(move |(q, v)| (i, t.rows() + q, v)));
        let scales = || scales(entries, std::iter::empty(), (t.rows() + t.cols(), 0));
        Self((0..t.rows()).any(is_small).then(scales))
    }

    /// The size of the terms of an entry of T. For rounding, it is the size of the numbers that cancelled; for other entries, the absolute
    /// value. T has `rows` rows.
    pub fn size(&self, (row, col, rows): (usize, usize, usize), value: f64) -> f64 {
        let Some(scale) = &self.0 else { return value.abs() };
        let unit = times_power(1.0, -scale[row] - scale[rows + col]);
        if value.abs() > NOISE * unit { value.abs() } else { unit.min(value.abs() / ENTRY_ROUNDING) }
    }
}
