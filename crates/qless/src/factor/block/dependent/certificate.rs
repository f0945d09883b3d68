//! `row = sum y_i row_i`: the certificates of dependent rows, what they leave of them, and of their right-hand sides.

use super::Rows;
use super::choice::Choice;
use crate::factor::backend::Factor;
use crate::factor::block::Block;
use crate::factor::block::tableau::Tableau;
use crate::factor::block::triangle::Triangle;
use crate::input::scale::ldexp;
use crate::presolve::basis::BlockDependent as Dependent;
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
const CERTIFICATE_UNITS: f64 = 2.0;

pub(super) fn rows(block: &Block, tableau: &Tableau, left: f64, choice: Choice, order: Vec<usize>) -> Rows {
    let Choice { near: nearness, triangle, .. } = choice;
    let sigma = nearness.sigma;
    let mut kept: Vec<usize> = tableau.free.iter().map(|&k| k as usize).collect();
    kept.sort_unstable();
    let noise = (ROUNDING * f64::EPSILON / sigma).max(NOISE);
    let by_row = by_row(block, &tableau.free);
    let all = (0..tableau.basic.len()).map(|i| dependent(block, tableau, i, &by_row, left, noise, sigma));
    Rows { dependent: all.collect(), kept, order, nearness, triangle }
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
    let units = CERTIFICATE_UNITS * because.len() as f64 / sigma.min(1.0);
    let mismatch = mismatch(block, tableau, i, noise * largest, units * f64::EPSILON * largest);
    // What is left of all rows together may be no more than rounding of the parts of each.
    let left = if left > 0.0 { left.min(confirmed(block, tableau, i)) } else { left };
    // A row that is small as a whole may be small for good: then its own numbers are what is dropped.
    let left = if norm_of(block, k) < SMALL_ROW { left.max(block.certain[k]) } else { left };
    Dependent { row: block.rows[k], because, units, dropped: left, mismatch: mismatch.scaled(-block.exponents[k]) }
}

/// What the certificate of dependent row i leaves of it, relative to its parts; 0 if rounding explains it.
fn confirmed(block: &Block, tableau: &Tableau, i: usize) -> f64 {
    let parts = tableau.row(i).iter().fold(1.0, |most: f64, y| most.max(y.abs()));
    let left = rest(block, tableau, i).iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    if left > noise_of(block) * parts { left } else { 0.0 }
}

fn norm_of(block: &Block, k: usize) -> f64 {
    block.matrix.row(k).map(|(_, v)| v * v).sum::<f64>().sqrt()
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
