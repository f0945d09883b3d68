//! `GRID id, CP, X1, X2, X3, CD, PS` and `GRDSET`, which says what the others leave blank.
//!
//! `CORD1R`, `CORD1C`, `CORD1S`, two frames a card, and `CORD2R`, `CORD2C`, `CORD2S`.
//!
//! Lists of grid points: `3 5 10 THRU 20`.

use std::collections::BTreeMap;

use crate::deck::Problem;
use crate::deck::kinematics::axes::Kind;
use crate::deck::kinematics::components::Components;
use crate::deck::kinematics::vector::Vector;
use crate::deck::nastran::syntax::card::{BulkCard, CardRefusal};

/// A coordinate system that nothing defines.
pub fn unknown_frame(frame: u32) -> Problem {
    Problem::Undefined { what: "coordinate system", name: frame.to_string() }
}

/// A grid point that nothing defines.
pub fn unknown_grid(node: u32) -> Problem {
    Problem::Undefined { what: "grid point", name: node.to_string() }
}

/// Frame 0, the basic one.
pub const BASIC: u32 = 0;

/// How a card defines a frame: by its origin, a point on its third axis, and one in the plane of first and third.
#[derive(Clone, Debug, PartialEq)]
pub enum FrameDefinition {
    /// `CORD2x`: points in frame `reference`.
    Points { kind: Kind, reference: u32, points: [Vector; 3] },
    /// `CORD1x`: grid points.
    Grids { kind: Kind, grids: [u32; 3] },
}

/// All definitions of a deck by identification.
pub type FrameDefinitions = BTreeMap<u32, FrameDefinition>;

/// What a `GRID` card says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridCard {
    pub id: u32,
    /// Coordinates in the system CP.
    pub at: Vector,
    pub usual: GridDefaults,
}

/// What `GRDSET` can give; none where the card leaves it blank.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct GridDefaults {
    /// CP.
    pub given_in: Option<u32>,
    /// CD.
    pub moves_in: Option<u32>,
    /// PS, components held in every subcase.
    pub held: Option<Components>,
}

impl GridCard {
    pub fn read(card: &BulkCard) -> Result<Self, CardRefusal> {
        let mut at = [0.0; 3];
        for (i, x) in at.iter_mut().enumerate() {
            *x = card.real(2 + i)?.unwrap_or(0.0);
        }
        let id = card.id(0, "the number of the grid point")?;
        Ok(Self { id, at, usual: GridDefaults::read(card)? })
    }
}

impl GridDefaults {
    pub fn read(card: &BulkCard) -> Result<Self, CardRefusal> {
        let held = if card.is_blank(6) { None } else { Some(card.components(6)?) };
        Ok(Self { given_in: frame(card, 1)?, moves_in: frame(card, 5)?, held })
    }

    /// This, with its blanks filled.
    pub fn or(self, other: Self) -> Self {
        Self {
            given_in: self.given_in.or(other.given_in),
            moves_in: self.moves_in.or(other.moves_in),
            held: self.held.or(other.held),
        }
    }
}

/// A coordinate system; -1, which makes a fluid point, counts as the basic one.
fn frame(card: &BulkCard, i: usize) -> Result<Option<u32>, CardRefusal> {
    if card.field(i) == b"-1" { Ok(Some(BASIC)) } else { card.optional_whole(i, "a coordinate system") }
}

const ID: &str = "the number of the coordinate system";

/// `CORD1x id, G1, G2, G3`, once or twice.
pub fn through_grids(card: &BulkCard, kind: Kind) -> Result<Vec<(u32, FrameDefinition)>, CardRefusal> {
    let mut found = Vec::new();
    for start in [0, 4] {
        if start > 0 && (start..start + 4).all(|i| card.is_blank(i)) {
            continue;
        }
        let mut grids = [0; 3];
        for (i, node) in grids.iter_mut().enumerate() {
            *node = card.id(start + 1 + i, "a grid point")?;
        }
        found.push((card.id(start, ID)?, FrameDefinition::Grids { kind, grids }));
    }
    Ok(found)
}

/// `CORD2x id, reference, A1, A2, A3, B1, B2, B3, C1, C2, C3`.
pub fn through_points(card: &BulkCard, kind: Kind) -> Result<(u32, FrameDefinition), CardRefusal> {
    let reference = card.optional_whole(1, "a coordinate system")?.unwrap_or(BASIC);
    let mut points = [[0.0; 3]; 3];
    for (i, x) in points.as_flattened_mut().iter_mut().enumerate() {
        *x = card.real(2 + i)?.unwrap_or(0.0);
    }
    Ok((card.id(0, ID)?, FrameDefinition::Points { kind, reference, points }))
}

/// Numbers from `first` to `last`; those between, but not the two themselves, may be missing in the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PointSpan {
    pub first: u32,
    pub last: u32,
}

/// The list in fields `from..to`; blank fields are passed over.
pub fn spans(card: &BulkCard, from: usize, to: usize) -> Result<Vec<PointSpan>, CardRefusal> {
    let filled: Vec<usize> = (from..to).filter(|&i| !card.is_blank(i)).collect();
    spans_in(card, &filled)
}

/// The list in these fields, none of them blank.
pub fn spans_in(card: &BulkCard, fields: &[usize]) -> Result<Vec<PointSpan>, CardRefusal> {
    const POINT: &str = "a grid or scalar point";
    let mut fields = fields.iter().copied().peekable();
    let mut spans = Vec::new();
    while let Some(i) = fields.next() {
        let first = card.id(i, POINT)?;
        if fields.next_if(|&i| card.field(i).eq_ignore_ascii_case(b"THRU")).is_none() {
            spans.push(PointSpan { first, last: first });
            continue;
        }
        let end = fields.next().unwrap_or(i + 2);
        let last = card.id(end, "the last point of the list after THRU")?;
        if last < first {
            return Err(card.expected(end, "a number after THRU that is not below the one before it"));
        }
        spans.push(PointSpan { first, last });
    }
    Ok(spans)
}
