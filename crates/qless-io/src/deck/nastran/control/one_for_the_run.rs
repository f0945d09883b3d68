//! MYSTRAN has one MPC set and one SPC set for the whole run: a subcase goes on with what those before it select, and where two differ it
//! stops (error 1830).

use super::subcases::{Choice, Selection};
use crate::deck::Model;
use crate::deck::nastran::cards::bulk::Bulk;

/// One kind of selection, for reading and writing.
type Kind = (&'static str, fn(&mut Selection) -> &mut Option<Choice>);

const KINDS: [Kind; 2] = [("MPC", |selection| &mut selection.mpc), ("SPC", |selection| &mut selection.spc)];

/// Gives each load case what MYSTRAN lets it have, and says where it stops.
pub fn carry_on(selections: &mut [(String, Selection)], bulk: &Bulk, model: &mut Model) {
    for (kind, of) in KINDS {
        let mut before = None;
        for (at, (_, selection)) in selections.iter_mut().enumerate() {
            let choice = of(selection);
            *choice = choice.or(before);
            if let Some(own) = *choice
                && at > 0
                && before.map(|before: Choice| before.set) != Some(own.set)
            {
                refuse(kind, own, before, model);
            }
            before = *choice;
        }
    }
    if selections.iter().all(|(_, selection)| selection.mpc.is_none()) {
        selections.iter_mut().for_each(|(_, selection)| selection.mpc = unnumbered(bulk));
    }
}

fn refuse(kind: &str, own: Choice, before: Option<Choice>, model: &mut Model) {
    let other = before.map_or_else(|| format!("no {kind} set"), |before| format!("{kind} = {}", before.set));
    let text =
        format!("{kind} = {}: MYSTRAN takes one {kind} set a run, and stops as a subcase before has {other}", own.set);
    model.refuse(own.file, own.line, text);
}

/// Set 0 holds where no other is selected.
fn unnumbered(bulk: &Bulk) -> Option<Choice> {
    bulk.ties.mpcs().find(|card| card.set == 0).map(|card| Choice { set: 0, file: card.file, line: card.line })
}
