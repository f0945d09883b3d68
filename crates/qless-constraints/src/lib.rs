//! Constraint types of finite-element and multibody models: equations `c(u) = 0`, their Jacobian `G = dc/du`, and their Hessian
//! `H = sum_r w_r d^2 c_r / du^2` with weights w_r.
//!
//! A [`ConstraintSet`] holds constraints of any types, from linear equations to the joints of multibody models.
//!
//! - It evaluates their values, Jacobian and effective Hessian into sparse matrices. Patterns are made once, and updated when constraints
//!   are added, removed, activated, deactivated or replaced ([`ConstraintSet::add`] and others).
//! - Right-hand sides may be functions of time ([`ConstraintSet::set_time`]).
//! - [`ConstraintSet::linearised`] passes `G du = -c` to [`qless::analyse`], which finds redundant and conflicting equations.
//!
//! The concept of the library is that of Boungard and Wackerfuß for dockSIM.
//!
#![doc = include_str!("../README.md")]

mod constraint;
mod equations;
mod geometry;
mod nonlinear;
pub mod scalar;
mod set;
pub mod types;

pub use constraint::{Constraint, EquationError, EquationSink};
pub use geometry::spin::rotation_tangent;
pub use nonlinear::Nonlinear;
pub use set::{
    ActiveError, ActiveSystem, AddError, ConstraintId, ConstraintIds, ConstraintSet, EditError, Evaluation,
    Inequalities, InequalityError, LineariseError, PerConstraint, ReplaceError, Rounding, SetBuilder, TimeError,
    Vanishing, shorten_rotation,
};
