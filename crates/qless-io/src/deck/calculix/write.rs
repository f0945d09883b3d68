//! A deck with other equations: old ones become comments, new ones stand before the first step.

use std::collections::{BTreeMap, HashMap};
use std::path::Path;

use super::card::{Card, card_input, is_include, keyword_end, next_keyword, walk};
use super::definitions::Definitions;
use crate::deck::clean::{CleanError, Edits, Plan, Reason, Removed, Written};
use crate::deck::{Deck, DeckError, Model};

/// Characters of a number that CalculiX reads.
const NUMBER: usize = 20;
/// Terms of a certificate that a comment names at most.
const NAMED: usize = 8;

/// The main file with the plan carried out. Included files that must change are written into it.
pub fn write(deck: &Deck, plan: &Plan) -> Result<Vec<u8>, CleanError> {
    let model = &deck.model;
    let mut comments: BTreeMap<(u32, u32), (u32, String)> = BTreeMap::new();
    for removed in &plan.removed {
        let origin = model.nth(removed.equation).origin;
        let file = model.cards.nth(origin.card).file;
        let entry = comments.entry((file, origin.line)).or_insert((origin.lines, String::new()));
        if entry.1.is_empty() || matches!(removed.reason, Reason::Redundant(_)) {
            entry.1 = comment(model, removed);
        }
    }
    let new = new_text(deck, plan)?;
    Writer { deck, comments, new: Some(new) }.file(0)
}

struct Writer<'a> {
    deck: &'a Deck,
    /// By file and line: how many lines go, and the comment in their place.
    comments: BTreeMap<(u32, u32), (u32, String)>,
    /// What is still to be put before the first step.
    new: Option<Vec<u8>>,
}

impl Writer<'_> {
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

    /// A keyword line: new equations stand before a step, and no `*EQUATION` stands without data.
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
        if word.starts_with(b"*STEP") && file == 0 {
            if let Some(new) = self.new.take() {
                edits.replace(line, 0, new);
            }
        } else if is_include(keyword) {
            if let Some(inner) = card_input(keyword).and_then(|name| self.included(&name, file)) {
                let text = self.file(inner)?;
                edits.replace(
                    line,
                    lines,
                    [b"** qless: included here, because it was changed\n", &*with_end(text)].concat(),
                );
            }
        } else if word.starts_with(b"*EQUATION") && !word.starts_with(b"*EQUATION,REMOVE") {
            let input = card_input(keyword).and_then(|name| self.included(&name, file));
            if input.is_some() {
                let path = self.deck.model.files[file as usize].clone();
                let why = "the equations that must change are in a file named by INPUT=; put them here";
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

    /// The number of an included file in which, or in whose own includes, something changes.
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
    !row.starts_with(b"**") && row.iter().any(|byte| !byte.is_ascii_whitespace())
}

fn with_end(mut text: Vec<u8>) -> Vec<u8> {
    if !text.ends_with(b"\n") {
        text.push(b'\n');
    }
    text
}

/// Why an equation is gone, in a line.
fn comment(model: &Model, removed: &Removed) -> String {
    let origin = model.nth(removed.equation).origin;
    let line = |i: usize| format!("line {}", model.nth(i).origin.line);
    let what = format!("** qless: equation of line {}", origin.line);
    match &removed.reason {
        Reason::Redundant(because) if because.is_empty() => format!("{what} removed: all of its DOFs are prescribed\n"),
        Reason::Redundant(because) => {
            let term = |(k, &(i, c)): (usize, &(usize, f64))| match (k, c < 0.0) {
                (0, _) => format!("{c} * {}", line(i)),
                (_, false) => format!(" + {c} * {}", line(i)),
                (_, true) => format!(" - {} * {}", -c, line(i)),
            };
            let terms: String = because.iter().take(NAMED).enumerate().map(term).collect();
            let more = because.len().saturating_sub(NAMED);
            let more = if more > 0 { format!(" + {more} more") } else { String::new() };
            format!("{what} removed, redundant: it is {terms}{more}\n")
        }
        Reason::Fault(fault) => format!("{what} written anew below: {}\n", fault.describe(model)),
        Reason::Connected => format!("{what} written anew below: it shares DOFs with others that are\n"),
    }
}

/// The new equations, and the node that carries right-hand sides, if there are any.
fn new_text(deck: &Deck, plan: &Plan) -> Result<Vec<u8>, CleanError> {
    if plan.written.is_empty() {
        return Ok(Vec::new());
    }
    let mut text =
        String::from("** qless: independent equations; each slave, the first DOF, occurs once and is not prescribed\n");
    let dummy = if plan.written.iter().any(|written| written.rhs != 0.0) { Some(unused_node(deck)?) } else { None };
    if let Some(node) = dummy {
        let carrier = format!(
            "** qless: node {node} carries the right-hand sides: its first DOF is 1\n\
             *NODE\n{node},0.,0.,0.\n*BOUNDARY\n{node},1,1,1.\n"
        );
        text.push_str(&carrier);
    }
    text += "*EQUATION\n";
    for written in &plan.written {
        add_equation(&mut text, written, dummy);
    }
    Ok(text.into_bytes())
}

fn add_equation(text: &mut String, written: &Written, dummy: Option<u32>) {
    let rhs = dummy.filter(|_| written.rhs != 0.0).map(|node| format!("{node},1,{}", number(-written.rhs)));
    let term = |dof: crate::deck::Dof, v: f64| format!("{},{},{}", dof.node, dof.component, number(v));
    let first = std::iter::once(term(written.slave, 1.0));
    let terms: Vec<String> = first.chain(written.terms.iter().map(|&(dof, v)| term(dof, v))).chain(rhs).collect();
    text.push_str(&terms.len().to_string());
    text.push('\n');
    for line in terms.chunks(4) {
        *text += &line.join(",");
        text.push('\n');
    }
}

/// The number with all of its digits, or with as many as CalculiX reads.
fn number(value: f64) -> String {
    let shortest = [format!("{value:?}"), format!("{value:e}")];
    if let Some(text) = shortest.into_iter().filter(|text| text.len() <= NUMBER).min_by_key(String::len) {
        return if text.contains(['.', 'e']) { text } else { text + "." };
    }
    (0..=NUMBER)
        .rev()
        .flat_map(|digits| [format!("{value:.digits$}"), format!("{value:.digits$e}")])
        .filter(|text| text.len() <= NUMBER)
        .min_by(|a, b| error(a, value).total_cmp(&error(b, value)))
        .unwrap_or_else(|| format!("{value:e}"))
}

fn error(text: &str, value: f64) -> f64 {
    text.parse::<f64>().map_or(f64::INFINITY, |read| (read - value).abs())
}

/// One more than the largest number of a node.
fn unused_node(deck: &Deck) -> Result<u32, CleanError> {
    let listed = definitions(deck)?.node_numbers().last().copied().unwrap_or(0);
    let used = deck.model.dofs.iter().map(|dof| dof.node).max().unwrap_or(0);
    Ok(listed.max(used).saturating_add(1))
}

/// What a deck that was read before defines.
fn definitions(deck: &Deck) -> Result<Definitions, DeckError> {
    let mut definitions = Definitions::default();
    let mut note = |card: &Card| {
        definitions.note(card);
        Ok(())
    };
    deck.again(|sources| walk(sources, &mut note))?;
    Ok(definitions)
}

/// Where the nodes of a deck are; none where its nodes cannot be read.
pub fn positions(deck: &Deck) -> HashMap<u32, [f64; 3]> {
    let found = definitions(deck).ok().and_then(|definitions| definitions.all_positions().ok());
    found.map(|all| all.into_iter().collect()).unwrap_or_default()
}

/// The nodes of a set, if there is such a set.
pub fn node_set(deck: &Deck, name: &str) -> Option<Vec<u32>> {
    definitions(deck).ok()?.nodes(name).ok().map(|nodes| nodes.to_vec())
}

/// The names of all node sets.
pub fn node_set_names(deck: &Deck) -> Vec<String> {
    definitions(deck).map(|found| found.node_set_names().map(str::to_owned).collect()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn numbers_are_short_enough_to_be_read_whole() {
        for (value, text) in [(1.0, "1.0"), (-1.0, "-1.0"), (1e-30, "1e-30"), (-1.0 / 3.0, "-0.3333333333333333")] {
            assert_eq!(number(value), text);
        }
        for value in [-1.234_567_890_123_456_7e-105, -12_345.678_901_234_567, std::f64::consts::PI * 1e-7] {
            let text = number(value);
            assert!(
                text.len() <= 20 && ((text.parse::<f64>().expect("a number") - value) / value).abs() < 1e-12,
                "{text}"
            );
        }
    }
}
