//! Writes a cleaned deck: comments replace the removed equations, and new equations precede the first step. Steps remove the equations that
//! end before them.

mod equations;
mod fewer_nodes;
mod local_axes;
mod new_nodes;

use std::collections::BTreeMap;
use std::path::Path;

use crate::deck::calculix::syntax::walk::{card_input, is_include, keyword_end, next_keyword};
use crate::deck::plan::{CleanError, Edits, Plan, Reason, Removed, Renamed, reason, shortened};
use crate::deck::{Deck, Model};
use equations::is_removal;
use new_nodes::NewNodes;

/// Returns the text of the main file after the plan is carried out, and the DOFs that have other names in it. Included files that change
/// are written into the main file.
pub fn write(deck: &Deck, plan: &Plan) -> Result<(Vec<u8>, Renamed), CleanError> {
    let model = &deck.model;
    let plan = &Plan { written: local_axes::with_slaves_for_ccx(deck, plan)?, ..plan.clone() };
    let mut comments: BTreeMap<(u32, u32), (u32, String)> = BTreeMap::new();
    for removed in &plan.removed {
        let origin = model.nth(removed.equation).origin;
        let file = model.cards.nth(origin.card).file;
        let entry = comments.entry((file, origin.line)).or_insert((origin.lines, String::new()));
        if entry.1.is_empty() || matches!(removed.reason, Reason::Redundant(_)) {
            entry.1 = comment(model, removed);
        }
    }
    shorten(deck, plan, &mut comments)?;
    let new = NewNodes::build(deck, plan)?;
    comments.extend(new.rotations.lines(deck)?.into_iter().map(|(at, text)| (at, (1, text))));
    let text = equations::new_text(deck, plan, &new)?;
    let ends = equations::ends(deck, plan, &new.rotations);
    let mut writer = CalculixWriter { deck, comments, new: Some(text), ends, steps: 0 };
    let text = writer.file(0)?;
    if writer.ends.is_some_and(|ends| ends.len() != writer.steps) {
        let path = deck.model.files[0].clone();
        let why = "equations end in a step of an included file; move the steps to the main file";
        return Err(CleanError::Place { path, line: 1, why });
    }
    Ok((text, new.rotations.renamed().chain(new.proxies.renamed()).collect()))
}

/// Handles cards that lose only some of their nodes: adds the shortened card below the comment that replaces the card.
fn shorten(deck: &Deck, plan: &Plan, comments: &mut BTreeMap<(u32, u32), (u32, String)>) -> Result<(), CleanError> {
    for (number, ((file, line), shorter)) in (1..).zip(shortened(&deck.model, &plan.removed)) {
        let Some((lines, text)) = comments.get_mut(&(file, line)) else { continue };
        let all = deck.texts[file as usize].split_inclusive(|&byte| byte == b'\n');
        let card: Vec<&[u8]> = all.skip(line as usize - 1).take(*lines as usize).collect();
        let card = String::from_utf8(card.concat()).ok().map(|card| card.replace("\r\n", "\n"));
        let card = card.and_then(|card| fewer_nodes::with_nodes(deck, &card, &shorter.left, number));
        let why = "a node cannot be left out of this card";
        let refused = || CleanError::Place { path: deck.model.files[file as usize].clone(), line: line as usize, why };
        let card = card.ok_or_else(refused)?;
        *text = text.replacen("equation of", &format!("equations of {} in", shorter.lost_names()), 1) + &card;
    }
    Ok(())
}

struct CalculixWriter<'a> {
    deck: &'a Deck,
    /// For a file and line: the number of lines to remove there, and the comment that replaces them.
    comments: BTreeMap<(u32, u32), (u32, String)>,
    /// The text of the new equations, until it is written before the first step.
    new: Option<Vec<u8>>,
    /// For each step, the card that removes equations. These cards replace the deck's own removal cards. `None` if the deck's own cards
    /// stay valid.
    ends: Option<Vec<String>>,
    /// Number of steps of the main file that were written so far.
    steps: usize,
}

impl CalculixWriter<'_> {
    fn file(&mut self, file: u32) -> Result<Vec<u8>, CleanError> {
        let text = std::sync::Arc::clone(&self.deck.texts[file as usize]);
        let mut edits = Edits::default();
        for (&(_, line), (lines, comment)) in self.comments.range((file, 0)..=(file, u32::MAX)) {
            edits.replace(line, *lines, comment.clone().into_bytes());
        }
        let (mut at, mut line) = (0, 1);
        while at < text.len() {
            let start = next_keyword(&text, at);
            line += memchr::memchr_iter(b'\n', &text[at..start]).count() as u32;
            if start == text.len() {
                break;
            }
            let (end, lines) = keyword_end(&text, start);
            self.keyword(
                file,
                &text[start..end],
                line,
                lines as u32,
                &mut edits,
                &text[end..next_keyword(&text, end)],
            )?;
            (at, line) = (end, line + lines as u32);
        }
        if file == 0 && self.new.is_some() {
            edits.replace(u32::MAX, 0, self.new.take().unwrap_or_default());
        }
        Ok(edits.apply(&text))
    }

    /// Writes what belongs before, after or in place of a keyword line. New equations go before the first step, or to the end of the
    /// assembly if the deck has instances. An `*EQUATION` line is removed if all of its equations are removed.
    fn keyword(
        &mut self,
        file: u32,
        keyword: &[u8],
        line: u32,
        lines: u32,
        edits: &mut Edits,
        data: &[u8],
    ) -> Result<(), CleanError> {
        let word: Vec<u8> = keyword.iter().filter(|b| !b.is_ascii_whitespace()).map(u8::to_ascii_uppercase).collect();
        let is_step = word.starts_with(b"*STEP");
        // Nodes of instances have names only within the assembly, so the equations must stand there.
        let is_place = if self.deck.model.has_instances() { word.starts_with(b"*ENDASSEMBLY") } else { is_step };
        if is_place && file == 0 {
            self.new.take().into_iter().for_each(|new| edits.replace(line, 0, new));
        }
        if is_step && file == 0 {
            if let Some(ends) = self.ends.as_ref().and_then(|ends| ends.get(self.steps)) {
                edits.replace(line + lines, 0, ends.clone().into_bytes());
            }
            self.steps += 1;
        } else if is_removal(keyword) && self.ends.is_some() {
            let data = memchr::memchr_iter(b'\n', data).count() as u32;
            edits.replace(line, lines + data, b"** qless: the start of the step removes the equations\n".to_vec());
        } else if word.starts_with(b"*COUPLING") {
            // If the second card of a `*COUPLING` is removed, the first one must be removed too: alone it would be incomplete.
            let next = line + lines + memchr::memchr_iter(b'\n', data).count() as u32;
            if self.is_removed(file, next) {
                edits.replace(line, lines, b"** qless: *COUPLING, written as equations\n".to_vec());
            }
        } else if is_include(keyword) {
            if let Some(inner) = card_input(keyword).and_then(|name| self.included(&name, file)) {
                let mut text = [b"** qless: included here, because it was changed\n", &*self.file(inner)?].concat();
                if !text.ends_with(b"\n") {
                    text.push(b'\n');
                }
                edits.replace(line, lines, text);
            }
        } else if word.starts_with(b"*EQUATION") && !is_removal(keyword) {
            let input = card_input(keyword).and_then(|name| self.included(&name, file));
            if input.is_some() {
                let path = self.deck.model.files[file as usize].clone();
                let why = "the equations that must change are in a file named by INPUT=; move them to this file";
                return Err(CleanError::Place { path, line: line as usize, why });
            }
            let is_removed = |k: u32| self.is_removed(file, line + lines + k);
            let mut rows = data.split(|&byte| byte == b'\n').zip(0..).filter(|(row, _)| is_data(row)).peekable();
            if rows.peek().is_some() && rows.all(|(_, k)| is_removed(k)) {
                edits.replace(line, lines, Vec::new());
            }
        }
        Ok(())
    }

    fn is_removed(&self, file: u32, line: u32) -> bool {
        let before = self.comments.range((file, 0)..=(file, line)).next_back();
        before.is_some_and(|((_, first), (lines, _))| line < first + lines)
    }

    /// The number of an included file if it, or a file that it includes, changes; otherwise `None`.
    fn included(&self, name: &str, from: u32) -> Option<u32> {
        let files = &self.deck.model.files;
        let beside = |file: usize| files[file].parent().unwrap_or(Path::new("")).join(name);
        let candidates = [beside(0), beside(from as usize)];
        let file = candidates.iter().find_map(|path| files.iter().position(|known| known == path))? as u32;
        let text = &self.deck.texts[file as usize];
        let own = self.comments.range((file, 0)..=(file, u32::MAX)).next().is_some();
        let mut at = next_keyword(text, 0);
        let mut inner = false;
        while at < text.len() && !own && !inner {
            let (end, _) = keyword_end(text, at);
            let keyword = &text[at..end];
            inner = is_include(keyword)
                && card_input(keyword).is_some_and(|name| file != from && self.included(&name, file).is_some());
            at = next_keyword(text, end);
        }
        (own || inner).then_some(file)
    }
}

fn is_data(row: &[u8]) -> bool {
    let begins = row.trim_ascii_start();
    !begins.is_empty() && !begins.starts_with(b"**")
}

/// Comment that says why an equation was removed.
fn comment(model: &Model, removed: &Removed) -> String {
    let line = model.nth(removed.equation).origin.line;
    format!("** qless: equation of line {line} {}\n", reason(model, removed, "written anew below"))
}
