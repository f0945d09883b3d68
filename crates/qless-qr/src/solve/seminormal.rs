//! `R1^T R1 y = (P^T A^T r)_1`: least squares with R and A alone, corrected (Björck 1987).

use super::{all_finite, each, same_shape};
use crate::factor::columns_of;
use crate::{Error, Factor, Index, Matrix};

impl Factor {
    /// Basic solutions of least `|A x - b|` without Q, n x k by columns: for right-hand sides that come after the
    /// factorization where Q would not fit in memory.
    ///
    /// `a` must be the matrix that was factored. The error is that of normal equations without corrections, and about
    /// that of Q with one of them, as long as the condition number squared times 1e-16 is below 1 or so; more
    /// corrections help beyond.
    ///
    /// # Errors
    /// [`Error::Length`] if the shapes do not fit, [`Error::Overflow`] (a number of `b` that is not finite, too).
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
                let (mut left, mut normal) = (b.to_vec(), vec![0.0; self.cols()]);
                a.add_product(-1.0, x, &mut left);
                a.transposed().add_product(1.0, &left, &mut normal);
                let mut step: Vec<f64> = self.order[..self.rank()].iter().map(|&j| normal[j]).collect();
                self.forward(&mut step);
                self.back(&mut step);
                self.order.iter().zip(step).for_each(|(&j, v)| x[j] += v);
            }
        }
        all_finite(all)
    }
}
