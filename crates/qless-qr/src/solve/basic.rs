//! `x = P [R1^{-1} z; 0]` and `x = Q [R1^{-T} c; 0]`.

use rayon::prelude::*;

use super::all_finite;
use crate::factor::columns_of;
use crate::{Error, Factor};

impl Factor {
    /// The basic solutions of least `|A x - b|` for the B that the factorization transformed, n x k by columns.
    ///
    /// # Errors
    /// [`Error::Overflow`] if they are beyond all numbers.
    pub fn basic(&self) -> Result<Vec<f64>, Error> {
        self.spread(&self.rhs, self.rank(), self.rest.len())
    }

    /// The basic solutions of least `|A x - b|` for other right-hand sides, m x k by columns.
    ///
    /// # Errors
    /// [`Error::NoQ`] if Q was not kept, [`Error::Length`], [`Error::Overflow`] (a number of `b` that is not finite, too).
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

    /// The shortest x with `A^T x = c`, as far as the independent rows of `A^T` go, for c of length n; k at once.
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

    /// `P [R1^{-1} z; 0]` for the first r of every `stride` numbers.
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
