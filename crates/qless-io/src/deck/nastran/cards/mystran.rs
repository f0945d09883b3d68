//! How MYSTRAN differs from Nastran in reading cards: which cards it ignores, and at which it stops.

use super::elements::{filled, is_real, is_word};
use super::unread::CardNotes;
use crate::deck::nastran::syntax::card::{BulkCard, PER_LINE};
use crate::number::whole;

/// Whether MYSTRAN ignores cards of this name, although they constrain in Nastran.
pub fn ignores(name: &str) -> bool {
    matches!(name, "RROD" | "RJOINT" | "RTRPLT" | "RTRPLT1" | "SPCD")
}

/// Whether the element number is blank, zero or negative, which MYSTRAN accepts.
pub fn has_no_number(card: &BulkCard) -> bool {
    let word = card.field(0);
    word.is_empty() || whole(word.strip_prefix(b"-").unwrap_or(word)).is_some_and(|id| id == 0 || word[0] == b'-')
}

/// Notes why MYSTRAN stops at a card, or which fields it ignores.
pub fn judge(card: &BulkCard, notes: &mut CardNotes) {
    let at = (card.file, card.line);
    if let Some(why) = refusal(card) {
        notes.refuse(at, format!("{}: {why}", card.title()));
    }
    if card.name == "SPC1" && is_word(card, 3, b"THRU") && card.len() > 5 {
        notes.warn(at, format!("MYSTRAN ignores the fields after the range of {}", card.title()));
    }
}

fn refusal(card: &BulkCard) -> Option<&'static str> {
    let has = |word| filled(card, 2).into_iter().any(|i| is_word(card, i, word));
    match card.name {
        "RBAR" | "RBAR1" | "RBE1" => Some("MYSTRAN stops at this element; write it as RBE2"),
        "RBE2" if has(b"THRU") => Some("MYSTRAN stops at THRU; write out the list"),
        "RBE2" if (3..card.len()).any(|i| is_real(card, i)) => Some("MYSTRAN stops at ALPHA; remove it"),
        "RBE3" if has(b"UM") => Some("MYSTRAN stops at UM; remove the list"),
        "RBE3" if has(b"THRU") => Some("MYSTRAN stops at THRU; write out the list"),
        "RBE3" if has(b"ALPHA") => Some("MYSTRAN stops at ALPHA; remove it"),
        "MPC" if has_whole(card, [3, 6]) => Some("MYSTRAN stops at a coefficient without a decimal point; add one"),
        "SPC" if has_whole(card, [3, 6]) => Some("MYSTRAN stops at a value without a decimal point; add one"),
        _ => None,
    }
}

/// Whether one of these fields, on any line of the card, holds a text without a decimal point.
fn has_whole(card: &BulkCard, fields: [usize; 2]) -> bool {
    let all = (0..card.len()).step_by(PER_LINE).flat_map(|line| fields.map(|field| line + field));
    all.into_iter().any(|i| !card.is_blank(i) && !card.field(i).contains(&b'.'))
}
