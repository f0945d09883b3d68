//! `C^T P = Q [R1 R2]`: which rows of a block are combinations of others, and of which.

mod certificate;
mod late;
mod weak;

use super::gathered::{Block, FactorContext};
use super::triangle::{Triangle, seeds};
use crate::factor::backend::faer::Faer;
use crate::factor::backend::{Backend, BackendError};
use crate::presolve::basis::NEAR;
use certificate::{Choice, MANY, beyond_rounding, in_order, over_kept, rows};
use late::late;
use weak::{ROUNDS, unexplained, without_weak};

pub(super) use certificate::Rows;

/// m n up to which a block that seems nearly dependent is factored once more, with pivoting.
const DENSE: usize = 1 << 20;

/// Stands for zero where rows are known to be independent and backends must not take rounding for a pivot.
pub(crate) const NO_PIVOT: f64 = 1e-13;

/// The estimate of a smallest singular value is not above this times the value.
const ESTIMATE: f64 = 10.0;

pub(super) fn find(block: &Block, means: FactorContext) -> Result<Rows, BackendError> {
    let mut rows = independent(block, means)?;
    rows.order = rows.order.iter().filter_map(|k| rows.kept.binary_search(k).ok()).collect();
    Ok(rows)
}

/// As [`find`], with the whole block in `order`.
fn independent(block: &Block, means: FactorContext) -> Result<Rows, BackendError> {
    let FactorContext { backend, tolerance, check, .. } = means;
    let factor = backend.factor(&block.matrix, &seeds(block), tolerance)?;
    let order = factor.order.clone();
    let left = beyond_rounding(&factor, block);
    let choice = Choice::new(block, factor, means)?;
    if !check {
        return Ok(if are_many(&choice.triangle) {
            late(block, left, choice, order)
        } else {
            rows(block, &over_kept(&choice.triangle), left, choice, order)
        });
    }
    let (m, n) = (block.matrix.rows(), block.matrix.cols);
    let pivots = backend.pivots(n, m) || choice.near.distance >= NEAR;
    if !pivots && m * n > DENSE {
        // No row is nearer to the others than sigma.
        let doubtful = choice.near.sigma <= ESTIMATE * tolerance;
        if let Some(rows) = if doubtful { without_weak(block, means, &choice, &order)? } else { None } {
            return Ok(rows);
        }
    } else if !pivots {
        // The backend may have kept the wrong rows of a sound block: with pivoting the best are kept.
        let means = FactorContext { backend: &Faer, ..means };
        let other = Faer.factor(&block.matrix, &seeds(block), tolerance)?;
        let left = beyond_rounding(&other, block);
        let better = Choice::new(block, other, means)?;
        if better.near.sigma > choice.near.sigma {
            return ordered_or_repaired(block, means, better, left, order);
        }
    }
    ordered_or_repaired(block, means, choice, left, order)
}

/// Whether certificates are too many numbers to be made before somebody reads them.
fn are_many(triangle: &Triangle) -> bool {
    triangle.dropped.len().saturating_mul(triangle.rows.len()) > MANY && triangle.holds_dropped()
}

/// Of what a backend kept the rows that are sound.
fn ordered_or_repaired(
    block: &Block,
    means: FactorContext,
    choice: Choice,
    left: f64,
    order: Vec<usize>,
) -> Result<Rows, BackendError> {
    if choice.weakest.left <= means.tolerance && choice.near.distance < NEAR && !choice.triangle.rows.is_empty() {
        return repair(block, means, choice, order);
    }
    if are_many(&choice.triangle) {
        return Ok(late(block, left, choice, order));
    }
    let tableau = over_kept(&choice.triangle);
    let (tableau, choice) = in_order(block, means, tableau, choice)?;
    Ok(rows(block, &tableau, left, choice, order))
}

/// The backend kept rows that are dependent to within the tolerance (no pivot was small, as in Kahan's matrix, or equations substituted
/// one into the next grew): row after row, the one with the largest part in the smallest singular vector is dropped, until what is kept is
/// independent. What was dropped before may be no combination of that, and comes back.
fn repair(block: &Block, means: FactorContext, mut choice: Choice, order: Vec<usize>) -> Result<Rows, BackendError> {
    let mut round = 0;
    loop {
        while choice.weakest.left <= means.tolerance {
            let Triangle { rows: mut kept, mut dropped, .. } = choice.triangle;
            let place = kept.iter().position(|&i| i == choice.weakest.row).unwrap_or(kept.len() - 1);
            dropped.push(kept.swap_remove(place));
            choice = Choice::of(block, &kept, &dropped, means)?;
        }
        let tableau = over_kept(&choice.triangle);
        let back = unexplained(block, &tableau, choice.triangle.rests(), means.tolerance)?;
        if back.is_empty() || round == ROUNDS {
            let left = choice.remainder(block);
            return Ok(rows(block, &tableau, left, choice, order));
        }
        let Triangle { rows: mut kept, mut dropped, .. } = choice.triangle;
        dropped.retain(|k| !back.contains(k));
        kept.extend(back);
        choice = Choice::of(block, &kept, &dropped, means)?;
        round += 1;
    }
}
