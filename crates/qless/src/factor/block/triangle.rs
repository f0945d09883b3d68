//! `C_k^T P = Q R` of the kept rows: computes everything that a diagnosis needs of a block by triangular solves with R.
//!
//! ```text
//! certificate of row c    y = R^-1 Q^T c                       Q^T c from the factorization
//! vector of the null space  u = v - C_k^T R^-1 (Q^T v)          Q^T v from the factorization
//! shortest solution       x = C_k^T R^-1 R^-T b                with a step of correction
//! ```
//!
//! c is a dropped row, v a random vector and b a right-hand side. Each takes O(nnz R). Sixteen certificates are computed at a time.

use std::sync::Arc;

use rayon::prelude::*;
use rayon::{FnContext, join_context};

use super::gathered::{Block, FactorContext};
use crate::common::random::signed;
use crate::factor::backend::many::{Slab, WIDTH, slabs};
use crate::factor::backend::{BackendError, Factor};
use crate::presolve::basis::Vectors;
use crate::presolve::eliminated::Mismatch;

/// Seeds of the two random vectors of the null space: an entry can be zero by chance in one of them, but hardly in both.
const SEEDS: [u64; 2] = [0x51ed_270b, 0x85eb_ca6b];

/// Largest number of corrections of the null-space vectors.
const CORRECTIONS: usize = 3;
/// If a correction subtracts no kept row with a coefficient above this, the correction is only rounding.
const DONE: f64 = 1e-12;

/// Allowed relative error of a solution from which an estimate is computed. A report shows the estimate to a tenth of a digit.
const ENOUGH: f64 = 1e-3;

/// Certificates with at most this many coefficients in total are all computed at once.
pub(super) const MANY: usize = 4_000_000;

/// Two vectors, stored entry by entry.
type VectorPair = Slab<2>;

/// The factor of some rows of a block.
#[derive(Clone)]
pub(crate) struct Triangle {
    pub factor: Arc<Factor>,
    /// For each column of the triangular factor R1, the row of the block.
    pub rows: Vec<usize>,
    /// Rows whose certificates the factor can compute: those asked for, then those left out as dependent.
    pub dropped: Vec<usize>,
    /// Number of rows whose certificates were asked for.
    asked: usize,
    /// Results that another thread computed before they were asked for.
    ahead: Ahead,
}

/// Results of [`Triangle::vectors`] and [`Triangle::certificates`], until they are asked for.
#[derive(Clone, Default)]
struct Ahead {
    vectors: Option<BlockVectors>,
    certificates: Option<Vec<Vec<f64>>>,
}

/// Vectors that a diagnosis needs of the factor, in the units of the block.
#[derive(Clone)]
pub(crate) struct BlockVectors {
    /// Only the two random vectors of the null space are set.
    pub motions: Vectors,
    /// For each block of [`Block::effective`], the two minimum-norm solutions; only these are set.
    pub solutions: Vec<Vectors>,
}

/// The random vectors by columns, as right-hand sides of a factorization of `C^T`.
pub(super) fn seeds(block: &Block) -> Vec<f64> {
    let n = block.matrix.cols as u64;
    SEEDS.iter().flat_map(|&seed| (0..n).map(move |j| signed(seed, j))).collect()
}

impl Triangle {
    /// Wraps the factor of a whole block; its rows are those that the backend kept.
    pub fn whole(factor: Factor) -> Self {
        let (rows, dropped) = factor.order.split_at(factor.rank);
        let (rows, dropped) = (rows.to_vec(), dropped.to_vec());
        Self { factor: Arc::new(factor), rows, dropped, asked: 0, ahead: Ahead::default() }
    }

    /// Factors rows that are known to be independent; rows that are dependent to the last bit are left out. The rows `asked` are right-hand
    /// sides, so that their certificates can be computed.
    pub fn of(block: &Block, kept: &[usize], asked: &[usize], means: FactorContext) -> Result<Self, BackendError> {
        let mut sides = seeds(block);
        for &k in asked {
            let first = sides.len();
            sides.resize(first + block.matrix.cols, 0.0);
            block.matrix.row(k).for_each(|(j, v)| sides[first + j] = v);
        }
        let factor = means.orthogonal().factor(&block.select(kept), &sides, 0.0)?;
        let (rows, left_out) = factor.order.split_at(factor.rank);
        let rows = rows.iter().map(|&k| kept[k]).collect();
        let dropped = asked.iter().copied().chain(left_out.iter().map(|&k| kept[k])).collect();
        Ok(Self { factor: Arc::new(factor), rows, dropped, asked: asked.len(), ahead: Ahead::default() })
    }

    /// Returns true if all dropped rows are columns of R2, so that certificates can be computed a few at a time.
    pub fn holds_dropped(&self) -> bool {
        self.asked == 0
    }

    /// For each row whose certificate was asked for, the 2-norm of what remains of the row.
    pub fn rests(&self) -> &[f64] {
        &self.factor.rest[SEEDS.len()..]
    }

    /// The certificates `y = R1^-1 Q^T c` of the rows c in [`Triangle::dropped`], with the QR factorization of the kept rows. Coefficients
    /// are in the order of [`Triangle::rows`].
    pub fn certificates(&mut self) -> Vec<Vec<f64>> {
        self.ahead.certificates.take().unwrap_or_else(|| self.computed_certificates())
    }

    fn computed_certificates(&self) -> Vec<Vec<f64>> {
        let r = self.factor.rank;
        let asked = self.factor.rhs[SEEDS.len() * r..].chunks(r.max(1));
        let sides: Vec<&[f64]> = asked.collect();
        let of = |some: &[&[f64]]| {
            let mut y = slabs(some.len(), r, |c, i| some[c][i]).swap_remove(0);
            self.factor.solve_slab(&mut y);
            (0..some.len()).map(|c| y.iter().map(|y| y[c]).collect()).collect::<Vec<Vec<f64>>>()
        };
        let mut all: Vec<Vec<f64>> = sides.par_chunks(WIDTH).flat_map_iter(of).collect();
        all.extend(self.factor.all_coefficients());
        all
    }

    /// The smallest singular value of the factor and its singular vector. If the first estimate is above `doubtful`, these rows will hardly
    /// change. Then a thread that has nothing to do may compute meanwhile what is asked next.
    pub fn smallest_singular_value(&mut self, block: &Block, doubtful: f64) -> (f64, Vec<f64>) {
        let (sigma, x) = self.factor.first_estimate();
        if sigma <= doubtful || rayon::current_num_threads() == 1 {
            return self.factor.after_first_estimate(x);
        }
        let ahead = |thread: FnContext| if thread.migrated() { self.ahead(block) } else { Ahead::default() };
        let (found, ahead) = join_context(|_| self.factor.after_first_estimate(x), ahead);
        self.ahead = ahead;
        found
    }

    fn ahead(&self, block: &Block) -> Ahead {
        let certificates = || (!self.has_many_certificates()).then(|| self.computed_certificates());
        let (vectors, certificates) = rayon::join(|| Some(self.computed_vectors(block)), certificates);
        Ahead { vectors, certificates }
    }

    /// Returns true if the certificates have too many coefficients to be computed before they are read.
    pub fn has_many_certificates(&self) -> bool {
        self.dropped.len().saturating_mul(self.rows.len()) > MANY && self.holds_dropped()
    }

    /// The vectors for a diagnosis of the block that was factored.
    pub fn vectors(&mut self, block: &Block) -> BlockVectors {
        self.ahead.vectors.take().unwrap_or_else(|| self.computed_vectors(block))
    }

    fn computed_vectors(&self, block: &Block) -> BlockVectors {
        let (motions, solutions) = rayon::join(|| self.motions(block), || self.solutions(block));
        BlockVectors { motions, solutions }
    }

    /// The two minimum-norm solutions for each of the blocks.
    fn solutions(&self, block: &Block) -> Vec<Vectors> {
        let of = |(random, effective): (&Vec<f64>, &Vec<Mismatch>)| {
            let sides = |&i: &usize| [random[i], effective[i].value];
            let x = self.shortest(block, &self.rows.iter().map(sides).collect());
            Vectors { sample: lane(&x, 0), particular: lane(&x, 1), ..Vectors::default() }
        };
        block.random.par_iter().zip(&block.effective).map(of).collect()
    }

    /// Two random vectors of the null space. If there are as many rows as DOFs, the vectors are zero, because only rounding would remain.
    pub fn motions(&self, block: &Block) -> Vectors {
        let (r, n) = (self.rows.len(), block.matrix.cols);
        if r == n {
            return Vectors { moves: [vec![0.0; n], vec![0.0; n]], ..Vectors::default() };
        }
        let sides = [&self.factor.rhs[..r], &self.factor.rhs[r..2 * r]];
        let mut weights = pair(r, |c, i| sides[c][i]);
        self.factor.solve_slab(&mut weights);
        let seeds = seeds(block);
        let mut moves = pair(n, |c, j| seeds[c * n + j]);
        self.subtract_from(block, &weights, &mut moves);
        // If kept rows were subtracted with large coefficients, the vectors have rounding errors, which these corrections remove.
        for _ in 0..CORRECTIONS {
            let mut left = self.times(block, &moves);
            self.normal(&mut left);
            self.subtract_from(block, &left, &mut moves);
            if left.iter().flatten().all(|w| w.abs() <= DONE) {
                break;
            }
        }
        Vectors { moves: [lane(&moves, 0), lane(&moves, 1)], ..Vectors::default() }
    }

    /// The minimum-norm `x` with `C_k x = b`, where `C_k` holds the kept rows; by a solve and one correction.
    pub fn shortest<const W: usize>(&self, block: &Block, b: &Slab<W>) -> Slab<W> {
        let mut x = self.first_shortest(block, b);
        let mut step = self.times(block, &x);
        step.iter_mut().zip(b).for_each(|(step, b)| step.iter_mut().zip(b).for_each(|(step, b)| *step -= b));
        self.normal(&mut step);
        self.subtract_from(block, &step, &mut x);
        x
    }

    /// As [`Triangle::shortest`], to a relative error of 1e-3: corrected only if a solve without correction is not accurate.
    pub fn nearly_shortest<const W: usize>(&self, block: &Block, b: &Slab<W>, is_accurate: bool) -> Slab<W> {
        if is_accurate { self.first_shortest(block, b) } else { self.shortest(block, b) }
    }

    /// Returns true if a solve with the kept rows C and without correction has a relative error below 1e-3. The error is
    /// `u |C|^2 / sigma^2`, where u is the rounding unit and sigma the smallest singular value of C.
    pub fn is_accurate(&self, block: &Block, sigma: f64) -> bool {
        f64::EPSILON * self.size_squared(block) < ENOUGH * sigma * sigma
    }

    /// An upper bound of `|C_k|^2`, where `C_k` holds the rows of the block that this factor contains: the largest absolute row sum times
    /// the largest absolute column sum.
    fn size_squared(&self, block: &Block) -> f64 {
        let (mut columns, mut rows) = (vec![0.0; block.matrix.cols], 0.0_f64);
        for &k in &self.rows {
            block.matrix.row(k).for_each(|(j, v)| columns[j] += v.abs());
            rows = rows.max(block.matrix.row(k).map(|(_, v)| v.abs()).sum());
        }
        rows * columns.into_iter().fold(0.0, f64::max)
    }

    /// The minimum-norm solution `C_k^T R^-1 R^-T b` of `C_k x = b` without a correction. `C_k` holds the kept rows, and R is the
    /// triangular factor of `C_k^T`.
    pub fn first_shortest<const W: usize>(&self, block: &Block, b: &Slab<W>) -> Slab<W> {
        let mut x = vec![[0.0; W]; block.matrix.cols];
        let mut step = b.iter().map(|b| b.map(|b| -b)).collect();
        self.normal(&mut step);
        self.subtract_from(block, &step, &mut x);
        x
    }

    /// The combinations `(R^T R)^-1 C_k X` of the kept rows `C_k` that are nearest to X, in the order of [`Triangle::rows`]. R is the
    /// triangular factor of `C_k^T`.
    pub fn projected(&self, block: &Block, x: &Slab) -> Slab {
        let mut z = self.times(block, x);
        self.normal(&mut z);
        z
    }

    /// `Z <- (R^T R)^-1 Z`, by two solves with the triangular factor R of the kept rows.
    fn normal<const W: usize>(&self, z: &mut Slab<W>) {
        self.factor.solve_slab_transposed(z);
        self.factor.solve_slab(z);
    }

    /// The product `C_k X` of the kept rows `C_k`.
    fn times<const W: usize>(&self, block: &Block, x: &Slab<W>) -> Slab<W> {
        let product = |&k: &usize| {
            let mut sum = [0.0; W];
            block.matrix.row(k).for_each(|(j, v)| sum.iter_mut().zip(&x[j]).for_each(|(sum, x)| *sum += v * x));
            sum
        };
        self.rows.iter().map(product).collect()
    }

    /// `X <- X - C_k^T W` with the kept rows `C_k`.
    fn subtract_from<const W: usize>(&self, block: &Block, w: &Slab<W>, x: &mut Slab<W>) {
        for (&k, w) in self.rows.iter().zip(w) {
            block.matrix.row(k).for_each(|(j, v)| x[j].iter_mut().zip(w).for_each(|(x, w)| *x -= v * w));
        }
    }
}

fn lane(slab: &VectorPair, c: usize) -> Vec<f64> {
    slab.iter().map(|row| row[c]).collect()
}

/// Packs two vectors; entry i of vector c is `of(c, i)`.
fn pair(length: usize, of: impl Fn(usize, usize) -> f64) -> VectorPair {
    (0..length).map(|i| [of(0, i), of(1, i)]).collect()
}
