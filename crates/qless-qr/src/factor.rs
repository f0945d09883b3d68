//! `Q^T A P = [R1 R2; 0 0]` and `Q^T B`: the result of a factorization, substitution with R1, estimates of its condition.

use crate::Error;
use crate::reflections::Q;
use crate::staircase::scaled_norm;

/// A rank-revealing factorization `A P = Q [R1 R2; 0 0]` of an m x n matrix, with `Q^T B` and, on request, with Q.
///
/// Solutions: [`basic`](Self::basic) for the B passed to the factorization; [`solve`](Self::solve) and
/// [`solve_transposed`](Self::solve_transposed) for other right-hand sides if Q is kept,
/// [`solve_seminormal`](Self::solve_seminormal) if not; [`complete`](Self::complete) for the shortest solutions of
/// rank-deficient systems.
#[derive(Clone, Debug, PartialEq)]
pub struct Factor {
    pub(crate) rows: usize,
    pub(crate) order: Vec<usize>,
    pub(crate) r: SparseRows,
    pub(crate) rhs: Vec<f64>,
    pub(crate) rest: Vec<f64>,
    pub(crate) dropped: f64,
    pub(crate) tolerance: f64,
    pub(crate) q: Option<Q>,
}

/// The owned arrays of a [`Factor`], without Q.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct FactorParts {
    /// Columns of A in the order of [`Factor::order`].
    pub order: Vec<usize>,
    /// The rows `[R1 R2]`, as [`Factor::r`].
    pub r: SparseRows,
    /// The first r rows of `Q^T B`, as [`Factor::rhs`].
    pub rhs: Vec<f64>,
    /// Residual norms, as [`Factor::rest`].
    pub rest: Vec<f64>,
}

impl Factor {
    /// m, the number of rows of A.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// n, the number of columns of A.
    pub fn cols(&self) -> usize {
        self.order.len()
    }

    /// r, the number of columns found independent.
    pub fn rank(&self) -> usize {
        self.r.start.len() - 1
    }

    /// P: `order[k]` is the column of A at position k; the r independent columns come first.
    pub fn order(&self) -> &[usize] {
        &self.order
    }

    /// `[R1 R2]`, r x n; the first entry of row i is in column i.
    pub fn r(&self) -> &SparseRows {
        &self.r
    }

    /// First r rows of `Q^T B`, r x k by columns.
    pub fn rhs(&self) -> &[f64] {
        &self.rhs
    }

    /// 2-norms of the rows of `Q^T B` after the first r, one for each right-hand side: the least residual `min |A x - b|`.
    pub fn rest(&self) -> &[f64] {
        &self.rest
    }

    /// Frobenius norm of the column parts that were treated as zero.
    pub fn dropped(&self) -> f64 {
        self.dropped
    }

    /// The tolerance: a column is independent if the 2-norm of its remaining part exceeds it.
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// The owned arrays; drops Q.
    pub fn into_parts(self) -> FactorParts {
        let Self { order, r, rhs, rest, .. } = self;
        FactorParts { order, r, rhs, rest }
    }

    /// `B <- Q B` for vectors of length m, one after the other.
    ///
    /// # Errors
    /// [`Error::NoQ`] if Q was not kept, [`Error::Length`] if `b` is not made of such vectors.
    pub fn apply_q(&self, b: &mut [f64]) -> Result<(), Error> {
        columns_of(b.len(), self.rows)?;
        self.q()?.apply(b);
        Ok(())
    }

    /// `B <- Q^T B` for vectors of length m, one after the other. The first r numbers of each belong to the rows of R.
    ///
    /// ```
    /// use qless_qr::{Options, Symbolic};
    /// let symbolic = Symbolic::analyse(2, 1, &[0, 2], &[0, 1])?;
    /// let factor = symbolic.factor(&[3.0, 4.0], &[], Options::new().keep_q(true))?;
    /// let mut b = [3.0, 4.0];
    /// factor.apply_q_transposed(&mut b)?;
    /// assert!((b[0].abs() - 5.0).abs() < 1e-14 && b[1].abs() < 1e-14);
    /// # Ok::<(), qless_qr::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::NoQ`] if Q was not kept, [`Error::Length`] if `b` is not made of such vectors.
    pub fn apply_q_transposed(&self, b: &mut [f64]) -> Result<(), Error> {
        columns_of(b.len(), self.rows)?;
        self.q()?.apply_transposed(b);
        Ok(())
    }

    pub(crate) fn q(&self) -> Result<&Q, Error> {
        self.q.as_ref().ok_or(Error::NoQ)
    }
}

/// Number of vectors of length `expected` in `found` numbers; one vector if `expected` is 0.
pub(crate) fn columns_of(found: usize, expected: usize) -> Result<usize, Error> {
    let count = found.checked_div(expected).unwrap_or(1);
    if count * expected == found { Ok(count) } else { Err(Error::Length { what: "b", found, expected }) }
}

/// A sparse matrix by rows, such as R: row i has the entries `start[i]..start[i + 1]`, columns ascending.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SparseRows {
    /// Start of each row, and the end of the last one.
    pub start: Vec<usize>,
    /// Column of each entry.
    pub col: Vec<u32>,
    /// Value of each entry; no value is zero.
    pub val: Vec<f64>,
}

impl SparseRows {
    /// Columns and values of row i; empty if there is no such row.
    pub fn row(&self, i: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let range = match self.start.get(i..).unwrap_or_default() {
            &[first, last, ..] => first..last,
            _ => 0..0,
        };
        let (col, val) = (self.col.get(range.clone()), self.val.get(range));
        col.into_iter().flatten().zip(val.into_iter().flatten()).map(|(&j, &v)| (j as usize, v))
    }
}

impl Factor {
    /// Row i of the triangle R1 of R: its diagonal entry, and the columns and values behind it.
    fn upper(&self, i: usize) -> (f64, &[u32], &[f64]) {
        let (from, to) = (self.r.start[i], self.r.start[i + 1]);
        let to = if self.rank() == self.cols() {
            to
        } else {
            from + self.r.col[from..to].partition_point(|&j| (j as usize) < self.rank())
        };
        (self.r.val[from], &self.r.col[from + 1..to], &self.r.val[from + 1..to])
    }

    /// `z <- R1^{-1} z` with the r x r triangle R1 of R and z of length r: two operations for each entry of R1.
    pub(crate) fn back(&self, z: &mut [f64]) {
        for i in (0..self.rank()).rev() {
            let (diagonal, columns, values) = self.upper(i);
            let known = columns.iter().zip(values).fold(0.0, |sum, (&j, &v)| sum + v * z[j as usize]);
            z[i] = (z[i] - known) / diagonal;
        }
    }

    /// `c <- R1^{-T} c` with the r x r triangle R1 of R and c of length r.
    pub(crate) fn forward(&self, c: &mut [f64]) {
        for i in 0..self.rank() {
            let (diagonal, columns, values) = self.upper(i);
            c[i] /= diagonal;
            let known = c[i];
            columns.iter().zip(values).for_each(|(&j, &v)| c[j as usize] -= v * known);
        }
    }

    /// `|R1|_1`, the largest absolute column sum of the r x r triangle R1 of R.
    pub(crate) fn norm_one(&self) -> f64 {
        let mut sums = vec![0.0; self.rank()];
        for i in 0..self.rank() {
            let (diagonal, columns, values) = self.upper(i);
            sums[i] += diagonal.abs();
            columns.iter().zip(values).for_each(|(&j, v)| sums[j as usize] += v.abs());
        }
        sums.into_iter().fold(0.0, f64::max)
    }
}

/// Largest number of steps of Hager's ascent for a norm, which seldom takes more than three.
const STEPS: usize = 5;
/// Largest number of steps of the inverse iteration for the smallest singular value.
const ITERATIONS: usize = 30;

impl Factor {
    /// Lower estimate of the condition number `|R1|_1 |R1^{-1}|_1`; 1 if the rank is 0, infinite if `R1^{-1}` overflows. R1 is the r x r
    /// triangle of R; with full column rank, it has the singular values of A.
    ///
    /// The norm of the inverse comes from Hager's ascent over the corners of the unit ball, and from one more vector by Higham (Hager 1984;
    /// Higham 1988, Algorithm 4.1). The estimate is seldom below a third of the true norm. Cost: two substitutions with R1 for each step,
    /// and one for Higham's vector.
    ///
    /// ```
    /// use qless_qr::{Options, Symbolic};
    /// let symbolic = Symbolic::analyse(2, 2, &[0, 1, 2], &[0, 1])?;
    /// let factor = symbolic.factor(&[1.0, 1e-6], &[], Options::new())?;
    /// assert!((factor.condition() / 1e6 - 1.0).abs() < 1e-9);
    /// assert!((factor.smallest_singular_value() / 1e-6 - 1.0).abs() < 1e-9);
    /// # Ok::<(), qless_qr::Error>(())
    /// ```
    pub fn condition(&self) -> f64 {
        if self.rank() == 0 { 1.0 } else { finite(self.norm_one() * self.inverse_norm_one()) }
    }

    /// Upper estimate of the smallest singular value of R1, the r x r triangle of R, by inverse iteration on `R1^T R1`; infinite if the
    /// rank is 0.
    pub fn smallest_singular_value(&self) -> f64 {
        let r = self.rank();
        let mut x: Vec<f64> = (0..r).map(|i| 1.0 + i as f64 / r as f64).collect();
        let mut smallest = f64::INFINITY;
        for _ in 0..ITERATIONS {
            let size = scaled_norm(&x);
            if size == 0.0 || !size.is_finite() {
                return if r == 0 { f64::INFINITY } else { 0.0 };
            }
            x.iter_mut().for_each(|v| *v /= size);
            self.forward(&mut x);
            let found = 1.0 / scaled_norm(&x);
            self.back(&mut x);
            let settled = found > 0.999 * smallest;
            smallest = smallest.min(found);
            if settled {
                break;
            }
        }
        smallest
    }

    /// Lower estimate of `|R1^{-1}|_1`, where R1 is the r x r triangle of R.
    fn inverse_norm_one(&self) -> f64 {
        let r = self.rank();
        let mut x = vec![1.0 / r as f64; r];
        let mut best = 0.0;
        for _ in 0..STEPS {
            let mut y = x.clone();
            self.back(&mut y);
            let found = sum(&y);
            if found <= best {
                break;
            }
            best = found;
            y.iter_mut().for_each(|v| *v = v.signum());
            self.forward(&mut y);
            let slope = y.iter().zip(&x).map(|(y, x)| y * x).sum::<f64>();
            let steepest = (0..r).max_by(|&i, &j| y[i].abs().total_cmp(&y[j].abs())).unwrap_or(0);
            if y[steepest].abs() <= slope {
                break;
            }
            x.fill(0.0);
            x[steepest] = 1.0;
        }
        let last = (r - 1).max(1) as f64;
        let mut guess: Vec<f64> =
            (0..r).map(|i| if i % 2 == 0 { 1.0 + i as f64 / last } else { -1.0 - i as f64 / last }).collect();
        self.back(&mut guess);
        finite(best.max(2.0 * sum(&guess) / (3.0 * r as f64)))
    }
}

fn sum(x: &[f64]) -> f64 {
    finite(x.iter().map(|v| v.abs()).sum())
}

/// Replaces NaN by infinity: a NaN means that the sums overflowed.
fn finite(x: f64) -> f64 {
    if x.is_nan() { f64::INFINITY } else { x }
}
