//! Refuses cards that stop ccx when it reads the deck, although their equations are clear.

use std::collections::BTreeSet;

use crate::deck::calculix::syntax::{DataLine, KeywordCard, number};
use crate::deck::{Model, Sources};

/// Largest number of fields of a line in ccx.
const FIELDS: usize = 16;

/// Refuses a byte order mark in front of a keyword, because ccx then does not recognise the card. If the card is `*HEADING`, this does no
/// harm.
pub fn byte_order_marks(sources: &Sources, model: &mut Model) {
    for (file, number) in (0..sources.paths().len()).zip(0..) {
        let text = sources.text(file);
        let Some(rest) = text.strip_prefix(b"\xef\xbb\xbf") else { continue };
        let is_heading = rest.get(..8).is_some_and(|word| word.eq_ignore_ascii_case(b"*HEADING"));
        if rest.starts_with(b"*") && !rest.starts_with(b"**") && !is_heading {
            let text = "ccx stops: it does not recognise the first card after a byte order mark; save the file without the mark";
            model.refuse(number, 1, text);
        }
    }
}

/// Refuses `*EQUATION` after the start of a step, and its lines that ccx does not accept. Reports each kind of error once for the card.
pub fn equation(card: &KeywordCard, is_late: bool, model: &mut Model) {
    if is_late {
        model.refuse(card.file, card.line, "ccx stops: *EQUATION follows the start of a step; write it before");
    }
    let mut reported = BTreeSet::new();
    for line in card.lines() {
        if let Some(flaw) = flaw(&line).filter(|flaw| reported.insert(*flaw)) {
            model.refuse(line.file, line.number, format!("ccx stops: {flaw}"));
        }
    }
}

/// Why ccx does not accept a line of `*EQUATION`; `None` if it does. A line with one field is accepted here: it holds the number of terms.
fn flaw(line: &DataLine) -> Option<&'static str> {
    let mut fields = line.fields().skip(1).peekable();
    fields.peek()?;
    if line.fields().count() > FIELDS {
        return Some("a line of *EQUATION has more than 16 fields; break it");
    }
    let mut fields = line.fields();
    while let Some(node) = fields.next() {
        let component = fields.next().and_then(|field| number(field, "a degree of freedom").ok());
        if !node.first().is_none_or(u8::is_ascii_digit) {
            return Some("a term of *EQUATION names a node set; write the equation for each of its nodes");
        }
        if component.is_some_and(|component| component > 6 && component != 8 && component != 11) {
            return Some("a term of *EQUATION has a component that is not defined in ccx");
        }
        if fields.next().is_none() {
            return Some("a term of *EQUATION has no coefficient; write it, even if it is 0");
        }
    }
    None
}

/// Refuses types of `*MPC` that Abaqus has and ccx does not, and node sets in `*MPC BEAM`.
pub fn mpc(card: &KeywordCard, kind: &str, has_set: bool, model: &mut Model) {
    let flaw = match kind {
        "LINK" | "PIN" | "TIE" => format!("it does not know *MPC {kind}; write *EQUATION"),
        "BEAM" if has_set => "*MPC BEAM names a node set; write the constraint for each of its nodes".to_owned(),
        _ => return,
    };
    model.refuse(card.file, card.line, format!("ccx stops: {flaw}"));
}

/// Refuses a `*COUPLING` without `CONSTRAINT NAME`.
pub fn coupling(card: &KeywordCard, model: &mut Model) {
    if card.parameter("CONSTRAINTNAME").is_none_or(str::is_empty) {
        model.refuse(card.file, card.line, "ccx stops: *COUPLING has no CONSTRAINT NAME; give it one");
    }
}

/// Refuses `*KINEMATIC` that couples rotations or component 3 of plane elements, or whose reference is on its own surface.
pub fn kinematic(
    card: &KeywordCard,
    components: &[u8],
    (is_plane, holds_its_reference): (bool, bool),
    model: &mut Model,
) {
    if is_plane && components.contains(&3) {
        let text = "ccx stops: *KINEMATIC couples component 3 of plane elements; write 1 to 2 at most";
        model.refuse(card.file, card.line, text);
    }
    if components.iter().any(|component| *component > 3) {
        let text = "ccx stops: *KINEMATIC couples components above 3; write 1 to 3 at most";
        model.refuse(card.file, card.line, text);
    }
    if holds_its_reference {
        let text = "ccx stops: the REF NODE of the *COUPLING is on its own surface; take another node";
        model.refuse(card.file, card.line, text);
    }
}
