//! Newton's method for constraints `c(u) = 0`. Each iterate solves `G du = -c` by elimination, `du_s = T du_q + g` (Eq. 23-26).
//!
//! The analysis finds redundant equations at every iterate; the step ignores them. At a distance d from the solution, rows of G that are
//! redundant there may be independent by an amount of order d. Their values differ from those that the other rows imply by an amount of
//! order d^2 only. A step that satisfies them is therefore still of order d, and convergence stays quadratic.
//!
//! - Convergence is measured in roundings of c, so that the result has all digits that the model allows, in any unit.
//! - A step is at most as long as a second-order model of c is valid along it.
//! - Connected parts are iterated together, each with its own step lengths, tolerance and termination. The result of a part does not depend
//!   on other parts, to the last bit. Prescribed DOFs do not connect parts.
//! - If G loses rank while c is nonzero (a dead centre), no first-order step exists. A second-order step may; see
//!   [`NewtonError::Conflict`].

mod advance;
mod configuration;
mod error;
mod lanczos;
mod linearisation;
mod parts;
mod redundancy;
mod singular;
mod solution;
mod state;
mod step;

use qless_constraints::ConstraintSet;

pub(crate) use configuration::{at_rest, change, in_roundings, weights};
pub use error::NewtonError;
pub(crate) use linearisation::units;
pub(crate) use parts::{EquationParts, join_all};
pub use redundancy::{Redundancy, redundancies};
pub use solution::{NewtonIterate, NewtonOptions, NewtonSolution};
use state::NewtonState;

/// Finds `c(u) = 0`, starting from `u`. Prescribed DOFs `(DOF, value)` take their values; among the others, only slaves move in a
/// first-order step.
///
/// Near a solution the residual falls as `r_(k+1) <= C r_k^2`, also with redundant constraints. If two motions lead away from a dead
/// centre, the one is taken in which the DOF that moves most, relative to its size, increases.
///
/// Rotation vectors longer than half a turn are replaced by shorter ones of the same rotation ([`ConstraintSet::shorten_rotations`]),
/// unless one of their DOFs is prescribed.
///
/// ```
/// use qless_solve::newton::{NewtonOptions, solve};
/// use qless_constraints::{ConstraintSet, types::{OnSphere, PlanarPoint}};
/// let point = PlanarPoint::new([0, 1], [1.0, 0.0]);
/// let mut builder = ConstraintSet::builder(2);
/// builder.add("crank", OnSphere { point, centre: [0.0; 2], radius: None })?;
/// let set = builder.build()?;
/// let solution = solve(&set, &[0.0, 0.5], &[(1, 0.6)], &NewtonOptions::default())?;
/// // (0.8, 0.6) is on the circle.
/// assert!((solution.u[0] + 0.2).abs() < 1e-15);
/// // From the dead centre: x = 0.8 requires a motion along y, for which G is zero.
/// let solution = solve(&set, &[0.0, 0.0], &[(0, -0.2)], &NewtonOptions::default())?;
/// assert!((solution.u[1] - 0.6).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`NewtonError`] of the connected part that failed at the earliest step; of several, the one with the first row.
pub fn solve(
    set: &ConstraintSet,
    u: &[f64],
    prescribed: &[(usize, f64)],
    options: &NewtonOptions,
) -> Result<NewtonSolution, NewtonError> {
    if !(options.tolerance >= 1.0 && options.tolerance.is_finite()) {
        return Err(NewtonError::Tolerance(options.tolerance));
    }
    let mut run = NewtonState::new(set, u, prescribed, options)?;
    let redundant = run.follow(<[_]>::is_empty)?;
    if run.failures.is_empty() { Ok(run.into_solution(redundant)) } else { Err(run.failures.swap_remove(0).1) }
}

/// Result of all parts, including those that failed.
pub(crate) struct PartwiseSolution {
    pub u: Vec<f64>,
    pub parts: EquationParts,
    /// Failed parts, ordered by their steps and then by their first rows.
    pub failures: Vec<(usize, NewtonError)>,
}

/// As [`solve`], but parts continue if others fail.
///
/// # Errors
/// [`NewtonError`] of the whole model.
pub(crate) fn solve_each(
    set: &ConstraintSet,
    u: &[f64],
    prescribed: &[(usize, f64)],
    options: &NewtonOptions,
) -> Result<PartwiseSolution, NewtonError> {
    let mut run = NewtonState::new(set, u, prescribed, options)?;
    run.follow(|_| true)?;
    Ok(PartwiseSolution { u: run.configuration.u, parts: run.parts, failures: run.failures })
}
