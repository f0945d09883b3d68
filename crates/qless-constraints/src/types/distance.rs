//! `c = (|x_b - x_a|^2 - L^2) / (2 L)`: two points at a fixed distance, such as the ends of a rod.
//!
//! c is quadratic in the positions, so its Hessian is constant for nodes. c is a length: near the solution
//! `c = |x_b - x_a| - L` to first order.

use crate::geometry::node::{Node, moved, separation};
use crate::scalar::Scalar;
use crate::scalar::vector::{Vector, dot, sub};
use crate::types::joints::attachment::{BodyPoint, PointFunction, on_points};
use crate::{Constraint, EquationSink, Nonlinear};

/// Two points at a fixed distance: nodes in D dimensions, or points of bodies ([`BodyPoint`]).
///
#[doc = include_str!("../../docs/pictures/distance.svg")]
///
#[doc = include_str!("../../docs/types/distance.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Distance, PlanarPoint}};
/// let a = PlanarPoint::new([0, 1], [0.0, 0.0]);
/// let b = PlanarPoint::new([2, 3], [0.0, 2.0]);
/// let mut builder = ConstraintSet::builder(4);
/// builder.add("rod", Distance::new(a, b))?;
/// let set = builder.build()?;
/// let mut evaluation = set.allocate();
/// set.evaluate(&[0.0; 4], &mut evaluation)?;
/// // The unit vector along the rod.
/// assert_eq!(evaluation.g().values(), [0.0, -1.0, 0.0, 1.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distance<P> {
    /// One end.
    pub a: P,
    /// The other end.
    pub b: P,
    /// The distance L, a length; `None` for the distance at u = 0.
    pub length: Option<f64>,
}

/// What can be wrong with a distance.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DistanceError {
    /// The length is not a positive number.
    #[error("the length is {0}; it must be positive (for nodes in one place use equal DOFs)")]
    Length(f64),
}

impl<P> Distance<P> {
    /// Keeps the distance at u = 0.
    pub fn new(a: P, b: P) -> Self {
        Self { a, b, length: None }
    }

    /// The length, checked; `at_rest` is the distance at u = 0.
    fn checked_length(&self, sink: &mut EquationSink, at_rest: f64) -> Result<f64, DistanceError> {
        let length = self.length.unwrap_or(at_rest);
        sink.length(length);
        if length > 0.0 && length.is_finite() { Ok(length) } else { Err(DistanceError::Length(length)) }
    }
}

impl<const D: usize> Constraint for Distance<Node<D>> {
    const NAME: &'static str = "distance";
    type Error = DistanceError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), DistanceError> {
        let length = self.checked_length(sink, separation(&self.a.at, &self.b.at))?;
        let between = std::array::from_fn(|k| self.b.at[k] - self.a.at[k]);
        [self.a, self.b].iter().for_each(|node| sink.coordinates_of(node));
        let dofs = [self.a.dofs, self.b.dofs];
        sink.nonlinear("", dofs.as_flattened(), RodParameters::<D> { between, length });
        Ok(())
    }
}

impl Constraint for Distance<BodyPoint> {
    const NAME: &'static str = "distance";
    type Error = DistanceError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), DistanceError> {
        let length = self.checked_length(sink, separation(&self.a.at, &self.b.at))?;
        on_points(sink, [self.a, self.b], Apart { length });
        Ok(())
    }
}

/// `c = (|x_b - x_a|^2 - L^2) / (2 L)` for the points `x_a` and `x_b` and the length L.
pub(super) struct Apart {
    pub length: f64,
}

impl PointFunction for Apart {
    const EQUATION_NAMES: &'static [&'static str] = &[""];

    fn value<S: Scalar>(&self, points: &[Vector<S>], c: &mut [S]) {
        let between = sub(points[1], points[0]);
        c[0] = (dot(between, between) - S::from(self.length * self.length)) / S::from(2.0 * self.length);
    }
}

/// The parameters of [`Distance`]: `x_b - x_a` at u = 0, and L.
struct RodParameters<const D: usize> {
    between: [f64; D],
    length: f64,
}

impl<const D: usize> Nonlinear for RodParameters<D> {
    const DOFS: usize = 2 * D;
    const NUMBERS: &'static [usize] = &[0, 1, 0];
    const EQUATION_NAMES: &'static [&'static str] = &[""];

    fn value<S: Scalar>(&self, u: &[S], c: &mut [S]) {
        let to_b = moved(&self.between, u, D);
        let square = (0..D).fold(S::from(0.0), |sum, k| {
            let d = to_b[k] - u[k];
            sum + d * d
        });
        c[0] = (square - S::from(self.length * self.length)) / S::from(2.0 * self.length);
    }

    /// The pairs of `H = [I -I; -I I] / L` with the length L.
    fn pairs(&self, _: usize, pair: &mut dyn FnMut(usize, usize)) {
        for k in 0..D {
            pair(k, k);
            pair(D + k, k);
            pair(D + k, D + k);
        }
    }

    #[inline]
    fn value_and_jacobian(&self, u: &[f64], c: &mut [f64], g: &mut [f64]) {
        let ((a, b), (to_a, to_b)) = (u.split_at(D), g.split_at_mut(D));
        let (mut square, scale) = (0.0, 1.0 / self.length);
        for k in 0..D {
            let d = self.between[k] + b[k] - a[k];
            square += d * d;
            to_b[k] = d * scale;
            to_a[k] = -to_b[k];
        }
        c[0] = (square - self.length * self.length) * 0.5 * scale;
    }

    #[inline]
    fn hessian(&self, _: &[f64], w: &[f64], h: &mut [f64]) {
        let value = w[0] / self.length;
        (h[0], h[1]) = (value, -value);
    }
}
