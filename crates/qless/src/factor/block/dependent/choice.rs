//! Rows that are kept, with their factor, and how near they are to dependence.

use super::certificate::noise_of;
use crate::Csr;
use crate::factor::backend::{BackendError, Factor, largest_place, part_of_largest};
use crate::factor::block::triangle::Triangle;
use crate::factor::block::{Block, Means};
use crate::presolve::basis::{NEAR, Nearness};

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
    pub fn new(block: &Block, factor: Factor, means: Means) -> Result<Self, BackendError> {
        let whole = Triangle::whole(factor);
        if means.backend.is_orthogonal() {
            return Ok(Self::measured(block, whole, means));
        }
        Self::of(block, &whole.rows, &whole.dropped, means)
    }

    /// Some rows, those left out that are dependent to the last bit; `asked` are rows of which certificates will be wanted.
    pub fn of(block: &Block, kept: &[usize], asked: &[usize], means: Means) -> Result<Self, BackendError> {
        Ok(Self::measured(block, Triangle::of(block, kept, asked, means)?, means))
    }

    /// Largest 2-norm of what the kept rows leave of those asked for, or 0 if rounding explains it.
    pub fn remainder(&self, block: &Block) -> f64 {
        let left = self.triangle.rests().iter().copied().fold(0.0, f64::max);
        if left > noise_of(block) { left } else { 0.0 }
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
