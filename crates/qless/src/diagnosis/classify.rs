//! Redundant or conflicting: `b_k - sum c_i b_i`, prescribed DOFs moved into b (Eq. 27, 28).

use crate::diagnosis::certificate::{CertificateTerm, History};
use crate::input::scale::Scaling;
use crate::presolve::basis::Diagnosed;
use crate::presolve::eliminated::Eliminated;
pub(crate) use crate::presolve::eliminated::Mismatch;
use crate::presolve::rows::MORE_THAN_ROUNDING;

/// What an equation is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
pub enum Kind {
    /// No combination of the others that were kept.
    Independent,
    /// A combination of kept equations, and consistent with them.
    Redundant,
    /// A combination of kept equations whose right-hand side contradicts them.
    Conflicting,
}

/// A redundant or conflicting equation.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Dependent {
    /// The equation, 0-based.
    pub row: usize,
    /// Redundant or conflicting.
    pub kind: Kind,
    /// `b_k - sum c_i b_i` in the units of the equation, prescribed DOFs moved into b.
    pub mismatch: f64,
    /// The mismatch relative to the largest part that went into it; 0 if it is no more than rounding.
    pub relative_mismatch: f64,
    /// What was dropped to call the equation dependent, relative to its size; 0 if it is no more than rounding.
    pub dropped: f64,
    /// The mismatch with its size and error, in the units of the equation.
    pub(crate) rest: Mismatch,
    pub(crate) source: Source,
}

/// Where the certificate of a dependent equation comes from.
#[derive(Clone, Debug)]
pub(crate) enum Source {
    /// Index of the row among those that went through elimination, its certificate over rows of its block, and by how many units in
    /// the last place of the largest of them its coefficients may be off.
    Traced(u32, Vec<(u32, f64)>, f64),
    /// The certificate itself.
    Given(Vec<CertificateTerm>),
}

impl Source {
    pub fn explain(&self, history: &History) -> Vec<CertificateTerm> {
        match self {
            Self::Traced(row, because, _) => history.certificate(*row, because),
            Self::Given(because) => because.clone(),
        }
    }
}

impl Dependent {
    /// Redundant unless the mismatch is more than `tolerance` of its parts and more than rounding.
    pub(crate) fn new(row: usize, rest: Mismatch, dropped: f64, source: Source, tolerance: f64) -> Self {
        let Mismatch { value, size, error } = rest;
        let conflicting = value.abs() > (tolerance * size).max(MORE_THAN_ROUNDING * error);
        Self {
            row,
            kind: if conflicting { Kind::Conflicting } else { Kind::Redundant },
            mismatch: value,
            relative_mismatch: if value.abs() > MORE_THAN_ROUNDING * error { value.abs() / size } else { 0.0 },
            dropped,
            rest,
            source,
        }
    }
}

/// Redundant or conflicting, for every dependent row.
pub(crate) fn classify(
    eliminated: &Eliminated,
    diagnosed: &[Diagnosed],
    scaling: &Scaling,
    tolerance: f64,
) -> Vec<Dependent> {
    let make = |source: u32, mismatch: Mismatch, dropped: f64, (because, units): (Vec<(u32, f64)>, f64)| {
        let row = eliminated.names[source as usize] as usize;
        let rest = mismatch.scaled(-scaling.row[row]);
        Dependent::new(row, rest, dropped, Source::Traced(source, because, units), tolerance)
    };
    let dead = eliminated.dead.iter().map(|d| make(d.row, d.mismatch, d.dropped, (Vec::new(), 0.0)));
    let dependent = diagnosed.iter().flat_map(|block| &block.dependent);
    let of_blocks = dependent.map(|d| make(d.row, d.mismatch, d.dropped, (d.because.clone(), d.units)));
    let mut all: Vec<_> = dead.chain(of_blocks).collect();
    all.sort_unstable_by_key(|d| d.row);
    all
}
