//! Changes to case control and to `MPCADD` cards, so that each subcase selects what it has to.

use super::target::MpcTargets;
use crate::deck::nastran::control::subcases::{CaseControl, SetChoice, SubcaseLeaf};
use crate::deck::nastran::reader::NastranContent;
use crate::deck::nastran::syntax::lines::FileLine;

/// Where, how many lines go, and the text in their place.
pub type TextChange = (FileLine, u32, String);

/// Fields of a set number in a line of a union.
const FIELD: usize = 8;

/// All of these changes.
pub fn changes(content: &NastranContent, targets: &MpcTargets) -> Vec<TextChange> {
    let mut changes = unions(content, targets);
    let Some(control) = &content.control else { return changes };
    if let (Some(set), Some(at)) = (targets.common(), content.landmarks.control) {
        changes.push((at, 0, format!("$ qless: selects the equations written below\nMPC = {set}\n")));
        // Where no selection is in force, those that are there would take the place of the new one.
        changes.extend(control.mpc_choices.iter().map(|(_, choice)| gone(choice, "another set is selected")));
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
    let above = control.above().filter(|above| !targets.dead.contains(&above.set));
    let is_used = above.is_some_and(|above| goes_by(above, control));
    if control.mpc_choices.iter().any(|choice| dead(&choice)) {
        changes.extend(above.filter(|_| !is_used).map(|above| gone(&above, "no subcase goes by it")));
    }
    for (holder, choice) in control.mpc_choices.iter().filter(dead) {
        let (at, lines, mut text) = gone(choice, "the set has no cards left");
        // Without a line of its own the subcase would take what is selected above.
        text.push_str(if *holder > 0 && is_used { "MPC = 0\n" } else { "" });
        changes.push((at, lines, text));
    }
    changes
}

/// Whether a subcase has what is selected above them all.
fn goes_by(above: SetChoice, control: &CaseControl) -> bool {
    control.cases().iter().flatten().any(|leaf| leaf.selection.mpc == Some(above))
}

/// Lets a subcase or a step select a set, in the place of what it selects itself.
fn select(leaf: &SubcaseLeaf, set: u32, control: &CaseControl) -> Vec<TextChange> {
    const WHY: &str = "$ qless: selects the equations written below\n";
    let own = control.mpc_choices.iter().filter(|(holder, _)| *holder == leaf.holder);
    let mut changes: Vec<TextChange> = own.map(|(_, choice)| gone(choice, "another set is selected")).collect();
    match (changes.last_mut(), control.opened(leaf.holder)) {
        (Some((.., text)), _) => text.extend([WHY, "MPC = ", &set.to_string(), "\n"]),
        (None, Some((file, line))) => changes.push(((file, line + 1), 0, format!("{WHY}MPC = {set}\n"))),
        // A deck without subcases that selects a set has a line that does.
        (None, None) => {}
    }
    changes
}

fn gone(choice: &SetChoice, why: &str) -> TextChange {
    ((choice.file, choice.line), 1, format!("$ qless: MPC = {} removed, as {why}\n", choice.set))
}

/// Unions without the sets that have no cards left.
fn unions(content: &NastranContent, targets: &MpcTargets) -> Vec<TextChange> {
    let mut changes = Vec::new();
    for (&set, cards) in &content.bulk.mpc_unions {
        for (of, place) in cards.iter().filter(|(of, _)| of.iter().any(|set| targets.dead.contains(set))) {
            let left: Vec<u32> = of.iter().copied().filter(|set| !targets.dead.contains(set)).collect();
            let mut text = format!("$ qless: {} without sets that have no cards left\n", place.name);
            text += &if left.is_empty() { String::new() } else { union(set, &left) };
            changes.push(((place.file, place.line), place.lines, text));
        }
    }
    changes
}

/// An `MPCADD` card.
pub fn union(set: u32, of: &[u32]) -> String {
    let mut text = format!("MPCADD  {set:>8}");
    for (k, part) in of.iter().enumerate() {
        // The number of the union takes the first field.
        if k > 0 && (k + 1).is_multiple_of(FIELD) {
            text += "+\n+       ";
        }
        text.push_str(&format_field(*part));
    }
    text + "\n"
}

/// A number in a field.
fn format_field(number: u32) -> String {
    format!("{number:>FIELD$}")
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_long_union_goes_on() {
        let of: Vec<u32> = (1..=9).collect();
        let expected =
            "MPCADD        70       1       2       3       4       5       6       7+\n+              8       9\n";
        assert_eq!(super::union(70, &of), expected);
    }
}
