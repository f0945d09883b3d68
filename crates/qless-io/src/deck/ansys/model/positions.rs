//! Positions and axes of nodes, for pictures and for the equations of rigid regions.

use std::collections::HashMap;

use crate::deck::ansys::syntax::command::AnsysCommand;
use crate::deck::ansys::syntax::field::real;
use crate::deck::kinematics::axes::{BASIC_AXES, sine};
use crate::deck::kinematics::body::Pose;
use crate::deck::kinematics::vector::Vector;
use crate::number;

/// The axes of a node after three rotations: by the first angle about z, by the second about the new x, by the third about the new y.
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
    /// The position of each node; `None` if positions are not needed.
    pub kept: Option<HashMap<u32, [f64; 3]>>,
    /// Three angles for each rotated node, in degrees: about z, then about the new x, then about the new y.
    angles: HashMap<u32, [f64; 3]>,
    /// Whether a command rotated axes in a way that this reader does not follow.
    axes_unknown: bool,
    /// Whether the active coordinate system may differ from the global one.
    is_local: bool,
}

impl NodePositions {
    /// Stores the positions that are read from now on.
    pub fn keep(&mut self) {
        self.kept = Some(HashMap::new());
    }

    /// Updates `is_local`: `CSYS, KCN` activates a coordinate system, and so do commands that define one.
    pub fn coordinate_system(&mut self, command: &AnsysCommand) {
        self.is_local = match &command.key {
            b"CSYS" => !command.field(1).iter().all(|&byte| byte == b'0'),
            b"LOCA" | b"CS  " | b"CLOC" | b"CSKP" => true,
            _ => self.is_local,
        };
    }

    /// Records that `NROTAT` or another command rotates the axes of nodes: from now on the axes are unknown.
    pub fn rotate(&mut self) {
        self.axes_unknown = true;
    }

    /// Position and axes of a node; `None` if either is unknown.
    pub fn pose(&self, node: u32) -> Option<Pose> {
        let position = *self.kept.as_ref().filter(|_| !self.axes_unknown)?.get(&node)?;
        let axes = self.angles.get(&node).map_or(BASIC_AXES, |angles| rotated_axes(*angles));
        Some(Pose { position, axes })
    }

    /// Sets the axes of a node. If all angles are 0, they are the global axes.
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

    /// Stores the position of a node of `NBLOCK`. The first three floats of its row are the coordinates; missing ones are 0.
    pub fn row<'a>(&mut self, node: u32, mut floats: impl Iterator<Item = &'a [u8]>) {
        if let Some(kept) = &mut self.kept {
            let mut next = || floats.next().and_then(|text| number::real(text).ok()).unwrap_or(0.0);
            kept.insert(node, [next(), next(), next()]);
        }
    }

    /// Stores the coordinates of a node from three fields, the first of which is `first`. In archives they are global.
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
        // After the first rotation, the new x axis is the old y axis. So the second rotation is about the old y axis.
        near(rotated_axes([90.0, 90.0, 0.0]), [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]);
        near(
            rotated_axes([30.0, 0.0, 0.0]),
            [[0.75_f64.sqrt(), 0.5, 0.0], [-0.5, 0.75_f64.sqrt(), 0.0], [0.0, 0.0, 1.0]],
        );
        let [a, b, c] = rotated_axes([12.0, 34.0, 56.0]);
        near([a, b, crate::deck::kinematics::vector::cross(a, b)], [a, b, c]);
    }
}
