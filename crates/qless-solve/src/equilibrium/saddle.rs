//! The saddle system `[K + H, G^T; G, 0] [du; dlambda] = [a; b]` on free DOFs and kept rows, scaled from both sides and solved by sparse
//! LU.
//!
//! `A = D (saddle) D` has entries of size one. D of a DOF is a displacement per square root of energy, so that all entries of a scaled
//! correction `D^-1 x` have the same unit, as have those of a scaled residual `D r`. The symbolic factors stay the same while the pattern
//! does ([`SaddlePattern`]).

use faer::Mat;
use faer::prelude::Solve;
use faer::sparse::linalg::solvers::{Lu, SymbolicLu};
use faer::sparse::{SymbolicSparseColMat, Triplet};

use crate::common::{SparseMatrix, random, times};

/// Number of passes of scaling by square roots of the largest entries. Each pass halves the exponents, which have 10 bits.
const ROUNDS: usize = 10;
/// A singular value of the scaled matrix below this, about 50 units in the last place, is rounding of the factors; the largest entries are
/// one.
pub const SINGULAR: f64 = 1e-14;
/// A DOF takes part in a motion if it moves by at least this fraction of the largest. It only decides which DOFs an error names.
const MOVES: f64 = 0.1;

/// Entries `(row, column, value)` of a symmetric matrix; repeated ones are summed.
pub struct SaddleEntries {
    /// Units of the DOFs, which come first, and of the equations. Scaling starts from them.
    pub units: Vec<f64>,
    /// Number of DOFs.
    pub free: usize,
    /// Number of entries of the model's stiffness, which come first in `list`.
    pub stiff: usize,
    pub list: Vec<(usize, usize, f64)>,
}

/// The scaled matrix with its factors.
pub struct Saddle {
    scale: Vec<f64>,
    /// The scaled matrix `A = D (saddle) D` with the scales D.
    pub a: SparseMatrix,
    lu: Lu<usize, f64>,
    /// The unit vector y with the smallest `|A y|`, and this smallest length; A is the scaled matrix.
    pub softest: (Vec<f64>, f64),
}

impl Saddle {
    /// Scales and factors; `added` is added to the diagonal of the DOFs in the scaled matrix.
    pub fn new(entries: &SaddleEntries, added: f64, pattern: &mut SaddlePattern) -> Result<Self, String> {
        let (scale, size) = (scaling(entries), entries.units.len());
        let scaled = entries.list.iter().map(|&(i, j, v)| Triplet::new(i, j, scale[i] * v * scale[j]));
        let diagonal =
            |shift: f64| (0..size).map(move |i| Triplet::new(i, i, if i < entries.free { added } else { 0.0 } + shift));
        let matrix = |shift: f64| -> Result<SparseMatrix, String> {
            let list: Vec<_> = scaled.clone().chain(diagonal(shift)).collect();
            SparseMatrix::try_new_from_triplets(size, size, &list).map_err(|e| format!("{e:?}"))
        };
        let a = matrix(0.0)?;
        let lu = pattern.factors(&a)?;
        let softest = match inverse_iteration(&lu, size) {
            Some(found) => found,
            // If a pivot is zero, factors of a slightly shifted matrix give the same null vector; its singular value is zero.
            None => (inverse_iteration(&pattern.factors(&matrix(SINGULAR)?)?, size).unwrap_or_default().0, 0.0),
        };
        Ok(Self { scale, a, lu, softest })
    }

    /// Solves, with one step of refinement.
    pub fn solve(&self, rhs: &[f64]) -> Vec<f64> {
        let b: Vec<f64> = rhs.iter().zip(&self.scale).map(|(r, d)| r * d).collect();
        let mut y = inverse(&self.lu, &b);
        let rest: Vec<f64> = b.iter().zip(times(&self.a, &y)).map(|(b, a)| b - a).collect();
        y.iter_mut().zip(inverse(&self.lu, &rest)).for_each(|(y, more)| *y += more);
        y.iter().zip(&self.scale).map(|(y, d)| y * d).collect()
    }

    /// Norm `|D^-1 x|` of a correction x in the scales D.
    pub fn length(&self, x: &[f64]) -> f64 {
        x.iter().zip(&self.scale).fold(0.0, |sum: f64, (x, d)| sum.hypot(x / d))
    }

    /// The product `D (saddle) D y` for another saddle matrix, with the scales D of this one.
    pub fn applied(&self, entries: &SaddleEntries, y: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; y.len()];
        entries.list.iter().for_each(|&(i, j, v)| sum[i] += self.scale[i] * v * self.scale[j] * y[j]);
        sum
    }
}

fn inverse(lu: &Lu<usize, f64>, b: &[f64]) -> Vec<f64> {
    if b.is_empty() {
        return Vec::new();
    }
    let x = lu.solve(Mat::from_fn(b.len(), 1, |i, _| b[i]));
    (0..b.len()).map(|i| x[(i, 0)]).collect()
}

/// The unit vector y with the smallest `|A y|` for the factored matrix A, and this length; none if a pivot is zero.
fn inverse_iteration(lu: &Lu<usize, f64>, n: usize) -> Option<(Vec<f64>, f64)> {
    let unit = |x: Vec<f64>| -> (Vec<f64>, f64) {
        let size = norm(&x);
        (x.iter().map(|x| x / size).collect(), size)
    };
    let (mut y, mut size) = (unit((0..n as u64).map(random).collect()).0, f64::INFINITY);
    for _ in 0..3 {
        (y, size) = unit(inverse(lu, &y));
        if !size.is_finite() {
            return None;
        }
    }
    Some((y, 1.0 / size))
}

/// Indices with large entries, in descending order of size.
pub fn largest(y: &[f64]) -> Vec<usize> {
    let most = y.iter().fold(0.0, |most: f64, y| most.max(y.abs()));
    let mut places: Vec<usize> = (0..y.len()).filter(|&i| most > 0.0 && y[i].abs() >= MOVES * most).collect();
    places.sort_by(|&a, &b| y[b].abs().total_cmp(&y[a].abs()));
    places
}

/// Powers of two that bring the largest entry of each row to about one.
///
/// DOFs with stiffness are scaled by stiffness alone: a rotation tied to a translation may differ from it in stiffness by the units, and
/// constraints must not hide that. The other DOFs are scaled to match. If several scales match, the start decides: the units, and a unit of
/// force that makes stiffness and constraints of equal size.
fn scaling(entries: &SaddleEntries) -> Vec<f64> {
    let SaddleEntries { units, free, stiff, list } = entries;
    let mut held = vec![false; units.len()];
    list[..*stiff].iter().filter(|(.., v)| *v != 0.0).for_each(|&(i, ..)| held[i] = true);
    let in_rows = |of: fn(usize, usize, usize) -> bool, scale: &[f64]| {
        let mut most = vec![0.0_f64; scale.len()];
        let own = list.iter().filter(|&&(i, j, _)| of(i, j, *free));
        own.for_each(|&(i, j, v)| most[i] = most[i].max((scale[i] * v * scale[j]).abs()));
        most
    };
    let (motion, all) = (|i, j, free| i < free && j < free, |_, _, _| true);
    let most = in_rows(motion, units).into_iter().fold(0.0, f64::max);
    let energy = if most > 0.0 { most.sqrt().recip() } else { 1.0 };
    let rows = in_rows(all, units);
    let start = |i: usize| match rows[i] {
        size if i >= *free && size > 0.0 => (size * energy).recip(),
        _ => units[i] * energy,
    };
    let mut scale: Vec<f64> = (0..units.len()).map(start).collect();
    for round in 0..3 * ROUNDS {
        let of_stiffness = round < ROUNDS;
        let most = in_rows(if of_stiffness { motion } else { all }, &scale);
        let moved = (0..scale.len()).filter(|&i| held[i] == of_stiffness && most[i] > 0.0);
        moved.collect::<Vec<_>>().into_iter().for_each(|i| scale[i] /= most[i].sqrt());
    }
    scale.iter().map(|d| d.log2().round().exp2()).collect()
}

pub fn norm(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |sum: f64, x| sum.hypot(*x))
}

/// The last pattern with its symbolic factors.
#[derive(Default)]
pub struct SaddlePattern(Option<(SymbolicSparseColMat<usize>, SymbolicLu<usize>)>);

impl SaddlePattern {
    /// Factors a matrix; the symbolic factors are used again while the pattern stays the same.
    fn factors(&mut self, a: &SparseMatrix) -> Result<Lu<usize, f64>, String> {
        let now = a.symbolic();
        let is_same = |of: &SymbolicSparseColMat<usize>| of.col_ptr() == now.col_ptr() && of.row_idx() == now.row_idx();
        if !self.0.as_ref().is_some_and(|(of, _)| is_same(of)) {
            let symbolic = SymbolicLu::try_new(now).map_err(|e| format!("{e:?}"))?;
            self.0 = Some((now.to_owned().map_err(|e| format!("{e:?}"))?, symbolic));
        }
        let (_, symbolic) = self.0.as_ref().expect("it was just made");
        Lu::try_new_with_symbolic(symbolic.clone(), a.as_ref()).map_err(|e| format!("{e:?}"))
    }
}
