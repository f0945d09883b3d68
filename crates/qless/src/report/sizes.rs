//! What a report counts: sizes, kinds, entries, time.

use std::time::Duration;

use super::Status;
use crate::Form;

/// Sizes of a system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct InputSizes {
    /// Equations.
    pub rows: usize,
    /// DOFs, prescribed ones included.
    pub dofs: usize,
    /// Coefficients that are not zero.
    pub nnz: usize,
    /// DOFs that are not prescribed.
    pub free: usize,
    /// DOFs that are.
    pub prescribed: usize,
}

impl InputSizes {
    /// Sizes of a system; DOFs that are not prescribed are free.
    pub fn new(rows: usize, dofs: usize, nnz: usize, prescribed: usize) -> Self {
        Self { rows, dofs, nnz, free: dofs - prescribed, prescribed }
    }
}

/// Equations of each kind; they sum to all, and `independent` is the rank.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Counts {
    /// Kept equations.
    pub independent: usize,
    /// Combinations of kept equations that are consistent with them.
    pub redundant: usize,
    /// Combinations of kept equations that contradict them.
    pub conflicting: usize,
}

impl Counts {
    /// Equations of each kind.
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
    /// `max |T_ij|`; of factored parts the largest entry that was found.
    pub growth: f64,
    /// How well it meets the independent equations, see [`crate::Analysis::residual`].
    pub residual: f64,
    /// Entries of T and G.
    pub nnz: usize,
    /// How many times a slave and a master changed places to keep the growth down.
    pub exchanges: usize,
    /// The form that was asked for.
    pub form: Form,
    /// Connected parts that stay factors: their rows are not in T and G.
    pub factored: Vec<FactoredSizes>,
}

/// The size of a connected part that stays factors, see [`crate::reduction::FactoredBlock`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct FactoredSizes {
    /// Its independent equations.
    pub equations: usize,
    /// Its slaves.
    pub slaves: usize,
    /// Its masters.
    pub masters: usize,
    /// Numbers that it holds: of L, U, C_M and C_p.
    pub nnz: usize,
    /// Numbers that its part of T would have, estimated.
    pub predicted: usize,
}

/// Preferences that are not met, counted from 1.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Unmet {
    /// Equations that are dependent though they were to be kept.
    pub equations: Vec<usize>,
    /// DOFs that are slaves though they must not be.
    pub masters: Vec<usize>,
    /// DOFs that are not slaves though that was preferred.
    pub slaves: Vec<usize>,
}

impl Unmet {
    /// Whether every preference is met.
    pub fn is_empty(&self) -> bool {
        self.equations.is_empty() && self.masters.is_empty() && self.slaves.is_empty()
    }
}

pub(super) fn from_one(numbers: &[usize]) -> Vec<usize> {
    numbers.iter().map(|k| k + 1).collect()
}

/// What factored the blocks.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct BackendUsed {
    /// `faer`, `spqr` or `gauss`.
    pub name: &'static str,
    /// Threads at work.
    pub threads: usize,
    /// Name and version of the library behind it.
    pub version: String,
}

/// Time spent in each stage, 0 for a stage that did not run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Milliseconds {
    /// Reading and checking the input.
    pub read: f64,
    /// Scaling and presolve.
    pub presolve: f64,
    /// The backend.
    pub factor: f64,
    /// Classification and generated boundary conditions.
    pub classify: f64,
    /// T, G and g.
    pub reduce: f64,
    /// From start to end, with what is in no stage.
    pub total: f64,
}

/// To the microsecond.
pub(super) fn milliseconds(time: Duration) -> f64 {
    (time.as_secs_f64() * 1e6).round() / 1e3
}

impl BackendUsed {
    /// As [`backend::Backend`](crate::backend::Backend) tells them, and threads at work.
    pub fn new(name: &'static str, threads: usize, version: String) -> Self {
        Self { name, threads, version }
    }
}
