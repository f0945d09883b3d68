//! `A P = Q [P2 R3^T 0; 0 0] Q2^T`: a second factorization, of `[R1 R2]^T P2 = Q2 [R3; 0]`, takes the rank out of both sides.

use super::all_finite;
use crate::factor::columns_of;
use crate::{Error, Factor, Options, Symbolic, Tolerance};

/// A complete orthogonal factorization; borrows the first one.
#[derive(Clone, Debug)]
pub struct Complete<'a> {
    outer: &'a Factor,
    /// Of `[R1 R2]^T`, n x r, Q kept.
    inner: Factor,
}

impl Factor {
    /// Factors `[R1 R2]^T`, for shortest solutions where the rank is not full. At most `memory` bytes are allocated.
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
    pub fn complete(&self, memory: usize) -> Result<Complete<'_>, Error> {
        // Rows of R are the columns of its transpose.
        let symbolic = Symbolic::analyse(self.cols(), self.rank(), &self.r.start, &self.r.col)?;
        let options = Options::new().tolerance(Tolerance::Absolute(0.0)).memory(memory).keep_q(true);
        Ok(Complete { outer: self, inner: symbolic.factor(&self.r.val, &[], options)? })
    }
}

impl Complete<'_> {
    /// The shortest x of least `|A x - b|` for the B that the factorization transformed, n x k by columns.
    ///
    /// # Errors
    /// [`Error::Overflow`] if they are beyond all numbers.
    pub fn minimum_norm(&self) -> Result<Vec<f64>, Error> {
        self.shortest(&self.outer.rhs, self.outer.rank(), self.outer.rest.len())
    }

    /// The shortest x of least `|A x - b|` for other right-hand sides, m x k by columns.
    ///
    /// # Errors
    /// [`Error::NoQ`] if Q was not kept, [`Error::Length`], [`Error::Overflow`].
    pub fn solve(&self, b: &[f64]) -> Result<Vec<f64>, Error> {
        let count = columns_of(b.len(), self.outer.rows)?;
        let mut z = b.to_vec();
        self.outer.q()?.apply_transposed(&mut z);
        self.shortest(&z, self.outer.rows, count)
    }

    /// The shortest x of least `|A^T x - c|`, m x k by columns, for c of length n; k at once.
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

    /// `P y` of the shortest y with `[R1 R2] y = z`, for the first r of every `stride` numbers.
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
