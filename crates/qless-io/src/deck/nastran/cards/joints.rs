//! `RBAR1`, `RJOINT`, `RTRPLT`, `RTRPLT1` and OptiStruct's `JOINTG` as they stand on their cards.

use super::elements::{POINT, Read, alpha};
use crate::deck::kinematics::components::Components;
use crate::deck::kinematics::rigid::{Rigid, Side};
use crate::deck::nastran::syntax::card::{Card, Refused};

/// `RBAR1 id, GA, GB, CB, ALPHA`: components CB of one end follow the other.
pub fn rbar1(card: &Card) -> Result<Read<Rigid>, Refused> {
    let element = follow(card, [1, 2], all_or(card, 3)?)?;
    Ok(Read { element, alpha: alpha(card, 4)? })
}

/// `RJOINT id, GA, GB, CB`: the same for points at one place.
pub fn rjoint(card: &Card) -> Result<Rigid, Refused> {
    follow(card, [1, 2], all_or(card, 3)?)
}

/// `RTRPLT id, GA, GB, GC, CNA, CNB, CNC, , CMA, CMB, CMC, ALPHA`; without CM all other components are dependent.
pub fn rtrplt(card: &Card) -> Result<Read<Rigid>, Refused> {
    let points = [card.id(1, POINT)?, card.id(2, POINT)?, card.id(3, POINT)?];
    let sets = |from: usize| Ok([card.components(from)?, card.components(from + 1)?, card.components(from + 2)?]);
    let (independent, dependent) = (sets(4)?, sets(8)?);
    let is_given = dependent.iter().any(|set| !set.is_empty());
    let dependent = if is_given { dependent } else { independent.map(|set| Components::ALL.without(set)) };
    let side =
        |sets: [Components; 3]| points.into_iter().zip(sets).filter(|(_, set)| !set.is_empty()).collect::<Side>();
    let element = Rigid { independent: side(independent), dependent: side(dependent) };
    Ok(Read { element, alpha: alpha(card, 11)? })
}

/// `RTRPLT1 id, GA, GB, GC, CB, CC, ALPHA`: components of two corners follow the third.
pub fn rtrplt1(card: &Card) -> Result<Read<Rigid>, Refused> {
    let mut element = follow(card, [1, 2], all_or(card, 4)?)?;
    element.dependent.push((card.id(3, POINT)?, all_or(card, 5)?));
    Ok(Read { element, alpha: alpha(card, 6)? })
}

/// What a `JOINTG` lets its second point do.
#[derive(Clone, Debug, PartialEq)]
pub enum Joint {
    /// Nothing by itself, wherever it is.
    Beam(Rigid),
    /// To turn; both points are at one place.
    Ball(Rigid),
    /// Something that this reader does not follow.
    Other,
}

/// `JOINTG id, property, type, G1, CID1, G2, CID2`.
pub fn jointg(card: &Card) -> Result<Joint, Refused> {
    match card.field(2).to_ascii_uppercase().as_slice() {
        b"RBEAM" => follow(card, [3, 5], Components::ALL).map(Joint::Beam),
        b"BALL" => {
            let translations = (1..=3).map(Components::one).fold(Components::ALL, Components::without);
            follow(card, [3, 5], Components::ALL.without(translations)).map(Joint::Ball)
        }
        _ => Ok(Joint::Other),
    }
}

/// Components of the second point follow the first.
fn follow(card: &Card, [first, second]: [usize; 2], set: Components) -> Result<Rigid, Refused> {
    let (first, second) = (card.id(first, POINT)?, card.id(second, POINT)?);
    Ok(Rigid { independent: vec![(first, Components::ALL)], dependent: vec![(second, set)] })
}

/// Components; all where the field is blank.
fn all_or(card: &Card, i: usize) -> Result<Components, Refused> {
    if card.is_blank(i) { Ok(Components::ALL) } else { card.some_components(i) }
}
