//! Stores `A x = b` in dimensionless numbers ([`super::scale`]) with the sizes of its terms, and refines its solutions.
//!
//! The residual `|A x - b|_i` of row i is compared with its terms `(|A| |x| + |b|)_i`. If all these terms are rounding of larger unknowns
//! elsewhere, the row cannot meet the limit. The terms therefore count as at least a fraction ([`FLOOR`] or less) of what they would be if
//! every unknown of the connected part were as large as its largest one. Cost of one residual: three passes over the entries.

use super::EnforceError;
use super::matrix::entries;
use crate::common::{ENTRY_ROUNDING, SparseMatrix, times};

/// A relative error up to this size counts as rounding. It covers the rounding of an entry, and of the few products in which the entry
/// occurs.
pub const ROUNDING: f64 = 4.0 * ENTRY_ROUNDING;
/// The largest relative residual that a row may have: half a million machine epsilons, so that sums of many terms can reach it.
pub const BALANCED: f64 = 1e-10;
/// Floor for the terms of a row, relative to the largest terms of its part. The product `BALANCED * FLOOR` = 1e-13 is the rounding of a sum
/// of hundreds of terms.
pub const FLOOR: f64 = 1e-3;
/// Largest number of solves in a refinement. Corrections that shrink by a factor of 0.8 reach [`BALANCED`] within this number from any
/// start; slower ones are not worth their cost.
const SOLVES: usize = 200;

/// A function that computes `M^-1 r`, where M approximates A.
pub type Solve<'a> = dyn FnMut(&[f64]) -> Result<Vec<f64>, EnforceError> + 'a;

/// A square matrix A, with the sizes of its terms and the limits for residuals.
#[derive(Debug)]
pub struct Equations {
    pub a: SparseMatrix,
    /// For each entry of A the size of the terms that it was summed from; `0.1 + 0.2 - 0.3` has the size 0.6.
    pub sizes: Vec<f64>,
    /// For each unknown, one unknown that identifies its connected part.
    pub parts: Vec<usize>,
    /// Whether the size of an unknown can be compared with those of others ([`super::scale::known_units`]).
    pub known: Vec<bool>,
    /// For each row, the floor for its terms relative to the largest terms of its part, and the largest relative residual allowed.
    pub limits: Vec<(f64, f64)>,
}

impl Equations {
    /// A system of one connected part; each entry of A counts as one term, not as a sum.
    pub fn connected(a: SparseMatrix, known: Vec<bool>, limits: Vec<(f64, f64)>) -> Self {
        let sizes = a.val().iter().map(|v| v.abs()).collect();
        Self { sizes, parts: vec![0; a.nrows()], a, known, limits }
    }

    /// `A x`.
    pub fn apply(&self, x: &[f64]) -> Vec<f64> {
        times(&self.a, x)
    }

    /// The sizes of all terms of A x, before they cancel.
    pub fn size(&self, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; x.len()];
        let mut sizes = self.sizes.iter();
        for (j, x) in x.iter().enumerate() {
            self.a.symbolic().row_idx_of_col(j).zip(&mut sizes).for_each(|(i, size)| y[i] += size * x.abs());
        }
        y
    }

    /// For each row, the size of its terms `|A| |x| + |b|`, and their floor: `|A| |x|` if every unknown were as large as the largest of its
    /// part. For an unknown x_j without a known unit, the largest `size_i / |A_ij|` of its rows i takes the place of `|x_j|`.
    fn sizes_and_floor(&self, x: &[f64], b: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let size: Vec<f64> = self.size(x).iter().zip(b).map(|(ax, b)| ax + b).collect();
        let of_known: Vec<f64> = x.iter().zip(&self.known).map(|(x, known)| if *known { *x } else { 0.0 }).collect();
        let mut levels = self.levelled(&of_known);
        if self.known.contains(&false) {
            (0..x.len()).filter(|&j| !self.known[j]).for_each(|j| levels[j] = 0.0);
            for (i, j, v) in entries(&self.a).filter(|&(_, j, v)| v != 0.0 && !self.known[j]) {
                levels[j] = levels[j].max(size[i] / v.abs());
            }
        }
        let floor = self.size(&levels);
        (size, floor)
    }

    /// x with every unknown as large as the largest of its part.
    pub fn levelled(&self, x: &[f64]) -> Vec<f64> {
        let mut most = vec![0.0_f64; x.len()];
        x.iter().zip(&self.parts).for_each(|(x, &part)| most[part] = most[part].max(x.abs()));
        self.parts.iter().map(|&part| most[part]).collect()
    }

    /// Solves `A x = b.0` and refines, `x += M^-1 (b - A x)`, until residuals are rounding or do not fall; `b.1` are the sizes of the terms
    /// of b. An error of the first solve is returned; an error of a correction ends the refinement.
    pub fn refine(&self, solve: &mut Solve<'_>, b: (&[f64], &[f64])) -> Result<Refined, EnforceError> {
        let (mut residual, mut best) = self.measured(solve(b.0)?, b);
        for _ in 1..SOLVES {
            if best.imbalance <= ROUNDING {
                break;
            }
            let Ok(correction) = solve(&residual) else { break };
            let x = best.x.iter().zip(correction).map(|(x, more)| x + more).collect();
            let (rest, found) = self.measured(x, b);
            if found.share >= best.share {
                break;
            }
            (residual, best) = (rest, found);
        }
        Ok(best)
    }

    /// The residual `b - A x`, and x with the row whose residual is largest relative to its limit.
    fn measured(&self, x: Vec<f64>, b: (&[f64], &[f64])) -> (Vec<f64>, Refined) {
        let residual: Vec<f64> = b.0.iter().zip(self.apply(&x)).map(|(b, ax)| b - ax).collect();
        let (size, floor) = self.sizes_and_floor(&x, b.1);
        let mut worst = Refined { x, row: 0, imbalance: 0.0, share: 0.0 };
        for (i, residual) in residual.iter().enumerate().filter(|(_, residual)| **residual != 0.0) {
            let (of_largest, limit) = self.limits[i];
            let imbalance = residual.abs() / size[i].max(of_largest * floor[i]);
            // NaN is worse than any number.
            let imbalance = if imbalance.is_nan() { f64::INFINITY } else { imbalance };
            if imbalance / limit > worst.share {
                (worst.row, worst.imbalance, worst.share) = (i, imbalance, imbalance / limit);
            }
        }
        (residual, worst)
    }
}

/// A solution x, and the row whose residual is largest relative to its limit.
#[derive(Clone, Debug)]
pub struct Refined {
    pub x: Vec<f64>,
    /// The row whose residual is largest relative to its limit; `imbalance` is that residual relative to the terms of the row.
    pub row: usize,
    pub imbalance: f64,
    /// The largest residual relative to its limit; at most 1 is allowed.
    pub share: f64,
}
