//! Instances of Abaqus parts: names, positions, and unique numbers for their nodes.

use crate::deck::Problem;
use crate::deck::calculix::syntax::{DataLines, DataPiece, Scope, float};
use crate::deck::kinematics::axes::Frame;
use crate::deck::kinematics::vector::{Vector, cross, dot, minus, plus, scaled, unit};

/// An `*INSTANCE` card.
pub struct Instance {
    /// Name, as spelled in the deck.
    pub name: String,
    /// The data lines: first the translation, then the rotation.
    pub data: Vec<DataPiece>,
}

/// The rigid motion that places an instance: `x = R (x_part + t)`. x_part is a point of the Abaqus part, t a translation, and R a rotation
/// about an axis through two points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InstanceMotion {
    shift: Vector,
    turn: Option<InstanceRotation>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct InstanceRotation {
    through: Vector,
    axis: Vector,
    cos: f64,
    sin: f64,
}

impl InstanceRotation {
    fn direction(&self, v: Vector) -> Vector {
        let along = scaled(self.axis, dot(self.axis, v) * (1.0 - self.cos));
        plus(plus(scaled(v, self.cos), scaled(cross(self.axis, v), self.sin)), along)
    }
}

impl InstanceMotion {
    /// Reads the data of an `*INSTANCE` card. The first line is a translation. The second line holds two points of an axis and an angle in
    /// degrees.
    pub fn read(data: &[DataPiece]) -> Result<Self, Problem> {
        let mut lines = DataLines::new(data);
        let mut motion = Self { shift: [0.0; 3], turn: None };
        if let Some(line) = lines.next() {
            for (x, field) in motion.shift.iter_mut().zip(line.fields()) {
                *x = if field.is_empty() { 0.0 } else { float(field)? };
            }
        }
        if let Some(line) = lines.next() {
            let mut numbers = Vec::with_capacity(7);
            for field in line.fields() {
                numbers.push(if field.is_empty() { 0.0 } else { float(field)? });
            }
            motion.turn = turn(&numbers)?;
        }
        Ok(motion)
    }

    /// Where a point of the Abaqus part lies in the deck.
    pub fn point(&self, x: Vector) -> Vector {
        let moved = plus(x, self.shift);
        self.turn.map_or(moved, |turn| plus(turn.through, turn.direction(minus(moved, turn.through))))
    }

    /// Converts axes of the Abaqus part to the coordinates of the deck.
    pub fn frame(&self, frame: Frame) -> Frame {
        let axes = frame.axes.map(|axis| self.turn.map_or(axis, |turn| turn.direction(axis)));
        Frame { origin: self.point(frame.origin), axes, ..frame }
    }
}

fn turn(numbers: &[f64]) -> Result<Option<InstanceRotation>, Problem> {
    let [ax, ay, az, bx, by, bz, angle] = *numbers else {
        return Err(Problem::TooFew { what: "numbers of a rotation", promised: 7, found: numbers.len() });
    };
    let axis = unit(minus([bx, by, bz], [ax, ay, az]));
    let axis = axis.ok_or_else(|| Problem::Degenerate { what: "the two points define no axis".into() })?;
    let (sin, cos) = match angle % 360.0 {
        0.0 => return Ok(None),
        quarter if quarter.abs() == 90.0 => (quarter.signum(), 0.0),
        half if half.abs() == 180.0 => (0.0, -1.0),
        quarter if quarter.abs() == 270.0 => (-quarter.signum(), 0.0),
        other => other.to_radians().sin_cos(),
    };
    Ok(Some(InstanceRotation { through: [ax, ay, az], axis, cos, sin }))
}

/// The numbers that the nodes of instances have in the whole deck.
pub struct NodeNumbers {
    /// For each scope: the first of its numbers in the deck, and its numbers within the instance, ascending.
    scopes: Vec<(u32, Vec<u32>)>,
}

impl NodeNumbers {
    /// Numbers the nodes of all instances consecutively, above the largest number in the deck itself.
    pub fn build(deck: &[u32], instances: impl Iterator<Item = Vec<u32>>) -> Result<Self, Problem> {
        let mut next = deck.last().map_or(Some(1), |last| last.checked_add(1));
        // Scope 0 is the deck itself. Its nodes keep their numbers, all of which are below the first number of the instances.
        let mut scopes = vec![(next.unwrap_or(u32::MAX), Vec::new())];
        for own in instances {
            let advice = "use smaller numbers for the nodes of the assembly";
            let limit = Problem::Limit { what: "the number of nodes", limit: u32::MAX as usize, advice };
            let first = next.ok_or(limit)?;
            next = u32::try_from(own.len()).ok().and_then(|count| first.checked_add(count));
            scopes.push((first, own));
        }
        Ok(Self { scopes })
    }

    /// The number in the deck of the node that has the number `own` in a scope.
    pub fn get(&self, scope: Scope, own: u32) -> Option<u32> {
        let (first, numbers) = self.scopes.get(scope.0 as usize)?;
        if scope == Scope::DECK {
            return (own < *first).then_some(own);
        }
        numbers.binary_search(&own).ok().map(|k| first + k as u32)
    }

    /// For each instance: the first of its numbers in the deck, and its numbers within the instance.
    pub fn instances(&self) -> &[(u32, Vec<u32>)] {
        &self.scopes[1..]
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    fn motion(text: &str) -> Result<InstanceMotion, Problem> {
        let text = Arc::new(text.as_bytes().to_vec());
        InstanceMotion::read(&[DataPiece { file: 0, line: 1, range: 0..text.len(), text }])
    }

    #[test]
    fn an_instance_is_shifted_and_then_turned() {
        let moved = motion("1.,0.,0.\n0.,0.,0.,0.,0.,1.,90.\n").expect("a motion");
        assert_eq!(moved.point([1.0, 0.0, 5.0]), [0.0, 2.0, 5.0]);
        assert_eq!(moved.frame(Frame::BASIC).axes, [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
        let around = motion("\n0.,0.,0.\n1.,0.,0.,1.,0.,2.,180.\n").expect("a motion");
        assert_eq!(around.point([3.0, 1.0, 0.0]), [-1.0, -1.0, 0.0]);
        let skew = motion("0.,0.,0.\n1.,2.,3.,4.,4.,1.,33.\n").expect("a motion");
        let apart = |a: Vector, b: Vector| crate::deck::kinematics::vector::length(minus(a, b));
        let (a, b) = ([0.3, 0.1, 9.0], [-2.0, 1.0, 0.5]);
        assert!((apart(skew.point(a), skew.point(b)) - apart(a, b)).abs() < 1e-13);
        assert!(apart(skew.point([4.0, 4.0, 1.0]), [4.0, 4.0, 1.0]) < 1e-14);
    }

    #[test]
    fn a_turn_about_no_axis_is_refused() {
        assert!(matches!(motion("0.,0.,0.\n1.,1.,1.,1.,1.,1.,5.\n"), Err(Problem::Degenerate { .. })));
        assert!(matches!(motion("0.,0.,0.\n1.,1.,1.,5.\n"), Err(Problem::TooFew { .. })));
    }

    #[test]
    fn every_node_gets_a_number_of_its_own() {
        let numbers = NodeNumbers::build(&[3, 7], [vec![1, 2, 9], vec![9]].into_iter()).expect("few");
        assert_eq!((numbers.get(Scope(1), 9), numbers.get(Scope(2), 9)), (Some(10), Some(11)));
        assert_eq!((numbers.get(Scope(1), 3), numbers.get(Scope::DECK, 3)), (None, Some(3)));
        assert_eq!(numbers.get(Scope::DECK, 8), None);
        assert!(NodeNumbers::build(&[u32::MAX], [vec![1]].into_iter()).is_err());
    }
}
