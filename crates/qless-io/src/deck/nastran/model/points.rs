//! The points of a deck: their kind, their position, and the axes of their components.

use std::collections::BTreeSet;

use super::frames::Frames;
use crate::deck::kinematics::body::{Pose, Poses};
use crate::deck::kinematics::components::Components;
use crate::deck::kinematics::vector::Vector;
use crate::deck::limits::POINTS;
use crate::deck::nastran::cards::grids::{GridPoint, Grids};
use crate::deck::nastran::cards::points::{
    BASIC, FrameDefinitions, GridDefaults, PointSpan, unknown_frame, unknown_grid,
};
use crate::deck::nastran::syntax::card::CardLocation;
use crate::deck::{CardFault, Dof, Model, Problem};

/// The grid points and scalar points of a deck.
#[derive(Debug, Default)]
pub struct Points {
    /// The grid points, ascending by number.
    grids: Grids,
    /// The numbers of the scalar points, as ascending disjoint ranges.
    scalars: Vec<PointSpan>,
    defaults: GridDefaults,
    frames: Frames,
}

/// The number of a grid point, and two cards that define it differently.
pub type DuplicateGrid = Box<(u32, [CardLocation; 2])>;

/// What kind of point has a given number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointKind {
    Grid,
    Scalar,
    Unknown,
}

impl Points {
    /// Makes the table of points. The error is a grid point that two cards define differently.
    pub fn new(mut grids: Grids, mut scalars: Vec<PointSpan>, defaults: GridDefaults) -> Result<Self, DuplicateGrid> {
        grids.sort()?;
        scalars.sort_unstable_by_key(|span| span.first);
        scalars.dedup_by(|next, span| {
            let joins = next.first <= span.last;
            span.last = if joins { span.last.max(next.last) } else { span.last };
            joins
        });
        Ok(Self { grids, scalars, defaults, frames: Frames::default() })
    }

    /// Computes the coordinate systems. The error holds the number of the faulty system.
    pub fn resolve(&mut self, definitions: &FrameDefinitions) -> Result<(), (u32, Problem)> {
        let grid = |node| self.grids.get(node).map(|grid| (self.fields(grid).position_frame.unwrap_or(BASIC), grid.at));
        self.frames = Frames::resolve(definitions, grid)?;
        Ok(())
    }

    /// Pairs of cards that define the same grid point equally.
    pub fn repeated(&self) -> &[[CardLocation; 2]] {
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

    /// The DOF of a point of this kind. `set` holds one component, or none for a scalar point.
    pub fn dof(node: u32, kind: PointKind, set: Components) -> Result<Dof, CardFault> {
        let component = Self::components(node, kind, set)?.iter().next();
        Ok(Dof { node, component: component.unwrap_or(0) })
    }

    /// The DOFs of these components of a point. A scalar point has one DOF, with component 0.
    pub fn dofs(&self, node: u32, set: Components) -> Result<Vec<Dof>, CardFault> {
        let set = Self::components(node, self.kind(node), set)?;
        let one = set.is_empty().then_some(0);
        Ok(one.into_iter().chain(set.iter()).map(|component| Dof { node, component }).collect())
    }

    /// Checks whether a point of this kind can have these components. Returns them, or the empty set for a scalar point.
    fn components(node: u32, kind: PointKind, set: Components) -> Result<Components, CardFault> {
        match kind {
            PointKind::Grid if set.is_empty() => Err(CardFault::NoComponent { node }),
            PointKind::Grid | PointKind::Unknown => Ok(set),
            PointKind::Scalar => match set.without(Components::one(1)).iter().next() {
                Some(component) => Err(CardFault::ScalarComponent { node, component }),
                None => Ok(Components::default()),
            },
        }
    }

    /// The numbers of the points in a list: single points, whether they are defined or not, and the defined points of each range.
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

    /// The grid points whose cards prescribe components, with these components. Their value is 0.
    pub fn prescribed(&self) -> impl Iterator<Item = (&GridPoint, Components)> {
        let prescribed = |fields: GridDefaults| fields.or(self.defaults).prescribed.filter(|set| !set.is_empty());
        let any = self.grids.any(|fields| prescribed(fields).is_some()).then(|| self.grids.iter());
        any.into_iter().flatten().filter_map(move |grid| prescribed(self.grids.fields(grid)).map(|set| (grid, set)))
    }

    /// Warns if a card names points that are not defined. They may be scalar points that elements define.
    pub fn warn_of_unknown(&self, nodes: impl Iterator<Item = u32>, place: &CardLocation, model: &mut Model) {
        let unknown: BTreeSet<u32> = nodes.filter(|&node| self.kind(node) == PointKind::Unknown).collect();
        if let Some(first) = unknown.first() {
            let more = if unknown.len() > 1 { format!(" and {} more", unknown.len() - 1) } else { String::new() };
            let text = format!(
                "{}: no GRID or SPOINT defines point {first}{more}; its components are used as they are",
                place.name
            );
            model.warn(place.file, place.line, text);
        }
    }

    /// The place of the card that defines a grid point.
    pub fn place(&self, grid: &GridPoint) -> CardLocation {
        self.grids.place(grid)
    }

    /// The fields of the point's card; blank ones are filled from `GRDSET`.
    fn fields(&self, grid: &GridPoint) -> GridDefaults {
        self.grids.fields(grid).or(self.defaults)
    }

    /// The number and the position in the basic system of each grid point.
    pub fn positions(&self) -> impl Iterator<Item = (u32, Vector)> {
        self.grids.iter().filter_map(|grid| Some((grid.id, self.position(grid).ok()?)))
    }

    /// The position of a grid point.
    fn position(&self, grid: &GridPoint) -> Result<Vector, Problem> {
        let frame = self.fields(grid).position_frame.unwrap_or(BASIC);
        Ok(self.frames.get(frame).ok_or_else(|| unknown_frame(frame))?.point(grid.at))
    }
}

/// An error if lists expand to too many points.
pub fn limited(count: usize) -> Result<(), Problem> {
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
        let frame = self.fields(grid).displacement_frame.unwrap_or(BASIC);
        let axes = self.frames.get(frame).ok_or_else(|| unknown_frame(frame))?.axes_at(position);
        Ok(Pose { position, axes })
    }
}
