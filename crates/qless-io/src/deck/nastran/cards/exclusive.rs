//! `ASET`, `OMIT`, `BSET`, `CSET`, `QSET`, `SUPORT`: sets of components of which none may be in another, or dependent.
//!
//! | card | fields |
//! | --- | --- |
//! | `ASET` and the like | G1, C1, G2, C2, ... |
//! | `ASET1` and the like | C, G1, G2, ..., or C, G1, THRU, G2 |

use super::points::{PointSpan, spans};
use crate::deck::kinematics::components::Components;
use crate::deck::nastran::syntax::card::{BulkCard, CardPlace, CardRefusal};

/// Components of points in a set.
#[derive(Clone, Debug)]
pub struct ExclusiveMembers {
    /// Its letter: components are in one such set only.
    pub letter: char,
    pub points: Vec<PointSpan>,
    pub components: Components,
    pub place: CardPlace,
}

/// Names of such cards, with the letter of their set.
const CARDS: [(&str, char); 15] = [
    ("ASET", 'a'),
    ("ASET1", 'a'),
    ("OMIT", 'o'),
    ("OMIT1", 'o'),
    ("BSET", 'b'),
    ("BSET1", 'b'),
    ("BNDFIX", 'b'),
    ("BNDFIX1", 'b'),
    ("CSET", 'c'),
    ("CSET1", 'c'),
    ("BNDFREE", 'c'),
    ("BNDFRE1", 'c'),
    ("QSET", 'q'),
    ("QSET1", 'q'),
    ("SUPORT", 'r'),
];

/// The names of such cards.
pub fn names() -> impl Iterator<Item = &'static str> {
    CARDS.iter().map(|(name, _)| *name)
}

/// What a card puts into its set; none if it is no such card.
pub fn read(card: &BulkCard) -> Result<Option<Vec<ExclusiveMembers>>, CardRefusal> {
    let Some(&(name, letter)) = CARDS.iter().find(|(name, _)| *name == card.name) else { return Ok(None) };
    let members = |points, components| ExclusiveMembers { letter, points, components, place: CardPlace::of(card) };
    if name.ends_with('1') {
        // Of all points there is nothing that could be told apart.
        let is_all = card.field(1).eq_ignore_ascii_case(b"ALL");
        let points = if is_all { Vec::new() } else { spans(card, 1, card.len())? };
        return Ok(Some(vec![members(points, card.components(0)?)]));
    }
    let mut found = Vec::new();
    for i in (0..card.len()).step_by(2).filter(|&i| !card.is_blank(i)) {
        let node = card.id(i, "a grid or scalar point")?;
        found.push(members(vec![PointSpan { first: node, last: node }], card.components(i + 1)?));
    }
    Ok(Some(found))
}
