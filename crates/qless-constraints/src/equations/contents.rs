//! Equations of constraints that are not yet, or no longer, part of a set.
//!
//! [`ConstraintContents`] holds one constraint: a new one, or one that is inactive. [`BulkEquations`] holds many new ones, stored as a set
//! stores them: one thread makes them without touching the set, which then takes them over.

use std::borrow::Cow;

use crate::equations::coordinates::{CoordinateList, DofCoordinate};
use crate::equations::linear::batch::LinearTerms;
use crate::equations::linear::{LinearEquations, StagedEquation};
use crate::equations::nonlinear::NonlinearEquations;
use crate::equations::nonlinear::batch::StagedNonlinear;
use crate::equations::{EquationNames, EquationOwner, LinearRhs};
use crate::nonlinear::Nonlinear;

/// Largest total capacity of a constraint's lists that is kept for reuse.
const KEPT: usize = 256;

/// The linear equations, nonlinear equations and reference coordinates of one constraint.
#[derive(Default)]
pub struct ConstraintContents {
    pub equations: Vec<StagedEquation>,
    pub pieces: Vec<Box<dyn StagedNonlinear>>,
    /// The DOFs of all nonlinear pieces.
    pub dofs: Vec<u32>,
    pub coordinates: Vec<DofCoordinate>,
}

impl ConstraintContents {
    /// Replaces the right-hand sides of the linear equations, one each.
    pub fn set_rhs(&mut self, rhs: &[f64]) {
        self.equations.iter_mut().zip(rhs).for_each(|(equation, &rhs)| equation.rhs = LinearRhs::Value(rhs));
    }

    /// Clears the lists for reuse; `None` if they are too large to be kept.
    pub fn emptied(mut self: Box<Self>) -> Option<Box<Self>> {
        let Self { equations, pieces, dofs, coordinates } = &mut *self;
        let room = equations.capacity() + pieces.capacity() + dofs.capacity() + coordinates.capacity();
        equations.clear();
        pieces.clear();
        dofs.clear();
        coordinates.clear();
        (room <= KEPT).then_some(self)
    }

    /// Evaluates the functions of time. The error is a value that is not finite.
    pub fn at_time(&mut self, time: f64) -> Result<(), f64> {
        let values = self.equations.iter().map(|equation| equation.rhs.at(time));
        let bad = values.into_iter().find(|value| !value.is_finite());
        bad.map_or(Ok(()), Err)?;
        self.pieces.iter_mut().try_for_each(|piece| piece.at_time(time))
    }

    pub fn rows(&self) -> usize {
        self.equations.len() + self.pieces.iter().map(|piece| piece.rows()).sum::<usize>()
    }
}

/// Equations and coordinates of consecutive constraints.
#[derive(Default)]
pub struct BulkEquations {
    pub linear: LinearEquations,
    pub nonlinear: NonlinearEquations,
    pub names: EquationNames,
    pub coordinates: CoordinateList,
    /// Number of the constraint that is being added.
    constraint: u32,
    /// Number of its linear equations so far.
    own: u32,
    pub time: f64,
    /// Empty list, reused for the terms of each equation.
    terms: LinearTerms,
}

impl BulkEquations {
    /// `constraint` is the number of the first one; functions of time are evaluated at `time`.
    pub fn new(constraint: u32, time: f64) -> Self {
        Self {
            constraint,
            time,
            linear: LinearEquations::for_many_items(),
            nonlinear: NonlinearEquations::for_many_items(),
            ..Self::default()
        }
    }

    pub fn rows(&self) -> usize {
        self.linear.rows() + self.nonlinear.rows()
    }

    /// An empty list, which [`BulkEquations::equation`] takes back.
    pub fn terms(&mut self) -> LinearTerms {
        let mut terms = std::mem::take(&mut self.terms);
        terms.clear();
        terms
    }

    pub fn equation(&mut self, name: Cow<'static, str>, terms: LinearTerms, rhs: LinearRhs) {
        let owner = EquationOwner { constraint: self.constraint, name: self.names.place(name) };
        self.linear.append(owner, self.own, (&terms, rhs), self.time);
        self.own += 1;
        self.terms = terms;
    }

    pub fn nonlinear<Q: Nonlinear>(&mut self, name: Cow<'static, str>, dofs: &[u32], parameters: Q) {
        let owner = EquationOwner { constraint: self.constraint, name: self.names.place(name) };
        self.nonlinear.insert(owner, dofs, parameters);
    }

    /// Ends the current constraint, one of `expected` in total.
    pub fn next(&mut self, expected: usize) {
        self.coordinates.close(expected);
        self.constraint += 1;
        self.own = 0;
    }
}
