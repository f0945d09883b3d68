//! `e_i . ((p - a) x (b - a)) / L = 0`, `i = 1, 2`: a node on the line through two others; `e_i . (p - a) = 0` on a fixed one.

use crate::geometry::node::{Point, moved};
use crate::scalar::Scalar;
use crate::scalar::vector::{Vector, cross, dot, lift, norm, perpendicular, scale, sub, unit};
use crate::{Constraint, Nonlinear, Store};

/// The line that a node stays on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Line {
    /// A line that does not move: linear equations.
    Fixed {
        /// A point of it, coordinates.
        through: Vector<f64>,
        /// Its direction, of any length.
        direction: Vector<f64>,
    },
    /// The line through two nodes. It may turn by less than a right angle from where it was at u = 0.
    Nodes(Point, Point),
}

/// A node on a line, two equations.
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Line, OnLine, Point}};
/// let at = |node: usize, x: f64| Point::new([3 * node, 3 * node + 1, 3 * node + 2], [x, 0.0, 0.0]);
/// let mut builder = ConstraintSet::builder(9);
/// builder.add("bead", OnLine { point: at(0, 0.3), line: Line::Nodes(at(1, 0.0), at(2, 1.0)) })?;
/// let set = builder.build()?;
/// // Both ends of the line rise by 1, and so does the bead, wherever it slides.
/// let mut quantities = set.allocate();
/// set.evaluate(&[0.5, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0], &mut quantities)?;
/// assert_eq!(quantities.c(), [0.0; 2]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnLine {
    /// The node.
    pub point: Point,
    /// The line.
    pub line: Line,
}

/// What can be wrong with a line.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OnLineError {
    /// The line has no direction.
    #[error("the line has no direction: its vector is zero, or its nodes are in one place")]
    Direction,
}

impl Constraint for OnLine {
    const NAME: &'static str = "point on line";
    type Error = OnLineError;

    fn process(self, store: &mut Store) -> Result<(), OnLineError> {
        let along = match self.line {
            Line::Fixed { direction, .. } => direction,
            Line::Nodes(a, b) => sub(b.at, a.at),
        };
        let across = perpendicular(unit(along).ok_or(OnLineError::Direction)?);
        match self.line {
            Line::Fixed { through, .. } => {
                for (part, e) in ["side 1", "side 2"].into_iter().zip(across) {
                    let terms = self.point.dofs.into_iter().zip(e);
                    store.equation(part, terms, dot(e, sub(through, self.point.at)));
                }
            }
            Line::Nodes(a, b) => {
                let dofs = [self.point.dofs, a.dofs, b.dofs].concat();
                let across = across.map(|e| scale(1.0 / norm(along), e));
                store.nonlinear("", &dofs, MovingLine { at: [self.point.at, a.at, b.at], across });
            }
        }
        Ok(())
    }
}

/// The stored parameters of a line through two nodes: coordinates, and `e_i / L`.
struct MovingLine {
    at: [Vector<f64>; 3],
    across: [Vector<f64>; 2],
}

impl Nonlinear for MovingLine {
    const PARTS: &'static [&'static str] = &["side 1", "side 2"];

    fn value<S: Scalar>(&self, u: &[S], c: &mut [S]) {
        let [p, a, b] = [0, 1, 2].map(|node| moved(&self.at[node], u, 3 * node));
        let off = cross(sub(p, a), sub(b, a));
        (0..2).for_each(|i| c[i] = dot(lift(self.across[i]), off));
    }

    /// Bilinear in the nodes: no node with itself, no component with itself.
    fn pairs(&self, dofs: usize, pair: &mut dyn FnMut(usize, usize)) {
        for j in 0..dofs {
            (0..j).filter(|k| k / 3 != j / 3 && k % 3 != j % 3).for_each(|k| pair(j, k));
        }
    }
}
