//! `(p - a) . ((b - a) x (d - a)) / (2 A) = 0`: a node on the plane through three others; `n . (p - a) = 0` on a fixed one.

use crate::geometry::node::{Point, moved};
use crate::scalar::Scalar;
use crate::scalar::vector::{Vector, cross, dot, norm, sub, unit};
use crate::{Constraint, Nonlinear, Store};

/// The plane that a node stays on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Plane {
    /// A plane that does not move: a linear equation.
    Fixed {
        /// A point of it, coordinates.
        through: Vector<f64>,
        /// Its normal, of any length.
        normal: Vector<f64>,
    },
    /// The plane through three nodes; A is the area of their triangle at u = 0.
    Nodes(Point, Point, Point),
}

/// A node on a plane, one equation.
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{OnPlane, Plane, Point}};
/// let ball = Point::new([0, 1, 2], [0.0, 0.0, 1.0]);
/// let table = Plane::Fixed { through: [0.0; 3], normal: [0.0, 0.0, 2.0] };
/// let mut builder = ConstraintSet::builder(3);
/// builder.add("table", OnPlane { point: ball, plane: table })?;
/// let set = builder.build()?;
/// let mut quantities = set.allocate();
/// set.evaluate(&[0.7, 0.2, 0.0], &mut quantities)?;
/// // It hovers at height 1.
/// assert_eq!(quantities.c(), [1.0]);
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
    #[error("the plane has no normal: its vector is zero, or its nodes lie in a line")]
    Normal,
}

impl Constraint for OnPlane {
    const NAME: &'static str = "point on plane";
    type Error = OnPlaneError;

    fn process(self, store: &mut Store) -> Result<(), OnPlaneError> {
        match self.plane {
            Plane::Fixed { through, normal } => {
                let n = unit(normal).ok_or(OnPlaneError::Normal)?;
                let terms = self.point.dofs.into_iter().zip(n).filter(|t| t.1 != 0.0);
                store.equation("", terms, dot(n, sub(through, self.point.at)));
            }
            Plane::Nodes(a, b, d) => {
                let (ab, ad) = (sub(b.at, a.at), sub(d.at, a.at));
                let area = norm(cross(ab, ad));
                let sound = area > 1e-12 * norm(ab) * norm(ad);
                if !sound {
                    return Err(OnPlaneError::Normal);
                }
                let at = [self.point.at, a.at, b.at, d.at];
                let dofs = [self.point.dofs, a.dofs, b.dofs, d.dofs].concat();
                store.nonlinear("", &dofs, MovingPlane { at, scale: 1.0 / area });
            }
        }
        Ok(())
    }
}

/// The stored parameters of a plane through three nodes: coordinates, and `1 / (2 A)`.
struct MovingPlane {
    at: [Vector<f64>; 4],
    scale: f64,
}

impl Nonlinear for MovingPlane {
    const PARTS: &'static [&'static str] = &[""];

    fn value<S: Scalar>(&self, u: &[S], c: &mut [S]) {
        let [p, a, b, d] = [0, 1, 2, 3].map(|node| moved(&self.at[node], u, 3 * node));
        c[0] = dot(sub(p, a), cross(sub(b, a), sub(d, a))) * S::from(self.scale);
    }

    /// Trilinear: no node with itself, no component with itself.
    fn pairs(&self, dofs: usize, pair: &mut dyn FnMut(usize, usize)) {
        for j in 0..dofs {
            (0..j).filter(|k| k / 3 != j / 3 && k % 3 != j % 3).for_each(|k| pair(j, k));
        }
    }
}
