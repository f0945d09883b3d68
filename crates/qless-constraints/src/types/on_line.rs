//! `e_i . (p - a) = 0`, `i = 1, 2`: a node on a line; where the line goes through two nodes, `e_i` turn with it.
//!
//! From where the line points at u = 0, D, to where it points now, `d = (b - a) / |b - a|`, the directions E_i across it are carried the shortest way:
//! `e_i = E_i - (E_i.d) (D + d) / (1 + D.d)`, perpendicular to d and to each other, of length one. Where d is opposite to D there is no
//! shortest way: from 123 degrees on they are carried from -D. No frame could be carried to all directions.

use crate::geometry::node::{Point, moved, separation};
use crate::scalar::Scalar;
use crate::scalar::vector::{Vector, add, dot, lift, norm, perpendicular, scale, sub, unit};
use crate::{Constraint, Nonlinear, Store};

/// `D.d` from which the frame is carried from -D; no angle at which anything is built.
const TURNED: f64 = -0.55;
/// A line that is shorter than this part of its length at u = 0 has no direction.
const COLLAPSED: f64 = 1e-12;

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
    /// The line through two nodes, wherever they go. Where they are in one place it has no direction, and c is not a number.
    Nodes(Point, Point),
}

/// A node on a line: `c_i = e_i . (p - a)`, two lengths: how far the node is off the line, in two directions across it.
///
/// `|c|` is the distance. The directions turn with a line through nodes; where it has turned by 123 degrees from u = 0 they are chosen
/// anew, so that c jumps, with the same length. Multipliers are the force across the line, along `e_i`. Two degrees of freedom are
/// removed. Singular where the nodes of the line are in one place.
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
        let direction = unit(along).ok_or(OnLineError::Direction)?;
        let across = perpendicular(direction);
        match self.line {
            Line::Fixed { through, .. } => {
                for (part, e) in ["side 1", "side 2"].into_iter().zip(across) {
                    let terms = self.point.dofs.into_iter().zip(e);
                    store.equation(part, terms, dot(e, sub(through, self.point.at)));
                }
            }
            Line::Nodes(a, b) => {
                let dofs = [self.point.dofs, a.dofs, b.dofs].concat();
                let (at, length) = ([self.point.at, a.at, b.at], norm(along));
                store.length(separation(&a.at, &b.at));
                store.numbers(at.into_iter().flatten());
                store.nonlinear("", &dofs, MovingLine { at, along: direction, length, across });
            }
        }
        Ok(())
    }
}

/// The stored parameters of a line through two nodes.
struct MovingLine {
    at: [Vector<f64>; 3],
    /// D, where the line points at u = 0.
    along: Vector<f64>,
    /// Its length there.
    length: f64,
    /// E_i.
    across: [Vector<f64>; 2],
}

impl MovingLine {
    /// The direction that the frame is carried from: D, or -D where the line has turned farther.
    fn origin(&self, along: Vector<f64>) -> Vector<f64> {
        scale(if dot(along, self.along) < TURNED { -1.0 } else { 1.0 }, self.along)
    }

    /// The length of the line, not a number where nothing is left of it.
    fn checked<S: Scalar>(&self, length: S) -> S {
        if length.real() > COLLAPSED * self.length { length } else { S::from(f64::NAN) }
    }
}

impl Nonlinear for MovingLine {
    const PARTS: &'static [&'static str] = &["side 1", "side 2"];

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

    /// All but the node with itself.
    fn pairs(&self, dofs: usize, pair: &mut dyn FnMut(usize, usize)) {
        (3..dofs).for_each(|j| (0..=j).for_each(|k| pair(j, k)));
    }

    /// `e_i` for the node; with `v = dc_i / dd` the end b has `(v - (v.d) d) / l`, and the end a what makes the sum zero.
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
            // half = 1 + D.d, with the slope D = both - d.
            let by_lean = sub(across, scale(lean, sub(both, along)));
            let v = sub(scale(-height / half, by_lean), scale(lean, off));
            let of_b = scale(inverse, sub(v, scale(dot(v, along), along)));
            for k in 0..3 {
                (g[k], g[3 + k], g[6 + k]) = (e[k], -e[k] - of_b[k], of_b[k]);
            }
        }
    }
}
