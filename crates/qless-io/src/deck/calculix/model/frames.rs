//! `*TRANSFORM` and `*ORIENTATION`: local axes from two points a and b.
//!
//! Rectangular axes: the first axis points to a, and b lies in the plane of the first two axes. Cylindrical axes: the third axis points
//! from a to b, and the first axis is radial. A second line of `*ORIENTATION` turns rectangular axes about one of them.

use rustc_hash::FxHashMap;

use crate::deck::Problem;
use crate::deck::calculix::model::{AxesCard, DeckDefinitions};
use crate::deck::calculix::syntax::{self, DataLines, DataPiece, Scope, float};
use crate::deck::kinematics::axes::{BASIC_AXES, Frame, FrameKind};
use crate::deck::kinematics::vector::{Vector, cross, minus, unit};
use crate::fault::quote;

impl DeckDefinitions {
    /// The local axes of each node that `*TRANSFORM` names.
    pub fn locals(&self) -> Result<FxHashMap<u32, Frame>, Problem> {
        let mut locals = FxHashMap::default();
        for (set, axes) in &self.transforms {
            let local = self.placed_axes(axes)?;
            locals.extend(self.nodes(axes.scope, set)?.iter().map(|&node| (node, local)));
        }
        Ok(locals)
    }

    /// The axes that the `*ORIENTATION` with this name defines.
    pub fn orientation(&self, scope: Scope, name: &str) -> Result<Frame, Problem> {
        let name = syntax::fold_name(name);
        match self.find(&self.orientations, scope, &name) {
            Some((_, axes)) => self.placed_axes(axes),
            None => Err(Problem::Undefined { what: "orientation", name }),
        }
    }

    fn placed_axes(&self, axes: &AxesCard) -> Result<Frame, Problem> {
        self.placed(axes.scope, local(axes.kind, &axes.data)?)
    }
}

fn local(kind: Option<FrameKind>, data: &[DataPiece]) -> Result<Frame, Problem> {
    let mut lines = DataLines::new(data);
    let [a, b] = two_points(lines.next().into_iter().flat_map(|line| line.fields()))?;
    let degenerate = |what: &str| Problem::Degenerate { what: what.into() };
    let axes = match kind {
        Some(FrameKind::Rectangular) => along(a, b),
        Some(FrameKind::Cylindrical) => around(a, b),
        _ => return Err(degenerate("axes that are neither rectangular nor cylindrical are not supported")),
    };
    let mut frame = axes.ok_or_else(|| degenerate("the two points define no axes"))?;
    if let Some(line) = lines.next() {
        let mut fields = line.fields();
        let axis = fields.next().unwrap_or_default();
        let angle = fields.next().filter(|field| !field.is_empty()).map_or(Ok(0.0), float)?;
        if angle != 0.0 {
            turn(&mut frame, turned_axis(axis)?, angle)?;
        }
    }
    Ok(frame)
}

/// The axis, from 0, in the second line of `*ORIENTATION`. Without an axis, Abaqus turns about the first one, and ccx does not turn.
fn turned_axis(field: &[u8]) -> Result<usize, Problem> {
    let axis = [b"1", b"2", b"3"].iter().position(|axis| field == *axis);
    axis.ok_or_else(|| Problem::Expected { expected: "an axis from 1 to 3", found: quote(field) })
}

/// Turns rectangular axes about one of them by an angle in degrees.
fn turn(frame: &mut Frame, axis: usize, angle: f64) -> Result<(), Problem> {
    if frame.kind != FrameKind::Rectangular {
        return Err(Problem::Degenerate {
            what: "cylindrical axes with an additional rotation are not supported".into(),
        });
    }
    let (sin, cos) = angle.to_radians().sin_cos();
    let [j, k] = [(axis + 1) % 3, (axis + 2) % 3];
    let (p, q) = (frame.axes[j], frame.axes[k]);
    frame.axes[j] = std::array::from_fn(|i| cos * p[i] + sin * q[i]);
    frame.axes[k] = std::array::from_fn(|i| cos * q[i] - sin * p[i]);
    Ok(())
}

/// Reads two points as six coordinates. Empty fields are zero.
pub fn two_points<'a>(fields: impl Iterator<Item = &'a [u8]>) -> Result<[Vector; 2], Problem> {
    let mut numbers = Vec::with_capacity(6);
    for field in fields.take(6) {
        numbers.push(if field.is_empty() { 0.0 } else { float(field)? });
    }
    let [ax, ay, az, bx, by, bz] = numbers[..] else {
        return Err(Problem::TooFew { what: "coordinates of two points", promised: 6, found: numbers.len() });
    };
    Ok([[ax, ay, az], [bx, by, bz]])
}

fn along(a: Vector, b: Vector) -> Option<Frame> {
    let first = unit(a)?;
    let third = unit(cross(first, unit(b)?))?;
    Some(Frame { kind: FrameKind::Rectangular, origin: [0.0; 3], axes: [first, cross(third, first), third] })
}

/// Cylindrical axes around the line between two points; `None` if they coincide.
pub fn around(a: Vector, b: Vector) -> Option<Frame> {
    let axis = unit(minus(b, a))?;
    // Any direction perpendicular to the axis will do: the radial direction at a point does not depend on it.
    let least = (0..3).min_by(|&i, &j| axis[i].abs().total_cmp(&axis[j].abs()))?;
    let second = unit(cross(axis, BASIC_AXES[least]))?;
    Some(Frame { kind: FrameKind::Cylindrical, origin: a, axes: [cross(second, axis), second, axis] })
}
