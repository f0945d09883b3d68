//! Solutions from a [`Factor`]: basic, transposed, complete and seminormal.
//!
//! ```text
//! basic        x = P [R1^{-1} z; 0]            z: the first rows of Q^T b, as many as the rank
//! transposed   x = Q [R1^{-T} c; 0]            c: the right-hand sides of the independent rows of A^T
//! complete     [R1 R2]^T P2 = Q2 [R3; 0]       a second factorization, for shortest x
//! seminormal   R1^T R1 y = (P^T A^T r)_1       y: the correction of x on the independent columns; r: the residual
//! ```

use rayon::prelude::*;

use super::{all_finite, each, same_shape};
use crate::factor::columns_of;
use crate::{Error, Factor, Index, Matrix, Options, Symbolic, Tolerance};

impl Factor {
    /// Basic solutions that minimise `|A x - b|` for the B passed to the factorization, n x k by columns.
    ///
    /// # Errors
    /// [`Error::Overflow`] if they exceed the floating-point range.
    pub fn basic(&self) -> Result<Vec<f64>, Error> {
        self.spread(&self.rhs, self.rank(), self.rest.len())
    }

    /// Basic solutions that minimise `|A x - b|` for other right-hand sides, m x k by columns.
    ///
    /// # Errors
    /// [`Error::NoQ`] if Q was not kept, [`Error::Length`], [`Error::Overflow`] (also if a number of `b` is not finite).
    ///
    /// ```
    /// use qless_qr::{Matrix, Options};
    /// let a = Matrix::by_columns(3, 1, &[0, 3], &[0_u32, 1, 2], &[1.0, 1.0, 1.0])?;
    /// let factor = a.analyse()?.factor(a.values(), &[], Options::new().keep_q(true))?;
    /// for b in [[1.0, 2.0, 6.0], [0.0, 0.0, 3.0]] {
    ///     assert!((factor.solve(&b)?[0] - b.iter().sum::<f64>() / 3.0).abs() < 1e-14);
    /// }
    /// # Ok::<(), qless_qr::Error>(())
    /// ```
    pub fn solve(&self, b: &[f64]) -> Result<Vec<f64>, Error> {
        let count = columns_of(b.len(), self.rows)?;
        let mut z = b.to_vec();
        self.q()?.apply_transposed(&mut z);
        self.spread(&z, self.rows, count)
    }

    /// The shortest x that satisfies the independent rows of `A^T x = c`, for k right-hand sides of length n by columns.
    ///
    /// # Errors
    /// As [`Self::solve`].
    ///
    /// ```
    /// use qless_qr::{Matrix, Options};
    /// let at = Matrix::by_columns(2, 1, &[0, 2], &[0_u32, 1], &[3.0, 4.0])?;
    /// let factor = at.analyse()?.factor(at.values(), &[], Options::new().keep_q(true))?;
    /// let x = factor.solve_transposed(&[25.0])?;
    /// assert!((x[0] - 3.0).abs() < 1e-14 && (x[1] - 4.0).abs() < 1e-14);
    /// # Ok::<(), qless_qr::Error>(())
    /// ```
    pub fn solve_transposed(&self, c: &[f64]) -> Result<Vec<f64>, Error> {
        let (count, q) = (columns_of(c.len(), self.cols())?, self.q()?);
        let (m, n, r) = (self.rows, self.cols(), self.rank());
        let mut x = vec![0.0; m * count];
        for (at, x) in x.chunks_exact_mut(m.max(1)).enumerate() {
            let c = &c[at * n..(at + 1) * n];
            x[..r].iter_mut().zip(&self.order).for_each(|(x, &j)| *x = c[j]);
            self.forward(&mut x[..r]);
        }
        q.apply(&mut x);
        all_finite(x)
    }

    /// The basic solutions `P [R1^{-1} z; 0]` from the factors `A P = Q [R1 R2; 0 0]`; z is the first r of every `stride` numbers.
    pub(super) fn spread(&self, z: &[f64], stride: usize, count: usize) -> Result<Vec<f64>, Error> {
        let (n, r) = (self.cols(), self.rank());
        let mut x = vec![0.0; n * count];
        let one = |(at, x): (usize, &mut [f64])| {
            let mut head = z[at * stride..at * stride + r].to_vec();
            self.back(&mut head);
            self.order.iter().zip(head).for_each(|(&j, v)| x[j] = v);
        };
        if count > 1 {
            x.par_chunks_exact_mut(n.max(1)).enumerate().for_each(one);
        } else {
            x.chunks_exact_mut(n.max(1)).enumerate().for_each(one);
        }
        all_finite(x)
    }
}

/// A complete orthogonal factorization, `A P = Q [P2 R3^T 0; 0 0] Q2^T`, which borrows the first factor.
#[derive(Clone, Debug)]
pub struct CompleteFactor<'a> {
    outer: &'a Factor,
    /// Factor of `[R1 R2]^T`, n x r, with Q.
    inner: Factor,
}

impl Factor {
    /// Factors `[R1 R2]^T`, for the shortest solutions of rank-deficient systems. Allocates at most `memory` bytes.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`], [`Error::Overflow`], [`Error::TooLarge`] or [`Error::Ordering`].
    ///
    /// ```
    /// use qless_qr::{Matrix, Options};
    /// let a = Matrix::by_rows(2, 2, &[0, 2, 4], &[0_u32, 1, 0, 1], &[1.0, 1.0, 1.0, 1.0])?;
    /// let factor = a.analyse()?.factor(a.values(), &[2.0, 4.0], Options::new())?;
    /// assert_eq!(factor.rank(), 1);
    /// let x = factor.complete(usize::MAX)?.minimum_norm()?;
    /// assert!((x[0] - 1.5).abs() < 1e-14 && (x[1] - 1.5).abs() < 1e-14);
    /// # Ok::<(), qless_qr::Error>(())
    /// ```
    pub fn complete(&self, memory: usize) -> Result<CompleteFactor<'_>, Error> {
        // The rows of R are the columns of its transpose.
        let symbolic = Symbolic::analyse(self.cols(), self.rank(), &self.r.start, &self.r.col)?;
        let options = Options::new().tolerance(Tolerance::Absolute(0.0)).memory(memory).keep_q(true);
        Ok(CompleteFactor { outer: self, inner: symbolic.factor(&self.r.val, &[], options)? })
    }
}

impl CompleteFactor<'_> {
    /// The shortest x that minimise `|A x - b|` for the B passed to the factorization, n x k by columns.
    ///
    /// # Errors
    /// [`Error::Overflow`] if they exceed the floating-point range.
    pub fn minimum_norm(&self) -> Result<Vec<f64>, Error> {
        self.shortest(&self.outer.rhs, self.outer.rank(), self.outer.rest.len())
    }

    /// The shortest x that minimise `|A x - b|` for other right-hand sides, m x k by columns.
    ///
    /// # Errors
    /// [`Error::NoQ`] if Q was not kept, [`Error::Length`], [`Error::Overflow`].
    pub fn solve(&self, b: &[f64]) -> Result<Vec<f64>, Error> {
        let count = columns_of(b.len(), self.outer.rows)?;
        let mut z = b.to_vec();
        self.outer.q()?.apply_transposed(&mut z);
        self.shortest(&z, self.outer.rows, count)
    }

    /// The shortest x that minimise `|A^T x - c|`, m x k by columns, for k right-hand sides of length n.
    ///
    /// # Errors
    /// As [`Self::solve`].
    pub fn solve_transposed(&self, c: &[f64]) -> Result<Vec<f64>, Error> {
        let (m, n, r) = (self.outer.rows, self.outer.cols(), self.outer.rank());
        let (count, q) = (columns_of(c.len(), n)?, self.outer.q()?);
        let permuted: Vec<f64> = (0..count).flat_map(|k| self.outer.order.iter().map(move |&j| c[k * n + j])).collect();
        let y = self.inner.solve(&permuted)?;
        let mut x = vec![0.0; m * count];
        for (k, x) in x.chunks_exact_mut(m.max(1)).enumerate() {
            x[..r].copy_from_slice(&y[k * r..(k + 1) * r]);
        }
        q.apply(&mut x);
        all_finite(x)
    }

    /// `P y` for the shortest y with `[R1 R2] y = z`; z is the first r of every `stride` numbers.
    fn shortest(&self, z: &[f64], stride: usize, count: usize) -> Result<Vec<f64>, Error> {
        let (n, r) = (self.outer.cols(), self.outer.rank());
        let heads: Vec<f64> = (0..count).flat_map(|k| &z[k * stride..k * stride + r]).copied().collect();
        if r == 0 {
            return Ok(vec![0.0; n * count]);
        }
        let y = self.inner.solve_transposed(&heads)?;
        let mut x = vec![0.0; n * count];
        for (x, y) in x.chunks_exact_mut(n).zip(y.chunks_exact(n)) {
            self.outer.order.iter().zip(y).for_each(|(&j, &v)| x[j] = v);
        }
        Ok(x)
    }
}

impl Factor {
    /// Basic solutions that minimise `|A x - b|` without Q, n x k by columns (Björck 1987): for right-hand sides that come
    /// after the factorization if Q does not fit in memory.
    ///
    /// `a` must be the factored matrix. Without corrections the error is that of the normal equations. One correction
    /// gives about the accuracy of Q if the squared condition number is below 1e16; beyond, use more corrections.
    ///
    /// # Errors
    /// [`Error::Length`] if the shapes do not fit, [`Error::Overflow`] (also if a number of `b` is not finite).
    ///
    /// ```
    /// use qless_qr::{Matrix, Options};
    /// let a = Matrix::by_columns(3, 1, &[0, 3], &[0_u32, 1, 2], &[1.0, 1.0, 1.0])?;
    /// let factor = a.analyse()?.factor(a.values(), &[], Options::new())?;
    /// assert!((factor.solve_seminormal(&a, &[1.0, 2.0, 6.0], 1)?[0] - 3.0).abs() < 1e-14);
    /// # Ok::<(), qless_qr::Error>(())
    /// ```
    pub fn solve_seminormal<P: Index, I: Index>(
        &self,
        a: &Matrix<P, I>,
        b: &[f64],
        corrections: usize,
    ) -> Result<Vec<f64>, Error> {
        same_shape(a, self)?;
        let count = columns_of(b.len(), self.rows)?;
        let mut all = vec![0.0; self.cols() * count];
        for (x, b) in all.chunks_exact_mut(self.cols().max(1)).zip(each(b, self.rows)) {
            for _ in 0..=corrections {
                let (mut residual, mut normal) = (b.to_vec(), vec![0.0; self.cols()]);
                a.add_product(-1.0, x, &mut residual);
                a.transposed().add_product(1.0, &residual, &mut normal);
                let mut step: Vec<f64> = self.order[..self.rank()].iter().map(|&j| normal[j]).collect();
                self.forward(&mut step);
                self.back(&mut step);
                self.order.iter().zip(step).for_each(|(&j, v)| x[j] += v);
            }
        }
        all_finite(all)
    }
}
