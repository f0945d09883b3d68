//! `n . (p - a) = 0`: a node on a plane. If the plane is given by three nodes a, b and d,
//! `n = (b - a) x (d - a) / |(b - a) x (d - a)|`.

use crate::geometry::node::{Point, rounding};
use crate::scalar::vector::{Vector, cross, dot, lift, norm, sub, unit};
use crate::scalar::{NO_EXTENT, Scalar};
use crate::types::joints::attachment::{BodyPoint, PointFunction, on_points};
use crate::{Constraint, EquationSink};

/// The plane that a node stays on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Plane<P = Point> {
    /// A fixed plane. If the point is a node, the equation is linear.
    Fixed {
        /// Coordinates of a point of the plane.
        through: Vector<f64>,
        /// Normal of the plane, a vector of any length.
        normal: Vector<f64>,
    },
    /// The plane through three nodes or points of bodies, which may move. If they are collinear, the plane has no normal and c is NaN.
    Nodes(P, P, P),
}

/// A node, or a point of a body ([`BodyPoint`]), on a plane: `c = n . (p - a)`, the height of the point p above the
/// plane, a length.
///
/// n is the unit normal and a is a point of the plane. If the plane goes through nodes, n rotates with it.
///
#[doc = include_str!("../../docs/pictures/on_plane.svg")]
///
#[doc = include_str!("../../docs/types/on_plane.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{OnPlane, Plane, Point}};
/// let ball = Point::new([0, 1, 2], [0.0, 0.0, 1.0]);
/// let table = Plane::Fixed { through: [0.0; 3], normal: [0.0, 0.0, 2.0] };
/// let mut builder = ConstraintSet::builder(3);
/// builder.add("table", OnPlane { point: ball, plane: table })?;
/// let set = builder.build()?;
/// let mut evaluation = set.allocate();
/// set.evaluate(&[0.7, 0.2, 0.0], &mut evaluation)?;
/// // The node is 1 above the plane.
/// assert_eq!(evaluation.c(), [1.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnPlane<P = Point> {
    /// The node, or the point of a body.
    pub point: P,
    /// The plane.
    pub plane: Plane<P>,
}

/// What can be wrong with a plane.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OnPlaneError {
    /// The plane has no normal.
    #[error(
        "the plane has no normal: its vector is zero, or its nodes are collinear up to the rounding of their coordinates"
    )]
    Normal,
}

impl Constraint for OnPlane {
    const NAME: &'static str = "point on plane";
    type Error = OnPlaneError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), OnPlaneError> {
        match self.plane {
            Plane::Fixed { through, normal } => {
                let n = unit(normal).ok_or(OnPlaneError::Normal)?;
                let terms = self.point.dofs.into_iter().zip(n).filter(|t| t.1 != 0.0);
                sink.equation("", terms, dot(n, sub(through, self.point.at)));
                Ok(())
            }
            Plane::Nodes(a, b, d) => {
                let [point, a, b, d] = [self.point, a, b, d].map(BodyPoint::from);
                OnPlane { point, plane: Plane::Nodes(a, b, d) }.emit(sink)
            }
        }
    }
}

impl Constraint for OnPlane<BodyPoint> {
    const NAME: &'static str = "point on plane";
    type Error = OnPlaneError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), OnPlaneError> {
        match self.plane {
            Plane::Fixed { through, normal } => {
                let normal = unit(normal).ok_or(OnPlaneError::Normal)?;
                sink.numbers(through);
                on_points(sink, [self.point], FixedPlane { through, normal });
            }
            Plane::Nodes(a, b, d) => {
                let (ab, ad) = (sub(b.at, a.at), sub(d.at, a.at));
                let (area, sides) = (norm(cross(ab, ad)), norm(ab).max(norm(ad)));
                // Far from the origin, the rounding of the coordinates gives even collinear nodes an area.
                let sound = area > NO_EXTENT * norm(ab) * norm(ad) && area > rounding(&[b.at, d.at], &a.at) * sides;
                if !sound {
                    return Err(OnPlaneError::Normal);
                }
                sink.length(area.sqrt());
                on_points(sink, [self.point, a, b, d], MovingPlane);
            }
        }
        Ok(())
    }
}

/// A fixed plane with a unit normal.
struct FixedPlane {
    through: Vector<f64>,
    normal: Vector<f64>,
}

impl PointFunction for FixedPlane {
    const EQUATION_NAMES: &'static [&'static str] = &[""];

    fn value<S: Scalar>(&self, points: &[Vector<S>], c: &mut [S]) {
        c[0] = dot(lift(self.normal), sub(points[0], lift(self.through)));
    }
}

/// A plane through three points. In `points`, the point on the plane comes first, then these three.
struct MovingPlane;

impl PointFunction for MovingPlane {
    const EQUATION_NAMES: &'static [&'static str] = &[""];

    /// Writes NaN if the three points of the plane are collinear.
    fn value<S: Scalar>(&self, points: &[Vector<S>], c: &mut [S]) {
        let [off, ab, ad] = [0, 2, 3].map(|k| sub(points[k], points[1]));
        let normal = cross(ab, ad);
        let size = |v: Vector<S>| norm(v.map(Scalar::real));
        let sound = size(normal) > NO_EXTENT * size(ab) * size(ad);
        c[0] = dot(off, normal) / if sound { norm(normal) } else { S::from(f64::NAN) };
    }
}
