//! The analysis: peel singleton columns, order the rest, find the fronts.

use super::singletons::{UnpeeledMatrix, peel};
use super::{Symbolic, order};
use crate::lists::Lists;
use crate::{Error, Index, Matrix};

impl Symbolic {
    /// Analyses the pattern of an m x n matrix, given by columns: column j has entries in the rows
    /// `index[start[j]..start[j + 1]]`, ascending without duplicates.
    ///
    /// # Errors
    /// [`Error::Length`], [`Error::Pattern`] or [`Error::TooLarge`] if the arrays are not such a pattern.
    pub fn analyse(rows: usize, cols: usize, start: &[usize], index: &[u32]) -> Result<Self, Error> {
        let columns = crate::lists::checked(rows, cols, start, index)?;
        analyse(rows, &columns, &|_| true)
    }
}

impl<P: Index, I: Index> Matrix<'_, P, I> {
    /// Analyses the pattern. [`Symbolic::factor`] then expects values in the order of this matrix.
    ///
    /// # Errors
    /// [`Error::TooLarge`] or [`Error::Ordering`].
    pub fn analyse(&self) -> Result<Symbolic, Error> {
        crate::lists::countable(self.rows(), self.cols(), self.values().len())?;
        let (columns, gather) = self.by_ascending_columns();
        let symbolic = analyse(self.rows(), &columns, &|_| true)?;
        Ok(Symbolic { gather, ..symbolic })
    }
}

/// AMD is tried first if the strictly lower part of `S^T S` has at most this many times the entries of S, the matrix without peeled rows
/// and columns: then AMD is faster than COLAMD.
const PRODUCT: usize = 5;
/// COLAMD is tried too if the order of AMD needs more than this many operations for each entry of the matrix without peeled rows and
/// columns.
const WORTH: f64 = 2e4;

/// Analyses the pattern. A column is peeled only if `may` accepts its remaining entry.
pub(crate) fn analyse(row_count: usize, columns: &Lists, may: &dyn Fn(usize) -> bool) -> Result<Symbolic, Error> {
    let rows = columns.transposed(row_count);
    let peeled = peel(columns, &rows, may);
    let rest = UnpeeledMatrix::new(columns, &rows, &peeled);
    let with = |order: Vec<u32>| rest.symbolic(columns, row_count, &peeled, &order);
    let by_rows = rest.columns.transposed(rest.rows);
    let Some(order) = order::amd(&rest.columns, &by_rows, PRODUCT * rest.columns.index.len())? else {
        return order::colamd(rest.rows, &rest.columns).map(with);
    };
    let first = with(order);
    if first.flops() <= WORTH * rest.columns.index.len() as f64 {
        return Ok(first);
    }
    let second = with(order::colamd(rest.rows, &rest.columns)?);
    Ok(if second.flops() < first.flops() { second } else { first })
}
