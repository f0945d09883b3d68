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
use crate::{Error, Factor, Options};
use ledger::Ledger;

/// The numbers of one factorization.
#[derive(Clone, Copy)]
pub(crate) struct Numbers<'a> {
    pub values: &'a [f64],
    /// B, m x k by columns.
    pub rhs: &'a [f64],
    pub count: usize,
    pub tolerance: f64,
    pub keep_q: bool,
}

/// Factors one matrix of the analysed pattern.
pub(crate) fn factor(symbolic: &Symbolic, values: &[f64], rhs: &[f64], options: Options) -> Result<Factor, Error> {
    let values = &*symbolic.gathered(values)?;
    let numbers = checked(symbolic, values, rhs, options)?;
    let (tolerance, limit) = (numbers.tolerance, options.memory);
    let is_live = |entry: usize| values[entry].abs() > tolerance;
    let diagonal = |i: usize| symbolic.entry[symbolic.pattern.start[i]] as usize;
    let result = if (0..symbolic.peeled).map(diagonal).all(is_live) {
        run(symbolic, &numbers, limit)
    } else {
        // Peeled by the pattern, but of no size: peel by the values.
        run(&crate::analyse::analyse(symbolic.rows, &symbolic.columns(), &is_live)?, &numbers, limit)
    };
    result.map(|(factor, _)| factor)
}

/// The factor, and the most bytes that were booked.
fn run(symbolic: &Symbolic, numbers: &Numbers, limit: usize) -> Result<(Factor, usize), Error> {
    let of_q = if numbers.keep_q { symbolic.memory_of_q() } else { 0 };
    let needed = symbolic.memory(numbers.count).saturating_add(of_q);
    if needed > limit {
        return Err(Error::OutOfMemory { needed, limit });
    }
    let ledger = Ledger::new(limit);
    let slots = tasks::run(symbolic, numbers, &ledger)?;
    let factor = result::collect(symbolic, numbers, slots, &ledger)?;
    Ok((factor, ledger.most()))
}

fn checked<'a>(symbolic: &Symbolic, values: &'a [f64], rhs: &'a [f64], options: Options) -> Result<Numbers<'a>, Error> {
    let count = rhs.len().checked_div(symbolic.rows).unwrap_or(0);
    if count * symbolic.rows != rhs.len() {
        return Err(Error::Length { what: "rhs", found: rhs.len(), expected: symbolic.rows });
    }
    for (what, numbers) in [("the matrix", values), ("the right-hand side", rhs)] {
        if !numbers.iter().all(|v| v.is_finite()) {
            return Err(Error::NotFinite(what));
        }
    }
    let tolerance = options.tolerance.distance(symbolic, values)?;
    Ok(Numbers { values, rhs, count, tolerance, keep_q: options.keep_q })
}
