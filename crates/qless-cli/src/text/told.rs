//! What the text says of equations, whoever analysed them.

use std::path::Path;

use qless::{CertificateTerm, ConstraintSystem, Kind, Tolerance};

use super::combination::is_prescribed;
use crate::deck_input::DeckInput;

/// What is known of single equations; rows count from 0.
pub trait Equations {
    /// `row 5` if it has no name.
    fn label(&self, row: usize) -> String;

    fn facts(&self, row: usize) -> Facts;
}

/// Of one equation.
#[derive(Clone, Copy)]
pub struct Facts {
    pub rhs: f64,
    /// Its largest coefficient, without sign.
    pub largest: f64,
    /// DOFs in it.
    pub dofs: usize,
    /// Those of them that are prescribed.
    pub prescribed: usize,
}

/// A redundant or conflicting equation.
#[derive(Clone, Copy)]
pub struct Finding {
    pub row: usize,
    pub kind: Kind,
    pub mismatch: f64,
    pub relative_mismatch: f64,
    pub dropped: f64,
}

/// A model and what was found in it.
pub struct Told<'a> {
    pub input: &'a Path,
    pub deck: Option<&'a DeckInput>,
    pub tolerance: Tolerance,
    pub equations: &'a dyn Equations,
    pub dependent: Vec<Finding>,
    pub because: &'a dyn Fn(usize) -> Vec<CertificateTerm>,
}

impl Equations for ConstraintSystem {
    fn label(&self, row: usize) -> String {
        self.equation_label(row)
    }

    fn facts(&self, row: usize) -> Facts {
        let entries = self.matrix().row(row);
        Facts {
            rhs: self.rhs()[row],
            largest: entries.clone().fold(0.0, |size: f64, (_, v)| size.max(v.abs())),
            dofs: entries.len(),
            prescribed: entries.filter(|&(j, _)| is_prescribed(self, j)).count(),
        }
    }
}

impl From<&qless::Dependent> for Finding {
    fn from(found: &qless::Dependent) -> Self {
        let &qless::Dependent { row, kind, mismatch, relative_mismatch, dropped, .. } = found;
        Self { row, kind, mismatch, relative_mismatch, dropped }
    }
}
