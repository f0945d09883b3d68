//! Mutually exclusive sets: a component in `ASET`, `OMIT`, `BSET`, `CSET`, `QSET` or `SUPORT` may be in no other of these sets, and may
//! not be dependent.
//!
//! | card | fields |
//! | --- | --- |
//! | `ASET` and the like | G1, C1, G2, C2, ... |
//! | `ASET1` and the like | C, G1, G2, ..., or C, G1, THRU, G2 |

use super::points::{PointSpan, spans};
use crate::deck::kinematics::components::Components;
use crate::deck::nastran::syntax::card::{BulkCard, CardPlace, CardRefusal};

/// Components of points that a card puts into an exclusive set.
#[derive(Clone, Debug)]
pub struct ExclusiveMembers {
    /// Letter of the set.
    pub letter: char,
    pub points: Vec<PointSpan>,
    pub components: Components,
    pub place: CardPlace,
}

/// Card names with the letter of their set.
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

/// All card names.
pub fn names() -> impl Iterator<Item = &'static str> {
    CARDS.iter().map(|(name, _)| *name)
}

/// The components that a card puts into its set; `None` for other cards.
pub fn read(card: &BulkCard) -> Result<Option<Vec<ExclusiveMembers>>, CardRefusal> {
    let Some(&(name, letter)) = CARDS.iter().find(|(name, _)| *name == card.name) else { return Ok(None) };
    let members = |points, components| ExclusiveMembers { letter, points, components, place: CardPlace::of(card) };
    if name.ends_with('1') {
        // A set of all points cannot conflict with a particular point here, so it counts as empty.
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
