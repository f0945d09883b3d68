//! `C^T P = Q [R1 R2]`: finds the rows of a block that are combinations of others, and the coefficients.

mod certificate;
mod late;
mod weak;

use super::gathered::{Block, FactorContext};
use super::triangle::{Triangle, seeds};
use crate::factor::backend::faer::Faer;
use crate::factor::backend::{Backend, BackendError};
use crate::presolve::basis::NEAR;
use certificate::{Choice, ESTIMATE, beyond_rounding, in_order, over_kept, rows};
use late::late;
use weak::{ROUNDS, unexplained, without_weak};

pub(super) use certificate::{Rows, noise_of};

/// Largest size m n (rows times DOFs) of a block that is factored again, with pivoting, if it seems nearly dependent.
const DENSE: usize = 1 << 20;

/// Tolerance for rows that are known to be independent; a tolerance of zero would let backends take rounding for a pivot.
pub(crate) const NO_PIVOT: f64 = 1e-13;

pub(super) fn find(block: &Block, means: FactorContext) -> Result<Rows, BackendError> {
    let mut rows = independent(block, means)?;
    rows.order = rows.order.iter().filter_map(|k| rows.kept.binary_search(k).ok()).collect();
    Ok(rows)
}

/// The kept and the dependent rows of a block; `order` covers the whole block, not only the kept rows.
fn independent(block: &Block, means: FactorContext) -> Result<Rows, BackendError> {
    let FactorContext { backend, tolerance, check, .. } = means;
    let factor = backend.factor(&block.matrix, &seeds(block), tolerance)?;
    let order = factor.order.clone();
    let left = beyond_rounding(&factor, block);
    let mut choice = Choice::new(block, factor, means)?;
    if !check {
        return Ok(if choice.triangle.has_many_certificates() {
            late(block, left, choice, order)
        } else {
            rows(block, &over_kept(&mut choice.triangle), left, choice, order)
        });
    }
    let (m, n) = (block.matrix.rows(), block.matrix.cols);
    let pivots = backend.pivots(n, m) || choice.near.distance >= NEAR;
    if !pivots && m * n > DENSE {
        // The smallest singular value sigma bounds from below how far each kept row is from the span of the others, so a large sigma leaves
        // no doubt.
        let doubtful = choice.near.sigma <= ESTIMATE * tolerance;
        if let Some(rows) = if doubtful { without_weak(block, means, &choice, &order)? } else { None } {
            return Ok(rows);
        }
    } else if !pivots {
        // The backend may have kept the wrong rows of a sound block; pivoting keeps the best ones.
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

/// Repairs a choice whose rows are dependent to within the tolerance; otherwise keeps the earlier ones of equivalent equations.
fn ordered_or_repaired(
    block: &Block,
    means: FactorContext,
    mut choice: Choice,
    left: f64,
    order: Vec<usize>,
) -> Result<Rows, BackendError> {
    if choice.weakest.left <= means.tolerance && choice.near.distance < NEAR && !choice.triangle.rows.is_empty() {
        return repair(block, means, choice, order);
    }
    if choice.triangle.has_many_certificates() {
        return Ok(late(block, left, choice, order));
    }
    let tableau = over_kept(&mut choice.triangle);
    let (tableau, choice) = in_order(block, means, tableau, choice)?;
    Ok(rows(block, &tableau, left, choice, order))
}

/// Repairs a choice in which the backend kept rows that are dependent to within the tolerance. This happens if no pivot is small, as in
/// Kahan's matrix, or if coefficients grow when equations are substituted into each other. Each step drops the row with the largest
/// component in the singular vector of the smallest singular value, until the kept rows are independent. Then dropped rows that are no
/// combination of the kept ones come back.
fn repair(block: &Block, means: FactorContext, mut choice: Choice, order: Vec<usize>) -> Result<Rows, BackendError> {
    let mut rounds = 0..ROUNDS;
    loop {
        while choice.weakest.left <= means.tolerance {
            let Triangle { rows: mut kept, mut dropped, .. } = choice.triangle;
            kept.retain(|&i| i != choice.weakest.row);
            dropped.push(choice.weakest.row);
            choice = Choice::of(block, &kept, &dropped, means)?;
        }
        let tableau = over_kept(&mut choice.triangle);
        let back = unexplained(block, &tableau, choice.triangle.rests(), means.tolerance)?;
        if back.is_empty() || rounds.next().is_none() {
            let left = choice.remainder(block);
            return Ok(rows(block, &tableau, left, choice, order));
        }
        let Triangle { rows: mut kept, mut dropped, .. } = choice.triangle;
        dropped.retain(|k| !back.contains(k));
        kept.extend(back);
        choice = Choice::of(block, &kept, &dropped, means)?;
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;
    use crate::Csr;
    use crate::common::random::signed;
    use crate::factor::backend::Factor;
    use crate::factor::backend::sparse::Sparse;
    use crate::presolve::eliminated::Mismatch;

    /// Sparse QR that counts its factorizations.
    struct CountedQr(AtomicUsize);

    impl Backend for CountedQr {
        fn name(&self) -> &'static str {
            "counted"
        }

        fn version(&self) -> String {
            String::new()
        }

        fn factor(&self, columns: &Csr, rhs: &[f64], tolerance: f64) -> Result<Factor, BackendError> {
            self.0.fetch_add(1, Ordering::Relaxed);
            Sparse { memory: usize::MAX }.factor(columns, rhs, tolerance)
        }
    }

    /// A block of more than [`DENSE`] numbers, most of them zero; its last row is the first one up to `off`.
    fn nearly_dependent(off: f64) -> Block {
        let (m, n) = (500_usize, 2200);
        let row = |i: usize| (4 * i..4 * i + 6).map(move |j| (j, signed(i as u64, j as u64)));
        let mut matrix = Csr::empty(n);
        (0..m - 1).for_each(|i| matrix.append(row(i)));
        matrix.append(row(0).map(|(j, v)| (j, v * (1.0 + off * signed(7, j as u64)))));
        block(matrix, vec![0; m], vec![Mismatch::default(); m])
    }

    /// A block without prescribed DOFs, with the rows 2, 4, 6, ....
    fn block(matrix: Csr, exponents: Vec<i32>, effective: Vec<Mismatch>) -> Block {
        let (m, n) = (matrix.rows(), matrix.cols);
        Block {
            rows: (1..=m as u32).map(|i| 2 * i).collect(),
            exponents,
            dofs: (0..n as u32).collect(),
            units: vec![0; n],
            balanced: vec![0; n],
            matrix,
            prescribed: Vec::new(),
            fixed: Csr { cols: 0, start: vec![0; m + 1], col: Vec::new(), val: Vec::new() },
            rhs: vec![0.0; m],
            effective: vec![effective],
            certain: vec![1.0; m],
            errors: vec![f64::EPSILON; m],
            random: vec![vec![0.5; m]],
        }
    }

    /// Rows, and combinations of two or three of them, each with a mismatch of 0 or 1. The last DOF is in the last combination only.
    fn with_combinations(seed: u64, small: f64) -> (Block, Vec<f64>) {
        let mut count = 1000 * seed;
        let mut next = || {
            count += 1;
            signed(5, count)
        };
        let (m, n, more) = (5 + seed as usize % 4, 12, 1 + seed as usize % 3);
        let mut rows: Vec<Vec<f64>> = (0..m).map(|_| (0..n).map(|_| next()).chain([0.0]).collect()).collect();
        let mut sides: Vec<f64> = (0..m).map(|_| 10.0 * next()).collect();
        let mut off = vec![0.0; m];
        for k in 0..more {
            let terms: Vec<(usize, f64)> = (0..2 + k % 2).map(|l| ((seed as usize + 2 * l + k) % m, next())).collect();
            let combined = |values: &dyn Fn(usize) -> f64| terms.iter().map(|&(i, c)| c * values(i)).sum::<f64>();
            rows.push((0..=n).map(|j| combined(&|i| rows[i][j])).collect());
            off.push(f64::from(next() > 0.0));
            sides.push(combined(&|i| sides[i]) + off[m + k]);
        }
        rows[m + more - 1][n] = small;
        let mut matrix = Csr::empty(n + 1);
        rows.iter().for_each(|row| matrix.append(row.iter().copied().enumerate().filter(|&(_, v)| v != 0.0)));
        let side = |&value: &f64| Mismatch { value, size: value.abs(), error: 1e-12 * (1.0 + next().abs()) };
        let sides = sides.iter().map(side).collect();
        let exponents = (0..rows.len() as i32).map(|i| i % 5 - 2).collect();
        (block(matrix, exponents, sides), off)
    }

    /// The same block with certificates at once and when they are read. Sizes and errors of late mismatches are estimates.
    #[test]
    fn certificates_computed_when_read_are_those_computed_at_once() {
        let backend = Sparse { memory: usize::MAX };
        for (seed, small) in (0..200).flat_map(|seed| [(seed, 0.0), (seed, 1e-11)]) {
            let (block, off) = with_combinations(seed, small);
            let means = FactorContext::new(&backend, 1e-10, true, usize::MAX);
            let factored = || {
                let factor = backend.factor(&block.matrix, &seeds(&block), 1e-10).expect("small");
                (beyond_rounding(&factor, &block), Choice::new(&block, factor, means).expect("small"))
            };
            let (left, mut choice) = factored();
            let at_once = rows(&block, &over_kept(&mut choice.triangle), left, choice, Vec::new());
            let (left, choice) = factored();
            let mut late = late(&block, left, choice, Vec::new());
            assert_eq!(at_once.kept, late.kept, "{seed}");
            let moves = late.triangle.motions(&block).moves;
            let explained = crate::factor::block::unexplained::unexplained(&block, &mut late, &moves);
            assert_eq!(explained.unexplained, 0, "{seed}, {small:e}");
            let last = block.rows[off.len() - 1];
            for (a, b) in at_once.dependent.iter().zip(&late.dependent) {
                let (own, terms) = (a.because.terms(), b.because.terms());
                assert!(own.iter().map(|term| term.0).eq(terms.iter().map(|term| term.0)), "{seed}: {own:?} {terms:?}");
                let is_near = |(a, b): (&(u32, f64), &(u32, f64))| (a.1 - b.1).abs() <= 1e-10 * a.1.abs();
                assert!(own.iter().zip(terms.iter()).all(is_near), "{seed}: {own:?} and {terms:?}");
                let (own, estimate) = (a.mismatches[0], b.mismatches[0]);
                assert!(
                    (own.value - estimate.value).abs() <= own.error + estimate.error,
                    "{seed}: {own:?} {estimate:?}"
                );
                let ratios = [estimate.size / own.size, estimate.error / own.error];
                assert!(ratios.iter().all(|ratio| (0.2..8.0).contains(ratio)), "{seed}: {ratios:?}");
                let is_told = small > 0.0 && (b.row == last || terms.iter().any(|term| term.0 == last));
                assert_eq!((a.row, b.dropped > 0.0), (b.row, is_told), "{seed}");
            }
        }
    }

    /// If the smallest singular value is far above the tolerance, no row is sought that should be dropped.
    #[test]
    fn large_blocks_without_doubt_are_factored_once() {
        for (off, kept) in [(1e-2, 500), (1e-6, 500), (1e-7, 500), (1e-13, 499)] {
            let backend = CountedQr(AtomicUsize::new(0));
            let found =
                find(&nearly_dependent(off), FactorContext::new(&backend, 1e-10, true, usize::MAX)).expect("small");
            assert_eq!((found.kept.len(), backend.0.into_inner()), (kept, 1), "off by {off:e}");
        }
    }
}
