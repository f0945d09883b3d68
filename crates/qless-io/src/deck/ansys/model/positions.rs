//! Where nodes are and along which axes their components count, for pictures and for what is made of them.

use std::collections::HashMap;

use crate::deck::ansys::syntax::command::AnsysCommand;
use crate::deck::ansys::syntax::field::real;
use crate::deck::kinematics::axes::BASIC_AXES;
use crate::deck::kinematics::body::Pose;
use crate::deck::kinematics::vector::Vector;
use crate::number;

/// The axes after turns by these angles about z, the new x and the new y.
fn turned([z, x, y]: [f64; 3]) -> [Vector; 3] {
    let [[cz, sz], [cx, sx], [cy, sy]] = [z, x, y].map(|degrees| [cosine(degrees), sine(degrees)]);
    [
        [cz * cy - sz * sx * sy, sz * cy + cz * sx * sy, -cx * sy],
        [-sz * cx, cz * cx, sx],
        [cz * sy + sz * sx * cy, sz * sy - cz * sx * cy, cx * cy],
    ]
}

/// Sine of degrees, exact at multiples of 90.
fn sine(degrees: f64) -> f64 {
    match degrees % 360.0 {
        turn if turn % 180.0 == 0.0 => 0.0,
        turn if turn == 90.0 || turn == -270.0 => 1.0,
        turn if turn == -90.0 || turn == 270.0 => -1.0,
        turn => turn.to_radians().sin(),
    }
}

fn cosine(degrees: f64) -> f64 {
    sine(90.0 - degrees.abs() % 360.0)
}

/// Positions as they are read.
#[derive(Debug, Default)]
pub struct NodePositions {
    /// None where nobody asks for them.
    pub kept: Option<HashMap<u32, [f64; 3]>>,
    /// Angles of the axes of nodes in degrees, of those that have any: about z, then the new x, then the new y.
    angles: HashMap<u32, [f64; 3]>,
    /// Whether axes were turned in a way that is not followed.
    are_turned: bool,
    /// Whether commands give coordinates along axes of their own.
    are_local: bool,
}

impl NodePositions {
    /// Notes positions from now on.
    pub fn keep(&mut self) {
        self.kept = Some(HashMap::new());
    }

    /// `CSYS, KCN`, and commands that define a coordinate system, which is the active one from then on.
    pub fn axes(&mut self, command: &AnsysCommand) {
        self.are_local = match &command.key {
            b"CSYS" => !command.field(1).iter().all(|&byte| byte == b'0'),
            b"LOCA" | b"CS  " | b"CLOC" | b"CSKP" => true,
            _ => self.are_local,
        };
    }

    /// `NROTAT` and others that turn the axes of nodes.
    pub fn turn(&mut self) {
        self.are_turned = true;
    }

    /// Where a node is, and along which axes its components count.
    pub fn pose(&self, node: u32) -> Option<Pose> {
        let position = *self.kept.as_ref().filter(|_| !self.are_turned)?.get(&node)?;
        let axes = self.angles.get(&node).map_or(BASIC_AXES, |angles| turned(*angles));
        Some(Pose { position, axes })
    }

    /// Notes the axes of a node; none of the angles is that of a node along the model's axes.
    pub fn axes_of(&mut self, node: u32, angles: [f64; 3]) {
        if self.kept.is_none() {
            return;
        }
        if angles == [0.0; 3] {
            self.angles.remove(&node);
        } else {
            self.angles.insert(node, angles);
        }
    }

    /// A node of a block, the floats of which are its coordinates and then angles; those left out are 0.
    pub fn row<'a>(&mut self, node: u32, mut floats: impl Iterator<Item = &'a [u8]>) {
        if let Some(kept) = &mut self.kept {
            let mut next = || floats.next().and_then(|text| number::real(text).ok()).unwrap_or(0.0);
            kept.insert(node, [next(), next(), next()]);
        }
    }

    /// Coordinates in three fields from `first` on; those of archives are along the model's axes.
    pub fn command(&mut self, node: u32, command: &AnsysCommand, first: usize, in_archive: bool) {
        let Some(kept) = self.kept.as_mut() else { return };
        kept.remove(&node);
        if self.are_local && !in_archive {
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
    fn axes_turn_one_after_the_other() {
        let near = |a: [Vector; 3], b: [Vector; 3]| {
            let worst = a.iter().flatten().zip(b.iter().flatten()).fold(0.0, |m: f64, (x, y)| m.max((x - y).abs()));
            assert!(worst < 1e-15, "{a:?} {b:?}");
        };
        assert_eq!(turned([90.0, 0.0, 0.0]), [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
        assert_eq!(turned([0.0, 90.0, 0.0]), [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]);
        assert_eq!(turned([0.0, 0.0, 90.0]), [[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]);
        // z first: the new x is the old y, about which the second turn goes.
        near(turned([90.0, 90.0, 0.0]), [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]]);
        near(turned([30.0, 0.0, 0.0]), [[0.75_f64.sqrt(), 0.5, 0.0], [-0.5, 0.75_f64.sqrt(), 0.0], [0.0, 0.0, 1.0]]);
        let [a, b, c] = turned([12.0, 34.0, 56.0]);
        near([a, b, crate::deck::kinematics::vector::cross(a, b)], [a, b, c]);
    }
}
