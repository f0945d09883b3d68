//! Writes a deck with changed equations: a comment replaces the commands of each removed equation, and the new equations
//! follow the last command that makes equations.

use std::collections::BTreeMap;
use std::ops::Range;

use rustc_hash::{FxHashMap, FxHashSet};

use super::build::fill;
use super::commands::equations::NodeRegion;
use super::reader::{AnsysModels, AnsysReader, CommandOwner, CommandPlace};
use super::syntax::command::{AnsysLine, parse};
use super::syntax::label;
use crate::deck::clean::{CleanError, Edits, Plan, Reason, Removed, Written};
use crate::deck::plan::reason;
use crate::deck::{Deck, DeckError, Dof, Model};

/// Returns the text of the deck's file with the changes of the plan.
///
/// A comment replaces the commands of a removed equation. If that would change the meaning of other commands, or if a loop makes the
/// equation, its commands stay, and a command further below deletes the equation.
pub fn write(deck: &Deck, plan: &Plan) -> Result<Vec<u8>, CleanError> {
    let text = deck.texts[0].as_slice();
    let with_places = |reader: &mut AnsysReader| reader.places = Some(Vec::new());
    let (mut reader, cleared) = first_model(AnsysModels::new(&deck.model.files[0], text, with_places))?;
    let owners = fill(&mut reader)?;
    let places = reader.places.take().unwrap_or_default();
    let place = |line: u32, why: &'static str| CleanError::Place {
        path: deck.model.files[0].clone(),
        line: line as usize,
        why,
    };
    if let Some(line) = cleared {
        return Err(place(line, "a second model begins below this line; make a deck for each model"));
    }
    let last = reader.made.line.max(1);
    if let Some(solved) = reader.solved_at.filter(|&solved| solved <= last) {
        return Err(place(solved, "equations change after this load step; make a deck for each load step"));
    }
    if reader.coupled.assumes_order() {
        return Err(place(last, "CPSGEN numbers coupled sets in an order that is not documented; write them as CP"));
    }
    let highest = reader.equations.highest();
    let numbering = match (reader.made.unread, reader.archive) {
        (true, _) => NewNumbers::Next,
        (false, Some(tag)) => NewNumbers::Archive(highest, tag),
        (false, None) => NewNumbers::From(highest),
    };
    let new = equations(plan, numbering);
    let new = new.ok_or_else(|| place(last, "no numbers are left for new equations; number the equations from 1"))?;
    let comments = comments(&deck.model, plan, &owners);
    let repeated: FxHashSet<CommandOwner> =
        places.iter().filter(|place| place.repeats).map(|place| place.owner).collect();
    let is_deleted = |owner: &CommandOwner| repeated.contains(owner);
    let checked = |result: Vec<u8>| is_as_planned(&result, &reader, deck, plan).then_some(result);
    let first = edited(text, &places, last, &comments, is_deleted, &reader.equations.regions, &new);
    let result = checked(first)
        .or_else(|| checked(edited(text, &places, last, &comments, |_| true, &reader.equations.regions, &new)));
    result.ok_or_else(|| {
        place(
            last,
            "commands refer to equations that change in a way that cannot be kept; write explicit equation numbers",
        )
    })
}

/// The first model that holds anything, or the last one if none does; and the line of the `/CLEAR` below which a second one begins.
fn first_model<F: Fn(&mut AnsysReader)>(models: AnsysModels<F>) -> Result<(AnsysReader, Option<u32>), DeckError> {
    let mut first = AnsysReader::default();
    let mut cleared = None;
    for reader in models {
        let reader = reader?;
        if !first.holds_nothing() && !reader.holds_nothing() {
            return Ok((first, cleared));
        }
        cleared = reader.cleared.map(|next| next.line - 1);
        if first.holds_nothing() {
            first = reader;
        }
    }
    Ok((first, None))
}

/// One comment for each removed equation, coupled set or region.
fn comments(model: &Model, plan: &Plan, owners: &[CommandOwner]) -> FxHashMap<CommandOwner, String> {
    let mut chosen: FxHashMap<CommandOwner, &Removed> = FxHashMap::default();
    // Equations of one owner may be removed for several reasons. The comment names one: preferably a fault of an equation, else a
    // connection to a faulty equation.
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

/// Returns the text with comments in place of removed commands. Below line `last` it adds commands that delete the other removed equations,
/// and then the new equations.
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
    let mut unused = comments.clone();
    unused.retain(|owner, _| !is_deleted(owner));
    let is_replaced = |place: &&CommandPlace| comments.contains_key(&place.owner) && !is_deleted(&place.owner);
    for place in places.iter().filter(is_replaced) {
        let (comment, removed) = lines.entry(place.line).or_default();
        comment.push_str(&unused.remove(&place.owner).unwrap_or_default());
        removed.push(place.range.clone());
    }
    let mut edits = Edits::default();
    for (line, (comment, removed)) in lines {
        edits.replace(line, 1, [comment.as_bytes(), &rest(text, line, &removed)].concat());
    }
    let mut deleted: Vec<(&CommandOwner, &String)> = comments.iter().filter(|(owner, _)| is_deleted(owner)).collect();
    deleted.sort_unstable_by_key(|(owner, _)| **owner);
    let mut below = String::new();
    for (owner, comment) in deleted {
        below.push_str(comment);
        below.push_str(&deletion(owner, regions));
    }
    below.push_str(new);
    if !below.is_empty() {
        edits.replace(last.saturating_add(1), 0, below.into_bytes());
    }
    edits.apply(text)
}

/// The line without its removed commands. It is empty if no command remains.
fn rest(text: &[u8], line: u32, removed: &[Range<usize>]) -> Vec<u8> {
    let Some(first) = removed.first() else { return Vec::new() };
    let start = memchr::memrchr(b'\n', &text[..first.start]).map_or(0, |end| end + 1);
    let end = memchr::memchr(b'\n', &text[start..]).map_or(text.len(), |end| start + end);
    let AnsysLine::Commands(commands) = parse(&text[start..end], start, line) else { return Vec::new() };
    let kept: Vec<&[u8]> =
        commands.iter().map(|c| c.range.clone()).filter(|c| !removed.contains(c)).map(|c| &text[c]).collect();
    if kept.is_empty() {
        return Vec::new();
    }
    let after = commands.last().map_or(end, |command| command.range.end);
    let comment = memchr::memchr(b'!', &text[after..end]).map_or(&b""[..], |at| &text[after + at..end]);
    [&kept.join(&b" $ "[..]), &b" "[..], comment].concat().trim_ascii_end().iter().copied().chain([b'\n']).collect()
}

/// Whether the new text, read again, gives exactly the kept and the new equations, and the same values and loads.
fn is_as_planned(text: &[u8], before: &AnsysReader, deck: &Deck, plan: &Plan) -> bool {
    let Ok((mut after, None)) = first_model(AnsysModels::new(&deck.model.files[0], text, |_| ())) else { return false };
    if fill(&mut after).is_err() {
        return false;
    }
    let mut events = before.events.iter().zip(&after.events);
    if before.events.len() != after.events.len() || !events.all(|(a, b)| a.acts_as(b)) {
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

type ExactTerm = (Dof, u64);

fn bits((dof, value): (Dof, f64)) -> ExactTerm {
    (dof, value.to_bits())
}

fn terms_of(model: &Model, i: usize) -> (Vec<ExactTerm>, u64) {
    let equation = model.nth(i);
    let terms = equation.columns.iter().map(|&j| model.dofs[j as usize]).zip(equation.coefficients.iter().copied());
    // Adding 0 turns -0 into 0, so that both have the same bits.
    (terms.map(bits).collect(), (equation.rhs + 0.0).to_bits())
}

/// A comment line with the reason why an equation was removed.
fn comment(model: &Model, removed: &Removed) -> String {
    let card = model.cards.nth(model.nth(removed.equation).origin.card).name;
    format!("! qless: {card} {}\n", reason(model, removed, "written anew below"))
}

/// How new equations are numbered; their numbers must be unused.
#[derive(Clone, Copy)]
enum NewNumbers {
    /// New equations get the numbers above this highest one. They are written as in an archive with this tag, such as `R5.0`.
    Archive(u32, &'static str),
    /// New equations get the numbers above this highest one. They are written as plain commands.
    From(u32),
    /// New equations get `NEXT` in place of a number, because only ANSYS knows which numbers are used.
    Next,
}

/// The text of the new equations; `None` if no numbers are left.
fn equations(plan: &Plan, numbering: NewNumbers) -> Option<String> {
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

/// The command that deletes the equations of an owner.
fn deletion(owner: &CommandOwner, regions: &[NodeRegion]) -> String {
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

/// Plain `CE` commands with up to three terms each. `first` is the text of the number field in the first command, `others` in all further
/// ones.
fn as_commands(written: &Written, first: &str, others: &str) -> String {
    let term = |(dof, value): &(Dof, f64)| format!(",{},{},{value:?}", dof.node, label::name(dof.component));
    let rhs = written.rhs + 0.0;
    let line = |(k, terms): (usize, &[(Dof, f64)])| {
        let number = if k == 0 { first } else { others };
        format!("CE,{number},{rhs:?}{}\n", terms.iter().map(term).collect::<String>())
    };
    terms(written).chunks(3).enumerate().map(line).collect()
}

/// All terms of a new equation, the slave first.
fn terms(written: &Written) -> Vec<(Dof, f64)> {
    std::iter::once((written.slave, 1.0)).chain(written.terms.iter().copied()).collect()
}
