//! A deck with other equations: the commands of old ones make way for comments, new ones stand below the last of them.

use std::collections::BTreeMap;
use std::ops::Range;

use rustc_hash::{FxHashMap, FxHashSet};

mod text;

use text::{Numbering, comment, deletion, equations};

use super::commands::equations::Region;
use super::model::fill;
use super::reader::{Owner, Place, Reader};
use super::syntax::command::{Line, parse};
use crate::deck::clean::{CleanError, Edits, Plan, Reason, Removed};
use crate::deck::{Deck, Model};

/// The main file with the plan carried out.
///
/// The text of what goes makes way for a comment. Where that would change what other commands mean, and for what a loop makes,
/// commands that delete it stand below instead.
pub fn write(deck: &Deck, plan: &Plan) -> Result<Vec<u8>, CleanError> {
    let text = deck.texts[0].as_slice();
    let mut reader = Reader::with_places(&deck.model.files[0], text)?;
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
        (true, _) => Numbering::Next,
        (false, Some(tag)) => Numbering::Archive(highest, tag),
        (false, None) => Numbering::From(highest),
    };
    let new = equations(plan, numbering);
    let new = new.ok_or_else(|| place(last, "no numbers are left for new equations; number the equations from 1"))?;
    let comments = comments(&deck.model, plan, &owners);
    let repeated: FxHashSet<Owner> = places.iter().filter(|place| place.repeats).map(|place| place.of).collect();
    let is_deleted = |owner: &Owner| repeated.contains(owner);
    let of = |result: Vec<u8>| says(&result, &reader, deck, plan).then_some(result);
    let first = edited(text, &places, last, &comments, is_deleted, &reader.equations.regions, &new);
    let result =
        of(first).or_else(|| of(edited(text, &places, last, &comments, |_| true, &reader.equations.regions, &new)));
    result.ok_or_else(|| {
        place(last, "what commands below make of equations that change cannot be kept; write their numbers")
    })
}

/// What is said in the place of each equation and set that goes.
fn comments(model: &Model, plan: &Plan, owners: &[Owner]) -> FxHashMap<Owner, String> {
    let mut chosen: FxHashMap<Owner, &Removed> = FxHashMap::default();
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
    places: &[Place],
    last: u32,
    comments: &FxHashMap<Owner, String>,
    is_deleted: impl Fn(&Owner) -> bool,
    regions: &[Region],
    new: &str,
) -> Vec<u8> {
    let mut lines: BTreeMap<u32, (String, Vec<Range<usize>>)> = BTreeMap::new();
    let mut left = comments.clone();
    left.retain(|owner, _| !is_deleted(owner));
    let goes = |place: &&Place| comments.contains_key(&place.of) && !is_deleted(&place.of);
    for place in places.iter().filter(goes) {
        let (said, gone) = lines.entry(place.line).or_default();
        said.push_str(&left.remove(&place.of).unwrap_or_default());
        gone.push(place.range.clone());
    }
    let mut edits = Edits::default();
    for (line, (said, gone)) in lines {
        edits.replace(line, 1, [said.as_bytes(), &rest(text, line, &gone)].concat());
    }
    let mut deleted: Vec<(&Owner, &String)> = comments.iter().filter(|(owner, _)| is_deleted(owner)).collect();
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
    let Line::Commands(commands) = parse(&text[start..end], start, line) else { return Vec::new() };
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
fn says(text: &[u8], before: &Reader, deck: &Deck, plan: &Plan) -> bool {
    let Ok(mut after) = Reader::read(&deck.model.files[0], text) else { return false };
    if fill(&mut after).is_err() {
        return false;
    }
    let model = &before.model;
    let removed = |i: &usize| plan.removed.binary_search_by_key(i, |removed| removed.equation).is_ok();
    let mut expected: Vec<_> = (0..model.equations()).filter(|i| !removed(i)).map(|i| terms(model, i)).collect();
    expected.extend(plan.written.iter().map(|written| {
        let first = std::iter::once((written.slave, 1.0));
        (first.chain(written.terms.iter().copied()).map(bits).collect(), (written.rhs + 0.0).to_bits())
    }));
    let mut found: Vec<_> = (0..after.model.equations()).map(|i| terms(&after.model, i)).collect();
    expected.sort_unstable();
    found.sort_unstable();
    expected == found
}

type Bits = (crate::deck::Dof, u64);

fn bits((dof, value): (crate::deck::Dof, f64)) -> Bits {
    (dof, value.to_bits())
}

fn terms(model: &Model, i: usize) -> (Vec<Bits>, u64) {
    let equation = model.nth(i);
    let terms = equation.columns.iter().map(|&j| model.dofs[j as usize]).zip(equation.coefficients.iter().copied());
    // A zero has no sign here.
    (terms.map(bits).collect(), (equation.rhs + 0.0).to_bits())
}
