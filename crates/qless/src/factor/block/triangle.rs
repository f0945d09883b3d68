//! `C_k^T P = Q R` of the kept rows: all that a diagnosis asks of a block, by triangular solves with R.
//!
//! ```text
//! certificate of row c    y = R^-1 R^-T C_k c                  with a step of correction (Björck 1987)
//! vector of the null space  u = v - C_k^T R^-1 (Q^T v)          Q^T v from the factorization
//! shortest solution       x = C_k^T R^-1 R^-T b                with a step of correction
//! ```
//!
//! Sixteen vectors at a time; O(nnz R) for each.

use rayon::prelude::*;

use super::{Block, Means};
use crate::common::random::signed;
use crate::factor::qr::many::{Slab, WIDTH, slabs};
use crate::factor::qr::{BackendError, Factor};
use crate::presolve::basis::Vectors;

/// Seeds of the vectors of the null space: two, for a number that is zero in both by chance is none.
const SEEDS: [u64; 2] = [0x51ed_270b, 0x85eb_ca6b];

/// Most corrections of vectors of the null space, ...
const CORRECTIONS: usize = 3;
/// ... and weights with which one has brought no more than rounding.
const DONE: f64 = 1e-12;

/// A solve and its correction.
const PASSES: usize = 2;

/// The factor of some rows of a block.
pub(crate) struct Triangle {
    pub factor: Factor,
    /// Row of the block for each column of R1.
    pub rows: Vec<usize>,
}

/// The random vectors, by columns, as right-hand sides of a factorization of `C^T`.
pub(super) fn seeds(block: &Block) -> Vec<f64> {
    let n = block.matrix.cols as u64;
    SEEDS.iter().flat_map(|&seed| (0..n).map(move |j| signed(seed, j))).collect()
}

impl Triangle {
    /// Factors rows that are known to be independent; those that are not, to the last bit, are left out.
    pub fn of(block: &Block, kept: &[usize], means: Means) -> Result<Self, BackendError> {
        let factor = means.orthogonal().factor(&block.select(kept), &seeds(block), 0.0)?;
        let rows = factor.order[..factor.rank].iter().map(|&k| kept[k]).collect();
        Ok(Self { factor, rows })
    }

    /// Whether the factor has columns for the rows that were dropped.
    pub fn holds(&self, dropped: &[usize]) -> bool {
        self.factor.order.len() == self.rows.len() + dropped.len()
    }

    /// Rows of the block over the kept ones: least squares, one column of numbers for each row asked for, in the order of
    /// [`Triangle::rows`].
    pub fn certificates(&self, block: &Block, rows: &[usize]) -> Vec<Vec<f64>> {
        let of = |asked: &[usize]| {
            let mut right = vec![[0.0; WIDTH]; block.matrix.cols];
            asked.iter().enumerate().for_each(|(c, &k)| block.matrix.row(k).for_each(|(j, v)| right[j][c] = v));
            let mut y = vec![[0.0; WIDTH]; self.rows.len()];
            for _ in 0..PASSES {
                let mut step = self.times(block, &right);
                self.normal(&mut step);
                self.subtract_from(block, &step, &mut right);
                y.iter_mut().zip(&step).for_each(|(y, step)| add(y, step));
            }
            (0..asked.len()).map(|c| y.iter().map(|y| y[c]).collect()).collect::<Vec<Vec<f64>>>()
        };
        rows.par_chunks(WIDTH).flat_map_iter(of).collect()
    }

    /// Everything that is asked of the null space and of solutions.
    pub fn vectors(&self, block: &Block) -> Vectors {
        let (r, n) = (self.rows.len(), block.matrix.cols);
        let sides = [&self.factor.rhs[..r], &self.factor.rhs[r..2 * r]];
        let mut weights = slabs(2, r, |c, i| sides[c][i]).swap_remove(0);
        self.factor.solve_slab(&mut weights);
        let seeds = seeds(block);
        let mut moves = slabs(2, n, |c, j| seeds[c * n + j]).swap_remove(0);
        self.subtract_from(block, &weights, &mut moves);
        // Again for what large weights have left by rounding.
        for _ in 0..CORRECTIONS {
            let mut left = self.times(block, &moves);
            self.normal(&mut left);
            self.subtract_from(block, &left, &mut moves);
            if left.iter().flatten().all(|w| w.abs() <= DONE) {
                break;
            }
        }
        let sides = |c: usize, i: usize| match c {
            0 => block.random[self.rows[i]],
            _ => block.effective[self.rows[i]].value,
        };
        let x = self.shortest(block, &slabs(2, r, sides)[0]);
        let lane = |slab: &Slab, c: usize| slab.iter().map(|row| row[c]).collect::<Vec<f64>>();
        Vectors { moves: [lane(&moves, 0), lane(&moves, 1)], sample: lane(&x, 0), particular: lane(&x, 1) }
    }

    /// `x` with `C_k x = b`, in the range of `C_k^T`.
    fn shortest(&self, block: &Block, b: &Slab) -> Slab {
        let mut x = vec![[0.0; WIDTH]; block.matrix.cols];
        for _ in 0..PASSES {
            let mut step: Slab = self.times(block, &x);
            step.iter_mut().zip(b).for_each(|(step, b)| step.iter_mut().zip(b).for_each(|(step, b)| *step -= b));
            self.normal(&mut step);
            self.subtract_from(block, &step, &mut x);
        }
        x
    }

    /// `Z <- (R^T R)^-1 Z`.
    fn normal(&self, z: &mut Slab) {
        self.factor.solve_slab_transposed(z);
        self.factor.solve_slab(z);
    }

    /// `C_k X`.
    fn times(&self, block: &Block, x: &Slab) -> Slab {
        let product = |&k: &usize| {
            let mut sum = [0.0; WIDTH];
            block.matrix.row(k).for_each(|(j, v)| sum.iter_mut().zip(&x[j]).for_each(|(sum, x)| *sum += v * x));
            sum
        };
        self.rows.iter().map(product).collect()
    }

    /// `X <- X - C_k^T W`.
    fn subtract_from(&self, block: &Block, w: &Slab, x: &mut Slab) {
        for (&k, w) in self.rows.iter().zip(w) {
            block.matrix.row(k).for_each(|(j, v)| x[j].iter_mut().zip(w).for_each(|(x, w)| *x -= v * w));
        }
    }
}

fn add(a: &mut [f64; WIDTH], b: &[f64; WIDTH]) {
    a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
}
