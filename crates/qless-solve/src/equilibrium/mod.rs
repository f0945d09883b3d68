//! Nonlinear equilibrium: u and lambda with `f_int(u) + G(u)^T lambda = f_ext` and `c(u) = 0`.
//!
//! | stage | formula | cost |
//! | --- | --- | --- |
//! | evaluation | `f_int, K` by the [`Model`]; `c, G, H = sum_r lambda_r d^2 c_r / du^2` by the set | one pass each |
//! | rows | redundant equations are ignored, their multipliers are zero | one analysis per load step |
//! | correction | `[K + H, G^T; G, 0] [du; dlambda] = -[r; c]`, scaled from both sides | one numeric LU of each part, one symbolic LU |
//! | length | the natural monotonicity test, which is affine invariant | one evaluation and solution per trial |
//! | branch | spectral radius of `G^-1 (G - G')` on the DOFs that constraints determine | one LU per step of prescribed DOFs or time |
//! | load steps | shorter after a failure, longer after an easy step | |
//!
//! Residuals are independent of units. Forces are compared with the sizes of their terms and with the effect of one unit in the last place
//! of u. Constraints are compared with the rounding of their own terms ([`ConstraintSet::rounding`]). The terms of a support `u_0 = 0`
//! vanish with u; its residual is negligible if the motion that it demands changes forces by less than their rounding.
//!
//! Connected parts are joined by K and by equations, but not by prescribed DOFs. All parts are iterated together; each has its own scales,
//! factors, step lengths, redundant equations, convergence, branch and stability. The result of a part equals that of a separate solve, to
//! the last bit, if the load steps are the same. Load steps are common to all parts, since time and history belong to the whole model: the
//! part with the hardest step determines their length. If several parts fail, the error is that of the first one, ordered by the lowest
//! DOFs; parts without free DOFs come last. If the [`Model`] rejects a configuration, evaluations without some of the parts find those that
//! it rejects.
//!
//! Loads and reactions at the rotations of bodies are moments in space ([`ConstraintSet::generalised_forces`]), and multipliers belong to
//! their constraints ([`qless_constraints::PerConstraint`]). If no equilibrium is found, the tangent of the model is compared with
//! differences of its forces ([`check_tangent`]), since a wrong tangent looks like a load that is too large.
//!
//! A returned equilibrium satisfies these tolerances, and its tangent is not singular. It may be unstable;
//! [`EquilibriumOptions::stability`] asks for a check.

mod branch;
mod check_tangent;
mod corrector;
mod error;
mod length;
mod load_path;
mod load_step;
mod model;
mod path;
mod result;
mod rows;
mod saddle;
mod stability;
mod state;
mod tangent;
mod time_path;

use qless_constraints::{ConstraintSet, TimeError};

pub use check_tangent::check_tangent;
pub use error::EquilibriumError;
pub use load_path::{EquilibriumOptions, Start, Target};
pub use model::{Assembly, Model};
use path::Path;
pub use result::{Equilibrium, EquilibriumIterate, LoadStep};
pub use stability::Stability;
use time_path::TimePath;

/// Finds an equilibrium at the target: `f_int(u) + G^T lambda = f_ext`, `c(u) = 0`, with prescribed DOFs at their values.
///
/// Loads and prescribed values change from the start to the target in one step, or in shorter steps if that fails. Near a solution the
/// residuals fall as `r_(k+1) <= C r_k^2`.
///
/// DOFs that constraints and prescribed DOFs determine, such as a linkage with a prescribed crank, stay on the branch of the start. A load
/// step is shortened if the constraint Jacobian G changes by more than half of what would make it singular. Newton's method chooses the
/// branch only if two branches meet, or if a change of G by less than 1/200 of its entries may lead to the other one;
/// [`LoadStep::branches_meet`] then says so. Equilibria that depend on stiffness are those that Newton's method finds.
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
/// let arm = builder.add("arm", OnSphere { point: PlanarPoint::new([0, 1], [1.0, 0.0]), centre: [0.0; 2], radius: None })?;
/// let set = builder.build()?;
/// let target = Target { loads: &[1.0, 3.0], prescribed: &[] };
/// let found = solve(&mut Spring, &set, &Start::at_rest(&set), &target, &EquilibriumOptions::default())?;
/// // The load turns the arm until `f - k u` points along it.
/// let (x, y) = (1.0 + found.u[0], found.u[1]);
/// assert!((x * (3.0 - 2.0 * y) - y).abs() < 1e-9 && (found.multipliers.of(arm)[0] - 1.0 / x).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`EquilibriumError`] of the first part without an equilibrium.
pub fn solve(
    model: &mut impl Model,
    set: &ConstraintSet,
    start: &Start,
    target: &Target,
    options: &EquilibriumOptions,
) -> Result<Equilibrium, EquilibriumError> {
    Path::new(model, TimePath::Still(set), start, target, options)?.follow()
}

/// As [`solve`], while the set advances to `time`: motors and other functions of time move with the loads, `t = t_0 + s (t_1 - t_0)` at the
/// load factor s.
///
/// The multiplier of a motor is its force: `dE = -lambda . db` along the path, where b is the prescribed motion (`phi`, `d`) and E the
/// energy of model and loads. Angles may advance by any number of turns; no load step turns a motor by more than a sixteenth of a turn.
/// Afterwards the set is at `time`; after an error, at its old time.
///
/// As in [`solve`], determined DOFs stay on the branch of the start, also between the ends of load steps: a linkage that cannot close on
/// the way is rejected, even if it closes at the end. If a load step starts exactly where a linkage stops closing, it may end where the
/// linkage closes again. Branches meet there, and [`LoadStep::branches_meet`] says so.
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
/// let moment = -found.multipliers.of(motor)[0];
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
    if !time.is_finite() {
        return Err(TimeError::Time(time).into());
    }
    let times = [set.time(), time];
    Path::new(model, TimePath::Driven { set, times }, start, target, options)?.follow()
}
