//! A deck with other constraints: cards become comments, new equations are `MPC` cards in the set that is selected.

use std::collections::{BTreeMap, BTreeSet};

use super::target::Target;
use super::wide::mpc;
use crate::deck::clean::{CleanError, Edits, Plan, Reason, Removed};
use crate::deck::nastran::syntax::content::{At, Content};
use crate::deck::nastran::syntax::reader::read;
use crate::deck::{Deck, Model};

/// Terms of a certificate that a comment names at most.
const NAMED: usize = 8;

/// The main file with the plan carried out. Included files that must change are written into it.
pub fn write(deck: &Deck, plan: &Plan) -> Result<Vec<u8>, CleanError> {
    let content = deck.again(read)?;
    let mut changes = Changes::default();
    changes.comments(&deck.model, plan);
    let target = Target::of(&content, deck, plan)?;
    changes.all.extend(target.changes(&content));
    if !plan.written.is_empty() {
        let at = place_of_new(&content);
        once(&content, at, deck)?;
        changes.all.push((at, 0, new_text(&target, content.control.is_some(), plan)));
    }
    let writer = Writer { deck, content: &content, changes: &changes.all };
    Ok(writer.file(0, false))
}

/// Where, how many lines go, and the text in their place.
pub type Change = (At, u32, String);

#[derive(Default)]
struct Changes {
    all: Vec<Change>,
}

impl Changes {
    /// A comment for each card that goes; one of several equations is told for all of the card.
    fn comments(&mut self, model: &Model, plan: &Plan) {
        let mut texts: BTreeMap<At, (u32, String)> = BTreeMap::new();
        for removed in &plan.removed {
            let origin = model.nth(removed.equation).origin;
            let file = model.cards.nth(origin.card).file;
            let text = texts.entry((file, origin.line)).or_insert((origin.lines, String::new()));
            if text.1.is_empty() || matches!(removed.reason, Reason::Fault(_)) {
                text.1 = comment(model, removed, !plan.written.is_empty());
            }
        }
        self.all.extend(texts.into_iter().map(|(at, (lines, text))| (at, lines, text)));
    }
}

/// Why a card is gone, in a line.
fn comment(model: &Model, removed: &Removed, is_written: bool) -> String {
    let equation = model.nth(removed.equation);
    let place = |i: usize| model.label_of(i);
    let what = format!("$ qless: {}", model.place(equation.origin));
    match &removed.reason {
        Reason::Redundant(because) if because.is_empty() => {
            format!("{what} removed: all components of an equation of it are prescribed\n")
        }
        Reason::Redundant(because) => {
            let terms: Vec<String> =
                because.iter().take(NAMED).map(|&(i, c)| format!("{c} * ({})", place(i))).collect();
            let more = because.len().saturating_sub(NAMED);
            let more = if more > 0 { format!(" + {more} more") } else { String::new() };
            let own = model.label_of(removed.equation);
            format!("{what} removed, redundant: {own} is {}{more}\n", terms.join(" + "))
        }
        Reason::Fault(fault) => format!("{what} {}: {}\n", now(is_written), fault.describe(model)),
        Reason::Connected => format!("{what} {}: it shares components with others that are\n", now(is_written)),
    }
}

fn now(is_written: bool) -> &'static str {
    if is_written { "written anew as MPC" } else { "removed" }
}

/// New cards are written wherever their file is included.
fn once(content: &Content, (file, line): At, deck: &Deck) -> Result<(), CleanError> {
    match content.landmarks.includes.iter().filter(|include| include.inner == file).count() {
        0 | 1 => Ok(()),
        _ => Err(CleanError::Place {
            path: deck.model.files[file as usize].clone(),
            line: line as usize,
            why: "new cards would stand here, but this file is included more than once; move BEGIN BULK to the main file",
        }),
    }
}

/// After `BEGIN BULK`; in bulk data alone, at the end.
fn place_of_new(content: &Content) -> At {
    content.landmarks.bulk.or(content.landmarks.end).unwrap_or((0, u32::MAX))
}

fn new_text(target: &Target, has_control: bool, plan: &Plan) -> String {
    let mut text = String::from(
        "$ qless: independent equations; each first component occurs first once and is not prescribed\n\
         $ qless: numbers of more than 16 columns are rounded to the nearest that Nastran reads\n",
    );
    let set = target.set;
    if !has_control {
        text.extend(["$ qless: select them in case control by MPC = ", &set.to_string(), "\n"]);
    }
    plan.written.iter().for_each(|written| text += &mpc(set, written));
    text
}

struct Writer<'a> {
    deck: &'a Deck,
    content: &'a Content,
    changes: &'a [Change],
}

impl Writer<'_> {
    /// A file with its changes; within another file, with all that it includes.
    fn file(&self, file: u32, is_within: bool) -> Vec<u8> {
        let mut edits = Edits::default();
        for ((_, line), lines, text) in self.changes.iter().filter(|((of, _), ..)| *of == file) {
            edits.replace(*line, *lines, text.clone().into_bytes());
        }
        let mut done = BTreeSet::new();
        for include in self.content.landmarks.includes.iter().filter(|include| include.file == file) {
            if done.insert(include.line) && (is_within || self.is_changed(include.inner)) {
                let head = b"$ qless: included here, because it was changed\n";
                let inner = self.file(include.inner, true);
                edits.replace(include.line, include.lines, [&head[..], &inner].concat());
            }
        }
        let text = &self.deck.texts[file as usize];
        let text = if is_within { text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text) } else { text };
        let mut text = edits.apply(text);
        if is_within && !text.ends_with(b"\n") {
            text.push(b'\n');
        }
        text
    }

    /// Whether a file or one that it includes has changes. Includes make no circle, as the deck could be read.
    fn is_changed(&self, file: u32) -> bool {
        let includes = || self.content.landmarks.includes.iter().filter(|include| include.file == file);
        self.changes.iter().any(|((of, _), ..)| *of == file) || includes().any(|include| self.is_changed(include.inner))
    }
}
