//! Positions and axes of nodes, for pictures and for the equations of rigid regions.

use std::collections::HashMap;

use crate::deck::ansys::syntax::command::AnsysCommand;
use crate::deck::ansys::syntax::field::real;
use crate::deck::kinematics::axes::{BASIC_AXES, sine};
use crate::deck::kinematics::body::Pose;
use crate::deck::kinematics::vector::Vector;
use crate::number;

/// The axes after rotations by these angles about z, the new x and the new y.
fn rotated_axes([z, x, y]: [f64; 3]) -> [Vector; 3] {
    let [[cz, sz], [cx, sx], [cy, sy]] = [z, x, y].map(|degrees| [cosine(degrees), sine(degrees)]);
    [
        [cz * cy - sz * sx * sy, sz * cy + cz * sx * sy, -cx * sy],
        [-sz * cx, cz * cx, sx],
        [cz * sy + sz * sx * cy, sz * sy - cz * sx * cy, cx * cy],
    ]
}

fn cosine(degrees: f64) -> f64 {
    sine(90.0 - degrees.abs() % 360.0)
}

/// Positions and axes of nodes in the deck.
#[derive(Debug, Default)]
pub struct NodePositions {
    /// Positions by node; `None` if they are not needed.
    pub kept: Option<HashMap<u32, [f64; 3]>>,
    /// Angles of rotated nodes in degrees: about z, then the new x, then the new y.
    angles: HashMap<u32, [f64; 3]>,
    /// Whether a command rotated axes in a way that this reader does not follow.
    axes_unknown: bool,
    /// Whether the active coordinate system may differ from the global one.
    is_local: bool,
}

impl NodePositions {
    /// Keeps positions from now on.
    pub fn keep(&mut self) {
        self.kept = Some(HashMap::new());
    }

    /// `CSYS, KCN`, and commands that define a coordinate system, which becomes the active one.
    pub fn coordinate_system(&mut self, command: &AnsysCommand) {
        self.is_local = match &command.key {
            b"CSYS" => !command.field(1).iter().all(|&byte| byte == b'0'),
            b"LOCA" | b"CS  " | b"CLOC" | b"CSKP" => true,
            _ => self.is_local,
        };
    }

    /// `NROTAT` and other commands that rotate the axes of nodes.
    pub fn rotate(&mut self) {
        self.axes_unknown = true;
    }

    /// Position and axes of a node; `None` if either is unknown.
    pub fn pose(&self, node: u32) -> Option<Pose> {
        let position = *self.kept.as_ref().filter(|_| !self.axes_unknown)?.get(&node)?;
        let axes = self.angles.get(&node).map_or(BASIC_AXES, |angles| rotated_axes(*angles));
        Some(Pose { position, axes })
    }

    /// Sets the axes of a node; they are the global ones if all angles are 0.
    pub fn set_axes(&mut self, node: u32, angles: [f64; 3]) {
        if self.kept.is_none() {
            return;
        }
        if angles == [0.0; 3] {
            self.angles.remove(&node);
        } else {
            self.angles.insert(node, angles);
        }
    }

    /// A node of a block: the first three floats are its coordinates; missing ones are 0.
    pub fn row<'a>(&mut self, node: u32, mut floats: impl Iterator<Item = &'a [u8]>) {
        if let Some(kept) = &mut self.kept {
            let mut next = || floats.next().and_then(|text| number::real(text).ok()).unwrap_or(0.0);
            kept.insert(node, [next(), next(), next()]);
        }
    }

    /// Coordinates in three fields from `first` on; in archives they are global.
    pub fn command(&mut self, node: u32, command: &AnsysCommand, first: usize, in_archive: bool) {
        let Some(kept) = self.kept.as_mut() else { return };
        kept.remove(&node);
        if self.is_local && !in_archive {
            return;
        }
        let [x, y, z] = [0, 1, 2].map(|k| real(command, first + k).ok());
        if let (Some(x), Some(y), Some(z)) = (x, y, z) {
            kept.insert(node, [x, y, z]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotations_are_applied_one_after_the_other() {
        let near = |a: [Vector; 3], b: [Vector; 3]| {
            let worst = a.iter().flatten().zip(b.iter().flatten()).fold(0.0, |m: f64, (x, y)| m.max((x - y).abs()));
            assert!(worst < 1e-15, "{a:?} {b:?}");
        };
        assert_eq!(rotated_axes([90.0, 0.0, 0.0]), [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
        assert_eq!(rotated_axes([0.0, 90.0, 0.0]), [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]);
        assert_eq!(rotated_axes([0.0, 0.0, 90.0]), [[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]);
        // After the first rotation the new x axis is the old y axis: the second rotation is about it.
        near(rotated_axes([90.0, 90.0, 0.0]), [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]);
        near(
            rotated_axes([30.0, 0.0, 0.0]),
            [[0.75_f64.sqrt(), 0.5, 0.0], [-0.5, 0.75_f64.sqrt(), 0.0], [0.0, 0.0, 1.0]],
        );
        let [a, b, c] = rotated_axes([12.0, 34.0, 56.0]);
        near([a, b, crate::deck::kinematics::vector::cross(a, b)], [a, b, c]);
    }
}
