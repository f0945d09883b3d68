//! Cards that equations cannot stand in for must not be among those that go.

use super::{Reason, Removed};
use crate::deck::Model;
use crate::deck::clean::CleanError;

/// What is said first is what is wrong itself.
pub fn check(model: &Model, removed: &[Removed]) -> Result<(), CleanError> {
    let card = |removed: &Removed| model.nth(removed.equation).origin.card;
    let weight = |reason: &Reason| match reason {
        Reason::Fault(_) => 0,
        Reason::Redundant(_) => 1,
        Reason::Connected => 2,
    };
    let fixed = removed.iter().filter(|removed| model.cards.nth(card(removed)).is_fixed);
    let Some(first) = fixed.min_by_key(|removed| weight(&removed.reason)) else { return Ok(()) };
    let fault = match &first.reason {
        Reason::Fault(fault) => fault.describe(model),
        Reason::Redundant(_) => "it repeats what other such cards say".to_owned(),
        Reason::Connected => "an equation that shares DOFs with it has to be".to_owned(),
    };
    let why = match model.cards.why_fixed(card(first)) {
        Some(why) => format!("{fault}; {why}"),
        None => fault,
    };
    Err(CleanError::Fixed { place: model.place(model.nth(first.equation).origin), why })
}
