//! Constraint types of finite-element and multibody models: `c(u) = 0` with `G = dc/du` and `H = sum_r w_r d^2 c_r / du^2`.
//!
//! A [`ConstraintSet`] holds constraints of any types, from linear equations to the joints of multibody models.
//!
//! - It evaluates their values, Jacobian and effective Hessian into sparse matrices. Patterns are made once, and updated when constraints are
//!   added, removed, activated, deactivated or replaced ([`ConstraintSet::add`] and others).
//! - Right-hand sides may be functions of time ([`ConstraintSet::set_time`]).
//! - [`ConstraintSet::linearised`] passes `G du = -c` to [`qless::analyse`], which finds redundant and conflicting equations.
//!
//! The concept of the library is that of Boungard and Wackerfuß for dockSIM.
//!
//! ```
//! use qless::{Options, analyse};
//! use qless_constraints::ConstraintSet;
//! use qless_constraints::types::{Distance, PlanarPoint};
//! // Four points in the plane with all six distances: one more than it takes to make them rigid.
//! let at = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.5]];
//! let points: Vec<_> = (0..4).map(|i| PlanarPoint::new([2 * i, 2 * i + 1], at[i])).collect();
//! let mut builder = ConstraintSet::builder(8);
//! for (i, j) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
//!     builder.add(format!("rod {i}-{j}"), Distance::new(points[i], points[j]))?;
//! }
//! let set = builder.build()?;
//! let mut evaluation = set.allocate();
//! set.evaluate(&[0.0; 8], &mut evaluation)?;
//! let analysis = analyse(&set.linearised(&evaluation, &[])?, &Options::default())?;
//! assert_eq!((set.equations(), analysis.rank()), (6, 5));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod constraint;
mod equations;
mod geometry;
mod nonlinear;
pub mod scalar;
mod set;
pub mod types;

pub use constraint::{Constraint, EquationError, EquationSink};
pub use nonlinear::Nonlinear;
pub use set::{
    ActiveError, ActiveSystem, AddError, ConstraintId, ConstraintIds, ConstraintSet, EditError, Evaluation,
    LineariseError, ReplaceError, Rounding, SetBuilder, TimeError, Vanishing, Weights, shorten_rotation,
};

/// Tests the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
