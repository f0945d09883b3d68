//! `C^T P = Q [R1 R2]`: which rows of a block are combinations of others, and of which.

use std::collections::HashSet;

use super::tableau::Tableau;
use super::triangle::{Triangle, seeds};
use super::{Block, Means};
use crate::Csr;
use crate::factor::qr::faer::Faer;
use crate::factor::qr::{Backend, BackendError, Factor, largest_place, norm, part_of_largest};
use crate::input::scale::ldexp;
use crate::presolve::basis::{BlockDependent as Dependent, NEAR, Nearness};
use crate::presolve::eliminate::Mismatch;

/// m n up to which a block that seems nearly dependent is factored once more, with pivoting.
const DENSE: usize = 1 << 20;

/// Coefficients of a certificate below this, relative to its largest, are rounding; where the kept rows are badly
/// conditioned, those below [`ROUNDING`] units in the last place times the condition.
const NOISE: f64 = 1e-11;
/// Stands for zero where rows are known to be independent and backends must not take rounding for a pivot.
pub(crate) const NO_PIVOT: f64 = 1e-13;

/// Units in the last place, times the root of the size, that a QR may leave of a dependent row.
const ROUNDING: f64 = 8.0;

/// A row of which presolve left less than this is small as a whole.
const SMALL_ROW: f64 = 1e-9;

/// Numbers of certificates that are held at once.
const MANY: usize = 4_000_000;

/// The estimate of a smallest singular value is not above this times the value.
const ESTIMATE: f64 = 10.0;

/// Coefficients of certificates above this are exchanged for smaller ones where the kept rows seem nearly dependent.
const STEEP: f64 = 2.0;

/// Most times that rows are dropped and taken back in search of a sound choice.
const ROUNDS: usize = 8;

/// Error of a certificate, in units in the last place of its largest coefficient for each of its terms, times the condition of
/// the kept rows.
const CERTIFICATE_UNITS: f64 = 2.0;

/// Kept rows (positions in the block) and dependent ones.
pub(super) struct Rows {
    pub kept: Vec<usize>,
    /// Indices of `kept` in an order in which they fill little.
    pub order: Vec<usize>,
    pub dependent: Vec<Dependent>,
    pub nearness: Nearness,
    /// Of the kept rows.
    pub triangle: Triangle,
}

/// Rows that are kept, with their factor, and what is known of them.
struct Choice {
    near: Nearness,
    weakest: Weakest,
    triangle: Triangle,
}

/// The kept row with the largest part in the smallest singular vector.
#[derive(Clone, Copy)]
struct Weakest {
    row: usize,
    /// What the other kept rows leave of it, in 2-norm; not less than its distance from their span.
    left: f64,
}

pub(super) fn find(block: &Block, means: Means) -> Result<Rows, BackendError> {
    let mut rows = independent(block, means)?;
    rows.order = rows.order.iter().filter_map(|k| rows.kept.binary_search(k).ok()).collect();
    Ok(rows)
}

/// As [`find`], with the whole block in `order`.
fn independent(block: &Block, means: Means) -> Result<Rows, BackendError> {
    let Means { backend, tolerance, check, .. } = means;
    let factor = backend.factor(&block.matrix, &seeds(block), tolerance)?;
    let order = factor.order.clone();
    let left = beyond_rounding(&factor, block);
    let dropped = factor.order[factor.rank..].to_vec();
    let choice = Choice::new(block, factor, means)?;
    if !check {
        return Ok(rows(block, &over_kept(block, &choice.triangle, &dropped), left, choice, order));
    }
    let (m, n) = (block.matrix.rows(), block.matrix.cols);
    let pivots = backend.pivots(n, m) || choice.near.distance >= NEAR;
    if !pivots && m * n > DENSE {
        // No row is nearer to the others than sigma.
        let doubtful = choice.near.sigma <= ESTIMATE * tolerance;
        if let Some(rows) = if doubtful { without_weak(block, means, &choice, &dropped, &order)? } else { None } {
            return Ok(rows);
        }
    } else if !pivots {
        // The backend may have kept the wrong rows of a sound block: with pivoting the best are kept.
        let means = Means { backend: &Faer, ..means };
        let other = Faer.factor(&block.matrix, &seeds(block), tolerance)?;
        let left = beyond_rounding(&other, block);
        let dropped = other.order[other.rank..].to_vec();
        let better = Choice::new(block, other, means)?;
        if better.near.sigma > choice.near.sigma {
            return ordered_or_repaired(block, means, better, (left, dropped), order);
        }
    }
    ordered_or_repaired(block, means, choice, (left, dropped), order)
}

/// Of what a backend kept the rows that are sound.
fn ordered_or_repaired(
    block: &Block,
    means: Means,
    choice: Choice,
    (left, dropped): (f64, Vec<usize>),
    order: Vec<usize>,
) -> Result<Rows, BackendError> {
    if choice.weakest.left <= means.tolerance && choice.near.distance < NEAR && !choice.triangle.rows.is_empty() {
        return repair(block, means, choice, dropped, order);
    }
    if dropped.len().saturating_mul(choice.triangle.rows.len()) > MANY && choice.triangle.holds(&dropped) {
        return Ok(many(block, &dropped, left, choice, order));
    }
    let tableau = over_kept(block, &choice.triangle, &dropped);
    let (tableau, choice) = in_order(block, means, tableau, choice)?;
    Ok(rows(block, &tableau, left, choice, order))
}

/// As [`rows`], where certificates are too many numbers to be held at once: slab by slab, what is zero being left out. Which of
/// equal equations is kept is what the factorization says.
fn many(block: &Block, dropped: &[usize], left: f64, choice: Choice, order: Vec<usize>) -> Rows {
    let Choice { near: nearness, triangle, .. } = choice;
    let noise = (ROUNDING * f64::EPSILON / nearness.sigma).max(NOISE);
    let dependent = triangle.factor.each_coefficients(|first, data| {
        let some = Tableau {
            basic: dropped[first..first + data.len()].iter().map(|&i| i as u32).collect(),
            free: triangle.rows.iter().map(|&k| k as u32).collect(),
            width: triangle.rows.len(),
            data: data.concat(),
        };
        let of = |i: usize| dependent(block, &some, i, left, noise, nearness.sigma);
        (0..some.basic.len()).map(of).collect::<Vec<_>>()
    });
    let mut kept = triangle.rows.clone();
    kept.sort_unstable();
    Rows { dependent: dependent.into_iter().flatten().collect(), kept, order, nearness, triangle }
}

/// The backend kept rows that are combinations of others to within the tolerance, as a QR without pivoting does where their
/// remainders are spread over many: those are found by the singular vectors and dropped. Dropped rows that are no combinations
/// come back for good: only such a row had explained them, or many together are nearer to dependence than each of them.
/// None where that does not end in a sound choice.
fn without_weak(
    block: &Block,
    means: Means,
    first: &Choice,
    dropped: &[usize],
    order: &[usize],
) -> Result<Option<Rows>, BackendError> {
    let mut kept = first.triangle.rows.clone();
    let mut dropped = dropped.to_vec();
    let mut sure = vec![false; block.matrix.rows()];
    let limit = means.tolerance;
    let Some(mut weak) = first.triangle.factor.weak_columns(limit)? else { return Ok(None) };
    for _ in 0..ROUNDS {
        weak.sort_unstable_by(|a, b| b.cmp(a));
        dropped.extend(weak.iter().map(|&k| kept.swap_remove(k)));
        let choice = Choice::of(block, &kept, means)?;
        dropped.extend(choice.left_out_of(&kept));
        kept.clone_from(&choice.triangle.rows);
        // Many rows together can be nearer to dependence than the tolerance, though none of them is.
        let apart = choice.weakest.left > limit;
        if !apart {
            let Some(still) = choice.triangle.factor.weak_columns(limit)? else { return Ok(None) };
            weak = still.into_iter().filter(|&k| !sure[kept[k]]).collect();
            if !weak.is_empty() {
                continue;
            }
        }
        let tableau = over_kept(block, &choice.triangle, &dropped);
        let unexplained = unexplained(block, &tableau, means.tolerance)?;
        if unexplained.is_empty() {
            let left = Some(remainder(block, &tableau)).filter(|&left| left > noise_of(block)).unwrap_or(0.0);
            let (tableau, choice) = in_order(block, means, tableau, choice)?;
            let sound = choice.near.distance >= NEAR || choice.weakest.left > means.tolerance;
            return Ok(sound.then(|| rows(block, &tableau, left, choice, order.to_vec())));
        }
        weak.clear();
        unexplained.iter().for_each(|&k| sure[k] = true);
        dropped.retain(|k| !unexplained.contains(k));
        kept.extend(unexplained);
    }
    Ok(None)
}

/// Dropped rows that are no combination of the kept ones, nor of one another.
fn unexplained(block: &Block, tableau: &Tableau, tolerance: f64) -> Result<Vec<usize>, BackendError> {
    let mut rests = Csr::empty(block.matrix.cols);
    let mut names = Vec::new();
    for i in 0..tableau.basic.len() {
        let rest = rest(block, tableau, i);
        if norm(&rest) > tolerance {
            rests.append(rest.into_iter().enumerate());
            names.push(tableau.basic[i] as usize);
        }
    }
    let factor = Faer.factor(&rests, &[], tolerance)?;
    Ok(factor.order[..factor.rank].iter().map(|&k| names[k]).collect())
}

/// Of equations that say the same the earlier one is kept, and what is said of nearness is that of the rows then kept; all
/// stays as it is where that would cost accuracy.
fn in_order(
    block: &Block,
    means: Means,
    mut tableau: Tableau,
    mut choice: Choice,
) -> Result<(Tableau, Choice), BackendError> {
    let kept_of = |tableau: &Tableau| tableau.free.iter().map(|&k| k as usize).collect::<Vec<_>>();
    if !choice.near.is_sound() {
        // Where certificates are small, no other choice of rows is much better (Gu and Eisenstat 1996).
        let mut better = tableau.clone();
        if better.limit(STEEP) && better.basic != tableau.basic {
            let found = Choice::of(block, &kept_of(&better), means)?;
            if found.near.sigma > choice.near.sigma {
                (tableau, choice) = (better, found);
            }
        }
    }
    let mut ordered = tableau.clone();
    ordered.prefer(|candidate, holder| candidate > holder);
    if ordered.basic == tableau.basic {
        return Ok((tableau, choice));
    }
    let found = Choice::of(block, &kept_of(&ordered), means)?;
    Ok(if 2.0 * found.near.sigma < choice.near.sigma { (tableau, choice) } else { (ordered, found) })
}

fn rows(block: &Block, tableau: &Tableau, left: f64, choice: Choice, order: Vec<usize>) -> Rows {
    let Choice { near: nearness, triangle, .. } = choice;
    let sigma = nearness.sigma;
    let mut kept: Vec<usize> = tableau.free.iter().map(|&k| k as usize).collect();
    kept.sort_unstable();
    let noise = (ROUNDING * f64::EPSILON / sigma).max(NOISE);
    let all = (0..tableau.basic.len()).map(|i| dependent(block, tableau, i, left, noise, sigma));
    Rows { dependent: all.collect(), kept, order, nearness, triangle }
}

/// The backend kept rows that are dependent to within the tolerance (no pivot was small, as in Kahan's matrix): row after
/// row, the one with the largest part in the smallest singular vector is dropped, until what is kept is independent.
fn repair(
    block: &Block,
    means: Means,
    mut choice: Choice,
    mut dropped: Vec<usize>,
    order: Vec<usize>,
) -> Result<Rows, BackendError> {
    let mut kept = choice.triangle.rows.clone();
    while choice.weakest.left <= means.tolerance {
        let place = kept.iter().position(|&i| i == choice.weakest.row).unwrap_or(kept.len() - 1);
        dropped.push(kept.swap_remove(place));
        choice = Choice::of(block, &kept, means)?;
        dropped.extend(choice.left_out_of(&kept));
        kept.clone_from(&choice.triangle.rows);
    }
    let tableau = over_kept(block, &choice.triangle, &dropped);
    let left = remainder(block, &tableau);
    Ok(rows(block, &tableau, left, choice, order))
}

impl Choice {
    /// What a factor of the whole block kept; factored anew where the backend is not orthogonal.
    fn new(block: &Block, factor: Factor, means: Means) -> Result<Self, BackendError> {
        let rows = factor.order[..factor.rank].to_vec();
        if means.backend.is_orthogonal() {
            return Ok(Self::measured(block, Triangle { factor, rows }, means));
        }
        Self::of(block, &rows, means)
    }

    /// Some rows, those left out that are dependent to the last bit.
    fn of(block: &Block, kept: &[usize], means: Means) -> Result<Self, BackendError> {
        Ok(Self::measured(block, Triangle::of(block, kept, means)?, means))
    }

    /// Rows that were to be kept and are dependent to the last bit.
    fn left_out_of(&self, kept: &[usize]) -> Vec<usize> {
        if kept.len() == self.triangle.rows.len() {
            return Vec::new();
        }
        let rows: HashSet<usize> = self.triangle.rows.iter().copied().collect();
        kept.iter().copied().filter(|k| !rows.contains(k)).collect()
    }

    /// `sigma` and, with its singular vectors y of the rows and v of the DOFs, `sigma / (max |y_i| max |v_j|)`: the entry of the
    /// inverse that is largest in the direction in which the rows are nearest to dependence.
    fn measured(block: &Block, triangle: Triangle, means: Means) -> Self {
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

/// The dropped rows over the kept ones: `R1^-1 R2` where the factor holds them, otherwise least squares.
fn over_kept(block: &Block, triangle: &Triangle, dropped: &[usize]) -> Tableau {
    let data = if triangle.holds(dropped) {
        triangle.factor.all_coefficients()
    } else {
        triangle.certificates(block, dropped)
    };
    Tableau {
        basic: dropped.iter().map(|&i| i as u32).collect(),
        free: triangle.rows.iter().map(|&k| k as u32).collect(),
        width: triangle.rows.len(),
        data: data.concat(),
    }
}

/// Largest part of a dependent row that its certificate does not give.
fn remainder(block: &Block, tableau: &Tableau) -> f64 {
    let largest = |i: usize| rest(block, tableau, i).iter().fold(0.0, |a: f64, v| a.max(v.abs()));
    (0..tableau.basic.len()).map(largest).fold(0.0, f64::max)
}

/// What the certificate of dependent row i leaves of it.
fn rest(block: &Block, tableau: &Tableau, i: usize) -> Vec<f64> {
    let mut rest = vec![0.0; block.matrix.cols];
    block.matrix.row(tableau.basic[i] as usize).for_each(|(j, v)| rest[j] = v);
    for (y, &k) in tableau.row(i).iter().zip(&tableau.free) {
        block.matrix.row(k as usize).for_each(|(j, v)| rest[j] -= y * v);
    }
    rest
}

/// Root mean square of what was left of the dependent rows, or 0 if rounding explains it.
fn beyond_rounding(factor: &Factor, block: &Block) -> f64 {
    let m = block.matrix.rows() as f64;
    let left = factor.dropped / (m - factor.rank as f64).max(1.0).sqrt();
    if left > noise_of(block) { left } else { 0.0 }
}

/// What rounding may leave of a dependent row.
fn noise_of(block: &Block) -> f64 {
    let (m, n) = (block.matrix.rows() as f64, block.matrix.cols as f64);
    ROUNDING * f64::EPSILON * (m.sqrt() + n.sqrt())
}

fn dependent(block: &Block, tableau: &Tableau, i: usize, left: f64, noise: f64, sigma: f64) -> Dependent {
    let (k, y) = (tableau.basic[i] as usize, tableau.row(i));
    let largest = y.iter().fold(0.0, |a: f64, v| a.max(v.abs()));
    let terms = y.iter().zip(&tableau.free).filter(|(v, _)| v.abs() > noise * largest);
    let unscaled =
        |(&v, &i): (&f64, &u32)| (block.rows[i as usize], ldexp(v, block.exponents[i as usize] - block.exponents[k]));
    let mut because: Vec<_> = terms.map(unscaled).collect();
    because.sort_unstable_by_key(|&(row, _)| row);
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
