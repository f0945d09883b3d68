//! Newton's method with the elimination applied to G: `G du = -c`, `du_s = T du_q + g` (Eq. 23-26 at every iterate).
//!
//! Redundant constraints are found by the analysis at every iterate, and left out of the step. Off the solution their rows of G
//! may be independent by as little as the distance to it. That does no harm: their values differ by the square of the
//! distance, so that a step which satisfies both is no longer than the distance, and the convergence stays quadratic.
//!
//! - Convergence is counted in roundings of c, so that every model is solved to the last digits that it has, in any unit.
//! - A step is no longer than second order describes c along it.
//! - Connected parts go in lock step, each by lengths, a tolerance and an end of its own: what is found of a part depends on it alone, to the
//!   last bit. Prescribed DOFs do not connect, but for what is stated of their coordinates.
//! - Where G loses rank and c is not zero (a dead centre), first order knows no way. Second order may: see [`NewtonError::Conflict`].

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

/// Finds `c(u) = 0` from `u`; prescribed DOFs `(DOF, value)` take their values, and others move only where they are slaves.
///
/// Near a solution the residual falls as `r_(k+1) <= C r_k^2`, with redundant constraints in the set too. Where two motions
/// leave a dead centre, the one in which the DOF that moves most, by its size, increases is taken.
///
/// Rotation vectors are kept below half a turn: one that is longer is replaced by a shorter one of the same rotation
/// ([`ConstraintSet::shorten_rotations`]), unless one of its DOFs is prescribed.
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
/// // From its dead centre, where x = 0.8 asks for a motion along y that G knows nothing of.
/// let solution = solve(&set, &[0.0, 0.0], &[(0, -0.2)], &NewtonOptions::default())?;
/// assert!((solution.u[1] - 0.6).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`NewtonError`]: what the connected part says that is the first to fail, by its step and then by its first row.
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

/// What parts come to that go on where others fail.
pub(crate) struct PartwiseSolution {
    pub u: Vec<f64>,
    pub parts: EquationParts,
    /// EquationParts that failed, by their steps and then by their first rows.
    pub failures: Vec<(usize, NewtonError)>,
}

/// [`solve`] for each part.
///
/// # Errors
/// What is wrong with the whole.
pub(crate) fn solve_each(
    set: &ConstraintSet,
    u: &[f64],
    prescribed: &[(usize, f64)],
    options: &NewtonOptions,
) -> Result<PartwiseSolution, NewtonError> {
    let mut run = NewtonState::new(set, u, prescribed, options)?;
    run.follow(|_| true)?;
    Ok(PartwiseSolution { u: run.place.u, parts: run.parts, failures: run.failures })
}
