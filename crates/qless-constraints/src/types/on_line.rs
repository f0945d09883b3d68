//! `e_i . (p - a) = 0`, `i = 1, 2`: a node on a line. If the line is given by two nodes, `e_i` rotate with it.
//!
//! Let D be the direction of the line at u = 0, and `d = (b - a) / |b - a|` its current direction. The shortest
//! rotation from D to d rotates the initial directions `E_i` across the line to
//! `e_i = E_i - (E_i.d) (D + d) / (1 + D.d)`, unit vectors perpendicular to d and to each other. It is singular for d =
//! -D, so that beyond 123 degrees the rotation starts from -D instead. No frame is continuous for all directions.

use crate::geometry::node::{Point, moved, separation};
use crate::scalar::Scalar;
use crate::scalar::vector::{Vector, add, dot, lift, norm, perpendicular, scale, sub, unit};
use crate::{Constraint, EquationSink, Nonlinear};

/// Value of `D.d` below which the rotation starts from -D. Models are unlikely to be built at this angle.
const TURNED: f64 = -0.55;
/// A line shorter than this share of its initial length has no direction.
const COLLAPSED: f64 = 1e-12;

/// The line that a node stays on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Line {
    /// A fixed line: linear equations.
    Fixed {
        /// A point of it, coordinates.
        through: Vector<f64>,
        /// Its direction, of any length.
        direction: Vector<f64>,
    },
    /// The line through two nodes, which may move. If they coincide, the line has no direction and c is NaN.
    Nodes(Point, Point),
}

/// A node on a line: `c_i = e_i . (p - a)`, two lengths: the distances of the node from the line in two directions
/// across it.
///
/// `|c|` is the distance from the line. The directions rotate with a line through nodes. At a rotation of 123 degrees
/// from u = 0 they are redefined: c jumps, but `|c|` does not.
///
#[doc = include_str!("../../docs/pictures/on_line.svg")]
///
#[doc = include_str!("../../docs/types/on_line.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Line, OnLine, Point}};
/// let at = |node: usize, x: f64| Point::new([3 * node, 3 * node + 1, 3 * node + 2], [x, 0.0, 0.0]);
/// let mut builder = ConstraintSet::builder(9);
/// builder.add("bead", OnLine { point: at(0, 0.3), line: Line::Nodes(at(1, 0.0), at(2, 1.0)) })?;
/// let set = builder.build()?;
/// // The line rises by 1, and so does the node, which also slides along it.
/// let mut evaluation = set.allocate();
/// set.evaluate(&[0.5, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0], &mut evaluation)?;
/// assert_eq!(evaluation.c(), [0.0; 2]);
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
    #[error("the line has no direction: its vector is zero, or its nodes coincide")]
    Direction,
}

impl Constraint for OnLine {
    const NAME: &'static str = "point on line";
    type Error = OnLineError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), OnLineError> {
        let along = match self.line {
            Line::Fixed { direction, .. } => direction,
            Line::Nodes(a, b) => sub(b.at, a.at),
        };
        let direction = unit(along).ok_or(OnLineError::Direction)?;
        let across = perpendicular(direction);
        match self.line {
            Line::Fixed { through, .. } => {
                for (part, e) in ["side 1", "side 2"].into_iter().zip(across) {
                    let terms = self.point.dofs.into_iter().zip(e);
                    sink.equation(part, terms, dot(e, sub(through, self.point.at)));
                }
            }
            Line::Nodes(a, b) => {
                let dofs = [self.point.dofs, a.dofs, b.dofs].concat();
                let (at, length) = ([self.point.at, a.at, b.at], norm(along));
                sink.length(separation(&a.at, &b.at));
                sink.numbers(at.into_iter().flatten());
                sink.nonlinear("", &dofs, MovingLine { at, along: direction, length, across });
            }
        }
        Ok(())
    }
}

/// The parameters of a line through two nodes.
struct MovingLine {
    at: [Vector<f64>; 3],
    /// D, the direction at u = 0.
    along: Vector<f64>,
    /// The length at u = 0.
    length: f64,
    /// The initial directions `E_i`.
    across: [Vector<f64>; 2],
}

impl MovingLine {
    /// The direction from which the frame is rotated: D, or -D beyond 123 degrees.
    fn origin(&self, along: Vector<f64>) -> Vector<f64> {
        scale(if dot(along, self.along) < TURNED { -1.0 } else { 1.0 }, self.along)
    }

    /// The length of the line, NaN if it has collapsed.
    fn checked<S: Scalar>(&self, length: S) -> S {
        if length.real() > COLLAPSED * self.length { length } else { S::from(f64::NAN) }
    }
}

impl Nonlinear for MovingLine {
    const EQUATION_NAMES: &'static [&'static str] = &["side 1", "side 2"];

    fn value<S: Scalar>(&self, u: &[S], c: &mut [S]) {
        let [p, a, b] = [0, 1, 2].map(|node| moved(&self.at[node], u, 3 * node));
        let (off, along) = (sub(p, a), sub(b, a));
        let along = scale(S::from(1.0) / self.checked(norm(along)), along);
        let both = add(lift(self.origin(along.map(Scalar::real))), along);
        let half = S::from(0.5) * dot(both, both);
        for (c, e) in c.iter_mut().zip(self.across.map(lift)) {
            *c = dot(e, off) - dot(e, along) * dot(both, off) / half;
        }
    }

    /// All pairs, except those within the node itself.
    fn pairs(&self, dofs: usize, pair: &mut dyn FnMut(usize, usize)) {
        (3..dofs).for_each(|j| (0..=j).for_each(|k| pair(j, k)));
    }

    /// The node has the gradient `e_i`. With `v = dc_i / dd`, the end b has `(v - (v.d) d) / l`; the end a makes the
    /// sum zero.
    fn value_and_jacobian(&self, u: &[f64], c: &mut [f64], g: &mut [f64]) {
        let [p, a, b] = [0, 1, 2].map(|node| moved(&self.at[node], u, 3 * node));
        let (off, along) = (sub(p, a), sub(b, a));
        let inverse = 1.0 / self.checked(norm(along));
        let along = scale(inverse, along);
        let both = add(self.origin(along), along);
        let (half, height) = (0.5 * dot(both, both), dot(both, off));
        for ((c, g), across) in c.iter_mut().zip(g.chunks_exact_mut(9)).zip(self.across) {
            let lean = dot(across, along) / half;
            let e = sub(across, scale(lean, both));
            *c = dot(e, off);
            // half = 1 + D.d, with the derivative D = both - d.
            let by_lean = sub(across, scale(lean, sub(both, along)));
            let v = sub(scale(-height / half, by_lean), scale(lean, off));
            let of_b = scale(inverse, sub(v, scale(dot(v, along), along)));
            for k in 0..3 {
                (g[k], g[3 + k], g[6 + k]) = (e[k], -e[k] - of_b[k], of_b[k]);
            }
        }
    }
}
