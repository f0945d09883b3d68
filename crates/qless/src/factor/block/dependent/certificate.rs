//! Which rows of a block are kept, and `row = sum y_i row_i` for the others: certificates and what they leave of rows and right-hand sides.

use crate::Csr;
use crate::factor::backend::{BackendError, Factor, largest_place, part_of_largest};
use crate::factor::block::gathered::{Block, FactorContext};
use crate::factor::block::tableau::Tableau;
use crate::factor::block::triangle::Triangle;
use crate::input::scale::ldexp;
use crate::presolve::basis::{BlockCertificate, BlockDependent as Dependent, NEAR, Nearness};
use crate::presolve::eliminated::Mismatch;

/// Coefficients of a certificate below this, relative to its largest, are rounding; where the kept rows are badly
/// conditioned, those below [`ROUNDING`] units in the last place times the condition.
pub(super) const NOISE: f64 = 1e-11;

/// Units in the last place, times the root of the size, that a QR may leave of a dependent row.
pub(super) const ROUNDING: f64 = 8.0;

/// A row of which presolve left less than this is small as a whole.
const SMALL_ROW: f64 = 1e-9;

/// Error of a certificate, in units in the last place of its largest coefficient for each of its terms, times the condition of
/// the kept rows.
pub(super) const CERTIFICATE_UNITS: f64 = 2.0;

/// Numbers of certificates up to which all are made at once.
pub(super) const MANY: usize = 4_000_000;

/// Coefficients of certificates above this are exchanged for smaller ones where the kept rows seem nearly dependent.
pub(super) const STEEP: f64 = 2.0;

/// Kept rows (positions in the block) and dependent ones.
pub(crate) struct Rows {
    pub kept: Vec<usize>,
    /// Indices of `kept` in an order in which they fill little.
    pub order: Vec<usize>,
    pub dependent: Vec<Dependent>,
    pub nearness: Nearness,
    /// Of the kept rows.
    pub triangle: Triangle,
    /// Root mean square of what was left of the dependent rows, or 0 if rounding explains it.
    pub left: f64,
}

/// Rows that are kept, with their factor, and what is known of them.
pub(super) struct Choice {
    pub near: Nearness,
    pub weakest: Weakest,
    pub triangle: Triangle,
}

/// The kept row with the largest part in the smallest singular vector.
#[derive(Clone, Copy)]
pub(super) struct Weakest {
    pub row: usize,
    /// What the other kept rows leave of it, in 2-norm; not less than its distance from their span.
    pub left: f64,
}

impl Choice {
    /// What a factor of the whole block kept; factored anew where the backend is not orthogonal.
    pub fn new(block: &Block, factor: Factor, means: FactorContext) -> Result<Self, BackendError> {
        let whole = Triangle::whole(factor);
        if means.backend.is_orthogonal() {
            return Ok(Self::measured(block, whole, means));
        }
        Self::of(block, &whole.rows, &whole.dropped, means)
    }

    /// Some rows, those left out that are dependent to the last bit; `asked` are rows of which certificates will be wanted.
    pub fn of(block: &Block, kept: &[usize], asked: &[usize], means: FactorContext) -> Result<Self, BackendError> {
        Ok(Self::measured(block, Triangle::of(block, kept, asked, means)?, means))
    }

    /// Largest 2-norm of what the kept rows leave of those asked for, or 0 if rounding explains it.
    pub fn remainder(&self, block: &Block) -> f64 {
        let left = self.triangle.rests().iter().copied().fold(0.0, f64::max);
        if left > noise_of(block) { left } else { 0.0 }
    }

    /// `sigma` and, with its singular vectors y of the rows and v of the DOFs, `sigma / (max |y_i| max |v_j|)`: the entry of the
    /// inverse that is largest in the direction in which the rows are nearest to dependence.
    fn measured(block: &Block, triangle: Triangle, means: FactorContext) -> Self {
        let (sigma, y) = if means.check { triangle.factor.smallest_singular_value() } else { (1.0, Vec::new()) };
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

/// The dropped rows over the kept ones.
pub(super) fn over_kept(triangle: &Triangle) -> Tableau {
    let names = |some: &[usize]| some.iter().map(|&i| i as u32).collect();
    Tableau {
        basic: names(&triangle.dropped),
        free: names(&triangle.rows),
        width: triangle.rows.len(),
        data: triangle.certificates().concat(),
    }
}

/// What the certificate of dependent row i leaves of it.
pub(super) fn rest(block: &Block, tableau: &Tableau, i: usize) -> Vec<f64> {
    let mut rest = vec![0.0; block.matrix.cols];
    block.matrix.row(tableau.basic[i] as usize).for_each(|(j, v)| rest[j] = v);
    for (y, &k) in tableau.row(i).iter().zip(&tableau.free) {
        block.matrix.row(k as usize).for_each(|(j, v)| rest[j] -= y * v);
    }
    rest
}

/// Root mean square of what was left of the dependent rows, or 0 if rounding explains it.
pub(super) fn beyond_rounding(factor: &Factor, block: &Block) -> f64 {
    let m = block.matrix.rows() as f64;
    let left = factor.dropped / (m - factor.rank as f64).max(1.0).sqrt();
    if left > noise_of(block) { left } else { 0.0 }
}

/// What rounding may leave of a dependent row.
pub(super) fn noise_of(block: &Block) -> f64 {
    let (m, n) = (block.matrix.rows() as f64, block.matrix.cols as f64);
    ROUNDING * f64::EPSILON * (m.sqrt() + n.sqrt())
}

/// The columns of certificates in the order of the rows that they stand for.
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
    let mismatch = mismatch(block, tableau, i, noise * largest, error);
    // What is left of all rows together may be no more than rounding of the parts of each.
    let left = if left > 0.0 { left.min(confirmed(block, tableau, i)) } else { left };
    let (because, dropped) = (BlockCertificate::Known(because), small_row(block, k, left));
    Dependent { row: block.rows[k], because, units, dropped, mismatch: mismatch.scaled(-block.exponents[k]) }
}

/// What the certificate of dependent row i leaves of it, relative to its parts; 0 if rounding explains it.
fn confirmed(block: &Block, tableau: &Tableau, i: usize) -> f64 {
    let parts = tableau.row(i).iter().fold(1.0, |most: f64, y| most.max(y.abs()));
    let left = rest(block, tableau, i).iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    if left > noise_of(block) * parts { left } else { 0.0 }
}

/// What is left of row k: a row that is small as a whole may be small for good, then its own numbers are what is dropped.
pub(super) fn small_row(block: &Block, k: usize, left: f64) -> f64 {
    let norm = block.matrix.row(k).map(|(_, v)| v * v).sum::<f64>().sqrt();
    if norm < SMALL_ROW { left.max(block.certain[k]) } else { left }
}

/// `b_k - sum y_i b_i`, where each y_i may be off by `error`; those below `noise` may be nothing else.
fn mismatch(block: &Block, tableau: &Tableau, i: usize, noise: f64, error: f64) -> Mismatch {
    let mut rest = block.effective[tableau.basic[i] as usize];
    for (&y, &kept) in tableau.row(i).iter().zip(&tableau.free) {
        let other = block.effective[kept as usize];
        rest.error += error * other.size;
        if y.abs() > noise {
            rest.subtract(y, other);
        } else {
            rest.error += y.abs() * other.size;
        }
    }
    rest
}

/// Which of equations that say the same is rather dropped.
pub(super) fn later(candidate: u32, holder: u32) -> bool {
    candidate > holder
}

/// Of equations that say the same the earlier one is kept, and what is said of nearness is that of the rows then kept; all
/// stays as it is where that would cost accuracy.
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

/// Where the kept rows seem nearly dependent, steep certificates are exchanged if others are better.
pub(super) fn sounder(
    block: &Block,
    means: FactorContext,
    mut tableau: Tableau,
    mut choice: Choice,
) -> Result<(Tableau, Choice), BackendError> {
    if !choice.near.is_sound() {
        // Where certificates are small, no other choice of rows is much better (Gu and Eisenstat 1996).
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
