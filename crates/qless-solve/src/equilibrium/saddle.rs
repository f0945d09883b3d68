//! The saddle system `[K + H, G^T; G, 0] [du; dlambda] = [a; b]` on free DOFs and kept rows, scaled from both sides and solved by sparse
//! LU.
//!
//! `A = D (saddle) D` has entries of size one. D of a DOF is a displacement per square root of energy, so that all entries of a scaled
//! correction `D^-1 x` have the same unit, as have those of a scaled residual `D r`. The pattern and the symbolic factors stay the same
//! while the same rows are kept ([`SaddlePattern`]).

use faer::Mat;
use faer::prelude::Solve;
use faer::sparse::linalg::solvers::{Lu, SymbolicLu};
use faer::sparse::{Argsort, Pair, SymbolicSparseColMat};

use crate::common::{SparseMatrix, random, times};

/// Passes of scaling by square roots of the largest entries.
const ROUNDS: usize = 10;
/// A singular value below this counts as zero; the largest entries are one.
const SINGULAR: f64 = 1e-14;
/// Added to the diagonal if a pivot is zero.
const SHIFT: f64 = 1e-13;
/// A DOF takes part in a motion if it moves by at least this fraction of the largest.
const MOVES: f64 = 0.1;

/// Entries `(row, column, value)` of a square matrix; repeated ones are summed.
pub struct SaddleEntries {
    pub size: usize,
    /// Number of entries of the model's stiffness, which come first.
    pub stiff: usize,
    pub list: Vec<(usize, usize, f64)>,
    /// Units of the DOFs, from which scaling starts; empty if all start equal.
    pub units: Vec<f64>,
}

/// The scaled matrix with its factors.
pub struct Saddle {
    scale: Vec<f64>,
    /// `A = D (saddle) D`.
    pub a: SparseMatrix,
    lu: Lu<usize, f64>,
}

impl Saddle {
    /// Scales and factors; `added` is added to the first `free` diagonal entries of the scaled matrix.
    pub fn new(entries: &SaddleEntries, free: usize, added: f64, pattern: &mut SaddlePattern) -> Result<Self, String> {
        let scale = scaling(entries, free);
        let scaled = entries.list.iter().map(|&(i, j, v)| (i, j, scale[i] * v * scale[j]));
        let more = (0..entries.size).map(|i| (i, i, if i < free { added } else { 0.0 }));
        let a = pattern.matrix(entries.size, &scaled.chain(more).collect::<Vec<_>>())?;
        let lu = pattern.factors(&a)?;
        Ok(Self { scale, a, lu })
    }

    /// Solves, with one step of refinement.
    pub fn solve(&self, rhs: &[f64]) -> Vec<f64> {
        let b: Vec<f64> = rhs.iter().zip(&self.scale).map(|(r, d)| r * d).collect();
        let mut y = inverse(&self.lu, &b);
        let rest: Vec<f64> = b.iter().zip(times(&self.a, &y)).map(|(b, a)| b - a).collect();
        y.iter_mut().zip(inverse(&self.lu, &rest)).for_each(|(y, more)| *y += more);
        y.iter().zip(&self.scale).map(|(y, d)| y * d).collect()
    }

    /// `|D^-1 x|`.
    pub fn length(&self, x: &[f64]) -> f64 {
        x.iter().zip(&self.scale).fold(0.0, |sum: f64, (x, d)| sum.hypot(x / d))
    }

    /// The scaled null vector of A up to rounding, by inverse iteration: none if A is not singular, empty if A is singular but the
    /// iteration fails.
    pub fn null_vector(&self, pattern: &SaddlePattern) -> Option<Vec<f64>> {
        match inverse_iteration(&self.lu, self.scale.len()) {
            Some((_, size)) if size >= SINGULAR => None,
            Some((y, _)) => Some(y),
            // A pivot is zero. A small shift gives the same vector.
            None => Some(
                self.shifted(pattern)
                    .and_then(|lu| inverse_iteration(&lu, self.scale.len()))
                    .map_or_else(Vec::new, |f| f.0),
            ),
        }
    }

    /// The unit vector y with the smallest `|A y|`, if that is less than `below`.
    pub fn softest(&self, below: f64) -> Option<Vec<f64>> {
        inverse_iteration(&self.lu, self.scale.len()).filter(|(_, size)| *size < below).map(|(y, _)| y)
    }

    /// `D (saddle) D y` for another saddle matrix, with the scales of this one.
    pub fn applied(&self, entries: &SaddleEntries, y: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; y.len()];
        entries.list.iter().for_each(|&(i, j, v)| sum[i] += self.scale[i] * v * self.scale[j] * y[j]);
        sum
    }

    fn shifted(&self, pattern: &SaddlePattern) -> Option<Lu<usize, f64>> {
        let mut shifted = self.a.clone();
        (0..self.scale.len()).for_each(|j| shifted[(j, j)] += SHIFT);
        pattern.factors(&shifted).ok()
    }
}

fn inverse(lu: &Lu<usize, f64>, b: &[f64]) -> Vec<f64> {
    if b.is_empty() {
        return Vec::new();
    }
    let x = lu.solve(Mat::from_fn(b.len(), 1, |i, _| b[i]));
    (0..b.len()).map(|i| x[(i, 0)]).collect()
}

/// The unit vector y with the smallest `|A y|`, and this length; none if a pivot is zero.
fn inverse_iteration(lu: &Lu<usize, f64>, n: usize) -> Option<(Vec<f64>, f64)> {
    let mut y = unit(&(0..n as u64).map(random).collect::<Vec<_>>());
    let mut size = f64::INFINITY;
    for _ in 0..3 {
        let x = inverse(lu, &y);
        size = 1.0 / norm(&x);
        if size.is_nan() || size == 0.0 {
            return None;
        }
        y = unit(&x);
    }
    Some((y, size))
}

/// Indices below `free` with large entries, in descending order of size; empty if the other entries are much larger.
pub fn large(y: &[f64], free: usize) -> Vec<usize> {
    let size = |part: &[f64]| part.iter().fold(0.0, |most: f64, y| most.max(y.abs()));
    let (motion, rest) = (size(&y[..free]), size(&y[free..]));
    if motion < MOVES * rest || motion == 0.0 {
        return Vec::new();
    }
    let mut places: Vec<usize> = (0..free).filter(|&i| y[i].abs() >= MOVES * motion).collect();
    places.sort_by(|&a, &b| y[b].abs().total_cmp(&y[a].abs()));
    places
}

/// Indices with large entries, ascending.
pub fn largest(y: &[f64]) -> impl Iterator<Item = usize> {
    let most = y.iter().fold(0.0, |most: f64, y| most.max(y.abs()));
    (0..y.len()).filter(move |&i| most > 0.0 && y[i].abs() >= MOVES * most)
}

/// Powers of two that bring the largest entry of each row to about one.
///
/// DOFs with stiffness are scaled by stiffness alone: a rotation tied to a translation may differ from it in stiffness by the units, and
/// constraints must not hide that. The other DOFs are scaled to match. If several scales match, the start decides.
fn scaling(entries: &SaddleEntries, free: usize) -> Vec<f64> {
    let unit = |i: usize| entries.units.get(i).copied().unwrap_or(1.0);
    let list = entries.list.iter().map(|&(i, j, v)| (i, j, unit(i) * v * unit(j))).collect();
    let in_units = SaddleEntries { size: entries.size, stiff: entries.stiff, list, units: Vec::new() };
    fitted(&in_units, free).iter().enumerate().map(|(i, scale)| unit(i) * scale).collect()
}

fn fitted(entries: &SaddleEntries, free: usize) -> Vec<f64> {
    let mut held = vec![false; entries.size];
    entries.list[..entries.stiff].iter().filter(|(.., v)| *v != 0.0).for_each(|&(i, ..)| held[i] = true);
    let mut scale = start(entries, free);
    for _ in 0..ROUNDS {
        let inner = entries.list.iter().filter(|(i, j, _)| *i < free && *j < free);
        let most = largest_in_rows(inner, &scale);
        (0..entries.size).filter(|&i| held[i] && most[i] > 0.0).for_each(|i| scale[i] /= most[i].sqrt());
    }
    for _ in 0..2 * ROUNDS {
        let most = largest_in_rows(entries.list.iter(), &scale);
        (0..entries.size).filter(|&i| !held[i] && most[i] > 0.0).for_each(|i| scale[i] /= most[i].sqrt());
    }
    scale.iter().map(|d| d.log2().round().exp2()).collect()
}

/// Start of scaling: stiffness and constraints of equal size, so that the unit of force cancels.
fn start(entries: &SaddleEntries, free: usize) -> Vec<f64> {
    let of_motion = entries.list.iter().filter(|(i, j, _)| *i < free && *j < free);
    let most = of_motion.map(|(.., v)| v.abs()).fold(0.0, f64::max);
    let of_dofs = if most > 0.0 { most.sqrt().recip() } else { 1.0 };
    let mut scale = vec![of_dofs; entries.size];
    let most = largest_in_rows(entries.list.iter(), &vec![1.0; entries.size]);
    (free..entries.size).filter(|&r| most[r] > 0.0).for_each(|r| scale[r] = (most[r] * of_dofs).recip());
    scale
}

fn largest_in_rows<'a>(entries: impl Iterator<Item = &'a (usize, usize, f64)>, scale: &[f64]) -> Vec<f64> {
    let mut most = vec![0.0_f64; scale.len()];
    entries.for_each(|&(i, j, v)| most[i] = most[i].max((scale[i] * v * scale[j]).abs()));
    most
}

pub fn norm(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |sum: f64, x| sum.hypot(*x))
}

fn unit(x: &[f64]) -> Vec<f64> {
    let size = norm(x);
    x.iter().map(|x| x / size).collect()
}

/// Pattern and symbolic factors. They are made for the first matrix, and again if the positions of entries change.
#[derive(Default)]
pub struct SaddlePattern(Option<KnownPattern>);

struct KnownPattern {
    /// `(row, column)` of each entry, including repetitions.
    places: Vec<(usize, usize)>,
    columns: SymbolicSparseColMat<usize>,
    order: Argsort<usize>,
    factors: SymbolicLu<usize>,
}

impl SaddlePattern {
    /// The matrix with these entries `(row, column, value)`; repeated ones are summed.
    pub fn matrix(&mut self, size: usize, entries: &[(usize, usize, f64)]) -> Result<SparseMatrix, String> {
        let places = || entries.iter().map(|&(i, j, _)| (i, j));
        let known = match self.0.take() {
            Some(known) if known.columns.ncols() == size && places().eq(known.places.iter().copied()) => known,
            _ => KnownPattern::new(size, places().collect())?,
        };
        let known = self.0.insert(known);
        let values: Vec<f64> = entries.iter().map(|&(.., v)| v).collect();
        SparseMatrix::new_from_argsort(known.columns.clone(), &known.order, &values).map_err(|e| format!("{e:?}"))
    }

    /// Factors a matrix with the pattern of the last one.
    pub fn factors(&self, matrix: &SparseMatrix) -> Result<Lu<usize, f64>, String> {
        let known = self.0.as_ref().ok_or("there is no matrix")?;
        Lu::try_new_with_symbolic(known.factors.clone(), matrix.as_ref()).map_err(|e| format!("{e:?}"))
    }
}

impl KnownPattern {
    fn new(size: usize, places: Vec<(usize, usize)>) -> Result<Self, String> {
        let pairs: Vec<_> = places.iter().map(|&(i, j)| Pair::new(i, j)).collect();
        let (columns, order) =
            SymbolicSparseColMat::try_new_from_indices(size, size, &pairs).map_err(|e| format!("{e:?}"))?;
        let factors = SymbolicLu::try_new(columns.as_ref()).map_err(|e| format!("{e:?}"))?;
        Ok(Self { places, columns, order, factors })
    }
}
