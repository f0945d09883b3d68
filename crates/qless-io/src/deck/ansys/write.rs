//! A deck with other equations: the commands of old ones make way for comments, new ones stand below the last of them.
//!
//! The text of equations and of comments on those that are gone.

use std::collections::BTreeMap;
use std::ops::Range;

use rustc_hash::{FxHashMap, FxHashSet};

use super::build::fill;
use super::commands::equations::NodeRegion;
use super::reader::{AnsysReader, CommandOwner, CommandPlace};
use super::syntax::command::{AnsysLine, parse};
use super::syntax::label;
use crate::deck::clean::{CleanError, Edits, Plan, Reason, Removed, Written};
use crate::deck::{Deck, Dof, Model};

/// The main file with the plan carried out.
///
/// The text of what goes makes way for a comment. Where that would change what other commands mean, and for what a loop makes,
/// commands that delete it stand below instead.
pub fn write(deck: &Deck, plan: &Plan) -> Result<Vec<u8>, CleanError> {
    let text = deck.texts[0].as_slice();
    let mut reader = AnsysReader::with_places(&deck.model.files[0], text)?;
    let owners = fill(&mut reader)?;
    let places = reader.places.take().unwrap_or_default();
    let place = |line: u32, why: &'static str| CleanError::Place {
        path: deck.model.files[0].clone(),
        line: line as usize,
        why,
    };
    let last = reader.made.line.max(1);
    if let Some(solved) = reader.solved_at.filter(|&solved| solved <= last) {
        return Err(place(solved, "equations change after this load step; make a deck for each load step"));
    }
    let highest = reader.equations.sets.highest().unwrap_or(0).max(reader.equations.reserved);
    let numbering = match (reader.made.unread, reader.archive) {
        (true, _) => NewNumbers::Next,
        (false, Some(tag)) => NewNumbers::Archive(highest, tag),
        (false, None) => NewNumbers::From(highest),
    };
    let new = equations(plan, numbering);
    let new = new.ok_or_else(|| place(last, "no numbers are left for new equations; number the equations from 1"))?;
    let comments = comments(&deck.model, plan, &owners);
    let repeated: FxHashSet<CommandOwner> = places.iter().filter(|place| place.repeats).map(|place| place.of).collect();
    let is_deleted = |owner: &CommandOwner| repeated.contains(owner);
    let of = |result: Vec<u8>| says(&result, &reader, deck, plan).then_some(result);
    let first = edited(text, &places, last, &comments, is_deleted, &reader.equations.regions, &new);
    let result =
        of(first).or_else(|| of(edited(text, &places, last, &comments, |_| true, &reader.equations.regions, &new)));
    result.ok_or_else(|| {
        place(last, "what commands below make of equations that change cannot be kept; write their numbers")
    })
}

/// What is said in the place of each equation and set that goes.
fn comments(model: &Model, plan: &Plan, owners: &[CommandOwner]) -> FxHashMap<CommandOwner, String> {
    let mut chosen: FxHashMap<CommandOwner, &Removed> = FxHashMap::default();
    // What is wrong itself says more than what it is wrong with.
    let weight = |reason: &Reason| match reason {
        Reason::Redundant(_) => 0,
        Reason::Connected => 1,
        Reason::Fault(_) => 2,
    };
    for removed in &plan.removed {
        let before = chosen.entry(owners[removed.equation]).or_insert(removed);
        if weight(&removed.reason) > weight(&before.reason) {
            *before = removed;
        }
    }
    chosen.into_iter().map(|(owner, removed)| (owner, comment(model, removed))).collect()
}

/// The text with comments in the place of what goes, and below line `last` the commands that delete the rest of it and the new
/// equations.
fn edited(
    text: &[u8],
    places: &[CommandPlace],
    last: u32,
    comments: &FxHashMap<CommandOwner, String>,
    is_deleted: impl Fn(&CommandOwner) -> bool,
    regions: &[NodeRegion],
    new: &str,
) -> Vec<u8> {
    let mut lines: BTreeMap<u32, (String, Vec<Range<usize>>)> = BTreeMap::new();
    let mut left = comments.clone();
    left.retain(|owner, _| !is_deleted(owner));
    let goes = |place: &&CommandPlace| comments.contains_key(&place.of) && !is_deleted(&place.of);
    for place in places.iter().filter(goes) {
        let (said, gone) = lines.entry(place.line).or_default();
        said.push_str(&left.remove(&place.of).unwrap_or_default());
        gone.push(place.range.clone());
    }
    let mut edits = Edits::default();
    for (line, (said, gone)) in lines {
        edits.replace(line, 1, [said.as_bytes(), &rest(text, line, &gone)].concat());
    }
    let mut deleted: Vec<(&CommandOwner, &String)> = comments.iter().filter(|(owner, _)| is_deleted(owner)).collect();
    deleted.sort_unstable_by_key(|(owner, _)| **owner);
    let mut below = String::new();
    for (owner, said) in deleted {
        below.push_str(said);
        below.push_str(&deletion(owner, regions));
    }
    below.push_str(new);
    if !below.is_empty() {
        edits.replace(last.saturating_add(1), 0, below.into_bytes());
    }
    edits.apply(text)
}

/// The line without the commands that go; empty if there are no others.
fn rest(text: &[u8], line: u32, gone: &[Range<usize>]) -> Vec<u8> {
    let Some(first) = gone.first() else { return Vec::new() };
    let start = memchr::memrchr(b'\n', &text[..first.start]).map_or(0, |end| end + 1);
    let end = memchr::memchr(b'\n', &text[start..]).map_or(text.len(), |end| start + end);
    let AnsysLine::Commands(commands) = parse(&text[start..end], start, line) else { return Vec::new() };
    let kept: Vec<&[u8]> =
        commands.iter().map(|c| c.range.clone()).filter(|c| !gone.contains(c)).map(|c| &text[c]).collect();
    if kept.is_empty() {
        return Vec::new();
    }
    let after = commands.last().map_or(end, |command| command.range.end);
    let comment = memchr::memchr(b'!', &text[after..end]).map_or(&b""[..], |at| &text[after + at..end]);
    [&kept.join(&b" $ "[..]), &b" "[..], comment].concat().trim_ascii_end().iter().copied().chain([b'\n']).collect()
}

/// Whether the new text, read again, has the equations that are kept and the new ones, and nothing else.
fn says(text: &[u8], before: &AnsysReader, deck: &Deck, plan: &Plan) -> bool {
    let Ok(mut after) = AnsysReader::read(&deck.model.files[0], text) else { return false };
    if fill(&mut after).is_err() {
        return false;
    }
    let model = &before.model;
    let removed = |i: &usize| plan.removed.binary_search_by_key(i, |removed| removed.equation).is_ok();
    let mut expected: Vec<_> = (0..model.equations()).filter(|i| !removed(i)).map(|i| terms_of(model, i)).collect();
    expected.extend(plan.written.iter().map(|written| {
        let first = std::iter::once((written.slave, 1.0));
        (first.chain(written.terms.iter().copied()).map(bits).collect(), (written.rhs + 0.0).to_bits())
    }));
    let mut found: Vec<_> = (0..after.model.equations()).map(|i| terms_of(&after.model, i)).collect();
    expected.sort_unstable();
    found.sort_unstable();
    expected == found
}

type ExactTerm = (crate::deck::Dof, u64);

fn bits((dof, value): (crate::deck::Dof, f64)) -> ExactTerm {
    (dof, value.to_bits())
}

fn terms_of(model: &Model, i: usize) -> (Vec<ExactTerm>, u64) {
    let equation = model.nth(i);
    let terms_of = equation.columns.iter().map(|&j| model.dofs[j as usize]).zip(equation.coefficients.iter().copied());
    // A zero has no sign here.
    (terms_of.map(bits).collect(), (equation.rhs + 0.0).to_bits())
}

/// Equations of a certificate that a comment names at most.
const NAMED: usize = 8;

/// Why an equation is gone, in a line.
pub fn comment(model: &Model, removed: &Removed) -> String {
    let name = |i: usize| model.cards.nth(model.nth(i).origin.card).name;
    let what = format!("! qless: {}", name(removed.equation));
    match &removed.reason {
        Reason::Redundant(because) if because.is_empty() => format!("{what} removed: all of its DOFs are prescribed\n"),
        Reason::Redundant(because) => {
            let terms: Vec<String> = because.iter().take(NAMED).map(|&(i, c)| format!("{c:?} * {}", name(i))).collect();
            let more = because.len().saturating_sub(NAMED);
            let more = if more > 0 { format!(" + {more} more") } else { String::new() };
            format!("{what} removed, redundant: it is {}{more}\n", terms.join(" + "))
        }
        Reason::Fault(fault) => format!("{what} written anew below: {}\n", fault.describe(model)),
        Reason::Connected => format!("{what} written anew below: it shares DOFs with others that are\n"),
    }
}

/// How new equations are numbered, so that no number is taken.
#[derive(Clone, Copy, Debug)]
pub enum NewNumbers {
    /// From one above the highest on, in the form of an archive with its tag.
    Archive(u32, &'static str),
    /// The same as commands.
    From(u32),
    /// By the program, since nobody else knows which are taken.
    Next,
}

/// The new equations; `None` if there are no numbers left.
pub fn equations(plan: &Plan, numbering: NewNumbers) -> Option<String> {
    if plan.written.is_empty() {
        return Some(String::new());
    }
    let mut text =
        String::from("! qless: independent equations; each slave, the first term, occurs once and is not prescribed\n");
    for (written, k) in plan.written.iter().zip(1..) {
        text.push_str(&match numbering {
            NewNumbers::Archive(highest, tag) => in_archive(written, highest.checked_add(k)?, tag),
            NewNumbers::From(highest) => {
                let number = highest.checked_add(k)?.to_string();
                as_commands(written, &number, &number)
            }
            NewNumbers::Next => as_commands(written, "NEXT", "HIGH"),
        });
    }
    Some(text)
}

/// The command that deletes equations or a set.
pub fn deletion(owner: &CommandOwner, regions: &[NodeRegion]) -> String {
    match *owner {
        CommandOwner::Equation(number) => format!("CEDELE,{number}\n"),
        CommandOwner::Coupled(number) => format!("CPDELE,{number}\n"),
        CommandOwner::Region(at) => format!("CEDELE,{},{}\n", regions[at].first, regions[at].last),
        CommandOwner::Other => String::new(),
    }
}

fn in_archive(written: &Written, number: u32, tag: &str) -> String {
    let terms = terms(written);
    let term = |(dof, value): &(Dof, f64)| format!(",{:>10},{:<4},{value:?}", dof.node, label::name(dof.component));
    let line = |terms: &[(Dof, f64)]| format!("CE,{tag},NODE{}\n", terms.iter().map(term).collect::<String>());
    let head = format!("CE,{tag},DEFI,{:>8},{number:>8},{:?}\n", terms.len(), written.rhs + 0.0);
    std::iter::once(head).chain(terms.chunks(2).map(line)).collect()
}

/// Commands of three terms each, the first of which has another word for the number.
fn as_commands(written: &Written, first: &str, others: &str) -> String {
    let term = |(dof, value): &(Dof, f64)| format!(",{},{},{value:?}", dof.node, label::name(dof.component));
    let rhs = written.rhs + 0.0;
    let line = |(k, terms): (usize, &[(Dof, f64)])| {
        let number = if k == 0 { first } else { others };
        format!("CE,{number},{rhs:?}{}\n", terms.iter().map(term).collect::<String>())
    };
    terms(written).chunks(3).enumerate().map(line).collect()
}

/// The terms with the slave first.
fn terms(written: &Written) -> Vec<(Dof, f64)> {
    std::iter::once((written.slave, 1.0)).chain(written.terms.iter().copied()).collect()
}
