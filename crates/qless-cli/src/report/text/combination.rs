//! Certificates as text: `row 14 = 1 * row 3 - 2 * row 9`.

use qless::CertificateTerm;

use super::COLUMNS;
use crate::wording;
use crate::wording::layout::{Flow, flow};
use crate::wording::number;
use crate::wording::{EquationFacts, EquationLookup};

/// Columns reserved for `+ ... and 1000000 more`.
const TAIL: usize = 26;

/// The equation and its certificate in one or two lines.
pub fn lines(equations: &dyn EquationLookup, row: usize, because: &[CertificateTerm]) -> Vec<String> {
    let head = format!("  {}", wording::equation(equations, row));
    if because.is_empty() {
        return vec![format!("{head} {}", CombinationAlone::classify(equations, row).one())];
    }
    let flowed = fill(equations, &head, because);
    if flowed.used == because.len() {
        return flowed.lines;
    }
    // Not all terms fit: show the largest.
    let flowed = fill(equations, &head, &largest(equations, because));
    let more = because.len() - flowed.used;
    flowed.finish(&format!(" + ... and {more} more"))
}

fn fill(equations: &dyn EquationLookup, head: &str, because: &[CertificateTerm]) -> Flow {
    // Two lines never hold more terms.
    let shown = because.iter().take(20).enumerate();
    let pieces: Vec<String> = shown.map(|(k, term)| piece(equations, term, k == 0)).collect();
    flow(head, "      ", &pieces, (2, COLUMNS), TAIL)
}

/// The terms in descending order of their size; terms of the same size in their order.
fn largest(equations: &dyn EquationLookup, because: &[CertificateTerm]) -> Vec<CertificateTerm> {
    let size = |term: &CertificateTerm| term.coefficient.abs() * equations.facts(term.row).largest;
    let mut terms: Vec<_> = because.iter().map(|term| (size(term), *term)).collect();
    terms.sort_by(|a, b| b.0.total_cmp(&a.0));
    terms.into_iter().map(|(_, term)| term).collect()
}

/// ` + 2 * row 3 "tie A/B"`.
fn piece(equations: &dyn EquationLookup, term: &CertificateTerm, is_first: bool) -> String {
    let equation = wording::equation(equations, term.row);
    let sign = match (is_first, term.coefficient < 0.0) {
        (true, _) => return format!(" = {} * {equation}", number(term.coefficient)),
        (false, true) => "-",
        (false, false) => "+",
    };
    format!(" {sign} {} * {equation}", number(term.coefficient.abs()))
}

/// Whether an equation is dependent without any other equation, and why.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum CombinationAlone {
    /// It has no coefficients.
    Empty,
    /// All of its DOFs are prescribed.
    Prescribed,
    /// It has free DOFs, and depends on other equations.
    No,
}

impl CombinationAlone {
    pub fn classify(equations: &dyn EquationLookup, row: usize) -> Self {
        let EquationFacts { dofs, prescribed, .. } = equations.facts(row);
        match dofs {
            0 => Self::Empty,
            _ if dofs == prescribed => Self::Prescribed,
            _ => Self::No,
        }
    }

    /// The predicate for one such equation.
    pub fn one(self) -> &'static str {
        if self == Self::Empty { "has no coefficients" } else { "has no free DOF: all are prescribed" }
    }

    /// The name of several such equations.
    pub fn several(self) -> &'static str {
        if self == Self::Empty { "rows without coefficients" } else { "rows whose DOFs are all prescribed" }
    }
}
