//! The data of the text report, from one process or from several ranks.

use std::path::Path;

use qless::{CertificateTerm, Kind, Tolerance};

use crate::deck_input::DeckInput;
use crate::wording::EquationLookup;

/// A redundant or conflicting equation.
#[derive(Clone, Copy)]
pub struct DependentRow {
    pub row: usize,
    pub kind: Kind,
    pub mismatch: f64,
    pub relative_mismatch: f64,
    pub dropped: f64,
}

/// A model and its dependent equations.
pub struct EquationList<'a> {
    pub input: &'a Path,
    pub deck: Option<&'a DeckInput>,
    pub tolerance: Tolerance,
    pub equations: &'a dyn EquationLookup,
    pub dependent: Vec<DependentRow>,
    pub because: &'a dyn Fn(usize) -> Vec<CertificateTerm>,
}

impl From<&qless::Dependent> for DependentRow {
    fn from(found: &qless::Dependent) -> Self {
        let &qless::Dependent { row, kind, mismatch, relative_mismatch, dropped, .. } = found;
        Self { row, kind, mismatch, relative_mismatch, dropped }
    }
}
