//! How equations and DOFs are called: by their row from 1 and their label, where they have one.

use super::fit::{printable, shorten};
use super::told::Equations;

/// Columns of a label at most.
const LABEL: usize = 30;

/// `row 14 "tie B/C, y"`, or `row 14` without a label.
pub fn equation(equations: &dyn Equations, row: usize) -> String {
    let number = format!("row {}", row + 1);
    let label = equations.label(row);
    if label == number { number } else { format!("{number} \"{}\"", shorten(&printable(&label), LABEL)) }
}

/// A label that is printable and not too long.
pub fn label(text: &str) -> String {
    shorten(&printable(text), LABEL)
}

/// `1 equation`, `2 equations`.
pub fn count(n: usize, what: &str) -> String {
    if n == 1 { format!("1 {what}") } else { format!("{n} {what}s") }
}
