//! `MPC set, G1, C1, A1, G2, C2, A2`, two terms a line: `sum A u = 0`, the first component dependent.

use crate::deck::kinematics::components::Components;
use crate::deck::nastran::fault::CardFault;
use crate::deck::nastran::syntax::card::{Card, PER_LINE, Refused};

/// A term: point, component (none for a scalar point), coefficient.
pub type Term = (u32, Components, f64);

/// The terms of the equation; one with coefficient 0 keeps its place.
pub fn terms(card: &Card) -> Result<Vec<Term>, Refused> {
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

fn term(card: &Card, at: usize) -> Result<Term, Refused> {
    const ONE: &str = "one component from 1 to 6, or 0 for a scalar point";
    let node = card.id(at, "a grid or scalar point")?;
    let component = card.components(at + 1)?;
    if component.len() > 1 {
        return Err(card.expected(at + 1, ONE));
    }
    Ok((node, component, card.real(at + 2)?.unwrap_or(0.0)))
}
