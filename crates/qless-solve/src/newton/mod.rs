//! Newton's method for constraints `c(u) = 0`. Each iterate solves `G du = -c` by elimination, `du_s = T du_q + g` (Eq. 23-26).
//!
//! The analysis finds redundant equations at every iterate; the step ignores them. At a distance d from the solution, rows of G that are
//! redundant there may be independent by an amount of order d. Their values differ from those that the other rows imply by an amount of
//! order d^2 only. A step that satisfies them is therefore still of order d, and convergence stays quadratic.
//!
//! - Convergence is measured in multiples of the rounding of c, so that the result has all digits that the model allows, in any unit.
//! - A step is at most so long that a second-order model of c is valid along it.
//! - A step may be shorter than the full one, or the equations too nearly dependent for any. Then a step with a lower rank is tried: it
//!   ignores rows that are independent by less than a step changes G.
//! - Connected parts are iterated together, each with its own step lengths and termination. The result of a part does not depend on other
//!   parts, to the last bit. Prescribed DOFs do not connect parts.
//!   An exception: beside a part near a redundant loop, the result of another one may differ by rounding.
//! - If G loses rank while c is nonzero (a dead centre), no first-order step exists. A second-order step may; see
//!   [`NewtonError::Conflict`].

mod configuration;
mod error;
mod iteration;
mod lanczos;
mod linearisation;
mod lower_rank;
mod parts;
mod redundancy;
mod scales;
mod singular;
mod solution;
mod step;

use qless_constraints::ConstraintSet;

pub(crate) use configuration::{at_rest, change, in_roundings};
pub use error::NewtonError;
use iteration::Iteration;
pub(crate) use iteration::{check_prescribed, free_rotations};
pub(crate) use linearisation::{Place, analyse_rows};
pub(crate) use parts::{Part, Parts};
pub use redundancy::{Redundancy, redundancies};
pub(crate) use scales::Scales;
pub use solution::{NewtonIterate, NewtonOptions, NewtonSolution};

/// Finds `c(u) = 0`, starting from `u`. Prescribed DOFs `(DOF, value)` take their values; among the others, only slaves move in a
/// first-order step.
///
/// Near a solution the residual falls as `r_(k+1) <= C r_k^2`, also with redundant constraints. If two opposite motions lead away from a
/// dead centre, that one is taken in which the DOF with the largest motion, relative to its unit, increases.
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
/// [`NewtonError`] of the connected part that failed at the earliest step; of several, the one with the lowest DOF.
pub fn solve(
    set: &ConstraintSet,
    u: &[f64],
    prescribed: &[(usize, f64)],
    options: &NewtonOptions,
) -> Result<NewtonSolution, NewtonError> {
    if !(options.tolerance >= 1.0 && options.tolerance.is_finite()) {
        return Err(NewtonError::Tolerance(options.tolerance));
    }
    check_prescribed(set, prescribed)?;
    let parts = Parts::new(set.allocate().g(), prescribed, free_rotations(set, prescribed));
    let mut run = Iteration::new((set, &parts), u, prescribed, options)?;
    let redundant = run.run(<[_]>::is_empty)?;
    if !run.failures.is_empty() {
        return Err(run.failures.swap_remove(0).1);
    }
    Ok(NewtonSolution { u: run.now.u, iterates: run.iterates, redundant })
}

/// Result of all parts, including those that failed.
pub(crate) struct PartwiseSolution {
    pub u: Vec<f64>,
    /// The error of each part that failed.
    pub errors: Vec<Option<NewtonError>>,
    /// Equations that are redundant at u.
    pub redundant: Vec<usize>,
}

/// As [`solve`], but other parts continue if a part fails. The prescribed DOFs are those that `parts` was made with.
///
/// # Errors
/// [`NewtonError`] of the whole model.
pub(crate) fn solve_each(
    (set, parts): (&ConstraintSet, &Parts),
    u: &[f64],
    prescribed: &[(usize, f64)],
    options: &NewtonOptions,
) -> Result<PartwiseSolution, NewtonError> {
    let mut run = Iteration::new((set, parts), u, prescribed, options)?;
    let redundant = run.run(|_| true)?;
    let mut errors: Vec<Option<NewtonError>> = parts.list.iter().map(|_| None).collect();
    run.failures.into_iter().for_each(|(part, error)| errors[part] = Some(error));
    Ok(PartwiseSolution { u: run.now.u, errors, redundant })
}
