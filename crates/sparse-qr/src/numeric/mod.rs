//! Values -> R and `Q^T B`, front by front.

mod contribution;
mod front;
mod ledger;
mod result;
mod tasks;
#[cfg(test)]
mod tests;

pub(crate) use crate::dense::PANEL;

use crate::dense::scaled_norm;
use crate::symbolic::Symbolic;
use crate::{Error, Factor};
use ledger::Ledger;

/// The numbers of one factorization.
#[derive(Clone, Copy)]
pub(crate) struct Numbers<'a> {
    pub values: &'a [f64],
    /// B, m x k by columns.
    pub rhs: &'a [f64],
    pub count: usize,
    pub tolerance: f64,
}

/// Factors one matrix of the analysed pattern.
pub(crate) fn factor(
    symbolic: &Symbolic,
    values: &[f64],
    rhs: &[f64],
    tolerance: f64,
    limit: usize,
) -> Result<Factor, Error> {
    let numbers = checked(symbolic, values, rhs, tolerance)?;
    let barred = barred(symbolic, &numbers);
    if barred.iter().any(|&at| at) {
        let again = crate::analyse::analyse(symbolic.rows, &symbolic.columns(), &barred)?;
        return run(&again, &numbers, limit).map(|(factor, _)| factor);
    }
    run(symbolic, &numbers, limit).map(|(factor, _)| factor)
}

/// The factor, and the most bytes that were booked.
fn run(symbolic: &Symbolic, numbers: &Numbers, limit: usize) -> Result<(Factor, usize), Error> {
    let needed = symbolic.memory(numbers.count);
    if needed > limit {
        return Err(Error::OutOfMemory { needed, limit });
    }
    let ledger = Ledger::new(limit);
    let slots = tasks::run(symbolic, numbers, &ledger)?;
    let factor = result::collect(symbolic, numbers, slots, &ledger)?;
    Ok((factor, ledger.most()))
}

fn checked<'a>(symbolic: &Symbolic, values: &'a [f64], rhs: &'a [f64], tolerance: f64) -> Result<Numbers<'a>, Error> {
    if values.len() != symbolic.entry.len() {
        return Err(Error::Length { what: "values", found: values.len(), expected: symbolic.entry.len() });
    }
    let count = rhs.len().checked_div(symbolic.rows).unwrap_or(0);
    if count * symbolic.rows != rhs.len() {
        return Err(Error::Length { what: "rhs", found: rhs.len(), expected: symbolic.rows });
    }
    if tolerance.is_nan() || tolerance < 0.0 {
        return Err(Error::Tolerance(tolerance));
    }
    for (what, numbers) in [("the matrix", values), ("the right-hand side", rhs)] {
        if !numbers.iter().all(|v| v.is_finite()) {
            return Err(Error::NotFinite(what));
        }
    }
    Ok(Numbers { values, rhs, count, tolerance })
}

/// Columns that were peeled by the pattern but whose one number is not above the tolerance.
fn barred(symbolic: &Symbolic, numbers: &Numbers) -> Vec<bool> {
    let mut barred = vec![false; symbolic.cols];
    for i in 0..symbolic.peeled {
        let diagonal = numbers.values[symbolic.entry[symbolic.pattern.start[i]] as usize];
        barred[symbolic.order[i] as usize] = diagonal.abs() <= numbers.tolerance;
    }
    barred
}
