//! Computes the coordinate frames of a deck in basic coordinates. Their definitions may be in any order.
//!
//! `CORD2x` names three points in another frame, and `CORD1x` three grid points, whose coordinates may be in other frames. A frame
//! is computed after all frames on which it depends. A circular definition is an error.

use std::collections::{HashMap, HashSet};

use crate::deck::Problem;
use crate::deck::kinematics::axes::{Frame, FrameKind};
use crate::deck::kinematics::vector::Vector;
use crate::deck::nastran::cards::points::{BASIC, FrameDefinition, FrameDefinitions, unknown_frame, unknown_grid};
use crate::deck::nastran::cards::sets::circle;

/// The computed frames, by number.
#[derive(Debug, Default)]
pub struct Frames(HashMap<u32, Frame>);

impl Frames {
    /// The frame with this number; `None` if the deck does not define it.
    pub fn get(&self, id: u32) -> Option<&Frame> {
        self.0.get(&id)
    }

    /// Computes all frames. `grid` returns the frame and the coordinates of a grid point. The error holds the number of the faulty frame.
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
    /// Computes a frame and those on which it depends, by depth-first search. The stack is explicit, so the nesting of frames has no limit.
    fn find(&mut self, id: u32) -> Result<(), (u32, Problem)> {
        let mut stack = vec![id];
        while let Some(&top) = stack.last() {
            let missing = self.missing(top).map_err(|fault| (top, fault))?;
            match missing {
                None => {
                    self.compute(top).map_err(|fault| (top, fault))?;
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

    /// A frame that is not computed yet although frame `id` depends on it; `None` if there is none.
    fn missing(&self, id: u32) -> Result<Option<u32>, Problem> {
        if self.found.contains_key(&id) {
            return Ok(None);
        }
        let (_, points) = self.points(id)?;
        let missing = points.into_iter().map(|(frame, _)| frame).find(|frame| !self.found.contains_key(frame));
        missing.map(|next| self.definition(next).map(|_| next)).transpose()
    }

    fn compute(&mut self, id: u32) -> Result<(), Problem> {
        if self.found.contains_key(&id) {
            return Ok(());
        }
        let (kind, points) = self.points(id)?;
        let mut basic = [[0.0; 3]; 3];
        for (basic, (frame, point)) in basic.iter_mut().zip(points) {
            *basic = self.found.get(&frame).ok_or_else(|| unknown_frame(frame))?.point(point);
        }
        let [a, b, c] = basic;
        self.found.insert(id, Frame::through(kind, a, b, c).ok_or_else(collinear)?);
        Ok(())
    }

    /// The three points that define a frame, each with the number of the frame of its coordinates.
    fn points(&self, id: u32) -> Result<(FrameKind, [(u32, Vector); 3]), Problem> {
        Ok(match self.definition(id)? {
            FrameDefinition::Points { kind, reference, points } => (*kind, points.map(|point| (*reference, point))),
            FrameDefinition::Grids { kind, grids: [a, b, c] } => {
                (*kind, [self.grid(*a)?, self.grid(*b)?, self.grid(*c)?])
            }
        })
    }

    fn definition(&self, id: u32) -> Result<&FrameDefinition, Problem> {
        self.definitions.get(&id).ok_or_else(|| unknown_frame(id))
    }

    fn grid(&self, node: u32) -> Result<(u32, Vector), Problem> {
        (self.grid)(node).ok_or_else(|| unknown_grid(node))
    }
}

fn collinear() -> Problem {
    Problem::Degenerate { what: "the three points of the coordinate system are collinear or coincide".into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn on(reference: u32, origin: Vector) -> FrameDefinition {
        let [x, y, z] = origin;
        let points = [origin, [x, y, z + 1.0], [x + 1.0, y, z]];
        FrameDefinition::Points { kind: FrameKind::Rectangular, reference, points }
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
            (1, FrameDefinition::Grids { kind: FrameKind::Cylindrical, grids: [10, 11, 12] }),
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
        let grids =
            FrameDefinitions::from([(1, FrameDefinition::Grids { kind: FrameKind::Rectangular, grids: [1, 2, 3] })]);
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
