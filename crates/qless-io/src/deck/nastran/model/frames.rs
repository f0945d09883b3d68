//! Coordinate frames of a deck in basic coordinates, whatever the order of their definitions.
//!
//! `CORD2x` names three points in another frame, `CORD1x` three grid points, which may lie in other frames themselves:
//! a frame is found once all it rests on is. A definition that rests on itself is an error.

use std::collections::{HashMap, HashSet};

use crate::deck::Problem;
use crate::deck::kinematics::axes::{Frame, Kind};
use crate::deck::kinematics::vector::Vector;
use crate::deck::nastran::cards::points::{BASIC, FrameDefinition, FrameDefinitions, unknown_frame, unknown_grid};
use crate::deck::nastran::cards::sets::circle;

/// Frames found so far, by identification.
#[derive(Debug, Default)]
pub struct Frames(HashMap<u32, Frame>);

impl Frames {
    /// The frame, if the deck defines it.
    pub fn get(&self, id: u32) -> Option<&Frame> {
        self.0.get(&id)
    }

    /// Finds every frame. `grid` says in which frame a grid point lies, and where. Errors name the frame at fault.
    pub fn resolve(
        definitions: &FrameDefinitions,
        grid: impl Fn(u32) -> Option<(u32, Vector)>,
    ) -> Result<Self, (u32, Problem)> {
        let mut search =
            FrameSearch { definitions, grid, found: HashMap::from([(BASIC, Frame::BASIC)]), open: HashSet::new() };
        for &id in definitions.keys() {
            search.find(id)?;
        }
        Ok(Self(search.found))
    }
}

struct FrameSearch<'a, G> {
    definitions: &'a FrameDefinitions,
    grid: G,
    found: HashMap<u32, Frame>,
    open: HashSet<u32>,
}

impl<G: Fn(u32) -> Option<(u32, Vector)>> FrameSearch<'_, G> {
    /// Depth first with a stack of its own: a deck may nest frames as deep as it likes.
    fn find(&mut self, id: u32) -> Result<(), (u32, Problem)> {
        let mut stack = vec![id];
        while let Some(&top) = stack.last() {
            let missing = self.rests_on(top).map_err(|fault| (top, fault))?;
            match missing {
                None => {
                    self.settle(top).map_err(|fault| (top, fault))?;
                    self.open.remove(&top);
                    stack.pop();
                }
                Some(next) => {
                    self.open.insert(top);
                    if self.open.contains(&next) {
                        return Err((top, circle("coordinate system", next)));
                    }
                    stack.push(next);
                }
            }
        }
        Ok(())
    }

    /// A frame that has to be found before this one.
    fn rests_on(&self, id: u32) -> Result<Option<u32>, Problem> {
        if self.found.contains_key(&id) {
            return Ok(None);
        }
        let references = match self.definition(id)? {
            FrameDefinition::Points { reference, .. } => [*reference; 3],
            FrameDefinition::Grids { grids, .. } => {
                let mut frames = [BASIC; 3];
                for (frame, &node) in frames.iter_mut().zip(grids) {
                    *frame = self.grid(node)?.0;
                }
                frames
            }
        };
        let missing = references.into_iter().find(|reference| !self.found.contains_key(reference));
        missing.map(|next| self.definition(next).map(|_| next)).transpose()
    }

    fn settle(&mut self, id: u32) -> Result<(), Problem> {
        if !self.found.contains_key(&id) {
            let (kind, [a, b, c]) = self.points(id)?;
            let frame = Frame::through(kind, a, b, c).ok_or_else(in_line)?;
            self.found.insert(id, frame);
        }
        Ok(())
    }

    /// The three points in basic coordinates.
    fn points(&self, id: u32) -> Result<(Kind, [Vector; 3]), Problem> {
        let basic = |frame: u32, point: Vector| self.found.get(&frame).map(|frame| frame.point(point));
        let mut at = [[0.0; 3]; 3];
        let kind = match self.definition(id)? {
            FrameDefinition::Points { kind, reference, points } => {
                for (at, &point) in at.iter_mut().zip(points) {
                    *at = basic(*reference, point).ok_or_else(|| unknown_frame(*reference))?;
                }
                kind
            }
            FrameDefinition::Grids { kind, grids } => {
                for (at, &node) in at.iter_mut().zip(grids) {
                    let (frame, point) = self.grid(node)?;
                    *at = basic(frame, point).ok_or_else(|| unknown_frame(frame))?;
                }
                kind
            }
        };
        Ok((*kind, at))
    }

    fn definition(&self, id: u32) -> Result<&FrameDefinition, Problem> {
        self.definitions.get(&id).ok_or_else(|| unknown_frame(id))
    }

    fn grid(&self, node: u32) -> Result<(u32, Vector), Problem> {
        (self.grid)(node).ok_or_else(|| unknown_grid(node))
    }
}

fn in_line() -> Problem {
    Problem::Degenerate { what: "the three points of the coordinate system lie in a line or coincide".into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn on(reference: u32, origin: Vector) -> FrameDefinition {
        let [x, y, z] = origin;
        let points = [origin, [x, y, z + 1.0], [x + 1.0, y, z]];
        FrameDefinition::Points { kind: Kind::Rectangular, reference, points }
    }

    #[test]
    fn frames_nest_in_any_order() {
        let definitions = FrameDefinitions::from([(1, on(3, [1.0; 3])), (2, on(0, [1.0; 3])), (3, on(2, [1.0; 3]))]);
        let frames = Frames::resolve(&definitions, |_| None).expect("frames");
        assert_eq!(frames.get(1).map(|frame| frame.origin), Some([3.0; 3]));
    }

    #[test]
    fn frames_through_grid_points() {
        let grids = |node: u32| {
            Some((if node == 12 { 2 } else { 0 }, [[1.0; 3], [1.0, 1.0, 2.0], [2.0, 0.0, 0.0]][node as usize - 10]))
        };
        let definitions = FrameDefinitions::from([
            (1, FrameDefinition::Grids { kind: Kind::Cylindrical, grids: [10, 11, 12] }),
            (2, on(0, [1.0; 3])),
        ]);
        let frames = Frames::resolve(&definitions, grids).expect("frames");
        assert_eq!(frames.get(1).map(|frame| (frame.origin, frame.axes[2])), Some(([1.0; 3], [0.0, 0.0, 1.0])));
    }

    #[test]
    fn cycles_and_gaps_are_errors() {
        let cycle = FrameDefinitions::from([(1, on(2, [0.0; 3])), (2, on(1, [0.0; 3]))]);
        assert_eq!(Frames::resolve(&cycle, |_| None).err(), Some((2, circle("coordinate system", 1))));
        let itself = FrameDefinitions::from([(7, on(7, [0.0; 3]))]);
        assert_eq!(Frames::resolve(&itself, |_| None).err(), Some((7, circle("coordinate system", 7))));
        let gap = FrameDefinitions::from([(1, on(9, [0.0; 3]))]);
        assert_eq!(Frames::resolve(&gap, |_| None).err(), Some((1, unknown_frame(9))));
        let grids = FrameDefinitions::from([(1, FrameDefinition::Grids { kind: Kind::Rectangular, grids: [1, 2, 3] })]);
        assert_eq!(Frames::resolve(&grids, |_| None).err(), Some((1, unknown_grid(1))));
        let through = |node| Some((1, [f64::from(node); 3]));
        assert_eq!(Frames::resolve(&grids, through).err(), Some((1, circle("coordinate system", 1))));
    }

    #[test]
    fn nesting_has_no_limit() {
        let definitions: FrameDefinitions = (1..=100_000).map(|id| (id, on(id % 100_000 + 1, [1.0; 3]))).collect();
        assert!(Frames::resolve(&definitions, |_| None).is_err());
        let definitions: FrameDefinitions = (1..=100_000).map(|id| (id, on((id + 1) % 100_001, [1.0; 3]))).collect();
        let frames = Frames::resolve(&definitions, |_| None).expect("frames");
        assert_eq!(frames.get(1).map(|frame| frame.origin), Some([1e5; 3]));
    }
}
