//! `e_i . (p - a) = 0`, `i = 1, 2`: a node p on a line through a, with unit vectors `e_i` perpendicular to the line. If the line is given
//! by two nodes a and b, `e_i` rotate with it.
//!
//! Let D be the direction of the line at u = 0, and `d = (b - a) / |b - a|` its current direction. The initial directions `E_i` are
//! perpendicular to D. The shortest rotation from D to d rotates them to `e_i = E_i - (E_i.d) (D + d) / (1 + D.d)`, unit vectors
//! perpendicular to d and to each other. This formula is singular for `d = -D`, so beyond 123 degrees the rotation starts from -D instead,
//! and `e_i` jump. A jump is unavoidable: no choice of `e_i` is continuous for all directions d.

use crate::geometry::node::{Point, separation};
use crate::scalar::vector::{Vector, add, dot, lift, norm, perpendicular, scale, sub, unit};
use crate::scalar::{NO_EXTENT, Scalar};
use crate::types::joints::attachment::{BodyPoint, PointFunction, on_points};
use crate::{Constraint, EquationSink};

/// Value of `D.d`, with the initial direction D and the current direction d of the line, below which the rotation starts from -D. It is not
/// a round angle, so models are unlikely to be at the jump.
const TURNED: f64 = -0.55;

/// The line that a node stays on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Line<P = Point> {
    /// A fixed line. If the point is a node, the equations are linear.
    Fixed {
        /// Coordinates of a point of the line.
        through: Vector<f64>,
        /// Direction of the line, a vector of any length.
        direction: Vector<f64>,
    },
    /// The line through two nodes or points of bodies, which may move. If they coincide, the line has no direction and c is NaN.
    Nodes(P, P),
}

/// A node, or a point of a body ([`BodyPoint`]), on a line: `c_i = e_i . (p - a)`, two lengths.
///
/// p is the point and a is a point of the line. `e_1` and `e_2` are unit vectors perpendicular to the line and to each
/// other.
///
/// `|c|` is the distance from the line. If the line goes through nodes, `e_i` rotate with it. When it has rotated by
/// 123 degrees from u = 0, `e_i` are redefined: c jumps, but `|c|` does not.
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
pub struct OnLine<P = Point> {
    /// The node, or the point of a body.
    pub point: P,
    /// The line.
    pub line: Line<P>,
}

/// What can be wrong with a line.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum OnLineError {
    /// The line has no direction.
    #[error("the line has no direction: its vector is zero, or its nodes coincide")]
    Direction,
}

/// Names of the two equations.
const SIDES: [&str; 2] = ["side 1", "side 2"];

/// Two unit vectors perpendicular to the line and to each other.
fn across(along: Vector<f64>) -> Result<[Vector<f64>; 2], OnLineError> {
    unit(along).map(perpendicular).ok_or(OnLineError::Direction)
}

impl Constraint for OnLine {
    const NAME: &'static str = "point on line";
    type Error = OnLineError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), OnLineError> {
        match self.line {
            Line::Fixed { through, direction } => {
                for (part, e) in SIDES.into_iter().zip(across(direction)?) {
                    let terms = self.point.dofs.into_iter().zip(e);
                    sink.equation(part, terms, dot(e, sub(through, self.point.at)));
                }
                Ok(())
            }
            Line::Nodes(a, b) => {
                let [point, a, b] = [self.point, a, b].map(BodyPoint::from);
                OnLine { point, line: Line::Nodes(a, b) }.emit(sink)
            }
        }
    }
}

impl Constraint for OnLine<BodyPoint> {
    const NAME: &'static str = "point on line";
    type Error = OnLineError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), OnLineError> {
        match self.line {
            Line::Fixed { through, direction } => {
                sink.numbers(through);
                on_points(sink, [self.point], FixedLine { through, across: across(direction)? });
            }
            Line::Nodes(a, b) => {
                let along = sub(b.at, a.at);
                let across = across(along)?;
                sink.length(separation(&a.at, &b.at));
                on_points(
                    sink,
                    [self.point, a, b],
                    MovingLine { along: unit(along).unwrap_or(along), length: norm(along), across },
                );
            }
        }
        Ok(())
    }
}

/// A fixed line.
struct FixedLine {
    through: Vector<f64>,
    across: [Vector<f64>; 2],
}

impl PointFunction for FixedLine {
    const EQUATION_NAMES: &'static [&'static str] = &SIDES;

    fn value<S: Scalar>(&self, points: &[Vector<S>], c: &mut [S]) {
        let off = sub(points[0], lift(self.through));
        c.iter_mut().zip(self.across).for_each(|(c, e)| *c = dot(lift(e), off));
    }
}

/// The parameters of a line through two nodes.
struct MovingLine {
    /// D, the direction of the line at u = 0.
    along: Vector<f64>,
    /// The length of the line at u = 0.
    length: f64,
    /// Two unit vectors `E_i` perpendicular to D and to each other.
    across: [Vector<f64>; 2],
}

impl MovingLine {
    /// The direction from which the vectors across the line are rotated: that of the line at u = 0, or its opposite beyond 123 degrees.
    fn origin(&self, along: Vector<f64>) -> Vector<f64> {
        scale(if dot(along, self.along) < TURNED { -1.0 } else { 1.0 }, self.along)
    }

    /// The length of the line, NaN if it has collapsed.
    fn checked<S: Scalar>(&self, length: S) -> S {
        if length.real() > NO_EXTENT * self.length { length } else { S::from(f64::NAN) }
    }
}

impl PointFunction for MovingLine {
    const EQUATION_NAMES: &'static [&'static str] = &SIDES;

    fn value<S: Scalar>(&self, points: &[Vector<S>], c: &mut [S]) {
        let (off, along) = (sub(points[0], points[1]), sub(points[2], points[1]));
        let along = scale(S::from(1.0) / self.checked(norm(along)), along);
        let both = add(lift(self.origin(along.map(Scalar::real))), along);
        let half = S::from(0.5) * dot(both, both);
        for (c, e) in c.iter_mut().zip(self.across.map(lift)) {
            *c = dot(e, off) - dot(e, along) * dot(both, off) / half;
        }
    }
}
