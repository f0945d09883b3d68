//! The factors of a factored part for other programs, in the user's units.
//!
//! The scaled equations are `D_r C D_c` with powers of two, and `D_r C_S D_c = U^T L^T`. So `C_S = V^T M^T` with
//! `M = D_c^-1 L D_c`, which has ones on its diagonal like L, and `V = D_c^-1 U D_r^-1`. Powers of two make M and V exact.

use super::FactoredBlock;
use crate::Csr;
use crate::input::scale::ldexp;

/// The factors of a [`FactoredBlock`]: [`FactoredBlock::parts`].
#[derive(Clone, Debug)]
pub struct Parts {
    /// The equation of each row of `of_masters`, `of_prescribed` and `rhs`.
    pub equations: Vec<usize>,
    /// The factor L of `C_S = U^T L^T`, with its diagonal of ones; C_S are the columns of the slaves.
    pub lower: Csr,
    /// The factor U of `C_S = U^T L^T`; C_S are the columns of the slaves.
    pub upper: Csr,
    /// C_M, the columns of the masters.
    pub of_masters: Csr,
    /// C_p, the columns of the prescribed DOFs.
    pub of_prescribed: Csr,
    /// The right-hand sides b.
    pub rhs: Vec<f64>,
}

/// `2^e x`, or None if that is not exact.
fn exactly(x: f64, e: i32) -> Option<f64> {
    let scaled = ldexp(x, e);
    (e == 0 || (scaled.is_finite() && ldexp(scaled, -e) == x)).then_some(scaled)
}

/// A matrix of these rows, with entry (k, j) multiplied by `2^exponent(k, j)`; None if a product is not exact.
fn rescaled<I: Iterator<Item = (usize, f64)>>(
    cols: usize,
    rows: impl Iterator<Item = I>,
    exponent: impl Fn(usize, usize) -> i32,
) -> Option<Csr> {
    let mut matrix = Csr::empty(cols);
    for (k, row) in rows.enumerate() {
        let row: Option<Vec<_>> = row.map(|(j, v)| Some((j, exactly(v, exponent(k, j))?))).collect();
        matrix.append(row?);
    }
    Some(matrix)
}

impl FactoredBlock {
    /// `C_S = U^T L^T`, C_M, C_p and b of the user's equations in the user's units. Rows are those of [`Parts::equations`], in the order
    /// of the elimination. Columns of `C_S` are [`FactoredBlock::slaves`], those of C_M `masters`, those of C_p `prescribed`.
    ///
    /// None if an entry of the factors leaves the range of doubles, for units that differ by more than 1e300.
    pub fn parts(&self) -> Option<Parts> {
        let lu = self.solver.lu();
        let count = lu.order.len();
        let places = || lu.order.iter().map(|&i| i as usize);
        let of_row = |k: usize| self.rows[lu.order[k] as usize];
        let of = |side: usize, j: usize| self.exponents[side].get(j).copied().unwrap_or(0);
        let lower = (0..count).map(|k| lu.l.row(k).chain([(k, 1.0)]));
        let upper = (0..count).map(|k| std::iter::once((k, lu.diagonal[k])).chain(lu.u.row(k)));
        let given = |side: usize, matrix: &Csr| {
            rescaled(matrix.cols, places().map(|i| matrix.row(i)), |k, j| -of_row(k) - of(side, j))
        };
        Some(Parts {
            equations: places().map(|i| self.equations[i]).collect(),
            lower: rescaled(count, lower, |k, j| of(0, j) - of(0, k))?,
            upper: rescaled(count, upper, |k, j| -of(0, k) - of_row(j))?,
            of_masters: given(1, &self.of_masters)?,
            of_prescribed: given(2, &self.of_prescribed)?,
            rhs: places().enumerate().map(|(k, i)| exactly(self.rhs[i], -of_row(k))).collect::<Option<_>>()?,
        })
    }
}
