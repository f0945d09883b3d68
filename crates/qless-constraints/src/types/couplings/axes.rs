//! `e_1, e_2, e_3`: the axes along which components of a node are taken.

use super::rows::clean;
use crate::scalar::vector::{Vector, cross, dot, norm, scale, sub, unit};

/// Sine of the angle between two directions below which they make no plane.
const PARALLEL: f64 = 1e-8;

/// Local axes, right-handed and of length one: rectangular ones, or the radial, the circumferential and the axial direction at a point.
///
/// ```
/// use qless_constraints::types::Axes;
/// let beam = Axes::new([1.0, 1.0, 0.0], [0.0, 1.0, 0.0])?;
/// let half = 0.5_f64.sqrt();
/// assert!((beam.rows()[1][0] + half).abs() < 1e-15 && beam.rows()[2] == [0.0, 0.0, 1.0]);
/// // On a bore along z through the origin: outwards, around, along.
/// let bore = Axes::cylindrical([0.0; 3], [0.0, 0.0, 2.0], [0.0, 3.0, 7.0])?;
/// assert_eq!(bore.rows(), [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
/// # Ok::<(), qless_constraints::types::AxesError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axes {
    rows: [Vector<f64>; 3],
}

/// Why there are no local axes.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AxesError {
    /// The vectors make no plane.
    #[error("{first:?} and {second:?} are parallel, zero or not finite; give two directions that differ")]
    NoPlane {
        /// The direction of an axis.
        first: Vector<f64>,
        /// What the plane goes through.
        second: Vector<f64>,
    },
}

impl Axes {
    /// The first axis along `x`, the second in the plane of `x` and `xy`, on its side; of any lengths.
    ///
    /// # Errors
    /// [`AxesError`] if the two are parallel to a part in 1e8, zero or not finite.
    pub fn new(x: Vector<f64>, xy: Vector<f64>) -> Result<Self, AxesError> {
        let fault = AxesError::NoPlane { first: x, second: xy };
        let (first, other) = (unit(x).ok_or(fault)?, unit(xy).ok_or(fault)?);
        let second = across(first, other).ok_or(fault)?;
        let third = unit(cross(first, second)).ok_or(fault)?;
        Ok(Self { rows: cleaned([first, second, third]) })
    }

    /// At the point `at`: away from the line through `origin` along `axis`, around it, and along it.
    ///
    /// # Errors
    /// [`AxesError`] if the point is on the line, to a part in 1e8 of its distance from `origin`.
    pub fn cylindrical(origin: Vector<f64>, axis: Vector<f64>, at: Vector<f64>) -> Result<Self, AxesError> {
        let arm = sub(at, origin);
        let fault = AxesError::NoPlane { first: axis, second: arm };
        let (along, away) = (unit(axis).ok_or(fault)?, unit(arm).ok_or(fault)?);
        let out = across(along, away).ok_or(fault)?;
        let around = unit(cross(along, out)).ok_or(fault)?;
        Ok(Self { rows: cleaned([out, around, along]) })
    }

    /// The three axes, one after the other.
    pub fn rows(&self) -> [Vector<f64>; 3] {
        self.rows
    }
}

/// The unit vector perpendicular to `e`, on the side of `other`.
fn across(e: Vector<f64>, other: Vector<f64>) -> Option<Vector<f64>> {
    let part = |x: Vector<f64>| sub(x, scale(dot(e, x), e));
    let rest = part(other);
    // Once more: what is left of the first is rounding that a short rest makes large.
    if norm(rest) > PARALLEL { unit(part(rest)) } else { None }
}

/// Components that are rounding would be coefficients.
fn cleaned(mut rows: [Vector<f64>; 3]) -> [Vector<f64>; 3] {
    rows.iter_mut().for_each(|row| clean(row.iter_mut(), 1.0));
    rows
}
