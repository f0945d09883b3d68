//! `*TRANSFORM` and `*ORIENTATION`: local axes from two points a and b.
//!
//! Rectangular axes: the first axis points from the origin c to a, and b lies in the plane of the first two axes; ccx knows no c. Cylindrical
//! axes: the third axis points from a to b, and the first axis is radial. A second line of `*ORIENTATION` turns rectangular axes about one of them.

use rustc_hash::FxHashMap;

use crate::deck::Problem;
use crate::deck::calculix::model::{AxesCard, AxesKind, DeckDefinitions, LocalAxes};
use crate::deck::calculix::syntax::parameters::undefined;
use crate::deck::calculix::syntax::{self, DataLines, Scope, float, number};
use crate::deck::kinematics::axes::{BASIC_AXES, Frame, FrameKind};
use crate::deck::kinematics::vector::{Vector, cross, minus, unit};
use crate::fault::quote;

/// What a card needs if the kind of its axes is [`AxesKind::Other`].
const OTHER: &str = "axes that are neither rectangular nor cylindrical";

impl DeckDefinitions {
    /// The local axes of each node that `*TRANSFORM` names.
    pub fn locals(&self) -> Result<LocalAxes, Problem> {
        let mut locals = FxHashMap::default();
        for (set, axes) in &self.transforms {
            let local = match self.placed_axes(axes) {
                Err(problem @ Problem::NotFollowed { .. }) => Err(problem),
                known => Ok(known?),
            };
            locals.extend(self.nodes(axes.scope, set)?.iter().map(|&node| (node, local.clone())));
        }
        Ok(locals)
    }

    /// The axes that the `*ORIENTATION` with this name defines.
    pub fn orientation(&self, scope: Scope, name: &str) -> Result<Frame, Problem> {
        let name = syntax::fold_name(name);
        match self.find(&self.orientations, scope, &name) {
            Some((_, axes)) => self.placed_axes(axes),
            None => Err(undefined("orientation", name)),
        }
    }

    fn placed_axes(&self, axes: &AxesCard) -> Result<Frame, Problem> {
        self.placed(axes.scope, self.local(axes)?)
    }

    /// The frame that the points a, b and, in Abaqus, the origin c define.
    fn local(&self, AxesCard { kind, has_points, data, .. }: &AxesCard) -> Result<Frame, Problem> {
        let mut lines = DataLines::new(data);
        let first = lines.next();
        let fields = || first.into_iter().flat_map(|line| line.fields());
        let unknown = |what: &str| Problem::NotFollowed { what: what.into() };
        if self.is_abaqus && !has_points {
            return Err(unknown("axes that nodes define"));
        }
        if self.is_abaqus && *kind == AxesKind::Other {
            return Err(unknown(OTHER));
        }
        let [a, b] = two_points(fields())?;
        let c = if self.is_abaqus {
            [6, 7, 8].map(|k| fields().nth(k).filter(|field| !field.is_empty()))
        } else {
            [None; 3]
        };
        let [x, y, z] = c.map(|field| field.map_or(Ok(0.0), float));
        let c = [x?, y?, z?];
        let axes = match kind {
            AxesKind::Cylindrical => around(a, b),
            AxesKind::ZRectangular if self.is_abaqus => Frame::through(FrameKind::Rectangular, c, a, b),
            _ => along(minus(a, c), minus(b, c)),
        };
        let mut frame = axes.ok_or_else(|| match kind {
            AxesKind::Other => unknown(OTHER),
            _ => Problem::Degenerate { what: "the two points define no axes".into() },
        })?;
        if let Some(line) = lines.next() {
            let mut fields = line.fields();
            let axis = fields.next().unwrap_or_default();
            let angle = fields.next().filter(|field| !field.is_empty()).map_or(Ok(0.0), float)?;
            if let Some(axis) = self.turned_axis(axis)?.filter(|_| angle != 0.0) {
                Self::turn(&mut frame, axis, angle)?;
            }
        }
        Ok(frame)
    }

    /// The axis, from 0, in the second line of `*ORIENTATION`. The default is the first one in Abaqus; ccx turns about no other number than 1,
    /// 2 and 3, and so by default about none.
    fn turned_axis(&self, field: &[u8]) -> Result<Option<usize>, Problem> {
        let given = if field.is_empty() { u32::from(self.is_abaqus) } else { number(field, "an axis from 1 to 3")? };
        match given {
            1..=3 => Ok(Some(given as usize - 1)),
            _ if self.is_abaqus => Err(Problem::Expected { expected: "an axis from 1 to 3", found: quote(field) }),
            _ => Ok(None),
        }
    }

    /// Turns rectangular axes about one of them by an angle in degrees.
    fn turn(frame: &mut Frame, axis: usize, angle: f64) -> Result<(), Problem> {
        if frame.kind != FrameKind::Rectangular {
            let what = "cylindrical axes with an additional rotation (where ccx stops)".into();
            return Err(Problem::NotFollowed { what });
        }
        let (sin, cos) = angle.to_radians().sin_cos();
        let [j, k] = [(axis + 1) % 3, (axis + 2) % 3];
        let (p, q) = (frame.axes[j], frame.axes[k]);
        frame.axes[j] = std::array::from_fn(|i| cos * p[i] + sin * q[i]);
        frame.axes[k] = std::array::from_fn(|i| cos * q[i] - sin * p[i]);
        Ok(())
    }
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

/// Rectangular axes: a is on the first axis, and b in the plane of the first two; `None` if they are on a line with the origin.
pub fn along(a: Vector, b: Vector) -> Option<Frame> {
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
