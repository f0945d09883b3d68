//! `GRID id, CP, X1, X2, X3, CD, PS` and `GRDSET`, which says what the others leave blank.

use crate::deck::kinematics::components::Components;
use crate::deck::kinematics::vector::Vector;
use crate::deck::nastran::model::frames::BASIC;
use crate::deck::nastran::syntax::card::{Card, Refused};

/// What a `GRID` card says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Given {
    pub id: u32,
    /// Coordinates in the system CP.
    pub at: Vector,
    pub usual: Usual,
}

/// What `GRDSET` can give; none where the card leaves it blank.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Usual {
    /// CP.
    pub given_in: Option<u32>,
    /// CD.
    pub moves_in: Option<u32>,
    /// PS, components held in every subcase.
    pub held: Option<Components>,
}

impl Given {
    pub fn read(card: &Card) -> Result<Self, Refused> {
        let mut at = [0.0; 3];
        for (i, x) in at.iter_mut().enumerate() {
            *x = card.real(2 + i)?.unwrap_or(0.0);
        }
        let id = card.id(0, "the number of the grid point")?;
        Ok(Self { id, at, usual: Usual::read(card)? })
    }
}

impl Usual {
    pub fn read(card: &Card) -> Result<Self, Refused> {
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
fn frame(card: &Card, i: usize) -> Result<Option<u32>, Refused> {
    if card.field(i) == b"-1" { Ok(Some(BASIC)) } else { card.optional_whole(i, "a coordinate system") }
}
