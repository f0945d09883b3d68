//! The counts of a report: sizes, kinds, entries, times.

use std::time::Duration;

use super::Status;
use crate::Form;

/// Sizes of a system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct InputSizes {
    /// Number of equations.
    pub rows: usize,
    /// Number of DOFs, including prescribed ones.
    pub dofs: usize,
    /// Number of coefficients that are not zero.
    pub nnz: usize,
    /// Number of free DOFs.
    pub free: usize,
    /// Number of prescribed DOFs.
    pub prescribed: usize,
}

impl InputSizes {
    /// Sizes of a system; DOFs that are not prescribed are free.
    pub fn new(rows: usize, dofs: usize, nnz: usize, prescribed: usize) -> Self {
        Self { rows, dofs, nnz, free: dofs - prescribed, prescribed }
    }
}

/// Number of equations of each kind; `independent` is the rank.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Counts {
    /// Number of kept equations.
    pub independent: usize,
    /// Number of equations that are combinations of kept ones and consistent with them.
    pub redundant: usize,
    /// Number of equations that are combinations of kept ones and conflict with them.
    pub conflicting: usize,
}

impl Counts {
    /// Counts with these numbers of equations of each kind.
    pub fn new(independent: usize, redundant: usize, conflicting: usize) -> Self {
        Self { independent, redundant, conflicting }
    }

    pub(super) fn status(self) -> Status {
        match self {
            Self { redundant: 0, conflicting: 0, .. } => Status::Independent,
            Self { conflicting: 0, .. } => Status::Redundant,
            Self { .. } => Status::Conflicting,
        }
    }
}

/// The size and quality of `u_s = T u_q + G u_p + g`.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct ReductionSizes {
    /// Number of slaves u_s.
    pub slaves: usize,
    /// Number of masters u_q.
    pub masters: usize,
    /// `max |T_ij|`; for factored parts the largest entry that the search found.
    pub growth: f64,
    /// The residual of the reduced form: [`crate::Analysis::residual`].
    pub residual: f64,
    /// Number of entries of T and G.
    pub nnz: usize,
    /// Number of exchanges of a slave and a master that kept the growth within the bound.
    pub exchanges: usize,
    /// The requested form of T, or its actual form if no request was stated.
    pub form: Form,
    /// The factored parts, whose rows of T and G are not explicit.
    pub factored: Vec<FactoredSizes>,
}

/// The sizes of a factored part: [`crate::reduction::FactoredBlock`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct FactoredSizes {
    /// Number of independent equations of the part.
    pub equations: usize,
    /// Number of slaves of the part.
    pub slaves: usize,
    /// Number of masters of the part.
    pub masters: usize,
    /// Number of entries of the factors L and U and of the columns of masters and prescribed DOFs.
    pub nnz: usize,
    /// Estimate of the number of entries of T in the part if its rows were explicit.
    pub predicted: usize,
}

/// Preferences that are not satisfied, with 1-based numbers.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Unmet {
    /// Equations that should be kept but are dependent.
    pub equations: Vec<usize>,
    /// DOFs that must not be slaves but are.
    pub masters: Vec<usize>,
    /// DOFs that are preferred as slaves but are not slaves.
    pub slaves: Vec<usize>,
}

impl Unmet {
    /// Returns true if every preference is satisfied.
    pub fn is_empty(&self) -> bool {
        self.equations.is_empty() && self.masters.is_empty() && self.slaves.is_empty()
    }
}

pub(super) fn from_one(numbers: &[usize]) -> Vec<usize> {
    numbers.iter().map(|k| k + 1).collect()
}

/// The backend that factored the blocks.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct BackendUsed {
    /// `faer`, `sparse`, `spqr` or `gauss`.
    pub name: &'static str,
    /// Number of threads.
    pub threads: usize,
    /// Name and version of the library behind the backend.
    pub version: String,
}

/// Time of each stage, 0 for a stage that did not run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Milliseconds {
    /// Time of reading and checking the input.
    pub read: f64,
    /// Time of scaling and presolve.
    pub presolve: f64,
    /// Time of the backend and of all computations with its factors.
    pub factor: f64,
    /// Time of classification and of generated boundary conditions.
    pub classify: f64,
    /// Time of computing T, G and g.
    pub reduce: f64,
    /// Total time, including time outside of these stages.
    pub total: f64,
}

/// Milliseconds, rounded to microseconds.
pub(super) fn milliseconds(time: Duration) -> f64 {
    (time.as_secs_f64() * 1e6).round() / 1e3
}

impl BackendUsed {
    /// A backend with its name and version, as in [`backend::Backend`](crate::backend::Backend).
    pub fn new(name: &'static str, threads: usize, version: String) -> Self {
        Self { name, threads, version }
    }
}
