//! Planar joint: a plate on a plate; `(R_a n) . (p_b - p_a) = 0`, `R_a n = R_b n`.

use super::attachment::Body;
use super::height::height;
use super::orientation::Tilt;
use super::relative::relative;
use super::{JointError, check_turns, direction};
use crate::scalar::vector::Vector;
use crate::{Constraint, EquationSink};

/// Body b moves in a plane of body a: `(R_a n) . (p_b - p_a) = 0` and the tilt of the normal, as in
/// [`super::Revolute`]. It slides in two directions and rotates about the normal.
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
    /// The body that slides on it.
    pub b: Body,
    /// A point of the plane in the reference configuration, coordinates.
    pub at: Vector<f64>,
    /// Its normal there, of any length.
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
