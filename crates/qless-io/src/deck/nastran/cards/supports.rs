//! `SPC`, `SPC1` and `SPCD`: points whose components have given values.

use super::spans::{Span, spans};
use crate::deck::kinematics::components::Components;
use crate::deck::nastran::syntax::card::{Card, Refused};

/// Components of some points, and their value.
#[derive(Clone, Debug, PartialEq)]
pub struct Support {
    pub points: Vec<Span>,
    pub components: Components,
    pub value: f64,
}

/// `SPC set, G1, C1, D1, G2, C2, D2`; `SPCD` has the same fields.
pub fn spc(card: &Card) -> Result<Vec<Support>, Refused> {
    let mut supports = Vec::new();
    for at in [1, 4] {
        if at > 1 && (at..at + 3).all(|i| card.is_blank(i)) {
            continue;
        }
        let node = card.id(at, "a grid or scalar point")?;
        let (components, value) = (card.components(at + 1)?, card.real(at + 2)?.unwrap_or(0.0));
        supports.push(Support { points: vec![Span { first: node, last: node }], components, value });
    }
    Ok(supports)
}

/// `SPC1 set, C, G1, G2, ...` or `SPC1 set, C, G1, THRU, G2`, beyond which MYSTRAN reads nothing.
pub fn spc1(card: &Card, is_mystran: bool) -> Result<Support, Refused> {
    let is_range = card.field(3).eq_ignore_ascii_case(b"THRU");
    let end = if is_mystran && is_range { 5 } else { card.len() };
    let points = spans(card, 2, end)?;
    if points.is_empty() {
        return Err(card.expected(2, "a grid or scalar point"));
    }
    Ok(Support { points, components: card.components(1)?, value: 0.0 })
}
