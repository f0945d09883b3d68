//! Iterative refinement, `[I A; A^T 0] [dr; dx] = [b - r - A x; -A^T r]` (Björck 1967).
//!
//! Residuals are computed with twice the digits, corrections with Q and R.

use super::{all_finite, each, same_shape};
use crate::factor::columns_of;
use crate::{Error, Factor, Index, Matrix};

impl Factor {
    /// Refines basic solutions that minimise `|A x - b|`, n x k by columns, with the given number of steps. Needs Q.
    ///
    /// `a` must be the factored matrix. Two or three steps give all digits of x unless the condition number is near 1e16.
    /// The unknowns of dependent columns stay zero.
    ///
    /// # Errors
    /// [`Error::NoQ`], [`Error::Length`] if the shapes do not fit, [`Error::Overflow`]; after an error `x` is unchanged.
    ///
    /// ```
    /// use qless_qr::{Matrix, Options};
    /// let a = Matrix::by_columns(3, 1, &[0, 3], &[0_u32, 1, 2], &[1.0, 1.0, 1.0])?;
    /// let b = [1.0, 2.0, 6.0];
    /// let factor = a.analyse()?.factor(a.values(), &b, Options::new().keep_q(true))?;
    /// let mut x = factor.basic()?;
    /// factor.refine(&a, &b, &mut x, 1)?;
    /// assert_eq!(x, [3.0]);
    /// # Ok::<(), qless_qr::Error>(())
    /// ```
    pub fn refine<P: Index, I: Index>(
        &self,
        a: &Matrix<P, I>,
        b: &[f64],
        x: &mut [f64],
        steps: usize,
    ) -> Result<(), Error> {
        same_shape(a, self)?;
        let expected = columns_of(b.len(), self.rows)? * self.cols();
        if x.len() != expected {
            return Err(Error::Length { what: "x", found: x.len(), expected });
        }
        if steps == 0 {
            return Ok(());
        }
        self.q()?;
        let mut refined = x.to_vec();
        for (x, b) in refined.chunks_exact_mut(self.cols().max(1)).zip(each(b, self.rows)) {
            let mut r = a.exact_residual(b, None, x);
            for _ in 0..steps {
                self.step(a, b, &mut r, x)?;
            }
        }
        x.copy_from_slice(&all_finite(refined)?);
        Ok(())
    }

    fn step<P: Index, I: Index>(&self, a: &Matrix<P, I>, b: &[f64], r: &mut [f64], x: &mut [f64]) -> Result<(), Error> {
        let rank = self.rank();
        let mut f = a.exact_residual(b, Some(r), x);
        let g = a.transposed().exact_residual(&vec![0.0; self.cols()], None, r);
        let mut h: Vec<f64> = self.order[..rank].iter().map(|&j| g[j]).collect();
        self.forward(&mut h);
        self.q()?.apply_transposed(&mut f);
        let mut dx: Vec<f64> = f.iter().zip(&h).map(|(d, h)| d - h).collect();
        self.back(&mut dx);
        f[..rank].copy_from_slice(&h);
        self.q()?.apply(&mut f);
        r.iter_mut().zip(&f).for_each(|(r, dr)| *r += dr);
        self.order.iter().zip(&dx).for_each(|(&j, dx)| x[j] += dx);
        Ok(())
    }
}

/// Repeats `x <- x + solve(b - A x)`; `solve` must be linear in b.
pub(super) fn refine_by<P: Index, I: Index>(
    a: &Matrix<P, I>,
    b: &[f64],
    x: &mut [f64],
    steps: usize,
    solve: impl Fn(&[f64]) -> Result<Vec<f64>, Error>,
) -> Result<(), Error> {
    let count = columns_of(b.len(), a.rows())?;
    for _ in 0..steps {
        let pairs = each(b, a.rows()).zip(each(x, a.cols())).take(count);
        let residual: Vec<f64> = pairs.flat_map(|(b, x)| a.exact_residual(b, None, x)).collect();
        x.iter_mut().zip(solve(&residual)?).for_each(|(x, step)| *x += step);
    }
    Ok(())
}
