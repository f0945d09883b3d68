//! Reads the cards of sets that exclude each other: a component in `ASET`, `OMIT`, `BSET`, `CSET`, `QSET` or `SUPORT` must not be in
//! another of these sets, and must not be dependent.
//!
//! | card | fields |
//! | --- | --- |
//! | `ASET` and the like | G1, C1, G2, C2, ... |
//! | `ASET1` and the like | C, G1, G2, ..., or C, G1, THRU, G2 |

use super::points::{PointSpan, spans};
use crate::deck::kinematics::components::Components;
use crate::deck::nastran::syntax::card::{BulkCard, CardLocation, CardRefusal};

/// Components of points that a card puts into one of the exclusive sets.
#[derive(Clone, Debug)]
pub struct ExclusiveMembers {
    /// The letter of the set, such as `a` for `ASET`.
    pub letter: char,
    pub points: Vec<PointSpan>,
    pub components: Components,
    pub place: CardLocation,
}

/// The letter of each set, with the names of its cards.
const CARDS: [(char, &str); 6] = [
    ('a', "ASET ASET1"),
    ('o', "OMIT OMIT1"),
    ('b', "BSET BSET1 BNDFIX BNDFIX1"),
    ('c', "CSET CSET1 BNDFREE BNDFRE1"),
    ('q', "QSET QSET1"),
    ('r', "SUPORT"),
];

/// The names of all cards that put components into exclusive sets.
pub fn names() -> impl Iterator<Item = &'static str> {
    CARDS.iter().flat_map(|(_, names)| names.split(' '))
}

/// The components that a card puts into an exclusive set; `None` if the card is of another kind.
pub fn read(card: &BulkCard) -> Result<Option<Vec<ExclusiveMembers>>, CardRefusal> {
    let is_named = |(_, names): &&(char, &str)| names.split(' ').any(|name| name == card.name);
    let Some(&(letter, _)) = CARDS.iter().find(is_named) else { return Ok(None) };
    let members = |points, components| ExclusiveMembers { letter, points, components, place: CardLocation::new(card) };
    if card.name.ends_with('1') {
        // `ALL` names no single points, so it adds none here.
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
