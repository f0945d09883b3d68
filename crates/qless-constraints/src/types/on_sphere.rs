//! `c = (|x - m|^2 - R^2) / (2 R)`: a node on a fixed sphere or circle with centre m and radius R, such as the tip of
//! an arm hinged to the ground.

use crate::geometry::node::{Node, moved, separation};
use crate::scalar::Scalar;
use crate::types::Body;
use crate::types::distance::Apart;
use crate::types::joints::attachment::{BodyPoint, on_points};
use crate::{Constraint, EquationSink, Nonlinear};

/// A node on a fixed sphere (D = 3) or circle (D = 2), or a point of a body ([`BodyPoint`]) on a sphere.
///
#[doc = include_str!("../../docs/pictures/on_sphere.svg")]
///
#[doc = include_str!("../../docs/types/on_sphere.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{OnSphere, PlanarPoint}};
/// let tip = PlanarPoint::new([0, 1], [0.0, 2.0]);
/// let mut builder = ConstraintSet::builder(2);
/// builder.add("arm", OnSphere { point: tip, centre: [0.0, 0.0], radius: None })?;
/// let set = builder.build()?;
/// let mut evaluation = set.allocate();
/// set.evaluate(&[2.0, -2.0], &mut evaluation)?;
/// assert_eq!((evaluation.c()[0], &evaluation.g().values()[..]), (0.0, &[1.0, 0.0][..]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnSphere<P, const D: usize> {
    /// The node, or the point of a body.
    pub point: P,
    /// The centre m, coordinates.
    pub centre: [f64; D],
    /// The radius R, a length; `None` for the distance at u = 0.
    pub radius: Option<f64>,
}

/// What can be wrong with a sphere.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OnSphereError {
    /// The radius is not a positive number.
    #[error("the radius is {0}; it must be positive")]
    Radius(f64),
}

impl<P, const D: usize> OnSphere<P, D> {
    /// The radius, checked; `at` is the point at u = 0.
    fn checked_radius(&self, sink: &mut EquationSink, at: &[f64; D]) -> Result<f64, OnSphereError> {
        let radius = self.radius.unwrap_or_else(|| separation(at, &self.centre));
        sink.length(radius);
        sink.numbers(self.centre);
        if radius > 0.0 && radius.is_finite() { Ok(radius) } else { Err(OnSphereError::Radius(radius)) }
    }
}

impl Constraint for OnSphere<BodyPoint, 3> {
    const NAME: &'static str = "point on sphere";
    type Error = OnSphereError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), OnSphereError> {
        let length = self.checked_radius(sink, &self.point.at)?;
        on_points(sink, [Body::ground().point(self.centre), self.point], Apart { length });
        Ok(())
    }
}

impl<const D: usize> Constraint for OnSphere<Node<D>, D> {
    const NAME: &'static str = "point on sphere";
    type Error = OnSphereError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), OnSphereError> {
        let radius = self.checked_radius(sink, &self.point.at)?;
        let from = std::array::from_fn(|k| self.point.at[k] - self.centre[k]);
        sink.coordinates_of(&self.point);
        sink.nonlinear("", &self.point.dofs, Sphere::<D> { from, radius });
        Ok(())
    }
}

/// The parameters of [`OnSphere`]: `x - m` at u = 0, and R.
struct Sphere<const D: usize> {
    from: [f64; D],
    radius: f64,
}

impl<const D: usize> Nonlinear for Sphere<D> {
    const DOFS: usize = D;
    const NUMBERS: &'static [usize] = &[0];
    const EQUATION_NAMES: &'static [&'static str] = &[""];

    fn value<S: Scalar>(&self, u: &[S], c: &mut [S]) {
        let x = moved(&self.from, u, 0);
        let square = x.iter().fold(S::from(0.0), |sum, &x| sum + x * x);
        c[0] = (square - S::from(self.radius * self.radius)) / S::from(2.0 * self.radius);
    }

    /// The pairs of `H = I / R` with the radius R.
    fn pairs(&self, _: usize, pair: &mut dyn FnMut(usize, usize)) {
        (0..D).for_each(|k| pair(k, k));
    }

    #[inline]
    fn value_and_jacobian(&self, u: &[f64], c: &mut [f64], g: &mut [f64]) {
        let (mut square, scale) = (0.0, 1.0 / self.radius);
        for k in 0..D {
            let x = self.from[k] + u[k];
            square += x * x;
            g[k] = x * scale;
        }
        c[0] = (square - self.radius * self.radius) * 0.5 * scale;
    }

    #[inline]
    fn hessian(&self, _: &[f64], w: &[f64], h: &mut [f64]) {
        h[0] = w[0] / self.radius;
    }
}
