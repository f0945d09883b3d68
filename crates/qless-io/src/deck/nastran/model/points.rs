//! The points of a deck: what a number stands for, where it is, and along which axes its components count.

use std::collections::BTreeSet;

use super::frames::Frames;
use crate::deck::kinematics::body::Pose;
use crate::deck::kinematics::components::Components;
use crate::deck::kinematics::row::Poses;
use crate::deck::kinematics::vector::Vector;
use crate::deck::nastran::cards::grids::{GridPoint, Grids};
use crate::deck::nastran::cards::points::{
    BASIC, FrameDefinitions, GridDefaults, PointSpan, unknown_frame, unknown_grid,
};
use crate::deck::nastran::syntax::card::CardPlace;
use crate::deck::{CardFault, Dof, Model, Problem};

/// Grid and scalar points.
#[derive(Debug, Default)]
pub struct Points {
    /// In order.
    grids: Grids,
    /// Scalar points: ascending, apart.
    scalars: Vec<PointSpan>,
    usual: GridDefaults,
    frames: Frames,
}

/// The number of a grid point, and two cards that differ about it.
pub type DuplicateGrid = Box<(u32, [CardPlace; 2])>;

/// What a number stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointKind {
    Grid,
    Scalar,
    Unknown,
}

impl Points {
    /// The error is a grid point that is defined in two ways.
    pub fn new(mut grids: Grids, mut scalars: Vec<PointSpan>, usual: GridDefaults) -> Result<Self, DuplicateGrid> {
        grids.sort()?;
        scalars.sort_unstable_by_key(|span| span.first);
        scalars.dedup_by(|next, span| {
            let joins = next.first <= span.last;
            span.last = if joins { span.last.max(next.last) } else { span.last };
            joins
        });
        Ok(Self { grids, scalars, usual, frames: Frames::default() })
    }

    /// Finds the coordinate systems. The error names the one at fault.
    pub fn resolve(&mut self, definitions: &FrameDefinitions) -> Result<(), (u32, Problem)> {
        let grid = |node| self.grids.get(node).map(|grid| (self.usual(grid).given_in.unwrap_or(BASIC), grid.at));
        self.frames = Frames::resolve(definitions, grid)?;
        Ok(())
    }

    /// Pairs of cards that say the same of a grid point.
    pub fn repeated(&self) -> &[[CardPlace; 2]] {
        &self.grids.repeated
    }

    pub fn kind(&self, node: u32) -> PointKind {
        let scalar = || {
            let after = self.scalars.partition_point(|span| span.first <= node);
            after > 0 && node <= self.scalars[after - 1].last
        };
        match self.grids.get(node) {
            Some(_) => PointKind::Grid,
            None if scalar() => PointKind::Scalar,
            None => PointKind::Unknown,
        }
    }

    /// The DOF that one component, or none, of a point of this kind means.
    pub fn dof(node: u32, kind: PointKind, set: Components) -> Result<Dof, CardFault> {
        let component = Self::meant(node, kind, set)?.iter().next();
        Ok(Dof { node, component: component.unwrap_or(0) })
    }

    /// The DOFs that components of a point mean; that of a scalar point is component 0.
    pub fn dofs(&self, node: u32, set: Components) -> Result<Vec<Dof>, CardFault> {
        let set = Self::meant(node, self.kind(node), set)?;
        let one = set.is_empty().then_some(0);
        Ok(one.into_iter().chain(set.iter()).map(|component| Dof { node, component }).collect())
    }

    /// The components of a grid point; the empty set stands for the one of a scalar point.
    fn meant(node: u32, kind: PointKind, set: Components) -> Result<Components, CardFault> {
        match kind {
            PointKind::Grid if set.is_empty() => Err(CardFault::NoComponent { node }),
            PointKind::Grid | PointKind::Unknown => Ok(set),
            PointKind::Scalar => match set.without(Components::one(1)).iter().next() {
                Some(component) => Err(CardFault::ScalarComponent { node, component }),
                None => Ok(Components::default()),
            },
        }
    }

    /// The points that lists name: single ones as they are, of a range those that the deck has.
    pub fn expand(&self, spans: &[PointSpan]) -> Result<Vec<u32>, Problem> {
        let mut nodes = Vec::new();
        for span in spans {
            if span.first == span.last {
                nodes.push(span.first);
                continue;
            }
            let start = nodes.len();
            nodes.extend(self.grids.from(span.first).map(|grid| grid.id).take_while(|&id| id <= span.last));
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
    pub fn held(&self) -> impl Iterator<Item = (&GridPoint, Components)> {
        let held = |usual: GridDefaults| usual.or(self.usual).held.filter(|set| !set.is_empty());
        let of_any = self.grids.any(|usual| held(usual).is_some()).then(|| self.grids.iter());
        of_any.into_iter().flatten().filter_map(move |grid| held(self.grids.usual(grid)).map(|set| (grid, set)))
    }

    /// Says which points of a card the deck does not define; scalar points may be those of elements.
    pub fn warn_of_unknown(&self, nodes: impl Iterator<Item = u32>, place: &CardPlace, model: &mut Model) {
        let unknown: BTreeSet<u32> = nodes.filter(|&node| self.kind(node) == PointKind::Unknown).collect();
        if let Some(first) = unknown.first() {
            let more = if unknown.len() > 1 { format!(" and {} more", unknown.len() - 1) } else { String::new() };
            let text = format!("{}: no GRID or SPOINT defines point {first}{more}; taken as it stands", place.name);
            model.warn(place.file, place.line, text);
        }
    }

    /// The card of a grid point.
    pub fn place(&self, grid: &GridPoint) -> CardPlace {
        self.grids.place(grid)
    }

    fn usual(&self, grid: &GridPoint) -> GridDefaults {
        self.grids.usual(grid).or(self.usual)
    }

    /// Grid points with their positions in the basic system.
    pub fn positions(&self) -> impl Iterator<Item = (u32, Vector)> {
        self.grids.iter().filter_map(|grid| Some((grid.id, self.position(grid).ok()?)))
    }

    /// The position of a grid point.
    fn position(&self, grid: &GridPoint) -> Result<Vector, Problem> {
        let frame = self.usual(grid).given_in.unwrap_or(BASIC);
        Ok(self.frames.get(frame).ok_or_else(|| unknown_frame(frame))?.point(grid.at))
    }
}

/// Refuses lists that no deck can mean.
pub fn limited(count: usize) -> Result<(), Problem> {
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
        let grid = self.grids.get(node).ok_or_else(|| unknown_grid(node))?;
        let position = self.position(grid)?;
        let frame = self.usual(grid).moves_in.unwrap_or(BASIC);
        let axes = self.frames.get(frame).ok_or_else(|| unknown_frame(frame))?.axes_at(position);
        Ok(Pose { position, axes })
    }
}
