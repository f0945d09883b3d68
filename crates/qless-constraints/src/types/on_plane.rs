//! `n . (p - a) = 0`: a node on a plane. If the plane is given by three nodes, `n = (b - a) x (d - a) / |(b - a) x (d
//! - a)|`.

use crate::geometry::node::{Point, moved, rounding};
use crate::scalar::Scalar;
use crate::scalar::vector::{Vector, cross, dot, norm, scale, sub, unit};
use crate::{Constraint, EquationSink, Nonlinear};

/// Nodes are collinear if the sine of their angle is below this.
const FLAT: f64 = 1e-12;

/// The plane that a node stays on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Plane {
    /// A fixed plane: a linear equation.
    Fixed {
        /// A point of it, coordinates.
        through: Vector<f64>,
        /// Its normal, of any length.
        normal: Vector<f64>,
    },
    /// The plane through three nodes, which may move. If they are collinear, the plane has no normal and c is NaN.
    Nodes(Point, Point, Point),
}

/// A node on a plane: `c = n . (p - a)`, a length: its height above the plane. The normal rotates with a plane through
/// nodes.
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
pub struct OnPlane {
    /// The node.
    pub point: Point,
    /// The plane.
    pub plane: Plane,
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
            }
            Plane::Nodes(a, b, d) => {
                let (ab, ad) = (sub(b.at, a.at), sub(d.at, a.at));
                let (area, sides) = (norm(cross(ab, ad)), norm(ab).max(norm(ad)));
                // Far from the origin, the rounding of the coordinates alone makes an area.
                let sound = area > FLAT * norm(ab) * norm(ad) && area > rounding(&[b.at, d.at], &a.at) * sides;
                if !sound {
                    return Err(OnPlaneError::Normal);
                }
                let at = [self.point.at, a.at, b.at, d.at];
                sink.length(area.sqrt());
                sink.numbers(at.into_iter().flatten());
                let dofs = [self.point.dofs, a.dofs, b.dofs, d.dofs].concat();
                sink.nonlinear("", &dofs, MovingPlane { at });
            }
        }
        Ok(())
    }
}

/// The parameters of a plane through three nodes: coordinates.
struct MovingPlane {
    at: [Vector<f64>; 4],
}

impl MovingPlane {
    /// `p - a`, `b - a`, `d - a`, their normal, and its length, which is NaN if the nodes are collinear.
    fn sides<S: Scalar>(&self, u: &[S]) -> ([Vector<S>; 4], S) {
        let [p, a, b, d] = [0, 1, 2, 3].map(|node| moved(&self.at[node], u, 3 * node));
        let (ab, ad) = (sub(b, a), sub(d, a));
        let normal = cross(ab, ad);
        let size = |v: Vector<S>| norm(v.map(Scalar::real));
        let sound = size(normal) > FLAT * size(ab) * size(ad);
        ([sub(p, a), ab, ad, normal], if sound { norm(normal) } else { S::from(f64::NAN) })
    }
}

impl Nonlinear for MovingPlane {
    const EQUATION_NAMES: &'static [&'static str] = &[""];

    fn value<S: Scalar>(&self, u: &[S], c: &mut [S]) {
        let ([off, _, _, normal], length) = self.sides(u);
        c[0] = dot(off, normal) / length;
    }

    /// All pairs, except those within the node itself.
    fn pairs(&self, dofs: usize, pair: &mut dyn FnMut(usize, usize)) {
        (3..dofs).for_each(|j| (0..=j).for_each(|k| pair(j, k)));
    }

    /// The node has the gradient n. With `m = dc / d((b - a) x (d - a)) = (p - a - c n) / |..|`, the corners b and d
    /// have `(d - a) x m` and `m x (b - a)`.
    fn value_and_jacobian(&self, u: &[f64], c: &mut [f64], g: &mut [f64]) {
        let ([off, ab, ad, normal], length) = self.sides(u);
        let n = scale(1.0 / length, normal);
        c[0] = dot(off, n);
        let m = scale(1.0 / length, sub(off, scale(c[0], n)));
        let (of_b, of_d) = (cross(ad, m), cross(m, ab));
        for k in 0..3 {
            (g[k], g[3 + k], g[6 + k], g[9 + k]) = (n[k], -n[k] - of_b[k] - of_d[k], of_b[k], of_d[k]);
        }
    }
}
