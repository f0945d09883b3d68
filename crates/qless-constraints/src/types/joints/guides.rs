//! Joints that let a body slide (prismatic, cylindrical, planar), and conditions on two axes (parallel, perpendicular).
//! Joints that slide add equations of `height` and `orientation`. Conditions on axes add only equations of `orientation`.

use super::attachment::Body;
use super::height::height;
use super::orientation::{Aligned, PerpendicularAxes, Tilt};
use super::relative::relative;
use super::{JointError, check_turns, direction};
use crate::scalar::vector::{Vector, dot, perpendicular};
use crate::{Constraint, EquationSink};

/// Body b slides along an axis of body a without rotating: `(R_a s_i) . (p_b - p_a) = 0` for two directions `s_i`
/// perpendicular to the axis, and `log(R_a^T R_b) = 0`, as in [`super::Fixed`]. `p_a` and `p_b` are the points of both
/// bodies that are at `at` in the reference configuration.
///
#[doc = include_str!("../../../docs/pictures/prismatic.svg")]
///
#[doc = include_str!("../../../docs/types/prismatic.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Body, Prismatic}};
/// let piston = Body::with_vector([0, 1, 2], [1.0, 0.0, 0.0], [3, 4, 5]);
/// let mut builder = ConstraintSet::builder(6);
/// builder.add("bore", Prismatic { a: Body::ground(), b: piston, at: [1.0, 0.0, 0.0], axis: [1.0, 0.0, 0.0] })?;
/// let set = builder.build()?;
/// let mut evaluation = set.allocate();
/// set.evaluate(&[5.0, 0.0, 0.0, 0.0, 0.0, 0.0], &mut evaluation)?;
/// assert_eq!(evaluation.c(), [0.0; 5]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prismatic {
    /// The body with the guide.
    pub a: Body,
    /// The body that slides.
    pub b: Body,
    /// A point of the axis in the reference configuration, coordinates.
    pub at: Vector<f64>,
    /// The direction of the axis in the reference configuration, of any length.
    pub axis: Vector<f64>,
}

impl Constraint for Prismatic {
    const NAME: &'static str = "prismatic joint";
    type Error = JointError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), JointError> {
        check_turns(&self.a, &self.b)?;
        let axis = direction(self.axis)?;
        path(sink, &self.a, &self.b, self.at, axis);
        relative(sink, "", &self.a, &self.b, Aligned);
        Ok(())
    }
}

/// Adds the two equations that keep the point `at` of body b on an axis of body a.
fn path(sink: &mut EquationSink, a: &Body, b: &Body, at: Vector<f64>, axis: Vector<f64>) {
    for (part, side) in ["path 1", "path 2"].into_iter().zip(perpendicular(axis)) {
        height(sink, part, a, b, at, side);
    }
}

/// Body b slides along an axis of body a and rotates about it: `(R_a s_i) . (p_b - p_a) = 0` for two directions `s_i` perpendicular to the
/// axis, and the tilt of the axis, as in [`super::Revolute`]. `p_a` and `p_b` are the points of both bodies that are at `at` in the
/// reference configuration.
///
#[doc = include_str!("../../../docs/pictures/cylindrical.svg")]
///
#[doc = include_str!("../../../docs/types/cylindrical.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Body, Cylindrical}};
/// let rod = Body::with_vector([0, 1, 2], [1.0, 0.0, 0.0], [3, 4, 5]);
/// let mut builder = ConstraintSet::builder(6);
/// builder.add("sleeve", Cylindrical { a: Body::ground(), b: rod, at: [0.0; 3], axis: [1.0, 0.0, 0.0] })?;
/// let set = builder.build()?;
/// // The rod slides by 2 and rotates by 1 rad.
/// let mut evaluation = set.allocate();
/// set.evaluate(&[2.0, 0.0, 0.0, 1.0, 0.0, 0.0], &mut evaluation)?;
/// assert_eq!(evaluation.c(), [0.0; 4]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cylindrical {
    /// The body with the sleeve.
    pub a: Body,
    /// The body that slides and turns.
    pub b: Body,
    /// A point of the axis in the reference configuration, coordinates.
    pub at: Vector<f64>,
    /// The direction of the axis in the reference configuration, of any length.
    pub axis: Vector<f64>,
}

impl Constraint for Cylindrical {
    const NAME: &'static str = "cylindrical joint";
    type Error = JointError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), JointError> {
        check_turns(&self.a, &self.b)?;
        let axis = direction(self.axis)?;
        path(sink, &self.a, &self.b, self.at, axis);
        relative(sink, "", &self.a, &self.b, Tilt::new(axis));
        Ok(())
    }
}

/// Body b moves in a plane of body a with the normal n: `(R_a n) . (p_b - p_a) = 0` and the tilt of the normal, as in [`super::Revolute`].
/// It slides in two directions and rotates about the normal. `p_a` and `p_b` are the points of both bodies that are at `at` in the
/// reference configuration.
///
#[doc = include_str!("../../../docs/pictures/planar.svg")]
///
#[doc = include_str!("../../../docs/types/planar.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Body, Planar}};
/// let puck = Body::with_vector([0, 1, 2], [1.0, 0.0, 0.0], [3, 4, 5]);
/// let mut builder = ConstraintSet::builder(6);
/// builder.add("table", Planar { a: Body::ground(), b: puck, at: [1.0, 0.0, 0.0], normal: [0.0, 0.0, 1.0] })?;
/// let set = builder.build()?;
/// // The body slides and spins.
/// let mut evaluation = set.allocate();
/// set.evaluate(&[2.0, -1.0, 0.0, 0.0, 0.0, 3.0], &mut evaluation)?;
/// assert_eq!(evaluation.c(), [0.0; 3]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Planar {
    /// The body with the plane.
    pub a: Body,
    /// The body that slides on the plane.
    pub b: Body,
    /// A point of the plane in the reference configuration, coordinates.
    pub at: Vector<f64>,
    /// The normal of the plane in the reference configuration, of any length.
    pub normal: Vector<f64>,
}

impl Constraint for Planar {
    const NAME: &'static str = "planar joint";
    type Error = JointError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), JointError> {
        check_turns(&self.a, &self.b)?;
        let normal = direction(self.normal)?;
        height(sink, "height", &self.a, &self.b, self.at, normal);
        relative(sink, "", &self.a, &self.b, Tilt::new(normal));
        Ok(())
    }
}

/// Keeps an axis t of each body parallel: `c = beta e`, the rotation vector that rotates `R_a t` to `R_b t`, in the axes of a. It is
/// perpendicular to t, so c has two components, which are angles.
///
/// `beta = acos(R_a t . R_b t)` is in `[0, pi]`, and e is along `t x R_a^T R_b t`. So the axes point the same way, not
/// in opposite directions. The positions of the bodies do not matter. Within 1e-8 rad of opposite directions the rank of
/// the Jacobian is one, and c is half a turn about a fixed direction perpendicular to the axis. So Newton's method can
/// leave this singular configuration.
///
#[doc = include_str!("../../../docs/pictures/parallel.svg")]
///
#[doc = include_str!("../../../docs/types/parallel.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Body, Parallel}};
/// let arm = Body::with_vector([0, 1, 2], [1.0, 0.0, 0.0], [3, 4, 5]);
/// let mut builder = ConstraintSet::builder(6);
/// builder.add("upright", Parallel { a: Body::ground(), b: arm, axis: [0.0, 0.0, 1.0] })?;
/// let set = builder.build()?;
/// // The body is tilted by 2 rad.
/// let mut evaluation = set.allocate();
/// set.evaluate(&[5.0, 5.0, 5.0, 0.0, 2.0, 0.0], &mut evaluation)?;
/// assert!((evaluation.c()[0].hypot(evaluation.c()[1]) - 2.0).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parallel {
    /// One body.
    pub a: Body,
    /// The other body.
    pub b: Body,
    /// The direction of the axis in the reference configuration, of any length.
    pub axis: Vector<f64>,
}

impl Constraint for Parallel {
    const NAME: &'static str = "parallel axes";
    type Error = JointError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), JointError> {
        check_turns(&self.a, &self.b)?;
        relative(sink, "", &self.a, &self.b, Tilt::new(direction(self.axis)?));
        Ok(())
    }
}

/// Keeps an axis s of body a and an axis t of body b perpendicular: `(R_a s) . (R_b t) = 0`, the cosine of their angle. The positions of
/// the bodies do not matter.
///
#[doc = include_str!("../../../docs/pictures/perpendicular.svg")]
///
#[doc = include_str!("../../../docs/types/perpendicular.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Body, Perpendicular}};
/// let arm = Body::with_vector([0, 1, 2], [1.0, 0.0, 0.0], [3, 4, 5]);
/// let joint = Perpendicular { a: Body::ground(), b: arm, axis_a: [1.0, 0.0, 0.0], axis_b: [0.0, 0.0, 1.0] };
/// let mut builder = ConstraintSet::builder(6);
/// builder.add("square", joint)?;
/// let set = builder.build()?;
/// // The axes stay perpendicular if the body rotates about one of them.
/// let mut evaluation = set.allocate();
/// set.evaluate(&[5.0, 5.0, 5.0, 0.0, 0.0, 2.0], &mut evaluation)?;
/// assert_eq!(evaluation.c(), [0.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Perpendicular {
    /// One body.
    pub a: Body,
    /// The other body.
    pub b: Body,
    /// The axis on body a in the reference configuration, of any length.
    pub axis_a: Vector<f64>,
    /// The axis on body b in the reference configuration, perpendicular to that on body a.
    pub axis_b: Vector<f64>,
}

impl Constraint for Perpendicular {
    const NAME: &'static str = "perpendicular axes";
    type Error = JointError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), JointError> {
        check_turns(&self.a, &self.b)?;
        relative(sink, "", &self.a, &self.b, perpendicular_axes(self.axis_a, self.axis_b)?);
        Ok(())
    }
}

/// Two axes, which must be perpendicular in the reference configuration.
pub(super) fn perpendicular_axes(of_a: Vector<f64>, of_b: Vector<f64>) -> Result<PerpendicularAxes, JointError> {
    let (of_a, of_b) = (direction(of_a)?, direction(of_b)?);
    let cosine = dot(of_a, of_b);
    if cosine.abs() > 1e-9 { Err(JointError::NotPerpendicular(cosine)) } else { Ok(PerpendicularAxes { of_a, of_b }) }
}
