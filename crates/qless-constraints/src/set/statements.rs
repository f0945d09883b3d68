//! Checks the statements of constraints about their DOFs against each other, and adds the equations that keep Euler parameters at length
//! one.
//!
//! A body with Euler parameters needs `|p| = 1` once, however many joints it has. The equation comes with the first constraint on the body
//! and goes with the last one.

use std::convert::Infallible;

use crate::constraint::{Constraint, EquationError, EquationSink};
use crate::equations::dof_uses::{DofClash, DofStatement, NO_DOF};
use crate::nonlinear::Nonlinear;
use crate::scalar::Scalar;
use crate::set::ConstraintSet;

impl ConstraintSet {
    /// Stores the statements of a new constraint, unless they contradict others.
    pub(super) fn state(&mut self, number: u32, list: Vec<DofStatement>) -> Result<(), EquationError> {
        self.dof_uses.enter(number, list).map_err(|clash| self.contradiction(clash))
    }

    /// Replaces the statements of a constraint, or leaves them if the new ones contradict others. Returns the
    /// Euler parameters of the old and the new statements.
    pub(super) fn state_anew(&mut self, number: u32, list: Vec<DofStatement>) -> Result<Vec<[u32; 4]>, EquationError> {
        let active = !self.register.inactive.contains_key(&number);
        let old = self.dof_uses.take(number, active);
        let found = euler_parameters(&[old.as_slice(), &list].concat());
        let entered = self.state(number, list);
        if entered.is_err() {
            // This cannot fail: the old statements were entered before, and nothing else changed.
            let _ = self.dof_uses.enter(number, old);
        }
        if !active {
            self.dof_uses.activate(number, false);
        }
        entered.map(|()| found)
    }

    fn contradiction(&self, (dof, clash): (u32, DofClash)) -> EquationError {
        let other = self.dof_uses.constraint_with(dof);
        let other = other
            .filter(|&number| number < self.register.ever())
            .map_or_else(|| "the same call".to_owned(), |number| self.register.name(number as u32).to_owned());
        let dof = dof as usize;
        match clash {
            DofClash::Places([here, there]) => EquationError::TwoPlaces { dof, here, other, there },
            DofClash::Rotations => EquationError::TwoRotations { dof, other },
            DofClash::Uses => EquationError::TwoUses { dof, other },
        }
    }

    /// Adds `|p| = 1` for Euler parameters without this equation, and removes it if no other constraint uses them any more.
    pub(super) fn keep_lengths(&mut self, rotations: &[[u32; 4]]) {
        for &dofs in rotations {
            let statements = self.dof_uses.statements_of(dofs[0]);
            match self.norms.get(&dofs).copied() {
                None if statements > 0 => {
                    let [first, .., last] = dofs;
                    let number = self.register.ever() as u32;
                    let label = format!("length of Euler parameters, DOFs {first} to {last}");
                    self.norms.insert(dofs, number);
                    // Another constraint already says that these DOFs are Euler parameters. The length equation says the same, so it
                    // contradicts nothing. `add` fails only if the set has its largest number of equations or constraints.
                    if self.add(label, EulerLength(dofs)).is_err() {
                        self.norms.remove(&dofs);
                    }
                }
                // Only the statement of the length equation itself is left.
                Some(number) if statements == 1 => {
                    self.norms.remove(&dofs);
                    self.register.inactive.remove(&number);
                    self.forget(number);
                    self.register.remove(number);
                }
                _ => (),
            }
        }
    }
}

/// The Euler parameters that these statements name.
pub(super) fn euler_parameters(statements: &[DofStatement]) -> Vec<[u32; 4]> {
    let euler = |statement: &DofStatement| match statement {
        DofStatement::Rotation(dofs) if dofs[3] != NO_DOF => Some(*dofs),
        _ => None,
    };
    statements.iter().filter_map(euler).collect()
}

/// `c = (|p|^2 - 1) / 2`: Euler parameters `p = (1, 0, 0, 0) + u` of length one.
struct EulerLength([u32; 4]);

impl Constraint for EulerLength {
    const NAME: &'static str = "length of Euler parameters";
    type Error = Infallible;

    fn emit(self, sink: &mut EquationSink) -> Result<(), Infallible> {
        let dofs = self.0.map(|dof| dof as usize);
        sink.rotation(&dofs);
        sink.nonlinear("", &dofs, Norm);
        Ok(())
    }
}

/// The equation of [`EulerLength`]; it has no parameters.
struct Norm;

impl Nonlinear for Norm {
    const DOFS: usize = 4;
    const NUMBERS: &'static [usize] = &[0];
    const EQUATION_NAMES: &'static [&'static str] = &[""];

    fn value<S: Scalar>(&self, u: &[S], c: &mut [S]) {
        // |p|^2 - 1 = 2 u_0 + |u|^2; this form avoids cancellation.
        c[0] = u.iter().fold(u[0], |sum, &x| sum + x * x * S::from(0.5));
    }

    /// Only the pairs of the diagonal, since `H = I`.
    fn pairs(&self, dofs: usize, pair: &mut dyn FnMut(usize, usize)) {
        (0..dofs).for_each(|k| pair(k, k));
    }

    fn value_and_jacobian(&self, u: &[f64], c: &mut [f64], g: &mut [f64]) {
        self.value(u, c);
        g.copy_from_slice(u);
        g[0] += 1.0;
    }

    fn hessian(&self, _: &[f64], w: &[f64], h: &mut [f64]) {
        h[0] = w[0];
    }
}
