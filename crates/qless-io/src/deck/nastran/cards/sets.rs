//! Reads cards that belong to numbered sets: `MPC` equations, prescribed values, and unions of sets.
//!
//! `MPC set, G1, C1, A1, G2, C2, A2, ...` is the equation `sum A_i u_i = 0`, where u_i is component Ci of point Gi. A line holds two terms,
//! and the first component is dependent. `SPC`, `SPC1` and `SPCD` prescribe components of points. `MPCADD` and `SPCADD` define a set as the
//! union of other sets.

use std::collections::{BTreeMap, BTreeSet};

use super::points::{PointSpan, spans};
use crate::deck::kinematics::components::Components;
use crate::deck::nastran::syntax::card::{BulkCard, CardLocation, CardRefusal, PER_LINE};
use crate::deck::{CardFault, Problem};

/// The problem that a set or a coordinate system depends on itself.
pub fn circle(what: &'static str, id: u32) -> Problem {
    Problem::Circular { what, name: id.to_string() }
}

/// A term of an `MPC` equation: the point, the component (empty for a scalar point), and the coefficient.
pub type MpcTerm = (u32, Components, f64);

/// Reads the terms of an `MPC` card in its order, including those with coefficient 0.
pub fn terms(card: &BulkCard) -> Result<Vec<MpcTerm>, CardRefusal> {
    let mut terms = Vec::new();
    for line in (0..card.len()).step_by(PER_LINE) {
        for at in [line + 1, line + 4] {
            if (at..at + 3).any(|i| !card.is_blank(i)) {
                terms.push(term(card, at)?);
            }
        }
    }
    if terms.is_empty() {
        return Err(card.at(1, CardFault::NothingConnected.into()));
    }
    Ok(terms)
}

fn term(card: &BulkCard, at: usize) -> Result<MpcTerm, CardRefusal> {
    const ONE: &str = "one component from 1 to 6, or 0 for a scalar point";
    let node = card.id(at, "a grid or scalar point")?;
    let component = card.components(at + 1)?;
    if component.len() > 1 {
        return Err(card.expected(at + 1, ONE));
    }
    Ok((node, component, card.real(at + 2)?.unwrap_or(0.0)))
}

/// Points, the components that are prescribed there, and their value.
#[derive(Clone, Debug, PartialEq)]
pub struct PointSupport {
    pub points: Vec<PointSpan>,
    pub components: Components,
    pub value: f64,
}

/// Reads `SPC set, G1, C1, D1, G2, C2, D2`, or `SPCD` with the same fields.
pub fn spc(card: &BulkCard) -> Result<Vec<PointSupport>, CardRefusal> {
    let mut supports = Vec::new();
    for at in [1, 4] {
        if at > 1 && (at..at + 3).all(|i| card.is_blank(i)) {
            continue;
        }
        let node = card.id(at, "a grid or scalar point")?;
        let (components, value) = (card.components(at + 1)?, card.real(at + 2)?.unwrap_or(0.0));
        supports.push(PointSupport { points: vec![PointSpan { first: node, last: node }], components, value });
    }
    Ok(supports)
}

/// Reads `SPC1 set, C, G1, G2, ...` or `SPC1 set, C, G1, THRU, G2`. MYSTRAN ignores fields after such a range.
pub fn spc1(card: &BulkCard, is_mystran: bool) -> Result<PointSupport, CardRefusal> {
    let is_range = card.field(3).eq_ignore_ascii_case(b"THRU");
    let end = if is_mystran && is_range { 5 } else { card.len() };
    let points = spans(card, 2, end)?;
    if points.is_empty() {
        return Err(card.expected(2, "a grid or scalar point"));
    }
    Ok(PointSupport { points, components: card.components(1)?, value: 0.0 })
}

/// For each number of a union: the sets that it unites, and the card. Several cards may have the same number.
pub type SetUnions = BTreeMap<u32, Vec<(Vec<u32>, CardLocation)>>;

/// Reads `MPCADD set, S1, S2, ...`, or `SPCADD` with the same fields.
pub fn read_union(card: &BulkCard, unions: &mut SetUnions) -> Result<(), CardRefusal> {
    const SET: &str = "the number of a set";
    let members = (1..card.len()).filter(|&i| !card.is_blank(i)).map(|i| card.id(i, SET)).collect::<Result<_, _>>()?;
    unions.entry(card.id(0, SET)?).or_default().push((members, CardLocation::new(card)));
    Ok(())
}

/// The elementary sets of which `set` consists; unions in it are resolved recursively. If a union and an elementary set have the same
/// number, the union counts. The error holds the card of a union that contains itself.
pub fn members(set: u32, unions: &SetUnions) -> Result<BTreeSet<u32>, (CardLocation, Problem)> {
    let mut found = BTreeSet::new();
    let mut open = BTreeSet::new();
    let mut closed = BTreeSet::new();
    // The flag of a set is true when all its members have been visited.
    let mut stack = vec![(set, false)];
    while let Some((set, done)) = stack.pop() {
        if done {
            open.remove(&set);
            closed.insert(set);
            continue;
        }
        let Some(cards) = unions.get(&set) else {
            found.insert(set);
            continue;
        };
        if closed.contains(&set) || !open.insert(set) {
            continue;
        }
        stack.push((set, true));
        for (sets, place) in cards {
            if let Some(&inner) = sets.iter().find(|inner| open.contains(inner)) {
                return Err((place.clone(), circle("set", inner)));
            }
            stack.extend(sets.iter().map(|&inner| (inner, false)));
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deck::CardName;

    fn unions(parts: &[(u32, &[u32])]) -> SetUnions {
        let place = |set| CardLocation { name: CardName::numbered("SPCADD", set), file: 0, line: 1, lines: 1 };
        parts.iter().map(|&(set, of)| (set, vec![(of.to_vec(), place(set))])).collect()
    }

    #[test]
    fn unions_nest() {
        let unions = unions(&[(10, &[1, 20, 20]), (20, &[2, 30]), (30, &[3, 1])]);
        assert_eq!(members(10, &unions).map(|set| set.into_iter().collect()), Ok(vec![1, 2, 3]));
        assert_eq!(members(7, &unions).map(|set| set.into_iter().collect()), Ok(vec![7]));
    }

    #[test]
    fn a_union_of_itself_is_refused() {
        for (parts, inner) in [(unions(&[(10, &[10])]), 10), (unions(&[(10, &[20]), (20, &[30]), (30, &[20])]), 20)] {
            let (_, problem) = members(10, &parts).expect_err("a circle");
            assert_eq!(problem, circle("set", inner));
        }
    }
}
