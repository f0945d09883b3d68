//! Linear equations given by DOFs and coefficients: general (Eq. 2 in Appl. Sci. 15 (2025) 13059), driven in time, prescribed values, equal
//! DOFs.

use std::sync::Arc;

use crate::set::repeated;
use crate::{Constraint, EquationSink};

/// A linear equation `sum_j a_j u_j = b`; terms on the same DOF are summed.
///
#[doc = include_str!("../../docs/pictures/linear_equation.svg")]
///
#[doc = include_str!("../../docs/types/linear_equation.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::LinearEquation};
/// let mut builder = ConstraintSet::builder(2);
/// builder.add("lever", LinearEquation { terms: vec![(0, 1.0), (1, -2.0)], rhs: 3.0 })?;
/// let set = builder.build()?;
/// let mut evaluation = set.allocate();
/// set.evaluate(&[5.0, 0.5], &mut evaluation)?;
/// assert_eq!(evaluation.c(), [1.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct LinearEquation {
    /// Terms `(DOF, a_j)`.
    pub terms: Vec<(usize, f64)>,
    /// The right-hand side b.
    pub rhs: f64,
}

/// What can be wrong with a linear equation.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LinearEquationError {
    /// It has no terms.
    #[error("the equation has no terms; give at least one DOF and its coefficient")]
    NoTerms,
}

impl Constraint for LinearEquation {
    const NAME: &'static str = "linear equation";
    type Error = LinearEquationError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), LinearEquationError> {
        if self.terms.is_empty() {
            return Err(LinearEquationError::NoTerms);
        }
        sink.equation("", self.terms, self.rhs);
        Ok(())
    }
}

/// A linear equation `sum_j a_j u_j = b(t)`. With the single term `(j, 1)` it prescribes a DOF as a function of time.
/// t is the time of [`crate::ConstraintSet::set_time`], initially 0.
///
#[doc = include_str!("../../docs/pictures/driven.svg")]
///
#[doc = include_str!("../../docs/types/driven.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::Driven};
/// let mut builder = ConstraintSet::builder(1);
/// builder.add("crank", Driven::new([(0, 1.0)], |t| (2.0 * t).sin()))?;
/// let mut set = builder.build()?;
/// let mut evaluation = set.allocate();
/// set.set_time(0.5)?;
/// set.evaluate(&[0.0], &mut evaluation)?;
/// assert_eq!(evaluation.c(), [-1_f64.sin()]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct Driven {
    /// Terms `(DOF, a_j)`; terms on the same DOF are summed.
    pub terms: Vec<(usize, f64)>,
    /// The right-hand side `b(t)`.
    pub rhs: Arc<dyn Fn(f64) -> f64 + Send + Sync>,
}

impl std::fmt::Debug for Driven {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Driven").field("terms", &self.terms).finish_non_exhaustive()
    }
}

/// What can be wrong with a driven equation.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DrivenError {
    /// It has no terms.
    #[error("the equation has no terms; give at least one DOF and its coefficient")]
    NoTerms,
}

impl Driven {
    /// The equation `sum_j a_j u_j = b(t)` with the terms `(j, a_j)` and the right-hand side b.
    pub fn new(
        terms: impl IntoIterator<Item = (usize, f64)>,
        rhs: impl Fn(f64) -> f64 + Send + Sync + 'static,
    ) -> Self {
        Self { terms: terms.into_iter().collect(), rhs: Arc::new(rhs) }
    }
}

impl Constraint for Driven {
    const NAME: &'static str = "driven equation";
    type Error = DrivenError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), DrivenError> {
        if self.terms.is_empty() {
            return Err(DrivenError::NoTerms);
        }
        sink.equation_in_time("", self.terms, move |time| (self.rhs)(time));
        Ok(())
    }
}

/// Prescribed values of DOFs, `u_j = v_j`, one equation for each DOF. The diagnosis checks these equations like all
/// others.
///
#[doc = include_str!("../../docs/pictures/prescribed.svg")]
///
#[doc = include_str!("../../docs/types/prescribed.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::Prescribed};
/// let mut builder = ConstraintSet::builder(4);
/// builder.add("clamp", Prescribed::fixed([0, 1]))?;
/// builder.add("push", Prescribed { values: vec![(3, 0.1)] })?;
/// assert_eq!(builder.build()?.equations(), 3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Prescribed {
    /// Pairs `(DOF, value)`.
    pub values: Vec<(usize, f64)>,
}

/// What can be wrong with prescribed DOFs.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PrescribedError {
    /// No DOF is named.
    #[error("no DOF is listed; give at least one")]
    NoDofs,
    /// A DOF has two values.
    #[error("DOF {dof} is prescribed as {first} and as {second}; remove one of them")]
    TwoValues {
        /// The DOF, 0-based.
        dof: usize,
        /// One value.
        first: f64,
        /// The other value.
        second: f64,
    },
}

impl Prescribed {
    /// DOFs that do not move.
    pub fn fixed(dofs: impl IntoIterator<Item = usize>) -> Self {
        Self { values: dofs.into_iter().map(|dof| (dof, 0.0)).collect() }
    }
}

impl Constraint for Prescribed {
    const NAME: &'static str = "prescribed DOF";
    type Error = PrescribedError;

    fn emit(mut self, sink: &mut EquationSink) -> Result<(), PrescribedError> {
        if self.values.is_empty() {
            return Err(PrescribedError::NoDofs);
        }
        self.values.sort_by_key(|&(dof, _)| dof);
        let differ = |pair: &&[(usize, f64)]| pair[0].0 == pair[1].0 && pair[0].1 != pair[1].1;
        if let Some(pair) = self.values.windows(2).find(differ) {
            return Err(PrescribedError::TwoValues { dof: pair[0].0, first: pair[0].1, second: pair[1].1 });
        }
        self.values.dedup_by_key(|&mut (dof, _)| dof);
        let single = self.values.len() == 1;
        for (dof, value) in self.values {
            let part = if single { String::new() } else { format!("DOF {dof}") };
            sink.equation(part, [(dof, 1.0)], value);
        }
        Ok(())
    }
}

/// Equal DOFs: `u_i - u_0 = 0` for every listed DOF after the first.
///
#[doc = include_str!("../../docs/pictures/equal.svg")]
///
#[doc = include_str!("../../docs/types/equal.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::Equal};
/// let mut builder = ConstraintSet::builder(4);
/// builder.add("floor", Equal::new([3, 0, 1]))?;
/// let set = builder.build()?;
/// assert_eq!((set.equations(), set.label(1)?), (2, "floor, DOF 1".to_owned()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Equal {
    /// The DOFs, 0-based.
    pub dofs: Vec<usize>,
}

/// What can be wrong with equal DOFs.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EqualError {
    /// Fewer than two DOFs.
    #[error("{found} DOF listed; at least two are needed")]
    TooFew {
        /// Number of DOFs given.
        found: usize,
    },
    /// A DOF is repeated.
    #[error("DOF {dof} is in the list twice; remove one of them")]
    Repeated {
        /// The DOF, 0-based.
        dof: usize,
    },
}

impl Equal {
    /// Makes these DOFs equal.
    pub fn new(dofs: impl Into<Vec<usize>>) -> Self {
        Self { dofs: dofs.into() }
    }
}

impl Constraint for Equal {
    const NAME: &'static str = "equal DOFs";
    type Error = EqualError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), EqualError> {
        let [first, others @ ..] = self.dofs.as_slice() else { return Err(EqualError::TooFew { found: 0 }) };
        if others.is_empty() {
            return Err(EqualError::TooFew { found: 1 });
        }
        if let Some(dof) = repeated(&self.dofs) {
            return Err(EqualError::Repeated { dof });
        }
        let single = others.len() == 1;
        for &dof in others {
            let part = if single { String::new() } else { format!("DOF {dof}") };
            sink.equation(part, [(dof, 1.0), (*first, -1.0)], 0.0);
        }
        Ok(())
    }
}
