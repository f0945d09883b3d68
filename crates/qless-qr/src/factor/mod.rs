//! `Q^T A P = [R1 R2; 0 0]` and `Q^T B`: what a factorization returns.

mod condition;
mod rows;
mod triangle;

pub use rows::Rows;

use crate::Error;
use crate::q::Q;

/// A rank-revealing factorization `A P = Q [R1 R2; 0 0]` of an m x n matrix, with `Q^T B` and, on request, with Q.
///
/// How to solve with it: [`basic`](Self::basic) for the B that was transformed, [`solve`](Self::solve) and
/// [`solve_transposed`](Self::solve_transposed) for others with Q kept, [`solve_seminormal`](Self::solve_seminormal)
/// without; [`complete`](Self::complete) for the shortest solutions where the rank is not full.
#[derive(Clone, Debug, PartialEq)]
pub struct Factor {
    pub(crate) rows: usize,
    pub(crate) order: Vec<usize>,
    pub(crate) r: Rows,
    pub(crate) rhs: Vec<f64>,
    pub(crate) rest: Vec<f64>,
    pub(crate) dropped: f64,
    pub(crate) tolerance: f64,
    pub(crate) q: Option<Q>,
}

/// What a [`Factor`] owns, for programs that go on with it.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Parts {
    /// [`Factor::order`].
    pub order: Vec<usize>,
    /// [`Factor::r`].
    pub r: Rows,
    /// [`Factor::rhs`].
    pub rhs: Vec<f64>,
    /// [`Factor::rest`].
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

    /// P: `order[k]` is the column of A at position k; the r independent ones stand first.
    pub fn order(&self) -> &[usize] {
        &self.order
    }

    /// `[R1 R2]`, r x n; the first entry of row i is in column i.
    pub fn r(&self) -> &Rows {
        &self.r
    }

    /// First r rows of `Q^T B`, r x k by columns.
    pub fn rhs(&self) -> &[f64] {
        &self.rhs
    }

    /// 2-norms of the other rows of `Q^T B`, one for each right-hand side: what no x takes away from `|A x - b|`.
    pub fn rest(&self) -> &[f64] {
        &self.rest
    }

    /// Frobenius norm of what was treated as zero.
    pub fn dropped(&self) -> f64 {
        self.dropped
    }

    /// What a remaining part must exceed in 2-norm for its column to be independent.
    pub fn tolerance(&self) -> f64 {
        self.tolerance
    }

    /// The owned parts; Q is dropped.
    pub fn into_parts(self) -> Parts {
        let Self { order, r, rhs, rest, .. } = self;
        Parts { order, r, rhs, rest }
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

    /// `B <- Q^T B` for vectors of length m, one after the other: r numbers that R meets, then the others.
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

/// How many vectors of so many numbers there are; nothing counts as one vector of length 0.
pub(crate) fn columns_of(found: usize, expected: usize) -> Result<usize, Error> {
    let count = found.checked_div(expected).unwrap_or(1);
    if count * expected == found { Ok(count) } else { Err(Error::Length { what: "b", found, expected }) }
}
