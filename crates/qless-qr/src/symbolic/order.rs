//! Column order with little fill in R: COLAMD of S or AMD of `S^T S`, both from faer, where S is A without its peeled rows and columns.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::{amd, colamd};

use crate::Error;
use crate::lists::Lists;

/// Column order by COLAMD of S, the matrix without peeled rows and columns: the column at each position.
pub(super) fn colamd(rows: usize, columns: &Lists) -> Result<Vec<u32>, Error> {
    let n = columns.len();
    if rows == 0 || columns.index.is_empty() {
        return Ok((0..n as u32).collect());
    }
    let start = narrow(&columns.start);
    let pattern = SymbolicSparseColMatRef::new_checked(rows, n, &start, None, &columns.index);
    let mut memory = MemBuffer::new(colamd::order_scratch::<u32>(rows, n, columns.index.len()));
    let control = colamd::Control { dense_row: 10.0, dense_col: 10.0, aggressive: true };
    let (mut order, mut inverse) = (vec![0; n], vec![0; n]);
    colamd::order(&mut order, &mut inverse, pattern, control, MemStack::new(&mut memory)).map_err(failed)?;
    Ok(order)
}

/// Column order by AMD of `S^T S`, where S is the matrix without peeled rows and columns; `None` if the strictly lower part of `S^T S` has
/// more than `most` entries.
pub(super) fn amd(columns: &Lists, rows: &Lists, most: usize) -> Result<Option<Vec<u32>>, Error> {
    let Some(product) = product(columns, rows, most) else { return Ok(None) };
    let n = columns.len();
    if n == 0 {
        return Ok(Some(Vec::new()));
    }
    let start = narrow(&product.start);
    let pattern = SymbolicSparseColMatRef::new_checked(n, n, &start, None, &product.index);
    let mut memory = MemBuffer::new(amd::order_scratch::<u32>(n, product.index.len()));
    let (mut order, mut inverse) = (vec![0; n], vec![0; n]);
    let stack = MemStack::new(&mut memory);
    amd::order(&mut order, &mut inverse, pattern, amd::Control::default(), stack).map_err(failed)?;
    Ok(Some(order))
}

/// The strictly lower part of `S^T S` by columns, for the matrix S with these columns and rows; the transposition sorts the rows.
fn product(columns: &Lists, rows: &Lists, most: usize) -> Option<Lists> {
    let mut upper = Lists::new();
    let mut seen = vec![u32::MAX; columns.len()];
    for j in 0..columns.len() {
        for &row in columns.list(j) {
            for &i in rows.list(row as usize).iter().take_while(|&&i| (i as usize) < j) {
                if seen[i as usize] != j as u32 {
                    seen[i as usize] = j as u32;
                    upper.index.push(i);
                }
            }
        }
        upper.close();
        if upper.index.len() > most {
            return None;
        }
    }
    Some(upper.transposed(columns.len()))
}

fn narrow(start: &[usize]) -> Vec<u32> {
    start.iter().map(|&at| at as u32).collect()
}

fn failed(error: impl std::fmt::Debug) -> Error {
    Error::Ordering(format!("{error:?}"))
}
