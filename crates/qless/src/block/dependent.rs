//! `C^T P = Q [R1 R2]`: which rows of a block are combinations of others, and of which.

use super::tableau::Tableau;
use super::{Block, Dependent};
use crate::Csr;
use crate::confidence::NEAR;
use crate::presolve::eliminate::Mismatch;
use crate::qr::faer::Faer;
use crate::qr::{Backend, BackendError, Factor, SMALL};
use crate::scale::ldexp;

/// Coefficients of a certificate below this, relative to its largest, are rounding; where the kept rows are badly
/// conditioned, those below [`ROUNDING`] units in the last place times the condition.
const NOISE: f64 = 1e-11;
/// Stands for zero where rows are known to be independent and backends must not take rounding for a pivot.
pub(crate) const NO_PIVOT: f64 = 1e-13;

/// Units in the last place, times the root of the size, that a QR may leave of a dependent row.
const ROUNDING: f64 = 8.0;

/// Most times that rows are dropped and taken back in search of a sound choice.
const ROUNDS: usize = 8;

/// Error of a certificate, in units in the last place of its largest coefficient for each of its terms, times the condition of
/// the kept rows.
const CERTIFICATE_UNITS: f64 = 2.0;

/// Kept rows (positions in the block) and dependent ones.
pub(super) struct Rows {
    pub kept: Vec<usize>,
    pub dependent: Vec<Dependent>,
    pub sigma: f64,
}

pub(super) fn find(block: &Block, backend: &dyn Backend, tolerance: f64, check: bool) -> Result<Rows, BackendError> {
    let mut factor = backend.factor(&block.matrix, &[], tolerance)?;
    if !check {
        return Ok(rows(block, &certificates(&factor), beyond_rounding(&factor, block), 1.0));
    }
    let (mut sigma, mut weakest) = smallest(block, &factor, backend)?;
    let (m, n) = (block.matrix.rows(), block.matrix.cols);
    let pivots = backend.pivots(n, m) || sigma >= NEAR;
    if !pivots && m * n > SMALL && backend.is_orthogonal() {
        if let Some(rows) = without_weak(block, backend, tolerance, &factor)? {
            return Ok(rows);
        }
    } else if !pivots {
        // The backend may have kept the wrong rows of a sound block: with pivoting the best are kept.
        let other = Faer.factor(&block.matrix, &[], tolerance)?;
        let (better, place) = smallest(block, &other, &Faer)?;
        if better > sigma {
            (factor, sigma, weakest) = (other, better, place);
        }
    }
    let left = beyond_rounding(&factor, block);
    if sigma <= tolerance && factor.rank > 0 {
        return repair(block, backend, tolerance, &factor, weakest);
    }
    let (tableau, sigma) = in_order(block, backend, certificates(&factor), sigma)?;
    Ok(rows(block, &tableau, left, sigma))
}

/// The backend kept rows that are combinations of others, as a QR without pivoting does where their remainders are spread over
/// many: those are found by the singular vectors and dropped, and dropped rows that only such a row had explained come
/// back. None where that does not end in a sound choice.
fn without_weak(
    block: &Block,
    backend: &dyn Backend,
    tolerance: f64,
    factor: &Factor,
) -> Result<Option<Rows>, BackendError> {
    let mut kept = factor.order[..factor.rank].to_vec();
    let mut dropped = factor.order[factor.rank..].to_vec();
    let Some(mut weak) = factor.weak_columns(NEAR)? else { return Ok(None) };
    for _ in 0..ROUNDS {
        weak.sort_unstable_by(|a, b| b.cmp(a));
        dropped.extend(weak.iter().map(|&k| kept.swap_remove(k)));
        let factor = backend.factor(&select(block, &kept), &[], 0.0)?;
        dropped.extend(factor.order[factor.rank..].iter().map(|&k| kept[k]));
        kept = factor.order[..factor.rank].iter().map(|&k| kept[k]).collect();
        let Some(still) = factor.weak_columns(NEAR)? else { return Ok(None) };
        weak = still;
        if !weak.is_empty() {
            continue;
        }
        let tableau = over_kept(block, backend, &kept, &dropped)?;
        let unexplained = unexplained(block, &tableau, tolerance)?;
        if unexplained.is_empty() {
            let (sigma, _) = factor.smallest_singular_value();
            let left = Some(remainder(block, &tableau)).filter(|&left| left > noise_of(block)).unwrap_or(0.0);
            let (tableau, sigma) = in_order(block, backend, tableau, sigma)?;
            return Ok((sigma >= NEAR).then(|| rows(block, &tableau, left, sigma)));
        }
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
            rests.push_row(rest.into_iter().enumerate());
            names.push(tableau.basic[i] as usize);
        }
    }
    let factor = Faer.factor(&rests, &[], tolerance)?;
    Ok(factor.order[..factor.rank].iter().map(|&k| names[k]).collect())
}

/// Of equations that say the same the earlier one is kept, and the singular value is that of the rows then kept; all stays as
/// it is where that would cost accuracy.
fn in_order(
    block: &Block,
    backend: &dyn Backend,
    tableau: Tableau,
    sigma: f64,
) -> Result<(Tableau, f64), BackendError> {
    let mut ordered = tableau.clone();
    ordered.prefer(|candidate, holder| candidate > holder);
    if ordered.basic == tableau.basic {
        return Ok((tableau, sigma));
    }
    let kept: Vec<usize> = ordered.free.iter().map(|&k| k as usize).collect();
    let (found, _) = if backend.is_orthogonal() {
        backend.factor(&select(block, &kept), &[], 0.0)?.smallest_singular_value()
    } else {
        smallest_of(block, &kept)?
    };
    Ok(if 2.0 * found < sigma { (tableau, sigma) } else { (ordered, found) })
}

fn rows(block: &Block, tableau: &Tableau, left: f64, sigma: f64) -> Rows {
    let mut kept: Vec<usize> = tableau.free.iter().map(|&k| k as usize).collect();
    kept.sort_unstable();
    let noise = (ROUNDING * f64::EPSILON / sigma).max(NOISE);
    let all = (0..tableau.basic.len()).map(|i| dependent(block, tableau, i, left, noise, sigma));
    Rows { dependent: all.collect(), kept, sigma }
}

/// The backend kept rows that are dependent to within the tolerance (no pivot was small, as in Kahan's matrix): row after
/// row, the one with the largest part in the smallest singular vector is dropped, until what is kept is independent.
fn repair(
    block: &Block,
    backend: &dyn Backend,
    tolerance: f64,
    factor: &Factor,
    weakest: usize,
) -> Result<Rows, BackendError> {
    let mut kept = factor.order[..factor.rank].to_vec();
    let mut dropped = factor.order[factor.rank..].to_vec();
    let mut drop = weakest;
    loop {
        let place = kept.iter().position(|&i| i == drop).unwrap_or(kept.len() - 1);
        dropped.push(kept.swap_remove(place));
        let (sigma, weakest) = if kept.is_empty() { (1.0, 0) } else { smallest_of(block, &kept)? };
        if sigma > tolerance {
            let tableau = over_kept(block, backend, &kept, &dropped)?;
            let left = remainder(block, &tableau);
            return Ok(rows(block, &tableau, left, sigma));
        }
        drop = weakest;
    }
}

/// Smallest singular value of the kept rows, and the row with the largest part in its singular vector.
fn smallest(block: &Block, factor: &Factor, backend: &dyn Backend) -> Result<(f64, usize), BackendError> {
    if backend.is_orthogonal() {
        let (sigma, k) = factor.smallest_singular_value();
        return Ok((sigma, factor.order.get(k).copied().unwrap_or(0)));
    }
    smallest_of(block, &factor.order[..factor.rank])
}

/// The same from a QR with column pivoting.
fn smallest_of(block: &Block, kept: &[usize]) -> Result<(f64, usize), BackendError> {
    let factor = Faer.factor(&select(block, kept), &[], 0.0)?;
    let (sigma, k) = factor.smallest_singular_value();
    Ok((sigma, factor.order.get(k).map_or(0, |&k| kept[k])))
}

fn select(block: &Block, rows: &[usize]) -> Csr {
    let mut selected = Csr::empty(block.matrix.cols);
    rows.iter().for_each(|&i| selected.push_row(block.matrix.row(i)));
    selected
}

/// The dropped rows over the kept ones: least squares with the kept rows as columns.
fn over_kept(block: &Block, backend: &dyn Backend, kept: &[usize], dropped: &[usize]) -> Result<Tableau, BackendError> {
    let n = block.matrix.cols;
    let mut rhs = vec![0.0; n * dropped.len()];
    for (c, &i) in dropped.iter().enumerate() {
        block.matrix.row(i).for_each(|(j, v)| rhs[c * n + j] = v);
    }
    let factor = backend.factor(&select(block, kept), &rhs, NO_PIVOT)?;
    let r = factor.rank;
    Ok(Tableau {
        basic: dropped.iter().map(|&i| i as u32).collect(),
        free: factor.order[..r].iter().map(|&k| kept[k] as u32).collect(),
        width: r,
        data: (0..dropped.len()).flat_map(|c| factor.solve(&factor.rhs[c * r..(c + 1) * r])).collect(),
    })
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

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|v| v * v).sum::<f64>().sqrt()
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

/// Row k of the tableau: `R1^-1 R2_k`, the dependent equation over the kept ones.
fn certificates(factor: &Factor) -> Tableau {
    let position = |k: &usize| *k as u32;
    Tableau {
        basic: factor.order[factor.rank..].iter().map(position).collect(),
        free: factor.order[..factor.rank].iter().map(position).collect(),
        width: factor.rank,
        data: factor.coefficients().concat(),
    }
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
    Dependent { row: block.rows[k], because, dropped: left, mismatch: mismatch.scaled(-block.exponents[k]) }
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
