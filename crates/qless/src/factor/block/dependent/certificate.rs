//! Kept rows of a block, and certificates `row = sum y_i row_i` of the dropped rows, with the remainders of rows and right-hand sides.

use crate::Csr;
use crate::factor::backend::{BackendError, Factor, largest_place, part_of_largest};
use crate::factor::block::gathered::{Block, FactorContext};
use crate::factor::block::tableau::Tableau;
use crate::factor::block::triangle::Triangle;
use crate::input::scale::ldexp;
use crate::presolve::basis::{BlockCertificate, BlockDependent as Dependent, NEAR, Nearness};
use crate::presolve::eliminated::Mismatch;

/// Coefficients of a certificate below this, relative to its largest, are rounding. If the kept rows are badly conditioned, the limit is
/// [`ROUNDING`] units in the last place times the condition.
pub(super) const NOISE: f64 = 1e-11;

/// Bound of the remainder of a dependent row of an m x n block after a QR, in units in the last place times `sqrt(m) + sqrt(n)`.
pub(super) const ROUNDING: f64 = 8.0;

/// A row whose 2-norm after presolve is below this is small as a whole.
const SMALL_ROW: f64 = 1e-9;

/// Error of a certificate, in units in the last place of its largest coefficient: this number times the number of terms times the condition
/// of the kept rows.
pub(super) const CERTIFICATE_UNITS: f64 = 2.0;

/// The estimate of a smallest singular value exceeds the value by at most this factor.
pub(super) const ESTIMATE: f64 = 10.0;

/// If the kept rows seem nearly dependent, rows are exchanged until no coefficient of a certificate exceeds this.
pub(super) const STEEP: f64 = 2.0;

/// Kept rows (positions in the block) and dependent rows.
pub(crate) struct Rows {
    pub kept: Vec<usize>,
    /// Indices of `kept` in a fill-reducing order.
    pub order: Vec<usize>,
    pub dependent: Vec<Dependent>,
    pub nearness: Nearness,
    /// The factor of the kept rows.
    pub triangle: Triangle,
    /// The size of the dependent rows' remainders: the root mean square of their 2-norms, or the largest 2-norm if the choice of kept rows
    /// was repaired. 0 if rounding explains the remainders.
    pub left: f64,
}

/// A choice of kept rows: how near they are to dependence, the row that is nearest to a combination of the others, and their factor.
pub(super) struct Choice {
    pub near: Nearness,
    pub weakest: Weakest,
    pub triangle: Triangle,
}

/// The kept row with the largest component in the singular vector of the smallest singular value.
#[derive(Clone, Copy)]
pub(super) struct Weakest {
    pub row: usize,
    /// `sigma / |y_k|`: an upper bound of the distance of the row from the span of the other kept rows. sigma is the smallest singular
    /// value, and y_k is the component of the row in its singular vector.
    pub left: f64,
}

impl Choice {
    /// The rows that a factor of the whole block kept, factored again if the backend is not orthogonal.
    pub fn new(block: &Block, factor: Factor, means: FactorContext) -> Result<Self, BackendError> {
        let whole = Triangle::whole(factor);
        if means.backend.is_orthogonal() {
            return Ok(Self::measured(block, whole, means));
        }
        Self::of(block, &whole.rows, &whole.dropped, means)
    }

    /// Factors the rows `kept` except those that are dependent to the last bit. Certificates can then be computed for the rows `asked`.
    pub fn of(block: &Block, kept: &[usize], asked: &[usize], means: FactorContext) -> Result<Self, BackendError> {
        Ok(Self::measured(block, Triangle::of(block, kept, asked, means)?, means))
    }

    /// Largest 2-norm of the remainders of the rows asked for, or 0 if rounding explains the remainders.
    pub fn remainder(&self, block: &Block) -> f64 {
        let left = self.triangle.rests().iter().copied().fold(0.0, f64::max);
        if left > noise_of(block) { left } else { 0.0 }
    }

    /// Computes the smallest singular value sigma and the distance of the rows from dependence. The distance is
    /// `sigma / (max |y_i| max |v_j|)` with the singular vectors y of the rows and v of the DOFs: the smallest change of one coefficient in
    /// the direction in which the rows are nearest to dependence. If sigma is at least [`NEAR`], the distance is set to sigma, a lower
    /// bound.
    fn measured(block: &Block, mut triangle: Triangle, means: FactorContext) -> Self {
        let (sigma, y) = if means.check {
            triangle.smallest_singular_value(block, ESTIMATE * means.tolerance)
        } else {
            (1.0, Vec::new())
        };
        let place = largest_place(&y);
        let row = place.map_or(0, |k| triangle.rows[k]);
        let weakest = Weakest { row, left: place.map_or(sigma, |k| sigma / y[k].abs()) };
        let distance = if sigma < NEAR { distance(&block.matrix, &triangle.rows, sigma, &y) } else { sigma };
        Self { near: Nearness { sigma, distance }, weakest, triangle }
    }
}

fn distance(rows: &Csr, kept: &[usize], sigma: f64, y: &[f64]) -> f64 {
    let mut v = vec![0.0; rows.cols];
    for (&i, y) in kept.iter().zip(y) {
        rows.row(i).for_each(|(j, c)| v[j] += y * c);
    }
    sigma / (part_of_largest(y) * part_of_largest(&v))
}

pub(super) fn rows(block: &Block, tableau: &Tableau, left: f64, choice: Choice, order: Vec<usize>) -> Rows {
    let Choice { near: nearness, triangle, .. } = choice;
    let sigma = nearness.sigma;
    let mut kept: Vec<usize> = tableau.free.iter().map(|&k| k as usize).collect();
    kept.sort_unstable();
    let noise = (ROUNDING * f64::EPSILON / sigma).max(NOISE);
    let by_row = by_row(block, &tableau.free);
    let all = (0..tableau.basic.len()).map(|i| dependent(block, tableau, i, &by_row, left, noise, sigma));
    Rows { dependent: all.collect(), kept, order, nearness, triangle, left }
}

/// The dropped rows as combinations of the kept ones.
pub(super) fn over_kept(triangle: &mut Triangle) -> Tableau {
    let data = triangle.certificates().concat();
    let names = |some: &[usize]| some.iter().map(|&i| i as u32).collect();
    let (basic, free) = (names(&triangle.dropped), names(&triangle.rows));
    Tableau { basic, free, width: triangle.rows.len(), data }
}

/// The remainder of dependent row i after subtracting its certificate.
pub(super) fn rest(block: &Block, tableau: &Tableau, i: usize) -> Vec<f64> {
    let mut rest = vec![0.0; block.matrix.cols];
    block.matrix.row(tableau.basic[i] as usize).for_each(|(j, v)| rest[j] = v);
    for (y, &k) in tableau.row(i).iter().zip(&tableau.free) {
        block.matrix.row(k as usize).for_each(|(j, v)| rest[j] -= y * v);
    }
    rest
}

/// Root mean square of the 2-norms of the dependent rows' remainders, or 0 if rounding explains the remainders.
pub(super) fn beyond_rounding(factor: &Factor, block: &Block) -> f64 {
    let m = block.matrix.rows() as f64;
    let left = factor.dropped / (m - factor.rank as f64).max(1.0).sqrt();
    if left > noise_of(block) { left } else { 0.0 }
}

/// Bound of the rounding error in the remainder of a dependent row.
pub(crate) fn noise_of(block: &Block) -> f64 {
    let (m, n) = (block.matrix.rows() as f64, block.matrix.cols as f64);
    ROUNDING * f64::EPSILON * (m.sqrt() + n.sqrt())
}

/// The columns of certificates, sorted by the rows that they refer to.
pub(super) fn by_row(block: &Block, free: &[u32]) -> Vec<usize> {
    let mut places: Vec<usize> = (0..free.len()).collect();
    places.sort_unstable_by_key(|&j| block.rows[free[j] as usize]);
    places
}

pub(super) fn dependent(
    block: &Block,
    tableau: &Tableau,
    i: usize,
    by_row: &[usize],
    left: f64,
    noise: f64,
    sigma: f64,
) -> Dependent {
    let (k, y) = (tableau.basic[i] as usize, tableau.row(i));
    let largest = y.iter().fold(0.0, |a: f64, v| a.max(v.abs()));
    let terms = by_row.iter().filter(|&&j| y[j].abs() > noise * largest).map(|&j| (y[j], tableau.free[j] as usize));
    let exponent = block.exponents[k];
    let because: Vec<_> = terms.map(|(v, i)| (block.rows[i], ldexp(v, block.exponents[i] - exponent))).collect();
    let units = CERTIFICATE_UNITS / sigma.min(1.0);
    let error = units * because.len() as f64 * f64::EPSILON * largest;
    let mismatch = |sides: &Vec<Mismatch>| mismatch(sides, tableau, i, noise * largest, error);
    let mismatches = block.effective.iter().map(|sides| mismatch(sides).scaled(-block.exponents[k])).collect();
    // `left` is the size of the remainders of all dependent rows. What remains of this row may be smaller, or may be only the rounding
    // error of its terms.
    let left = if left > 0.0 { left.min(confirmed(block, tableau, i)) } else { left };
    let (because, dropped) = (BlockCertificate::Known(because), small_row(block, k, left));
    Dependent { row: block.rows[k], because, units, dropped, mismatches }
}

/// Largest entry that remains of dependent row i, or 0 if the rounding of its terms explains it.
fn confirmed(block: &Block, tableau: &Tableau, i: usize) -> f64 {
    let parts = tableau.row(i).iter().fold(1.0, |most: f64, y| most.max(y.abs()));
    let left = rest(block, tableau, i).iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    if left > noise_of(block) * parts { left } else { 0.0 }
}

/// What remains of row k. A row that is small as a whole is dropped although its coefficients may be more than rounding. They then count as
/// its remainder.
pub(super) fn small_row(block: &Block, k: usize, left: f64) -> f64 {
    let norm = block.matrix.row(k).map(|(_, v)| v * v).sum::<f64>().sqrt();
    if norm < SMALL_ROW { left.max(block.certain[k]) } else { left }
}

/// The mismatch `b_k - sum y_i b_i` with its error, if each y_i has an error up to `error`. A y_i below `noise` counts as error only.
fn mismatch(sides: &[Mismatch], tableau: &Tableau, i: usize, noise: f64, error: f64) -> Mismatch {
    let mut rest = sides[tableau.basic[i] as usize];
    for (&y, &kept) in tableau.row(i).iter().zip(&tableau.free) {
        let other = sides[kept as usize];
        rest.error += error * other.size;
        if y.abs() > noise {
            rest.subtract(y, other);
        } else {
            rest.error += y.abs() * other.size;
        }
    }
    rest
}

/// Returns true if the kept row `candidate` should be dropped instead of the dropped row `holder`: among equivalent equations, the later
/// one is dropped.
pub(super) fn later(candidate: u32, holder: u32) -> bool {
    candidate > holder
}

/// Applies `sounder`, then keeps the earlier ones of equivalent equations and measures the nearness of these rows. This second choice is
/// discarded if its smallest singular value is less than half of that of the first.
pub(super) fn in_order(
    block: &Block,
    means: FactorContext,
    tableau: Tableau,
    choice: Choice,
) -> Result<(Tableau, Choice), BackendError> {
    let (tableau, choice) = sounder(block, means, tableau, choice)?;
    let mut ordered = tableau.clone();
    ordered.prefer(later);
    if ordered.basic == tableau.basic {
        return Ok((tableau, choice));
    }
    let found = Choice::of(block, &kept_of(&ordered), &[], means)?;
    Ok(if 2.0 * found.near.sigma < choice.near.sigma { (tableau, choice) } else { (ordered, found) })
}

fn kept_of(tableau: &Tableau) -> Vec<usize> {
    tableau.free.iter().map(|&k| k as usize).collect()
}

/// If the kept rows seem nearly dependent, exchanges rows until no coefficient of a certificate exceeds [`STEEP`]. The exchanges count only
/// if they increase the smallest singular value.
pub(super) fn sounder(
    block: &Block,
    means: FactorContext,
    mut tableau: Tableau,
    mut choice: Choice,
) -> Result<(Tableau, Choice), BackendError> {
    if !choice.near.is_sound() {
        // If certificates are small, no other choice of rows is much better (Gu and Eisenstat 1996).
        let mut better = tableau.clone();
        if better.limit(STEEP) && better.basic != tableau.basic {
            let found = Choice::of(block, &kept_of(&better), &[], means)?;
            if found.near.sigma > choice.near.sigma {
                (tableau, choice) = (better, found);
            }
        }
    }
    Ok((tableau, choice))
}
