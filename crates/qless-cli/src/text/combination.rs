//! `row 14 = 1 * row 3 - 2 * row 9`: why an equation is dependent.

use qless::{Because, ConstraintSystem};

use super::COLUMNS;
use super::fit::flow;
use super::name;
use super::number::number;

/// Columns of `+ ... and 1000000 more` at most.
const TAIL: usize = 26;

/// The equation and its certificate in one or two lines.
pub fn lines(system: &ConstraintSystem, row: usize, because: &[Because]) -> Vec<String> {
    let head = format!("  {}", name::equation(system, row));
    if because.is_empty() {
        return vec![format!("{head} {}", alone(system, row))];
    }
    let shown = because.iter().take(20).enumerate();
    let pieces: Vec<String> = shown.map(|(k, term)| piece(system, term, k == 0)).collect();
    // A piece that is never shown keeps the reserve for the tail when there are more terms than pieces.
    let flowed = flow(&head, "      ", &pieces, (2, COLUMNS), TAIL);
    match because.len() - flowed.used {
        0 => flowed.lines,
        more => flowed.finish(&format!(" + ... and {more} more")),
    }
}

/// ` + 2 * row 3 "tie A/B"`.
fn piece(system: &ConstraintSystem, term: &Because, is_first: bool) -> String {
    let equation = name::equation(system, term.row);
    let sign = match (is_first, term.coefficient < 0.0) {
        (true, _) => return format!(" = {} * {equation}", number(term.coefficient)),
        (false, true) => "-",
        (false, false) => "+",
    };
    format!(" {sign} {} * {equation}", number(term.coefficient.abs()))
}

/// What is to be said of an equation that needs no others to be dependent.
fn alone(system: &ConstraintSystem, row: usize) -> &'static str {
    match system.matrix().row(row).len() {
        0 => "has no coefficients: 0 = b",
        _ => "holds no free DOF: all of its DOFs are prescribed",
    }
}
