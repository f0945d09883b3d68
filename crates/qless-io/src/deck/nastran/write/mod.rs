//! Writes a deck with changed constraints. Comments replace removed cards. New equations become `MPC` cards in sets that the load cases
//! select.

mod fewer_nodes;
mod select;
mod target;
mod wide;

use std::collections::{BTreeMap, BTreeSet};

use target::MpcTargets;
use wide::mpc;

use super::reader::{NastranContent, read};
use super::syntax::lines::FileLine;
use crate::deck::clean::{CleanError, Edits, Plan, Reason, Removed, shortened};
use crate::deck::plan::reason;
use crate::deck::{Deck, Model};
use select::TextChange;
use target::EquationGroup;

/// Returns the text of the main file with the changes of the plan. The text of included files that change becomes part of it.
pub fn write(deck: &Deck, plan: &Plan) -> Result<Vec<u8>, CleanError> {
    let cases = deck.model.cases.len();
    let mut groups: Vec<EquationGroup> = Vec::new();
    for written in &plan.written {
        let holds_in: Vec<usize> = (0..cases).filter(|&case| written.cases.contain(case)).collect();
        match groups.iter_mut().find(|(cases, _)| *cases == holds_in) {
            Some((_, group)) => group.push(written.clone()),
            None => groups.push((holds_in, vec![written.clone()])),
        }
    }
    write_groups(deck, &plan.removed, &groups)
}

/// Returns the text of the main file without the cards of removed equations. It has the new equations of each group, which hold only in the
/// load cases of that group.
///
/// A removed card no longer holds in any load case. So the groups must contain its equations for the load cases that still need them.
pub fn write_groups(deck: &Deck, removed: &[Removed], groups: &[EquationGroup]) -> Result<Vec<u8>, CleanError> {
    let content = deck.again(read)?;
    let is_written = groups.iter().any(|(_, written)| !written.is_empty());
    let mut changes = comments(&deck.model, &content, removed, is_written);
    let targets = MpcTargets::new(&content, deck, removed, groups)?;
    changes.extend(select::changes(&content, &targets));
    if is_written {
        // New cards stand after `BEGIN BULK`, or at the end of a deck without it.
        let at = content.landmarks.bulk.or(content.landmarks.end).unwrap_or((0, u32::MAX));
        check_included_once(&content, at, deck)?;
        changes.push((at, 0, new_text(&targets, content.control.is_some())));
    }
    Ok(NastranWriter { deck, content: &content, changes: &changes }.file(0, false))
}

/// The comments that replace the removed cards. A comment gives the reason of one of the card's equations, preferably a fault.
fn comments(model: &Model, content: &NastranContent, removed: &[Removed], is_written: bool) -> Vec<TextChange> {
    let mut texts: BTreeMap<FileLine, (u32, String)> = BTreeMap::new();
    for removed in removed {
        let origin = model.nth(removed.equation).origin;
        let file = model.cards.nth(origin.card).file;
        let text = texts.entry((file, origin.line)).or_insert((origin.lines, String::new()));
        if text.1.is_empty() || matches!(removed.reason, Reason::Fault(_)) {
            text.1 = comment(model, removed, is_written);
        }
    }
    let shorter = shortened(model, removed);
    for (at, card) in fewer_nodes::with_points(&content.bulk.ties) {
        if let (Some(shorter), Some((_, text))) = (shorter.get(&at), texts.get_mut(&at)) {
            let lost = format!("$ qless: {} of ", shorter.lost_names());
            *text = text.replacen("$ qless: ", &lost, 1) + &card(&shorter.left);
        }
    }
    let apart =
        |at: &FileLine| content.bulk.apart.get(at).into_iter().flatten().map(|&at| (at, 1, CONTINUED.to_owned()));
    let continuations: Vec<TextChange> = texts.keys().flat_map(apart).collect();
    texts.into_iter().map(|(at, (lines, text))| (at, lines, text)).chain(continuations).collect()
}

/// The comment that replaces a continuation line of a removed card, if other cards separate the line from the card.
const CONTINUED: &str = "$ qless: continuation of a removed card\n";

/// A comment line with the reason why a card was removed.
fn comment(model: &Model, removed: &Removed, is_written: bool) -> String {
    let place = model.place(model.nth(removed.equation).origin);
    let now = if is_written { "written anew as MPC" } else { "removed" };
    format!("$ qless: {place} {}\n", reason(model, removed, now))
}

/// Refuses to write new cards into a file that is included more than once, because the cards would then occur more than once.
fn check_included_once(content: &NastranContent, (file, line): FileLine, deck: &Deck) -> Result<(), CleanError> {
    match content.landmarks.includes.iter().filter(|include| include.inner == file).count() {
        0 | 1 => Ok(()),
        _ => Err(CleanError::Place {
            path: deck.model.files[file as usize].clone(),
            line: line as usize,
            why: "new cards belong here, but this file is included more than once; move BEGIN BULK to the main file",
        }),
    }
}

fn new_text(targets: &MpcTargets, has_control: bool) -> String {
    let mut text = String::from(
        "$ qless: independent equations; the first component of each is first in no other, and is not prescribed\n\
         $ qless: numbers of more than 16 columns are rounded to the nearest that Nastran reads\n",
    );
    for (parts, set) in &targets.unions {
        text += &select::union(*set, parts);
    }
    for (set, written) in &targets.cards {
        if !has_control {
            text.extend(["$ qless: select them in case control by MPC = ", &set.to_string(), "\n"]);
        }
        written.iter().for_each(|written| text += &mpc(*set, written));
    }
    text
}

struct NastranWriter<'a> {
    deck: &'a Deck,
    content: &'a NastranContent,
    changes: &'a [TextChange],
}

impl NastranWriter<'_> {
    /// The text of a file with its changes. If the text becomes part of another file (`is_embedded`), the files that it includes become
    /// part of it too.
    fn file(&self, file: u32, is_embedded: bool) -> Vec<u8> {
        let mut edits = Edits::default();
        for ((_, line), lines, text) in self.changes.iter().filter(|((of, _), ..)| *of == file) {
            edits.replace(*line, *lines, text.clone().into_bytes());
        }
        let mut done = BTreeSet::new();
        for include in self.content.landmarks.includes.iter().filter(|include| include.file == file) {
            if done.insert(include.line) && (is_embedded || self.is_changed(include.inner)) {
                let head = b"$ qless: included here, because it was changed\n";
                let inner = self.file(include.inner, true);
                edits.replace(include.line, include.lines, [&head[..], &inner].concat());
            }
        }
        let text = &self.deck.texts[file as usize];
        let text = if is_embedded { text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text) } else { text };
        let mut text = edits.apply(text);
        if is_embedded && !text.ends_with(b"\n") {
            text.push(b'\n');
        }
        text
    }

    /// Whether a file changes, or a file that it includes. The recursion ends, because files of a deck that was read include each other in
    /// no circle.
    fn is_changed(&self, file: u32) -> bool {
        let includes = || self.content.landmarks.includes.iter().filter(|include| include.file == file);
        self.changes.iter().any(|((of, _), ..)| *of == file) || includes().any(|include| self.is_changed(include.inner))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deck::clean::{Cases, Written};
    use crate::deck::{Dof, Format, parse};

    fn deck(text: &str) -> Deck {
        let mut none = |_: &std::path::Path| Err(std::io::ErrorKind::NotFound.into());
        parse(Format::Nastran, std::path::Path::new("deck.bdf"), text.into(), &mut none)
            .unwrap_or_else(|e| panic!("{e}"))
    }

    /// The equation `u_a - u_b = 0` for component 1 of two points.
    fn tie(a: u32, b: u32) -> Written {
        let dof = |node| Dof { node, component: 1 };
        Written { slave: dof(a), terms: vec![(dof(b), -1.0)], rhs: 0.0, cases: Cases::All }
    }

    /// The equations of each load case, each given by the two nodes that it ties.
    fn ties(deck: &Deck) -> Vec<Vec<[u32; 2]>> {
        let nodes = |i: usize| [0, 1].map(|k| deck.model.dofs[deck.model.nth(i).columns[k] as usize].node);
        deck.model.cases.iter().map(|case| deck.model.in_force(case).map(nodes).collect()).collect()
    }

    fn removed(equations: &[usize]) -> Vec<Removed> {
        equations.iter().map(|&equation| Removed { equation, reason: Reason::Connected }).collect()
    }

    const BULK: &str = "BEGIN BULK\nGRID,1\nGRID,2\nGRID,3\nGRID,4\nMPC,1,1,1,1.,2,1,-1.\nMPC,2,1,1,1.,3,1,-1.\nMPC,2,3,1,1.,4,1,-1.\n\
                        MPCADD,9,1,2\nENDDATA\n";

    fn written(control: &str, without: &[usize], groups: &[EquationGroup]) -> (String, Vec<Vec<[u32; 2]>>) {
        let deck_before = deck(&format!("SOL 101\nCEND\n{control}{BULK}"));
        let text = write_groups(&deck_before, &removed(without), groups).unwrap_or_else(|error| panic!("{error}"));
        let text = String::from_utf8(text).expect("text");
        let found = ties(&deck(&text));
        (text, found)
    }

    #[test]
    fn each_group_has_a_set_of_its_own() {
        let control = "SUBCASE 1\nMPC=1\nSUBCASE 2\nMPC=2\nSUBCASE 7\nMPC=2\nSPC=3\n";
        let groups = [(vec![0], vec![tie(2, 1)]), (vec![1], vec![tie(3, 1)]), (vec![2], vec![tie(4, 3)])];
        let (text, found) = written(control, &[0, 1, 2], &groups);
        assert_eq!(found, [vec![[2, 1]], vec![[3, 1]], vec![[4, 3]]], "{text}");
        assert!(text.contains("SUBCASE 1\nMPC=1\nSUBCASE 2\n$ qless: MPC = 2 removed"), "{text}");
    }

    #[test]
    fn kept_cards_of_an_old_set_are_selected_with_the_new_set() {
        let control = "MPC=9\nSUBCASE 1\nSUBCASE 2\nSPC=3\nSUBCASE 4\nSPC=4\n";
        let groups = [(vec![0], vec![tie(3, 1)]), (vec![2], vec![tie(1, 3)])];
        let (text, found) = written(control, &[1], &groups);
        let mut sorted = found.clone();
        sorted.iter_mut().for_each(|ties| ties.sort_unstable());
        assert_eq!(
            sorted,
            [vec![[1, 2], [3, 1], [3, 4]], vec![[1, 2], [3, 4]], vec![[1, 2], [1, 3], [3, 4]]],
            "{text}"
        );
        assert!(text.contains("MPC = 12\nSUBCASE 2\nSPC=3\nSUBCASE 4\n"), "{text}");
    }

    #[test]
    fn a_set_without_cards_leaves_its_unions() {
        let (text, found) = written("MPC=9\n", &[1, 2], &[]);
        assert_eq!(found, [[[1, 2]]], "{text}");
        assert!(text.contains("MPCADD         9       1\n"), "{text}");
        let (text, found) = written("MPC=9\n", &[0, 1, 2], &[]);
        assert_eq!(found, [[[0; 2]; 0]], "{text}");
        assert!(!text.contains("\nMPC=9") && !text.contains("\nMPCADD"), "{text}");
    }

    #[test]
    fn a_subcase_whose_set_has_no_cards_does_not_inherit_a_set() {
        let (text, found) = written("MPC=1\nSUBCASE 1\nSUBCASE 2\nMPC=2\n", &[1, 2], &[]);
        assert_eq!(found, [vec![[1, 2]], vec![]], "{text}");
    }

    #[test]
    fn unused_common_choices_are_removed_not_cancelled() {
        let (text, found) = written("MPC=1\nSUBCASE 1\nMPC=2\n", &[0, 1], &[]);
        assert_eq!(found, [[[0; 2]; 0]], "{text}");
        assert!(!text.contains("\nMPC = 0") && !text.contains("\nMPC=1"), "{text}");
        let (text, found) = written("SUBCASE 1\nMPC=1\nSUBCASE 2\nMPC=2\n", &[1, 2], &[]);
        assert_eq!(found, [vec![[1, 2]], vec![]], "{text}");
        assert!(!text.contains("\nMPC = 0"), "{text}");
    }

    #[test]
    fn steps_have_their_own_selection() {
        let control = "SUBCASE 1\nMPC=1\nSTEP 1\nSTEP 2\nSPC=3\n";
        let (text, found) = written(control, &[0], &[(vec![1], vec![tie(2, 4)])]);
        assert_eq!(found, [vec![], vec![[2, 4]]], "{text}");
        assert!(text.contains("STEP 2\n$ qless: selects the equations written below\nMPC = 10\n"), "{text}");
    }

    #[test]
    fn separated_continuation_lines_are_removed_with_their_card() {
        let text =
            "GRID,1\nGRID,2\nGRID,3\nGRID,4\nMPC,1,1,1,1.,2,1,-1.,,+A\nGRID,5\n+A,,3,1,-1.\nMPC,1,3,1,1.,4,1,-1.\n";
        let before = deck(text);
        assert_eq!(before.model.nth(1).columns.len(), 3, "the card is complete");
        let after = write_groups(&before, &removed(&[1]), &[]).unwrap_or_else(|error| panic!("{error}"));
        let after = String::from_utf8(after).expect("text");
        assert!(after.contains("GRID,5\n$ qless: continuation of a removed card\nMPC,1,3"), "{after}");
        assert_eq!(ties(&deck(&after)), [[[3, 4]]], "{after}");
    }
}
