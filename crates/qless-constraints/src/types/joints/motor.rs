//! Motors prescribe a relative motion as a function of time: `angle about an axis = phi(t)` or
//! `travel along an axis = d(t)`.

use std::sync::Arc;

use super::attachment::Body;
use super::height::Height;
use super::orientation::{Twist, value_at};
use super::relative::relative;
use super::{JointError, check_moves, check_turns, direction};
use crate::equations::TimeFunction;
use crate::geometry::rotation::RotationKind;
use crate::scalar::Scalar;
use crate::scalar::vector::Vector;
use crate::{Constraint, EquationSink, Nonlinear};

/// Rotates body b relative to body a about an axis: `c = psi - phi(t)`, an angle, at the time t of the set
/// ([`set_time`](crate::ConstraintSet::set_time), initially 0).
///
/// psi is the angle of `R_a^T R_b` about the axis, once the axes are aligned. `psi - phi` is known only modulo 2 pi,
/// and c is its value in `[-pi, pi]`. `phi` may cover any number of turns. Between two times the motor takes the
/// shorter way, so phi must change by less than half a turn in each time step. The motor does not align the axes: add a
/// [`super::Revolute`] or [`super::Cylindrical`] joint.
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
/// let mut evaluation = set.allocate();
/// set.evaluate(&[0.0, 0.0, 0.0, 0.0, 0.0, 15.0 - 2.0 * std::f64::consts::TAU], &mut evaluation)?;
/// assert!(evaluation.c().iter().all(|c| c.abs() < 1e-12));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct RotationMotor {
    /// The body that carries the motor.
    pub a: Body,
    /// The body that is rotated.
    pub b: Body,
    /// The direction of the axis in the reference configuration, of any length.
    pub axis: Vector<f64>,
    /// `phi(t)` in radians, counter-clockwise about the axis.
    pub angle: Arc<dyn Fn(f64) -> f64 + Send + Sync>,
}

/// Moves body b relative to body a along an axis: `c = (R_a t) . (p_b - p_a) - d`, a length. t is the unit vector along the axis; d is the
/// prescribed travel at the time of the set ([`set_time`](crate::ConstraintSet::set_time), initially 0).
///
/// `p_a` and `p_b` are the points of both bodies that are at `at` in the reference configuration. The motor does not
/// keep `p_b` on the axis: add a [`super::Prismatic`] or [`super::Cylindrical`] joint, or another guide if body b is a
/// node without rotations ([`Body::node`]). Body a carries the axis, so it is the ground or has rotations.
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
/// let mut evaluation = set.allocate();
/// set.evaluate(&[0.5, 0.0, 0.0, 0.0, 0.0, 0.0], &mut evaluation)?;
/// assert!(evaluation.c().iter().any(|c| (c - 0.3).abs() < 1e-15));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct TranslationMotor {
    /// The body that carries the motor.
    pub a: Body,
    /// The body or node that is moved.
    pub b: Body,
    /// Coordinates of `p_a` and `p_b`, the points of both bodies, in the reference configuration.
    pub at: Vector<f64>,
    /// The direction of the axis in the reference configuration, of any length.
    pub axis: Vector<f64>,
    /// The travel along the axis, a length, as a function of time.
    pub travel: Arc<dyn Fn(f64) -> f64 + Send + Sync>,
}

impl RotationMotor {
    /// A motor that rotates body b by `angle`, in radians.
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

    fn emit(self, sink: &mut EquationSink) -> Result<(), JointError> {
        check_turns(&self.a, &self.b)?;
        relative(sink, "", &self.a, &self.b, Twist::new(direction(self.axis)?, self.angle));
        Ok(())
    }
}

impl Constraint for TranslationMotor {
    const NAME: &'static str = "translation motor";
    type Error = JointError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), JointError> {
        check_moves(&self.a, &self.b)?;
        // Body a carries the axis, so it must not be a node. Of body b only the point matters.
        if self.a.kind == RotationKind::Node {
            return Err(JointError::NoRotations);
        }
        let height = Height::new(&self.a, &self.b, self.at, direction(self.axis)?);
        let dofs = [self.a.dofs(), self.b.dofs()].concat();
        sink.numbers(self.at);
        [self.a, self.b].iter().for_each(|body| body.state(sink));
        sink.nonlinear("", &dofs, Travel { height, motion: self.travel });
        Ok(())
    }
}

/// The equation of a [`Height`] whose prescribed height is a function of time.
struct Travel {
    height: Height,
    motion: TimeFunction,
}

impl Nonlinear for Travel {
    const DRIVEN: bool = true;
    const EQUATION_NAMES: &'static [&'static str] = Height::EQUATION_NAMES;

    fn at_time(&mut self, time: f64) -> Result<(), f64> {
        self.height.rise = value_at(&self.motion, time)?;
        Ok(())
    }

    fn value<S: Scalar>(&self, u: &[S], c: &mut [S]) {
        self.height.value(u, c);
    }

    fn pairs(&self, dofs: usize, pair: &mut dyn FnMut(usize, usize)) {
        self.height.pairs(dofs, pair);
    }

    fn value_and_jacobian(&self, u: &[f64], c: &mut [f64], g: &mut [f64]) {
        self.height.value_and_jacobian(u, c, g);
    }

    fn hessian(&self, u: &[f64], w: &[f64], h: &mut [f64]) {
        self.height.hessian(u, w, h);
    }
}
