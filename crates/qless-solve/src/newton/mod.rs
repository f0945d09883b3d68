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

mod error;
mod lanczos;
mod linearisation;
mod parts;
mod place;
mod redundancy;
mod residual;
mod run;
mod scaling;
mod singular;
mod step;
mod units;

use qless::{Analysis, Options};

pub use error::NewtonError;
pub(crate) use parts::{Parts, Union};
pub(crate) use redundancy::random;
pub use redundancy::{Redundancy, redundancies};
pub(crate) use residual::{change, in_roundings};
use run::Run;
pub(crate) use scaling::{at_rest, weights};
pub(crate) use units::units;

use qless_constraints::ConstraintSet;

/// Settings of [`solve`].
#[derive(Clone, Debug)]
pub struct NewtonOptions {
    /// Done when each `|c_r|` is at most so many times the bound on its rounding ([`ConstraintSet::rounding`]). Default 4, at least 1.
    ///
    /// Where c no longer falls, that of the largest terms of its connected part counts, with the weights of [`Iterate::residual`], for rows that ask for no
    /// motion that matters: `|c_r| <= 1e-11 sum_j |G_rj| s_j` with the coordinates `s_j` that the DOFs add to, or `|u_j|`, or one radian.
    pub tolerance: f64,
    /// Most steps of any part; all go in lock step. Default 50.
    pub steps: usize,
    /// How the linearised equations are analysed.
    pub analysis: Options,
}

impl Default for NewtonOptions {
    fn default() -> Self {
        Self { tolerance: 4.0, steps: 50, analysis: Options::default() }
    }
}

/// One iterate: what was found before its step was made.
#[derive(Clone, Debug, PartialEq)]
pub struct Iterate {
    /// `max_r D_r |c_r| / max_r D_r size_r`: relative to the largest terms that went into any c, with weights D that make equations
    /// comparable; the same in all units. The largest of all connected parts.
    pub residual: f64,
    /// Rank of G.
    pub rank: usize,
    /// Equations left out of the step.
    pub left_out: Vec<usize>,
    /// How much of `du` was gone to come here: the least of the connected parts that were still on their way; 1 for a full step and for the
    /// first iterate.
    pub length: f64,
}

/// A configuration that satisfies all constraints.
#[derive(Clone, Debug)]
pub struct Solution {
    /// The DOFs.
    pub u: Vec<f64>,
    /// The way there; the last one is the solution.
    pub iterates: Vec<Iterate>,
    /// Equations that are redundant at the solution.
    pub redundant: Vec<usize>,
}

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
) -> Result<Solution, NewtonError> {
    if !(options.tolerance >= 1.0 && options.tolerance.is_finite()) {
        return Err(NewtonError::Tolerance(options.tolerance));
    }
    let mut run = Run::new(set, u, prescribed, options)?;
    let redundant = run.follow(<[_]>::is_empty)?;
    if run.failures.is_empty() { Ok(run.into_solution(redundant)) } else { Err(run.failures.swap_remove(0).1) }
}

/// What parts come to that go on where others fail.
pub(crate) struct Each {
    pub u: Vec<f64>,
    pub parts: Parts,
    /// Parts that failed, by their steps and then by their first rows.
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
) -> Result<Each, NewtonError> {
    let mut run = Run::new(set, u, prescribed, options)?;
    run.follow(|_| true)?;
    Ok(Each { u: run.place.u, parts: run.parts, failures: run.failures })
}

/// Equations that are not kept.
pub(crate) fn dependent(analysis: &Analysis) -> Vec<usize> {
    analysis.dependent().iter().map(|dependent| dependent.row).collect()
}
