//! `*TRANSFORM` and `*ORIENTATION`: local axes from two points a and b.
//!
//! Rectangular axes: the first axis points to a, and b lies in the plane of the first two axes. Cylindrical axes: the third axis points
//! from a to b, and the first axis is radial.

use rustc_hash::FxHashMap;

use crate::deck::Problem;
use crate::deck::calculix::model::{AxesCard, DeckDefinitions};
use crate::deck::calculix::syntax::{self, DataLines, DataPiece, Scope, float};
use crate::deck::kinematics::axes::{BASIC_AXES, Frame, FrameKind};
use crate::deck::kinematics::vector::{Vector, cross, minus, unit};

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
        self.placed(axes.scope, local(axes.is_cylindrical, &axes.data)?)
    }
}

fn local(cylindrical: bool, data: &[DataPiece]) -> Result<Frame, Problem> {
    let [a, b] = two_points(DataLines::new(data).take(1).flat_map(|line| line.fields()))?;
    let axes = if cylindrical { around(a, b) } else { along(a, b) };
    axes.ok_or_else(|| Problem::Degenerate { what: "the two points define no axes".into() })
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
