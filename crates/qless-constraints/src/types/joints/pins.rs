//! Joints that keep a point of both bodies together: fixed, revolute, spherical and universal. All add the equations
//! of `coincident`; all but the spherical joint also add equations of `orientation`.

use super::attachment::Body;
use super::coincident::coincident;
use super::guides::perpendicular_axes;
use super::orientation::{Aligned, Tilt};
use super::relative::relative;
use super::{JointError, check_moves, check_turns, direction};
use crate::scalar::vector::Vector;
use crate::{Constraint, EquationSink};

/// Two bodies that move as one: `x_a + R_a s_a - x_b - R_b s_b = 0` and `log(R_a^T R_b) = 0`. `s_a` and `s_b` are the arms from the
/// positions `x_a` and `x_b` of the bodies to the joint.
///
/// The angles are the components of the shortest rotation vector from a to b, in the axes of a. So a joint that is not
/// yet assembled closes over at most half a turn; at exactly half a turn, the sign of the quaternion decides the sense of
/// rotation.
/// The multipliers of these angles form a moment in the axes of a.
///
#[doc = include_str!("../../../docs/pictures/fixed.svg")]
///
#[doc = include_str!("../../../docs/types/fixed.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Body, Fixed}};
/// let bracket = Body::with_vector([0, 1, 2], [1.0, 0.0, 0.0], [3, 4, 5]);
/// let mut builder = ConstraintSet::builder(6);
/// builder.add("weld", Fixed { a: Body::ground(), b: bracket, at: [0.0; 3] })?;
/// assert_eq!(builder.build()?.equations(), 6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fixed {
    /// One body.
    pub a: Body,
    /// The other body.
    pub b: Body,
    /// Position of the joint in the reference configuration, coordinates.
    pub at: Vector<f64>,
}

impl Constraint for Fixed {
    const NAME: &'static str = "fixed joint";
    type Error = JointError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), JointError> {
        check_turns(&self.a, &self.b)?;
        coincident(sink, "", &self.a, &self.b, self.at);
        relative(sink, "", &self.a, &self.b, Aligned);
        Ok(())
    }
}

/// A hinge: `x_a + R_a s_a - x_b - R_b s_b = 0` and the tilt of the axis. `s_a` and `s_b` are the arms from the positions `x_a` and `x_b`
/// of the bodies to the joint.
///
/// t is the direction of the axis in the reference configuration. The tilt is the rotation vector that rotates `R_a t` to
/// `R_b t`, in the axes of a, with the angle `acos(R_a t . R_b t)` in `[0, pi]` ([`super::Parallel`]). So the axes point
/// the same way after assembly, from any initial position. The joint may turn any number of times.
///
#[doc = include_str!("../../../docs/pictures/revolute.svg")]
///
#[doc = include_str!("../../../docs/types/revolute.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Body, Revolute}};
/// let arm = Body::with_vector([0, 1, 2], [1.0, 0.0, 0.0], [3, 4, 5]);
/// let mut builder = ConstraintSet::builder(6);
/// builder.add("door", Revolute { a: Body::ground(), b: arm, at: [0.0; 3], axis: [0.0, 0.0, 1.0] })?;
/// let set = builder.build()?;
/// assert_eq!((set.equations(), set.label(3)?), (5, "door, tilt 1".to_owned()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Revolute {
    /// One body.
    pub a: Body,
    /// The other body.
    pub b: Body,
    /// A point of the axis in the reference configuration, coordinates.
    pub at: Vector<f64>,
    /// The direction of the axis in the reference configuration, of any length.
    pub axis: Vector<f64>,
}

impl Constraint for Revolute {
    const NAME: &'static str = "revolute joint";
    type Error = JointError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), JointError> {
        check_turns(&self.a, &self.b)?;
        let axis = direction(self.axis)?;
        coincident(sink, "", &self.a, &self.b, self.at);
        relative(sink, "", &self.a, &self.b, Tilt::new(axis));
        Ok(())
    }
}

/// A ball joint: `x_a + R_a s_a - x_b - R_b s_b = 0`. `s_a` and `s_b` are the arms from the positions `x_a` and `x_b` of the bodies to the
/// joint.
///
#[doc = include_str!("../../../docs/pictures/spherical.svg")]
///
#[doc = include_str!("../../../docs/types/spherical.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Body, Spherical}};
/// let arm = Body::with_vector([0, 1, 2], [1.0, 0.0, 0.0], [3, 4, 5]);
/// let mut builder = ConstraintSet::builder(6);
/// builder.add("hip", Spherical { a: Body::ground(), b: arm, at: [0.0; 3] })?;
/// assert_eq!(builder.build()?.equations(), 3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spherical {
    /// One body.
    pub a: Body,
    /// The other body.
    pub b: Body,
    /// Position of the joint in the reference configuration, coordinates.
    pub at: Vector<f64>,
}

impl Constraint for Spherical {
    const NAME: &'static str = "spherical joint";
    type Error = JointError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), JointError> {
        check_moves(&self.a, &self.b)?;
        coincident(sink, "", &self.a, &self.b, self.at);
        Ok(())
    }
}

/// A cross of two axes, s on body a and t on body b: `x_a + R_a s_a - x_b - R_b s_b = 0` and `(R_a s) . (R_b t) = 0`. `s_a` and `s_b` are
/// the arms from the positions `x_a` and `x_b` of the bodies to the joint. The rotations `psi_a` and `psi_b` of shafts at an angle beta
/// satisfy `tan(psi_b) = tan(psi_a) / cos(beta)`.
///
#[doc = include_str!("../../../docs/pictures/universal.svg")]
///
#[doc = include_str!("../../../docs/types/universal.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Body, Universal}};
/// let shaft = Body::with_vector([0, 1, 2], [1.0, 0.0, 0.0], [3, 4, 5]);
/// let joint = Universal { a: Body::ground(), b: shaft, at: [0.0; 3], axis_a: [0.0, 1.0, 0.0], axis_b: [0.0, 0.0, 1.0] };
/// let mut builder = ConstraintSet::builder(6);
/// builder.add("cardan", joint)?;
/// assert_eq!(builder.build()?.equations(), 4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Universal {
    /// One body.
    pub a: Body,
    /// The other body.
    pub b: Body,
    /// Point where the axes cross in the reference configuration, coordinates.
    pub at: Vector<f64>,
    /// The axis on body a in the reference configuration, of any length.
    pub axis_a: Vector<f64>,
    /// The axis on body b in the reference configuration, perpendicular to that on body a.
    pub axis_b: Vector<f64>,
}

impl Constraint for Universal {
    const NAME: &'static str = "universal joint";
    type Error = JointError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), JointError> {
        check_turns(&self.a, &self.b)?;
        let cross = perpendicular_axes(self.axis_a, self.axis_b)?;
        coincident(sink, "", &self.a, &self.b, self.at);
        relative(sink, "cross", &self.a, &self.b, cross);
        Ok(())
    }
}
