//! Equations that follow from others, where it is in doubt whether they do.
//!
//! ```text
//! row_i = sum c_k row_k + e        e u = (C_i u - b_i) - sum c_k (C_k u - b_k)
//! ```
//!
//! e is what the analysis took for nothing. Where it does nothing to u, whether it is nothing does not matter.

use qless::{Analysis, Kind};

use super::EnforceError;

/// What `e u` may be of the terms of the combination.
const NOTHING: f64 = 1e-9;

/// Refuses u where a redundant equation of a doubtful rank does not hold as well as those that it is said to follow from.
pub fn settled(analysis: &Analysis, kinds: &[Kind], rhs: &[f64], u: &[f64]) -> Result<(), EnforceError> {
    if !analysis.confidence().ambiguous {
        return Ok(());
    }
    let system = analysis.system();
    let gap = |row: usize| {
        let terms = system.matrix().row(row).map(|(j, v)| v * u[j]);
        terms.fold((-rhs[row], rhs[row].abs()), |(left, size), term| (left + term, size + term.abs()))
    };
    for row in (0..kinds.len()).filter(|&row| kinds[row] == Kind::Redundant) {
        let (mut left, mut size) = gap(row);
        for term in analysis.because(row)? {
            let (of_kept, size_of_kept) = gap(term.row);
            left -= term.coefficient * of_kept;
            size += (term.coefficient * size_of_kept).abs();
        }
        if left.is_nan() || left.abs() > NOTHING * size {
            return Err(EnforceError::Doubtful { row, label: system.equation_label(row), left: left.abs() / size });
        }
    }
    Ok(())
}
