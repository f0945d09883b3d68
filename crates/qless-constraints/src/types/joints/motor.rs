//! Motors: relative motion as a function of time, `angle about an axis = phi(t)`, `travel along an axis = d(t)`.

use std::sync::Arc;

use super::height::Height;
use super::orientation::Twist;
use super::relative::relative;
use super::{JointError, check_moves, check_turns, direction};
use crate::geometry::carrier::{Body, Kind};
use crate::scalar::Scalar;
use crate::scalar::vector::Vector;
use crate::{Constraint, Nonlinear, Store};

/// `phi(t)`, `d(t)`.
pub(super) type Motion = Arc<dyn Fn(f64) -> f64 + Send + Sync>;

/// Its value at a time; as an error one that is not finite.
pub(super) fn at(motion: &Motion, time: f64) -> Result<f64, f64> {
    let value = motion(time);
    if value.is_finite() { Ok(value) } else { Err(value) }
}

/// Body b is turned on body a about an axis: `c = psi - phi(t)`, an angle, for the time t of the set
/// ([`set_time`](crate::ConstraintSet::set_time), 0 at first).
///
/// psi is the angle about the axis that is left of `R_a^T R_b` once the axes are aligned. `psi - phi` is known up to whole turns, and c is the
/// one of these in `[-pi, pi]`: the function runs over any number of turns, and from one time to the next the motor follows the shorter way, so that it
/// has to be solved for at least every half turn. The motor holds no axis: it is added to a joint, [`super::Revolute`] or [`super::Cylindrical`]. Its
/// multiplier is the moment about the axis. One degree of freedom is removed. Singular where the axes are opposite.
///
#[doc = include_str!("../../../docs/pictures/rotation_motor.svg")]
///
#[doc = include_str!("../../../docs/types/rotation_motor.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Body, Revolute, RotationMotor}};
/// let (ground, wheel, axis) = (Body::ground(), Body::with_vector([0, 1, 2], [0.0; 3], [3, 4, 5]), [0.0, 0.0, 1.0]);
/// let mut builder = ConstraintSet::builder(6);
/// builder.add("bearing", Revolute { a: ground, b: wheel, at: [0.0; 3], axis })?;
/// builder.add("motor", RotationMotor::new(ground, wheel, axis, |t| 3.0 * t))?;
/// let mut set = builder.build()?;
/// set.set_time(5.0)?;
/// // 15 rad are two turns and 2.43 rad; `qless_solve::newton::solve` finds this configuration.
/// let mut quantities = set.allocate();
/// set.evaluate(&[0.0, 0.0, 0.0, 0.0, 0.0, 15.0 - 2.0 * std::f64::consts::TAU], &mut quantities)?;
/// assert!(quantities.c().iter().all(|c| c.abs() < 1e-12));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct RotationMotor {
    /// The body that holds the motor.
    pub a: Body,
    /// The body that it turns.
    pub b: Body,
    /// The direction of the axis in the reference configuration, of any length.
    pub axis: Vector<f64>,
    /// `phi(t)` in radians, counter-clockwise about the axis.
    pub angle: Arc<dyn Fn(f64) -> f64 + Send + Sync>,
}

/// Body b is moved on body a along an axis: `c = (R_a t) . (p_b - p_a) - d(t)`, a length, for the time t of the set
/// ([`set_time`](crate::ConstraintSet::set_time), 0 at first).
///
/// `p_a` and `p_b` are the points of both bodies that are at `at` in the reference configuration. The motor holds no path: it is added to a joint,
/// [`super::Prismatic`] or [`super::Cylindrical`], or to a node ([`Body::node`]) that is guided otherwise. Body b may be a node without rotations; body a
/// carries the axis, so that it is the ground or turns. Its multiplier is the force along the axis. One degree of freedom is removed. Singular: nowhere.
///
#[doc = include_str!("../../../docs/pictures/translation_motor.svg")]
///
#[doc = include_str!("../../../docs/types/translation_motor.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Body, Prismatic, TranslationMotor}};
/// let (ground, ram, at) = (Body::ground(), Body::with_vector([0, 1, 2], [0.0; 3], [3, 4, 5]), [0.0; 3]);
/// let mut builder = ConstraintSet::builder(6);
/// builder.add("cylinder", Prismatic { a: ground, b: ram, at, axis: [1.0, 0.0, 0.0] })?;
/// builder.add("pressure", TranslationMotor::new(ground, ram, at, [1.0, 0.0, 0.0], |t| 0.1 * t))?;
/// let mut set = builder.build()?;
/// set.set_time(2.0)?;
/// let mut quantities = set.allocate();
/// set.evaluate(&[0.5, 0.0, 0.0, 0.0, 0.0, 0.0], &mut quantities)?;
/// assert!(quantities.c().iter().any(|c| (c - 0.3).abs() < 1e-15));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct TranslationMotor {
    /// The body that holds the motor.
    pub a: Body,
    /// The body that it moves, or a node.
    pub b: Body,
    /// A point in the reference configuration, coordinates.
    pub at: Vector<f64>,
    /// The direction of the axis there, of any length.
    pub axis: Vector<f64>,
    /// `d(t)`, a length along the axis.
    pub travel: Arc<dyn Fn(f64) -> f64 + Send + Sync>,
}

impl RotationMotor {
    /// A motor that turns body b by `angle`, in radians.
    pub fn new(a: Body, b: Body, axis: Vector<f64>, angle: impl Fn(f64) -> f64 + Send + Sync + 'static) -> Self {
        Self { a, b, axis, angle: Arc::new(angle) }
    }
}

impl TranslationMotor {
    /// A motor that moves body b by `travel`, a length.
    pub fn new(
        a: Body,
        b: Body,
        at: Vector<f64>,
        axis: Vector<f64>,
        travel: impl Fn(f64) -> f64 + Send + Sync + 'static,
    ) -> Self {
        Self { a, b, at, axis, travel: Arc::new(travel) }
    }
}

impl std::fmt::Debug for RotationMotor {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut text = f.debug_struct("RotationMotor");
        text.field("a", &self.a).field("b", &self.b).field("axis", &self.axis).finish_non_exhaustive()
    }
}

impl std::fmt::Debug for TranslationMotor {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut text = f.debug_struct("TranslationMotor");
        text.field("a", &self.a).field("b", &self.b).field("at", &self.at).field("axis", &self.axis);
        text.finish_non_exhaustive()
    }
}

impl Constraint for RotationMotor {
    const NAME: &'static str = "rotation motor";
    type Error = JointError;

    fn process(self, store: &mut Store) -> Result<(), JointError> {
        check_turns(&self.a, &self.b)?;
        relative(store, "", &self.a, &self.b, Twist::new(direction(self.axis)?, self.angle));
        Ok(())
    }
}

impl Constraint for TranslationMotor {
    const NAME: &'static str = "translation motor";
    type Error = JointError;

    fn process(self, store: &mut Store) -> Result<(), JointError> {
        check_moves(&self.a, &self.b)?;
        // Of body b only a point counts; it is body a that carries the axis.
        if self.a.kind == Kind::Node {
            return Err(JointError::NoRotations);
        }
        let height = Height::new(&self.a, &self.b, self.at, direction(self.axis)?);
        let dofs = [self.a.dofs(), self.b.dofs()].concat();
        store.numbers(self.at);
        [self.a, self.b].iter().for_each(|body| body.state(store));
        store.nonlinear("", &dofs, Travel { height, motion: self.travel });
        Ok(())
    }
}

/// A height that changes with time.
struct Travel {
    height: Height,
    motion: Motion,
}

impl Nonlinear for Travel {
    const DRIVEN: bool = true;
    const PARTS: &'static [&'static str] = Height::PARTS;

    fn at_time(&mut self, time: f64) -> Result<(), f64> {
        self.height.rise = at(&self.motion, time)?;
        Ok(())
    }

    fn value<S: Scalar>(&self, u: &[S], c: &mut [S]) {
        self.height.value(u, c);
    }

    fn pairs(&self, dofs: usize, pair: &mut dyn FnMut(usize, usize)) {
        self.height.pairs(dofs, pair);
    }

    fn rotation_vectors(&self, found: &mut dyn FnMut(usize)) {
        self.height.rotation_vectors(found);
    }

    fn value_and_jacobian(&self, u: &[f64], c: &mut [f64], g: &mut [f64]) {
        self.height.value_and_jacobian(u, c, g);
    }

    fn hessian(&self, u: &[f64], w: &[f64], h: &mut [f64]) {
        self.height.hessian(u, w, h);
    }
}
