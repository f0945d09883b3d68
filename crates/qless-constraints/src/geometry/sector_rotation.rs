//! `x' = c + R (x - c)`: the rotation from one sector of a cyclic model to the next.

use super::rotation::by_vector;
use crate::scalar::SUM_ROUNDING;
use crate::scalar::vector::{Vector, scale, unit};

/// A rotation R by an angle about an axis in space, or a centre in the plane: `x' = c + R (x - c)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn<const D: usize> {
    centre: [f64; D],
    /// The rotation matrix R, row by row.
    pub(crate) rotation: [[f64; D]; D],
    pub(crate) angle: f64,
}

/// Sets an entry of a rotation matrix to zero if it is only rounding. Quarter and full turns have no exact angle in
/// floating point, and noise of 1e-16 would become a coefficient and change the rank.
fn snap_to_zero(x: f64, angle: f64) -> f64 {
    if x.abs() <= SUM_ROUNDING * angle.abs().max(1.0) { 0.0 } else { x }
}

/// Sine and cosine; values that are only rounding are exactly zero.
pub fn sin_cos(angle: f64) -> (f64, f64) {
    let (sin, cos) = angle.sin_cos();
    (snap_to_zero(sin, angle), snap_to_zero(cos, angle))
}

/// Error: the axis has no direction.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("the axis {axis:?} has no direction; give a vector that is finite and not zero")]
pub struct TurnError {
    /// The axis.
    pub axis: [f64; 3],
}

impl Turn<3> {
    /// A rotation by an angle in radians about the axis through `centre`. The axis may have any length.
    ///
    /// # Errors
    /// [`TurnError`] if the axis has no direction.
    pub fn about(centre: Vector<f64>, axis: Vector<f64>, angle: f64) -> Result<Self, TurnError> {
        let direction = unit(axis).ok_or(TurnError { axis })?;
        let turn = |s| by_vector(scale(angle, direction), s);
        let columns = [turn([1.0, 0.0, 0.0]), turn([0.0, 1.0, 0.0]), turn([0.0, 0.0, 1.0])];
        let rotation = std::array::from_fn(|i| std::array::from_fn(|j| snap_to_zero(columns[j][i], angle)));
        Ok(Self { centre, rotation, angle })
    }
}

impl Turn<2> {
    /// A counter-clockwise rotation in the plane about `centre`, by an angle in radians.
    pub fn in_plane(centre: [f64; 2], angle: f64) -> Self {
        let (sin, cos) = sin_cos(angle);
        Self { centre, rotation: [[cos, -sin], [sin, cos]], angle }
    }
}

impl<const D: usize> Turn<D> {
    /// The image of a point.
    pub(crate) fn image(&self, place: [f64; D]) -> [f64; D] {
        std::array::from_fn(|i| {
            self.centre[i] + (0..D).map(|j| self.rotation[i][j] * (place[j] - self.centre[j])).sum::<f64>()
        })
    }
}
