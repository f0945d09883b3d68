//! Nonlinear equilibrium: u and lambda with `f_int(u) + G(u)^T lambda = f_ext` and `c(u) = 0`.
//!
//! | stage | formula | cost |
//! | --- | --- | --- |
//! | evaluation | `f_int, K` by the [`Model`]; `c, G, H = sum_r lambda_r d^2 c_r / du^2` by the set | one pass each |
//! | rows | redundant equations are left out, their multipliers are zero | one analysis per load step |
//! | correction | `[K + H, G^T; G, 0] [du; dlambda] = -[r; c]`, scaled from both sides | one numeric sparse LU of each part; its symbolic part once |
//! | length | the natural test of affine invariance | one evaluation and solution per trial |
//! | branch | spectral radius of `G^-1 (G - G')` on what the constraints determine, over a load step | one sparse LU per step that moves prescribed DOFs or time |
//! | load steps | cut where a step fails, longer where it is easy | |
//!
//! Units: forces are compared with the sizes of their own terms and with what one unit in the last place of u does to them, constraints
//! with the rounding of their own terms ([`ConstraintSet::rounding`]); those of a support `u_0 = 0` vanish with u, and what is left of it is nothing
//! where it moves forces by less than their rounding. Nothing is compared with 1, so that the unit of length, force or angle
//! drops out.
//!
//! Connected parts of the model, joined by K and equations but not by prescribed DOFs, go in lock step: scales, factors, lengths, redundant equations,
//! convergence, branch and stability are a part's own. What is found of a part is what is found of it alone, to the last bit, where the load steps are
//! the same. These are common to all, since time and history are the model's: the part that takes a step worst decides on its length. An error is that of
//! the first part that has one: by their lowest DOFs, then by the rows of equations on prescribed DOFs alone. Where the [`Model`] refuses a configuration, the
//! parts that it refuses are found by evaluations of parts without the others.
//!
//! An equilibrium that is returned is one to these tolerances, and its tangent is not singular. It may be unstable: [`EquilibriumOptions::stability`] asks.

mod branch;
mod correct;
mod error;
mod load_path;
mod model;
mod parts;
mod path;
mod result;
mod rows;
mod saddle;
mod stability;
mod state;
mod time_path;

use qless_constraints::{ConstraintSet, TimeError};

pub use error::EquilibriumError;
use error::StepFailure;
pub use load_path::{EquilibriumOptions, Start, Target};
pub use model::{Assembly, Model};
pub use result::{Equilibrium, EquilibriumIterate, LoadStep};
pub use stability::Stability;
use time_path::TimePath;

/// Finds equilibrium at the target: `f_int(u) + G^T lambda = f_ext`, `c(u) = 0`, prescribed DOFs at their values.
///
/// Loads and prescribed values go from the start to the target in one step, in shorter ones where that fails. Near a solution the
/// residuals fall as `r_(k+1) <= C r_k^2`.
///
/// What constraints and prescribed DOFs determine, such as a linkage whose crank is prescribed, stays on the branch of the start: a load step is cut
/// where G turns by more than half of what would take its rank. Only where two branches meet, or G changes by less than 1/200 of its entries from
/// one to the other, Newton's method decides, and [`LoadStep::branches_meet`] says so. Where stiffness has a part in it, equilibria are those that
/// Newton's method comes to.
///
/// ```
/// use qless_solve::equilibrium::{Assembly, EquilibriumOptions, Model, Start, Target, solve};
/// use qless_constraints::{ConstraintSet, types::{OnSphere, PlanarPoint}};
/// /// A spring of stiffness 2 along y.
/// struct Spring;
/// impl Model for Spring {
///     fn dofs(&self) -> usize {
///         2
///     }
///     fn pattern(&self, entry: &mut dyn FnMut(usize, usize)) {
///         entry(1, 1);
///     }
///     fn assemble(&mut self, u: &[f64], out: &mut Assembly) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
///         out.force(1, 2.0 * u[1]);
///         out.stiffness(1, 1, 2.0);
///         Ok(())
///     }
/// }
/// // On the end of an arm of length 1.
/// let mut builder = ConstraintSet::builder(2);
/// builder.add("arm", OnSphere { point: PlanarPoint::new([0, 1], [1.0, 0.0]), centre: [0.0; 2], radius: None })?;
/// let set = builder.build()?;
/// let target = Target { loads: &[1.0, 3.0], prescribed: &[] };
/// let found = solve(&mut Spring, &set, &Start::at_rest(&set), &target, &EquilibriumOptions::default())?;
/// // The load turns the arm until `f - k u` points along it.
/// let (x, y) = (1.0 + found.u[0], found.u[1]);
/// assert!((x * (3.0 - 2.0 * y) - y).abs() < 1e-9 && (found.multipliers[0] - 1.0 / x).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`EquilibriumError`]: what the first part says that comes to no equilibrium.
pub fn solve(
    model: &mut impl Model,
    set: &ConstraintSet,
    start: &Start,
    target: &Target,
    options: &EquilibriumOptions,
) -> Result<Equilibrium, EquilibriumError> {
    options.validate()?;
    path::check(model.dofs(), set, start, target)?;
    path::Path::new(model, TimePath::Still(set), start, target, options)?.follow()
}

/// [`solve`] while the set goes from its time to another: motors and right-hand sides that are functions of time move with the loads,
/// `t = t_0 + s (t_1 - t_0)` at the load factor s.
///
/// Multipliers are what the motors push with: on the way `dE = -lambda . db` with b what they prescribe (`phi`, `d`) and E the energy of model and loads.
/// An angle is followed the right way, however many turns it goes: no load step turns it by more than a sixteenth of one. Afterwards the
/// set is at `time`; after an error, where it was.
///
/// What constraints and prescribed DOFs determine stays on the branch of the start, as in [`solve`], also between load steps: what does not close on
/// the way is refused, whether or not it closes at the end. A load step that starts just where a linkage ceases to close may find where it closes
/// again: then branches meet there, which [`LoadStep::branches_meet`] says.
///
/// ```
/// use qless_solve::equilibrium::{Assembly, EquilibriumOptions, Model, Start, Target, drive};
/// use qless_constraints::{ConstraintSet, types::{Body, Revolute, RotationMotor}};
/// /// No stiffness: a weight on an arm.
/// struct Weight;
/// impl Model for Weight {
///     fn dofs(&self) -> usize {
///         6
///     }
///     fn pattern(&self, _: &mut dyn FnMut(usize, usize)) {}
///     fn assemble(&mut self, _: &[f64], _: &mut Assembly) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
///         Ok(())
///     }
/// }
/// let (ground, arm, axis) = (Body::ground(), Body::with_vector([0, 1, 2], [2.0, 0.0, 0.0], [3, 4, 5]), [0.0, 0.0, 1.0]);
/// let mut builder = ConstraintSet::builder(6);
/// builder.add("bearing", Revolute { a: ground, b: arm, at: [0.0; 3], axis })?;
/// let motor = builder.add("motor", RotationMotor::new(ground, arm, axis, |t| t))?;
/// let mut set = builder.build()?;
/// let loads = [0.0, -3.0, 0.0, 0.0, 0.0, 0.0];
/// let start = Start { loads: loads.to_vec(), ..Start::at_rest(&set) };
/// let target = Target { loads: &loads, prescribed: &[] };
/// let found = drive(&mut Weight, &mut set, &start, &target, 7.0, &EquilibriumOptions::default())?;
/// // One turn and 0.717 rad later the motor carries the moment of the weight.
/// let moment = -found.multipliers[set.rows_of(motor)?[0]];
/// assert!((moment - 3.0 * 2.0 * 7_f64.cos()).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`EquilibriumError`].
pub fn drive(
    model: &mut impl Model,
    set: &mut ConstraintSet,
    start: &Start,
    target: &Target,
    time: f64,
    options: &EquilibriumOptions,
) -> Result<Equilibrium, EquilibriumError> {
    options.validate()?;
    path::check(model.dofs(), set, start, target)?;
    if !time.is_finite() {
        return Err(TimeError::Time(time).into());
    }
    let times = [set.time(), time];
    path::Path::new(model, TimePath::Driven { set, times }, start, target, options)?.follow()
}
