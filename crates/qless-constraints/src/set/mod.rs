//! A set of constraints: `c(u)`, `G = dc/du` and `H = sum_r w_r d^2 c_r / du^2` with weights w_r, evaluated in parallel into patterns that
//! follow its changes.
//!
//! Rows are the equations of active constraints. Linear equations come first, in the order in which their constraints were added; then
//! nonlinear ones, by type in the order of the types' first use, and within a type in the order in which the constraints were added.
//!
//! Every number is computed by the same operations in the same order. Results depend neither on the number of threads nor on the history of
//! the set, except for the order of types.

mod active;
mod builder;
mod edit;
mod error;
mod evaluation;
mod inequalities;
mod linearised;
mod moments;
mod per_constraint;
mod register;
mod rotations;
mod rounding;
mod statements;
mod time;

use std::collections::BTreeMap;
use std::sync::OnceLock;

use qless::ArgumentError;
use qless::common::Identity;

use crate::equations::ChangeStamp;
use crate::equations::dof_uses::DofUses;
use crate::equations::hessian::HessianPlan;
use crate::equations::linear::LinearEquations;
use crate::equations::nonlinear::{NonlinearBatch, NonlinearEquations};
use crate::equations::tasks::{number_tasks, run_tasks, value_tasks};
use crate::set::register::ConstraintRegister;

pub(crate) use crate::constraint::repeated;
pub use active::{ActiveError, ActiveSystem};
pub use builder::SetBuilder;
pub use error::{AddError, EditError, LineariseError, ReplaceError, TimeError};
pub use evaluation::Evaluation;
pub use inequalities::{Inequalities, InequalityError};
pub use linearised::Vanishing;
pub use per_constraint::PerConstraint;
pub use register::{ConstraintId, ConstraintIds};
pub use rotations::shorten_rotation;
pub use rounding::Rounding;

/// Validated constraints on n DOFs.
///
/// ```
/// use qless_constraints::ConstraintSet;
/// use qless_constraints::types::{Distance, Equal, Point};
/// let a = Point::new([0, 1, 2], [0.0; 3]);
/// let b = Point::new([3, 4, 5], [2.0, 0.0, 0.0]);
/// let mut builder = ConstraintSet::builder(6);
/// builder.add("rod", Distance::new(a, b))?;
/// builder.add("guide", Equal::new([1, 4]))?;
/// let set = builder.build()?;
/// let mut evaluation = set.allocate();
/// // The rod is stretched from 2 to 3: c = (3^2 - 2^2) / (2 * 2).
/// set.evaluate(&[0.0, 0.0, 0.0, 1.0, 0.0, 0.0], &mut evaluation)?;
/// assert_eq!(evaluation.c(), [0.0, 1.25]);
/// assert_eq!(set.label(1)?, "rod");
/// assert_eq!(evaluation.g().row(1).filter(|&(_, v)| v != 0.0).collect::<Vec<_>>(), [(0, -1.5), (3, 1.5)]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct ConstraintSet {
    register: ConstraintRegister,
    dofs: usize,
    linear: LinearEquations,
    nonlinear: NonlinearEquations,
    /// The plan by which the entries of H are summed. It is made when it is first needed, and dropped when the pattern of H may have
    /// changed.
    hessian_plan: OnceLock<HessianPlan>,
    time: f64,
    /// The statements of all constraints about their DOFs: which coordinate a DOF displaces, or to which rotation it belongs.
    dof_uses: DofUses,
    /// For each body with Euler parameters, the number of the constraint that keeps their length.
    norms: BTreeMap<[u32; 4], u32>,
    /// Stamp of the pattern of G and of the coefficients of linear equations; each change of them gives a new stamp.
    pattern: ChangeStamp,
    /// Stamp of the state of the set; each change of the set gives a new stamp.
    version: ChangeStamp,
}

impl std::fmt::Debug for ConstraintSet {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut text = f.debug_struct("ConstraintSet");
        text.field("dofs", &self.dofs).field("constraints", &self.constraints()).finish_non_exhaustive()
    }
}

impl ConstraintSet {
    /// A builder without constraints, on DOFs `0..dofs`.
    pub fn builder(dofs: usize) -> SetBuilder {
        SetBuilder::new(dofs)
    }

    /// Number of DOFs n.
    pub fn dofs(&self) -> usize {
        self.dofs
    }

    /// Number of equations m.
    pub fn equations(&self) -> usize {
        self.linear.rows() + self.nonlinear.rows()
    }

    /// Number of constraints, active or not.
    pub fn constraints(&self) -> usize {
        self.register.alive
    }

    /// Writes `c(u)` and `G(u)`, in parallel.
    ///
    /// If an entry of u is not finite, the numbers of c and G that depend on it are not finite either; [`ConstraintSet::linearised`]
    /// refuses them.
    ///
    /// # Errors
    /// [`ArgumentError`] if `u` does not have length n, or this set did not allocate the evaluation.
    pub fn evaluate(&self, u: &[f64], evaluation: &mut Evaluation) -> Result<(), ArgumentError> {
        self.evaluate_with(u, None, evaluation)
    }

    /// Writes the effective Hessian `sum_r w_r H_r(u)`, in parallel; `weights` has one number per equation: `w = lambda` with multipliers
    /// lambda, `w = p c` with penalty factors p, and `w = lambda + p c` with both. With penalties, the tangent also has the term `G^T p G`,
    /// which is not added here.
    ///
    /// # Errors
    /// [`ArgumentError`] if `u` or `weights` has the wrong length, or this set did not allocate the evaluation.
    pub fn effective_hessian(
        &self,
        u: &[f64],
        weights: &[f64],
        evaluation: &mut Evaluation,
    ) -> Result<(), ArgumentError> {
        self.check(u, Some(weights))?;
        self.follow(evaluation)?;
        let plan = self.follow_hessian(evaluation);
        let mut numbers = vec![0.0; plan.numbers];
        run_tasks(number_tasks(&self.nonlinear.batches, u, &weights[self.linear.rows()..], &mut numbers));
        plan.sum(&numbers, evaluation.h.values_mut());
        Ok(())
    }

    /// [`ConstraintSet::evaluate`] and [`ConstraintSet::effective_hessian`] in one pass over u. The weights must not depend on c at this u,
    /// which is not known before the call. Multipliers may be weights; penalty terms `p c` may not.
    ///
    /// ```
    /// use qless_constraints::ConstraintSet;
    /// use qless_constraints::types::{Distance, PlanarPoint};
    /// let (a, b) = (PlanarPoint::new([0, 1], [0.0; 2]), PlanarPoint::new([2, 3], [0.0, 2.0]));
    /// let mut builder = ConstraintSet::builder(4);
    /// builder.add("rod", Distance::new(a, b))?;
    /// let set = builder.build()?;
    /// let mut evaluation = set.allocate();
    /// set.assemble(&[0.0; 4], &[6.0], &mut evaluation)?;
    /// // w H = 6 [I -I; -I I] / 2.
    /// assert_eq!(evaluation.g().values(), [0.0, -1.0, 0.0, 1.0]);
    /// assert_eq!(evaluation.h().row(0).collect::<Vec<_>>(), [(0, 3.0), (2, -3.0)]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ArgumentError`] if `u` or `weights` has the wrong length, or this set did not allocate the evaluation.
    pub fn assemble(&self, u: &[f64], weights: &[f64], evaluation: &mut Evaluation) -> Result<(), ArgumentError> {
        self.evaluate_with(u, Some(weights), evaluation)
    }

    /// Writes c and G, and with weights also H.
    fn evaluate_with(
        &self,
        u: &[f64],
        weights: Option<&[f64]>,
        evaluation: &mut Evaluation,
    ) -> Result<(), ArgumentError> {
        self.check(u, weights)?;
        self.follow(evaluation)?;
        let plan = weights.map(|weights| (self.follow_hessian(evaluation), &weights[self.linear.rows()..]));
        let Evaluation { u: kept, c, g, h, .. } = &mut *evaluation;
        let of_linear = |rows, c: &mut [f64]| self.linear.evaluate(rows, u, c);
        let of_items = |batch: &dyn NonlinearBatch, items, c: &mut [f64], g: &mut [f64]| batch.evaluate(items, u, c, g);
        let mut numbers = vec![0.0; plan.map_or(0, |(plan, _)| plan.numbers)];
        let mut tasks = value_tasks((&self.linear, &self.nonlinear.batches), (c, g), of_linear, of_items);
        if let Some((_, weights)) = plan {
            tasks.extend(number_tasks(&self.nonlinear.batches, u, weights, &mut numbers));
        }
        run_tasks(tasks);
        plan.into_iter().for_each(|(plan, _)| plan.sum(&numbers, h.values_mut()));
        kept.copy_from_slice(u);
        evaluation.evaluated = self.version.get();
        Ok(())
    }

    fn check(&self, u: &[f64], weights: Option<&[f64]>) -> Result<(), ArgumentError> {
        long("u", u.len(), self.dofs)?;
        weights.map_or(Ok(()), |weights| long("the list of weights", weights.len(), self.equations()))
    }

    fn own(&self, what: &'static str, of: Identity) -> Result<(), ArgumentError> {
        if of == self.register.identity { Ok(()) } else { Err(ArgumentError::Foreign { what }) }
    }

    /// The plan by which the entries of H are summed, for the current equations.
    fn plan(&self) -> &HessianPlan {
        // No lock is held while the plan is made: a thread that waits for tasks may take up one that asks for the plan too, and would then
        // wait for itself.
        if let Some(plan) = self.hessian_plan.get() {
            return plan;
        }
        let plan = HessianPlan::new(&self.nonlinear.batches, self.dofs);
        self.hessian_plan.get_or_init(|| plan)
    }
}

/// Checks the length of an argument.
pub(crate) fn long(what: &'static str, found: usize, expected: usize) -> Result<(), ArgumentError> {
    if found == expected { Ok(()) } else { Err(ArgumentError::WrongLength { what, found, expected }) }
}

#[cfg(test)]
mod tests;
