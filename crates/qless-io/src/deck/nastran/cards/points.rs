//! Reads the cards of points: `GRID`, `GRDSET`, coordinate systems, and lists of points such as `3 5 10 THRU 20`.
//!
//! `GRID id, CP, X1, X2, X3, CD, PS` defines a grid point; `GRDSET` gives defaults for its blank fields. `CORD1R`, `CORD1C` and
//! `CORD1S` define up to two coordinate systems by grid points; `CORD2R`, `CORD2C` and `CORD2S` define one by coordinates.

use std::collections::BTreeMap;

use crate::deck::Problem;
use crate::deck::kinematics::axes::FrameKind;
use crate::deck::kinematics::components::Components;
use crate::deck::kinematics::vector::Vector;
use crate::deck::nastran::syntax::card::{BulkCard, CardRefusal};

/// The problem that a coordinate system is not defined.
pub fn unknown_frame(frame: u32) -> Problem {
    Problem::Undefined { what: "coordinate system", name: frame.to_string() }
}

/// The problem that a grid point is not defined.
pub fn unknown_grid(node: u32) -> Problem {
    Problem::Undefined { what: "grid point", name: node.to_string() }
}

/// Number of the basic coordinate system.
pub const BASIC: u32 = 0;

/// The three points that define a coordinate frame: its origin, a point on its third axis, and a point in the plane of its first and third
/// axes.
#[derive(Clone, Debug, PartialEq)]
pub enum FrameDefinition {
    /// The coordinates of the points in the frame `reference`, from `CORD2R`, `CORD2C` or `CORD2S`.
    Points { kind: FrameKind, reference: u32, points: [Vector; 3] },
    /// Three grid points, from `CORD1R`, `CORD1C` or `CORD1S`.
    Grids { kind: FrameKind, grids: [u32; 3] },
}

/// All frame definitions of a deck, by number.
pub type FrameDefinitions = BTreeMap<u32, FrameDefinition>;

/// The content of a `GRID` card.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridCard {
    pub id: u32,
    /// The coordinates of the point in its coordinate system CP.
    pub at: Vector,
    pub fields: GridDefaults,
}

/// The fields of `GRID` that `GRDSET` can fill in; `None` for a blank field.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct GridDefaults {
    /// CP, the number of the frame of the coordinates.
    pub position_frame: Option<u32>,
    /// CD, the number of the frame of the displacements.
    pub displacement_frame: Option<u32>,
    /// PS, the components that are prescribed to 0 in every subcase.
    pub prescribed: Option<Components>,
}

impl GridCard {
    pub fn read(card: &BulkCard) -> Result<Self, CardRefusal> {
        let mut at = [0.0; 3];
        for (i, x) in at.iter_mut().enumerate() {
            *x = card.real(2 + i)?.unwrap_or(0.0);
        }
        let id = card.id(0, "the number of the grid point")?;
        Ok(Self { id, at, fields: GridDefaults::read(card)? })
    }
}

impl GridDefaults {
    pub fn read(card: &BulkCard) -> Result<Self, CardRefusal> {
        let prescribed = if card.is_blank(6) { None } else { Some(card.components(6)?) };
        Ok(Self { position_frame: frame(card, 1)?, displacement_frame: frame(card, 5)?, prescribed })
    }

    /// Returns these fields. Those that are blank are filled from `other`.
    pub fn or(self, other: Self) -> Self {
        Self {
            position_frame: self.position_frame.or(other.position_frame),
            displacement_frame: self.displacement_frame.or(other.displacement_frame),
            prescribed: self.prescribed.or(other.prescribed),
        }
    }
}

/// The number of a coordinate system in field `i`. -1, which makes a fluid point, counts as the basic system.
fn frame(card: &BulkCard, i: usize) -> Result<Option<u32>, CardRefusal> {
    if card.field(i) == b"-1" { Ok(Some(BASIC)) } else { card.optional_whole(i, "a coordinate system") }
}

const ID: &str = "the number of the coordinate system";

/// Reads `CORD1x id, G1, G2, G3`, which may occur twice on a card.
pub fn through_grids(card: &BulkCard, kind: FrameKind) -> Result<Vec<(u32, FrameDefinition)>, CardRefusal> {
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

/// Reads `CORD2x id, reference, A1, A2, A3, B1, B2, B3, C1, C2, C3`.
pub fn through_points(card: &BulkCard, kind: FrameKind) -> Result<(u32, FrameDefinition), CardRefusal> {
    let reference = card.optional_whole(1, "a coordinate system")?.unwrap_or(BASIC);
    let mut points = [[0.0; 3]; 3];
    for (i, x) in points.as_flattened_mut().iter_mut().enumerate() {
        *x = card.real(2 + i)?.unwrap_or(0.0);
    }
    Ok((card.id(0, ID)?, FrameDefinition::Points { kind, reference, points }))
}

/// The point numbers from `first` to `last`. Numbers without a point are skipped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PointSpan {
    pub first: u32,
    pub last: u32,
}

/// Reads the list of points in the fields `from..to`; blank fields are skipped.
pub fn spans(card: &BulkCard, from: usize, to: usize) -> Result<Vec<PointSpan>, CardRefusal> {
    let filled: Vec<usize> = (from..to).filter(|&i| !card.is_blank(i)).collect();
    spans_in(card, &filled)
}

/// Reads the list of points in these fields, none of which is blank.
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
