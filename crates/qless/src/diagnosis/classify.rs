//! Redundant or conflicting: `b_k - sum c_i b_i`, prescribed DOFs moved into b (Eq. 27, 28).

use std::sync::OnceLock;

use crate::Options;
use crate::diagnosis::certificate::{CertificateTerm, History};
use crate::input::noise::{Noise, is_typed, rounding_of_sides};
use crate::input::numbering::LocalSystem;
use crate::input::scale::Scaling;
use crate::presolve::basis::{BlockCertificate, Diagnosed};
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
    /// Whether the mismatch would be a conflict if it were no rounding of the largest right-hand side.
    pub(crate) is_suspect: bool,
    /// The mismatch with its size and error, in the units of the equation.
    pub(crate) rest: Mismatch,
    pub(crate) source: Source,
}

/// What makes a mismatch a conflict.
pub(crate) struct MismatchRule<'a> {
    pub tolerance: f64,
    /// Whether mismatches below the rounding of the largest right-hand side are suspect, and numbers may be rounded as typed.
    is_auto: bool,
    /// As [`rounding_of_sides`] gives it, when it is wanted.
    rounding: OnceLock<Vec<f64>>,
    pub scaling: &'a Scaling,
    pub system: LocalSystem<'a>,
}

impl<'a> MismatchRule<'a> {
    pub fn new(system: LocalSystem<'a>, scaling: &'a Scaling, options: &Options) -> Self {
        let is_auto = options.noise == Noise::Auto && !options.tolerance.is_absolute();
        Self { tolerance: options.tolerance.value(), is_auto, rounding: OnceLock::new(), scaling, system }
    }

    /// Whether numbers that were typed with few digits may be rounded.
    pub fn reads_digits(&self) -> bool {
        self.is_auto
    }

    fn suspects(&self, row: usize, mismatch: f64) -> bool {
        if !self.is_auto || is_typed(mismatch) {
            return false;
        }
        let rounding = self.rounding.get_or_init(|| rounding_of_sides(self.system));
        mismatch.abs().log2() <= rounding[row]
    }
}

/// Where the certificate of a dependent equation comes from.
#[derive(Clone, Debug)]
pub(crate) enum Source {
    /// Index of the row among those that went through elimination, its certificate over rows of its block, and by how many units in
    /// the last place of the largest of them its coefficients may be off, for each of them.
    Traced(u32, BlockCertificate, f64),
    /// The certificate itself.
    Given(Vec<CertificateTerm>),
}

impl Source {
    /// Whether the certificate is there without a solve.
    pub fn is_known(&self) -> bool {
        !matches!(self, Self::Traced(_, BlockCertificate::Late(..), _))
    }

    pub fn explain(&self, history: &History) -> Vec<CertificateTerm> {
        match self {
            Self::Traced(row, because, _) => history.certificate(*row, &because.terms()),
            Self::Given(because) => because.clone(),
        }
    }
}

impl Dependent {
    /// Redundant unless the mismatch is more than the tolerance of its parts, more than rounding, and not suspect.
    pub(crate) fn new(row: usize, rest: Mismatch, dropped: f64, source: Source, rule: &MismatchRule) -> Self {
        let Mismatch { value, size, error } = rest;
        let is_within = value.abs() <= (rule.tolerance * size).max(MORE_THAN_ROUNDING * error);
        // What is not a number agrees with nothing.
        let differs = !(is_within && value.is_finite());
        let is_suspect = differs && rule.suspects(row, value);
        Self {
            row,
            kind: if differs && !is_suspect { Kind::Conflicting } else { Kind::Redundant },
            is_suspect,
            mismatch: value,
            relative_mismatch: if value.abs() > MORE_THAN_ROUNDING * error { value.abs() / size } else { 0.0 },
            dropped,
            rest,
            source,
        }
    }
}

/// Redundant or conflicting, for every dependent row.
pub(crate) fn classify(eliminated: &Eliminated, diagnosed: &[Diagnosed], rule: &MismatchRule) -> Vec<Dependent> {
    let make = |source: u32, mismatch: Mismatch, dropped: f64, (because, units): (BlockCertificate, f64)| {
        let row = eliminated.names[source as usize] as usize;
        let rest = mismatch.scaled(-rule.scaling.row[row]);
        Dependent::new(row, rest, dropped, Source::Traced(source, because, units), rule)
    };
    let dead =
        eliminated.dead.iter().map(|d| make(d.row, d.mismatch, d.dropped, (BlockCertificate::Known(Vec::new()), 0.0)));
    let dependent = diagnosed.iter().flat_map(|block| &block.dependent);
    let of_blocks = dependent.map(|d| make(d.row, d.mismatch, d.dropped, (d.because.clone(), d.units)));
    let mut all: Vec<_> = dead.chain(of_blocks).collect();
    all.sort_unstable_by_key(|d| d.row);
    all
}
