//! The points of a deck: what a number stands for, where it is, and along which axes its components count.

use super::body::Pose;
use super::fault::{CardFault, unknown_frame, unknown_grid};
use super::frames::{BASIC, Definitions, Frames};
use super::grid::{Grid, Usual};
use super::number::Components;
use super::row::Poses;
use super::spans::Span;
use super::vector::Vector;
use crate::deck::{Dof, Problem};

/// Grid and scalar points.
#[derive(Debug, Default)]
pub(super) struct Points {
    /// Ascending, each number once.
    grids: Vec<Grid>,
    /// Scalar points: ascending, apart.
    scalars: Vec<Span>,
    usual: Usual,
    frames: Frames,
}

/// What a number stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Point {
    Grid,
    Scalar,
    Unknown,
}

impl Points {
    /// The error is a grid point that is defined in two ways.
    pub fn new(mut grids: Vec<Grid>, mut scalars: Vec<Span>, usual: Usual) -> Result<Self, Box<[Grid; 2]>> {
        if !grids.is_sorted_by_key(|grid| grid.id) {
            grids.sort_by_key(|grid| grid.id);
        }
        let differs = |pair: &&[Grid]| pair[0].id == pair[1].id && !pair[0].is_same(&pair[1]);
        if let Some(pair) = grids.windows(2).find(differs) {
            return Err(Box::new([pair[0], pair[1]]));
        }
        grids.dedup_by_key(|grid| grid.id);
        scalars.sort_unstable_by_key(|span| span.first);
        scalars.dedup_by(|next, span| {
            let joins = next.first <= span.last;
            span.last = if joins { span.last.max(next.last) } else { span.last };
            joins
        });
        Ok(Self { grids, scalars, usual, frames: Frames::default() })
    }

    /// Finds the coordinate systems. The error names the one at fault.
    pub fn resolve(&mut self, definitions: &Definitions) -> Result<(), (u32, Problem)> {
        let grid = |node| self.grid(node).map(|grid| (self.usual(grid).given_in.unwrap_or(BASIC), grid.given));
        self.frames = Frames::resolve(definitions, grid)?;
        Ok(())
    }

    pub fn kind(&self, node: u32) -> Point {
        let scalar = || {
            let after = self.scalars.partition_point(|span| span.first <= node);
            after > 0 && node <= self.scalars[after - 1].last
        };
        match self.grid(node) {
            Some(_) => Point::Grid,
            None if scalar() => Point::Scalar,
            None => Point::Unknown,
        }
    }

    /// The DOFs that components of a point mean; that of a scalar point is component 0.
    pub fn dofs(&self, node: u32, set: Components) -> Result<Vec<Dof>, CardFault> {
        let dofs = || set.iter().map(|component| Dof { node, component }).collect();
        match self.kind(node) {
            Point::Grid if set.is_empty() => Err(CardFault::NoComponent { node }),
            Point::Unknown if set.is_empty() => Ok(vec![Dof { node, component: 0 }]),
            Point::Grid | Point::Unknown => Ok(dofs()),
            Point::Scalar => match set.without(Components::one(1)).iter().next() {
                Some(component) => Err(CardFault::ScalarComponent { node, component }),
                None => Ok(vec![Dof { node, component: 0 }]),
            },
        }
    }

    /// The points that lists name: single ones as they are, of a range those that the deck has.
    pub fn expand(&self, spans: &[Span]) -> Result<Vec<u32>, Problem> {
        let mut nodes = Vec::new();
        for span in spans {
            if span.first == span.last {
                nodes.push(span.first);
                continue;
            }
            let start = nodes.len();
            let from = self.grids.partition_point(|grid| grid.id < span.first);
            nodes.extend(self.grids[from..].iter().map(|grid| grid.id).take_while(|&id| id <= span.last));
            for scalar in &self.scalars {
                let (first, last) = (scalar.first.max(span.first), scalar.last.min(span.last));
                limited(nodes.len() + (u64::from(last) + 1).saturating_sub(first.into()) as usize)?;
                nodes.extend(first..=last);
            }
            nodes[start..].sort_unstable();
        }
        Ok(nodes)
    }

    /// Grid points of which components are held in every subcase.
    pub fn held(&self) -> impl Iterator<Item = (&Grid, Components)> {
        let held = |grid| self.usual(grid).held.filter(|set| !set.is_empty()).map(|set| (grid, set));
        self.grids.iter().filter_map(held)
    }

    fn grid(&self, node: u32) -> Option<&Grid> {
        self.grids.binary_search_by_key(&node, |grid| grid.id).ok().map(|i| &self.grids[i])
    }

    fn usual(&self, grid: &Grid) -> Usual {
        grid.usual.or(self.usual)
    }

    /// The position of a grid point.
    fn position(&self, grid: &Grid) -> Result<Vector, Problem> {
        let frame = self.usual(grid).given_in.unwrap_or(BASIC);
        Ok(self.frames.get(frame).ok_or_else(|| unknown_frame(frame))?.point(grid.given))
    }
}

/// Refuses lists that no deck can mean.
pub(super) fn limited(count: usize) -> Result<(), Problem> {
    const POINTS: usize = 50_000_000;
    let advice = "shorten the lists with THRU";
    if count > POINTS {
        Err(Problem::Limit { what: "the number of constrained points", limit: POINTS, advice })
    } else {
        Ok(())
    }
}

impl Poses for Points {
    fn pose(&self, node: u32) -> Result<Pose, Problem> {
        let grid = self.grid(node).ok_or_else(|| unknown_grid(node))?;
        let position = self.position(grid)?;
        let frame = self.usual(grid).moves_in.unwrap_or(BASIC);
        let axes = self.frames.get(frame).ok_or_else(|| unknown_frame(frame))?.axes_at(position);
        Ok(Pose { position, axes })
    }
}
