//! Classifies dependent equations as redundant or conflicting by `b_k - sum c_i b_i`, with prescribed DOFs moved into b (Eq. 27 and 28 of
//! the paper).

use std::collections::HashMap;
use std::sync::OnceLock;

use crate::Options;
use crate::diagnosis::certificate::{CertificateTerm, History};
use crate::input::noise::{Noise, is_typed, rounding_of_sides};
use crate::input::numbering::LocalSystem;
use crate::input::scale::Scaling;
use crate::presolve::basis::{BlockCertificate, Diagnosed};
use crate::presolve::eliminated::Eliminated;
pub(crate) use crate::presolve::eliminated::Mismatch;
use crate::presolve::rows::{MORE_THAN_ROUNDING, WorkingRow};

/// The verdict on an equation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
pub enum Kind {
    /// Kept: not a combination of the other kept equations.
    Independent,
    /// A combination of kept equations, and consistent with them.
    Redundant,
    /// A combination of kept equations, but with a right-hand side that contradicts them.
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
    /// The mismatch relative to its largest term; 0 if it may be rounding.
    pub relative_mismatch: f64,
    /// What remained of the equation and was treated as zero, relative to the equation; 0 if it may be rounding.
    pub dropped: f64,
    /// True if the mismatch exceeds the tolerance but may be rounding, of the largest right-hand side or of the certificate. It then does
    /// not count as a conflict.
    pub(crate) is_suspect: bool,
    /// The mismatch with its size and error, in the units of the equation.
    pub(crate) rest: Mismatch,
    pub(crate) source: Source,
}

/// Decides whether a mismatch is a conflict.
pub(crate) struct MismatchRule<'a> {
    pub tolerance: f64,
    /// True if small mismatches may be rounding: those below the rounding of the largest right-hand side are suspect, and so are numbers
    /// that were typed with few digits.
    is_auto: bool,
    /// For each equation, log2 of the largest mismatch that may be rounding ([`rounding_of_sides`]); computed when it is needed.
    rounding: OnceLock<Vec<f64>>,
    /// The values of prescribed DOFs, collected when they are needed.
    prescribed: OnceLock<HashMap<usize, f64>>,
    pub scaling: &'a Scaling,
    pub system: LocalSystem<'a>,
}

impl<'a> MismatchRule<'a> {
    pub fn new(system: LocalSystem<'a>, scaling: &'a Scaling, options: &Options) -> Self {
        let is_auto = options.noise == Noise::Auto && !options.tolerance.is_absolute();
        let (rounding, prescribed) = (OnceLock::new(), OnceLock::new());
        Self { tolerance: options.tolerance.value(), is_auto, rounding, prescribed, scaling, system }
    }

    /// Returns true if numbers that were typed with few digits may be rounded.
    pub fn reads_digits(&self) -> bool {
        self.is_auto
    }

    /// The value of a prescribed DOF; 0 for any other.
    pub fn prescribed_value(&self, dof: usize) -> f64 {
        let values = self.prescribed.get_or_init(|| self.system.prescribed().iter().copied().collect());
        values.get(&dof).copied().unwrap_or(0.0)
    }

    /// `b - C_p u_p` of an equation: its right-hand side minus the terms of prescribed DOFs.
    pub fn side(&self, row: usize) -> Mismatch {
        let mut side = WorkingRow::new(self.system.rhs()[row]);
        for (j, v) in self.system.row(row).filter(|&(j, _)| !self.system.free()[j]) {
            side.prescribe(v * self.prescribed_value(j));
        }
        Mismatch::of_row(&side)
    }

    fn suspects(&self, row: usize, mismatch: f64) -> bool {
        if !self.is_auto || is_typed(mismatch) {
            return false;
        }
        let rounding = self.rounding.get_or_init(|| rounding_of_sides(self.system));
        mismatch.abs().log2() <= rounding[row]
    }
}

/// The origin of the certificate of a dependent equation.
#[derive(Clone, Debug)]
pub(crate) enum Source {
    /// A certificate over rows of a block: the index of the row among those that went through elimination, the terms, and a number that
    /// bounds their errors. The error of each coefficient is at most this number times the number of terms, in units in the last place of
    /// the largest coefficient.
    Traced(u32, BlockCertificate, f64),
    /// The certificate itself.
    Given(Vec<CertificateTerm>),
}

impl Source {
    /// Returns true if the certificate is available without a solve.
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
    /// Whether the equation is redundant although its mismatch exceeds the tolerance: its error bound is large, or the mismatch is suspect.
    pub(crate) fn is_excused(&self, tolerance: f64) -> bool {
        self.kind == Kind::Redundant && self.rest.value.abs() > tolerance * self.rest.size
    }

    /// The equation is redundant unless its mismatch exceeds the tolerance of its terms, exceeds rounding, and is not suspect.
    pub(crate) fn new(row: usize, rest: Mismatch, dropped: f64, source: Source, rule: &MismatchRule) -> Self {
        let Mismatch { value, size, error } = rest;
        let is_within = value.abs() <= (rule.tolerance * size).max(MORE_THAN_ROUNDING * error);
        // A mismatch that is not finite agrees with nothing.
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

/// Classifies every dependent row as redundant or conflicting.
pub(crate) fn classify(eliminated: &Eliminated, diagnosed: &[Diagnosed], rule: &MismatchRule) -> Vec<Dependent> {
    let make = |source: u32, mismatch: Mismatch, dropped: f64, (because, units): (BlockCertificate, f64)| {
        let row = eliminated.names[source as usize] as usize;
        let rest = mismatch.scaled(-rule.scaling.row[row]);
        Dependent::new(row, rest, dropped, Source::Traced(source, because, units), rule)
    };
    let dead =
        eliminated.dead.iter().map(|d| make(d.row, d.mismatch, d.dropped, (BlockCertificate::Known(Vec::new()), 0.0)));
    let dependent = diagnosed.iter().flat_map(|block| &block.dependent);
    let of_blocks = dependent.map(|d| make(d.row, d.mismatches[0], d.dropped, (d.because.clone(), d.units)));
    let mut all: Vec<_> = dead.chain(of_blocks).collect();
    all.sort_unstable_by_key(|d| d.row);
    all
}
