//! Changes case control and `MPCADD` cards, so that each load case selects its sets.

use super::target::MpcTargets;
use crate::deck::nastran::control::subcases::{CaseControl, SetChoice, SubcaseLeaf};
use crate::deck::nastran::reader::NastranContent;
use crate::deck::nastran::syntax::lines::FileLine;

/// A change of the text: the first line, the number of lines that are removed there, and the text that replaces them.
pub type TextChange = (FileLine, u32, String);

/// Number of data fields on a line, and also the number of columns of a field.
const FIELD: usize = 8;

/// All changes to the selections of sets and to unions.
pub fn changes(content: &NastranContent, targets: &MpcTargets) -> Vec<TextChange> {
    let mut changes = unions(content, targets);
    let Some(control) = &content.control else { return changes };
    if let (Some(set), Some(at)) = (targets.common(), content.landmarks.control) {
        changes.push((at, 0, format!("$ qless: selects the equations written below\nMPC = {set}\n")));
        // None of the existing choices has an effect, but one that stands further down would override the new choice.
        changes.extend(control.mpc_choices.iter().map(|(_, choice)| removed(choice, "another set is selected")));
        return changes;
    }
    let mut replaced = Vec::new();
    for (leaves, &(before, after)) in control.cases().iter().zip(&targets.selected) {
        let Some(set) = after.filter(|_| after != before) else { continue };
        for leaf in leaves {
            replaced.push(leaf.holder);
            changes.extend(select(leaf, set, control));
        }
    }
    let dead =
        |(holder, choice): &&(usize, SetChoice)| targets.dead.contains(&choice.set) && !replaced.contains(holder);
    let common = control.common_choice().filter(|common| !targets.dead.contains(&common.set));
    let is_used = common.is_some() && control.cases().iter().flatten().any(|leaf| leaf.selection.mpc == common);
    if control.mpc_choices.iter().any(|choice| dead(&choice)) {
        changes.extend(common.filter(|_| !is_used).map(|common| removed(&common, "no subcase uses it")));
    }
    for (holder, choice) in control.mpc_choices.iter().filter(dead) {
        let (at, lines, mut text) = removed(choice, "the set has no cards left");
        // Without a choice of its own, the subcase would inherit the choice before the first subcase.
        text.push_str(if *holder > 0 && is_used { "MPC = 0\n" } else { "" });
        changes.push((at, lines, text));
    }
    changes
}

/// Lets a subcase or step select this set in place of its own choices.
fn select(leaf: &SubcaseLeaf, set: u32, control: &CaseControl) -> Vec<TextChange> {
    const WHY: &str = "$ qless: selects the equations written below\n";
    let own = control.mpc_choices.iter().filter(|(holder, _)| *holder == leaf.holder);
    let mut changes: Vec<TextChange> = own.map(|(_, choice)| removed(choice, "another set is selected")).collect();
    match (changes.last_mut(), control.opened(leaf.holder)) {
        (Some((.., text)), _) => text.extend([WHY, "MPC = ", &set.to_string(), "\n"]),
        (None, Some((file, line))) => changes.push(((file, line + 1), 0, format!("{WHY}MPC = {set}\n"))),
        // This does not happen: `changes` has already handled a deck without subcases and without choices.
        (None, None) => {}
    }
    changes
}

fn removed(choice: &SetChoice, why: &str) -> TextChange {
    ((choice.file, choice.line), 1, format!("$ qless: MPC = {} removed, as {why}\n", choice.set))
}

/// Replaces the unions that contain sets without cards by unions of the other sets.
fn unions(content: &NastranContent, targets: &MpcTargets) -> Vec<TextChange> {
    let mut changes = Vec::new();
    for (&set, cards) in &content.bulk.mpc_unions {
        for (sets, place) in cards.iter().filter(|(sets, _)| sets.iter().any(|set| targets.dead.contains(set))) {
            let live: Vec<u32> = sets.iter().copied().filter(|set| !targets.dead.contains(set)).collect();
            let mut text = format!("$ qless: {} without sets that have no cards left\n", place.name);
            text += &if live.is_empty() { String::new() } else { union(set, &live) };
            changes.push(((place.file, place.line), place.lines, text));
        }
    }
    changes
}

/// The text of an `MPCADD` card.
pub fn union(set: u32, members: &[u32]) -> String {
    small_field("MPCADD", [set].iter().chain(members).map(u32::to_string))
}

/// The text of a card in small field, with continuation lines if needed.
pub fn small_field(name: &str, fields: impl Iterator<Item = String>) -> String {
    let mut text = format!("{name:FIELD$}");
    for (k, field) in fields.enumerate() {
        if k > 0 && k.is_multiple_of(FIELD) {
            text += "+\n+       ";
        }
        text.extend([format!("{field:>FIELD$}")]);
    }
    text + "\n"
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_long_union_has_a_continuation_line() {
        let members: Vec<u32> = (1..=9).collect();
        let expected =
            "MPCADD        70       1       2       3       4       5       6       7+\n+              8       9\n";
        assert_eq!(super::union(70, &members), expected);
    }
}
