//! The contents of a new or inactive constraint: equations that the set does not evaluate now, and statements about DOFs.

use crate::equations::LinearRhs;
use crate::equations::dof_uses::DofStatement;
use crate::equations::linear::StagedEquation;
use crate::equations::nonlinear::StagedNonlinear;
use crate::scalar::Bounded;

/// The linear equations, nonlinear equations and statements about DOFs of one constraint.
#[derive(Default)]
pub struct ConstraintContents {
    pub equations: Vec<StagedEquation>,
    pub pieces: Vec<Box<dyn StagedNonlinear>>,
    /// The DOFs of the nonlinear equations in `pieces`, one piece after the other.
    pub dofs: Vec<u32>,
    pub statements: Vec<DofStatement>,
    /// The first value that is not finite among the functions of time, evaluated at the time of the set. `None` if all are finite. Only
    /// inactive constraints may have such a value.
    pub not_finite: Option<f64>,
}

impl ConstraintContents {
    /// Replaces the right-hand sides of the linear equations; `rhs` holds one value for each.
    pub fn set_rhs(&mut self, rhs: &[f64]) {
        self.equations.iter_mut().zip(rhs).for_each(|(equation, &rhs)| equation.rhs = LinearRhs::Value(rhs));
    }

    /// Evaluates the functions of time. The error is a value that is not finite.
    pub fn at_time(&mut self, time: f64) -> Result<(), f64> {
        let values = self.equations.iter().map(|equation| equation.rhs.at(time));
        let bad = values.into_iter().find(|value| !value.is_finite());
        bad.map_or(Ok(()), Err)?;
        self.pieces.iter_mut().try_for_each(|piece| piece.at_time(time))
    }

    /// The values `c(u)` of all equations, with bounds on their rounding errors.
    pub fn values(&self, u: &[f64], time: f64) -> Vec<Bounded> {
        let of = |equation: &StagedEquation| {
            let term = |&(j, a): &(u32, f64)| Bounded::from(a) * Bounded::from(u[j as usize]);
            let sum = equation.terms.iter().map(term).fold(Bounded::from(0.0), |sum, term| sum + term);
            sum - Bounded::from(equation.rhs.at(time))
        };
        let mut all: Vec<Bounded> = self.equations.iter().map(of).collect();
        self.pieces.iter().for_each(|piece| all.extend(piece.values(&self.dofs, u)));
        all
    }

    pub fn rows(&self) -> usize {
        self.equations.len() + self.pieces.iter().map(|piece| piece.rows()).sum::<usize>()
    }
}
