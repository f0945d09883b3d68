//! What one constraint consists of, as long as it is not among the equations of a set.
//! Constraints that follow one another, as equations of their own: one thread makes them, and nothing of the set is touched until they join it.

use std::borrow::Cow;

use crate::equations::coordinates::{CoordinateList, DofCoordinate};
use crate::equations::linear::batch::LinearTerms;
use crate::equations::linear::{LinearEquations, StagedEquation};
use crate::equations::nonlinear::NonlinearEquations;
use crate::equations::nonlinear::batch::StagedNonlinear;
use crate::equations::{EquationNames, EquationOwner, LinearRhs};
use crate::nonlinear::Nonlinear;

/// Parts of a constraint whose room is kept for the next one.
const KEPT: usize = 256;

/// Linear equations, nonlinear names, and what they state.
#[derive(Default)]
pub struct ConstraintContents {
    pub equations: Vec<StagedEquation>,
    pub pieces: Vec<Box<dyn StagedNonlinear>>,
    /// The DOFs of all pieces.
    pub dofs: Vec<u32>,
    /// What DOFs add to.
    pub coordinates: Vec<DofCoordinate>,
}

impl ConstraintContents {
    /// Gives its equations, as many, these right-hand sides.
    pub fn set_rhs(&mut self, rhs: &[f64]) {
        self.equations.iter_mut().zip(rhs).for_each(|(equation, &rhs)| equation.rhs = LinearRhs::Value(rhs));
    }

    /// Nothing, with the room that a constraint of usual size needs.
    pub fn emptied(mut self: Box<Self>) -> Option<Box<Self>> {
        let Self { equations, pieces, dofs, coordinates } = &mut *self;
        let room = equations.capacity() + pieces.capacity() + dofs.capacity() + coordinates.capacity();
        equations.clear();
        pieces.clear();
        dofs.clear();
        coordinates.clear();
        (room <= KEPT).then_some(self)
    }

    /// Takes the numbers of this time; as an error one that is not finite.
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

/// Equations, and what they state of coordinates.
#[derive(Default)]
pub struct BulkEquations {
    pub linear: LinearEquations,
    pub nonlinear: NonlinearEquations,
    pub names: EquationNames,
    pub coordinates: CoordinateList,
    /// The constraint that is being added.
    constraint: u32,
    /// How many linear equations it has.
    own: u32,
    pub time: f64,
    /// Room for the terms of one equation.
    terms: LinearTerms,
}

impl BulkEquations {
    /// From this constraint on, at this time.
    pub fn new(constraint: u32, time: f64) -> Self {
        Self {
            constraint,
            time,
            linear: LinearEquations::of_many(),
            nonlinear: NonlinearEquations::of_many(),
            ..Self::default()
        }
    }

    pub fn rows(&self) -> usize {
        self.linear.rows() + self.nonlinear.rows()
    }

    /// Room for terms, to be given back with the equation.
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

    /// The constraint, one of so many, is complete.
    pub fn next(&mut self, expected: usize) {
        self.coordinates.close(expected);
        self.constraint += 1;
        self.own = 0;
    }
}
