//! From lines to cards: executive control, case control, `BEGIN BULK`, bulk data, `ENDDATA`.

use super::card::{Card, Refused};
use super::content::{Content, Landmarks};
use super::continuations::{Before, Continuations, is_always_one_line, name_of};
use super::copies::{self, Change};
use super::fields::{continues, is_copy, mark, name_in};
use super::lines::{Include, Line, Visitor, walk};
use super::section::{self, Section};
use super::word::keyword;
use crate::deck::nastran::cards::bulk::{Bulk, known};
use crate::deck::nastran::cards::quick;
use crate::deck::{DeckError, Problem, Solver, Sources};
use crate::fault::quote;

/// Reads all lines of a deck.
pub fn read(sources: &mut Sources) -> Result<Content, DeckError> {
    let section = section::first(sources)?;
    let content = Content { landmarks: Landmarks::default(), bulk: Bulk::default(), control: None };
    let mut reader = Reader {
        content,
        section,
        card: Card::default(),
        before: Before::Nothing,
        mark: Vec::new(),
        continuations: Continuations::default(),
        copies: None,
        by_name: sources.solver() != Solver::Optistruct,
    };
    walk(sources, &mut reader)?;
    reader.finish(sources)
}

struct Reader {
    content: Content,
    section: Section,
    card: Card,
    /// What the last line belongs to.
    before: Before,
    /// How the last line names its continuation, if it is one of a card that is not read.
    mark: Vec<u8>,
    continuations: Continuations,
    /// How the last copies were made.
    copies: Option<Change>,
    /// Whether a continuation may be elsewhere than in the next line. Where not, names do not matter.
    by_name: bool,
}

impl Visitor for Reader {
    fn quick(&mut self, line: &Line, sources: &Sources) -> Result<bool, DeckError> {
        if self.section != Section::Bulk {
            return Ok(false);
        }
        let Some(card) = quick::read(line.text) else { return Ok(false) };
        self.finish_card(sources)?;
        // No continuation follows, and no copy.
        self.copies = None;
        self.content.bulk.quick(&card, line);
        Ok(true)
    }

    fn line(&mut self, line: &Line, sources: &Sources) -> Result<bool, DeckError> {
        match self.section {
            Section::Executive | Section::Control => self.control(line, sources)?,
            Section::Bulk => return self.bulk(line, sources),
            Section::Passed => {
                let (word, rest) = keyword(line.text);
                match word.as_str() {
                    "ENDDATA" => return Ok(false),
                    "BEGIN" => self.begin(rest, line),
                    _ => {}
                }
            }
        }
        Ok(true)
    }

    fn included(&mut self, include: Include) {
        self.content.landmarks.includes.push(include);
    }

    /// Files of executive control hold procedures, not constraints.
    fn unreadable(&mut self, error: DeckError) -> Result<(), DeckError> {
        if self.section != Section::Executive || !matches!(error.problem, Problem::Include { .. }) {
            return Err(error);
        }
        let text = format!("{}; executive control is read on without it", error.problem);
        self.content.bulk.warnings.warn((0, error.line as u32), text);
        Ok(())
    }
}

impl Reader {
    fn control(&mut self, line: &Line, sources: &Sources) -> Result<(), DeckError> {
        let (word, rest) = keyword(line.text);
        if self.section == Section::Control {
            self.content.landmarks.control.get_or_insert(line.at());
        }
        match word.as_str() {
            "CEND" if self.section == Section::Executive => self.end_executive(line),
            "BEGIN" => self.begin(rest, line),
            _ if self.section == Section::Control => {
                let control = self.content.control.get_or_insert_default();
                control.line(line).map_err(|problem| {
                    let path = sources.path(line.file as usize).to_path_buf();
                    DeckError { path, line: line.number as usize, card: word, field: None, problem }
                })?;
            }
            _ => {}
        }
        Ok(())
    }

    fn end_executive(&mut self, line: &Line) {
        self.section = Section::Control;
        self.content.control.get_or_insert_default();
        self.content.landmarks.control = Some((line.file, line.number + 1));
    }

    /// `BEGIN BULK`, or the part of a superelement.
    fn begin(&mut self, rest: &[u8], line: &Line) {
        let text = String::from_utf8_lossy(rest).trim().to_ascii_uppercase();
        self.before = Before::Nothing;
        if text.is_empty() || text == "BULK" || text == "BULK SUPER=0" {
            self.section = Section::Bulk;
            self.content.landmarks.bulk.get_or_insert((line.file, line.number + 1));
            return;
        }
        self.section = Section::Passed;
        let text = format!("BEGIN {text}: this part of the deck is not understood and left out");
        self.content.bulk.warnings.leave_out(line.at(), text);
    }

    fn bulk(&mut self, line: &Line, sources: &Sources) -> Result<bool, DeckError> {
        if continues(line.text) {
            self.continuation(line, sources)?;
            return Ok(true);
        }
        if is_copy(line.text) && self.before == Before::Read {
            self.copy(line, sources)?;
            return Ok(true);
        }
        self.finish_card(sources)?;
        self.copies = None;
        let mut name = [0; 8];
        let name = card_name(line.text, &mut name);
        match name {
            b"ENDDATA" => {
                self.content.landmarks.end = Some(line.at());
                return Ok(false);
            }
            name if name.starts_with(b"BEGIN") => self.begin(keyword(line.text).1, line),
            b"CEND" if self.content.control.is_none() => self.end_executive(line),
            name => match known(name) {
                Some(name) => {
                    self.before = Before::Read;
                    let begun = self.card.begin(name, line.text, line.at());
                    begun.map_err(|refused| self.error(refused, sources))?;
                }
                None => self.pass(line),
            },
        }
        Ok(true)
    }

    /// Passes over a line of a card that is not read.
    fn pass(&mut self, line: &Line) {
        self.before = Before::Unread;
        self.mark.clear();
        self.mark.extend_from_slice(mark(line.text));
    }

    /// Finds out what a continuation line goes on with.
    fn continuation(&mut self, line: &Line, sources: &Sources) -> Result<(), DeckError> {
        let name = if self.by_name { name_of(line.text) } else { Vec::new() };
        let own = match self.before {
            Before::Read => self.card.continues_in(),
            Before::Unread => name_in(&self.mark),
            Before::Nothing | Before::Piece => Vec::new(),
        };
        let is_next = name.is_empty() || own == name;
        match self.before {
            Before::Nothing if name.is_empty() => {
                return Err(error(line, "continuation", "a card before the line that continues it", sources));
            }
            Before::Read if is_next && self.copies.is_some() => {
                let expected = "a card of one line, as what `=` copies has to be";
                return Err(error(line, "continuation", expected, sources));
            }
            Before::Read if is_next => {
                let taken = self.card.extend(line.text, line.at(), false);
                taken.map_err(|refused| self.error(refused, sources))?;
            }
            Before::Unread if is_next => self.pass(line),
            Before::Piece if self.continuations.goes_on(&name) => self.continuations.extend(line.text, line.at()),
            before => self.start_piece(before, name, own, line, sources)?,
        }
        Ok(())
    }

    /// Keeps a line of a name that what stands before it does not go on with.
    fn start_piece(
        &mut self,
        before: Before,
        name: Vec<u8>,
        own: Vec<u8>,
        line: &Line,
        sources: &Sources,
    ) -> Result<(), DeckError> {
        let names_none = own.is_empty();
        if before == Before::Read && names_none && self.copies.is_none() {
            self.continuations.claim_next(std::mem::take(&mut self.card));
        } else {
            self.finish_card(sources)?;
        }
        self.continuations.start(name, line.text, line.at(), before == Before::Unread && names_none);
        self.before = Before::Piece;
        Ok(())
    }

    /// Makes copies of the card before the line.
    fn copy(&mut self, line: &Line, sources: &Sources) -> Result<(), DeckError> {
        if !self.card.is_one_line() || !self.card.continues_in().is_empty() {
            return Err(error(line, "=", "a card of one line before its copies", sources));
        }
        if self.copies.is_none() {
            self.content.bulk.fixed.insert((self.card.file, self.card.line));
            self.give(sources)?;
        }
        let read = copies::read(line.text, self.copies.as_ref(), line.at());
        let (count, change) = read.map_err(|refused| self.error(refused, sources))?;
        self.content.bulk.fixed.insert(line.at());
        for _ in 0..count {
            let made = change.apply(&mut self.card, line.at());
            made.map_err(|refused| self.error(refused, sources))?;
            self.give(sources)?;
        }
        self.copies = Some(change);
        Ok(())
    }

    /// Ends the card before the line.
    fn finish_card(&mut self, sources: &Sources) -> Result<(), DeckError> {
        match std::mem::replace(&mut self.before, Before::Nothing) {
            // Copies were given when they were made.
            Before::Read if self.copies.is_none() => {
                let name = if self.by_name { self.card.continues_in() } else { Vec::new() };
                if name.is_empty() || is_always_one_line(self.card.name) {
                    return self.give(sources);
                }
                self.continuations.claim(name, Some(std::mem::take(&mut self.card)));
            }
            Before::Unread if self.by_name => {
                let name = name_in(&self.mark);
                if !name.is_empty() {
                    self.continuations.claim(name, None);
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// Hands the card on.
    fn give(&mut self, sources: &Sources) -> Result<(), DeckError> {
        self.content.bulk.card(&self.card).map_err(|refused| self.error(refused, sources))
    }

    /// Ends the deck.
    fn finish(mut self, sources: &Sources) -> Result<Content, DeckError> {
        self.finish_card(sources)?;
        let cards = std::mem::take(&mut self.continuations).finish().map_err(|(card, refused)| match card {
            Some(card) => fail(refused, card.title().to_string(), sources),
            None => fail(refused, "continuation".into(), sources),
        })?;
        for card in cards {
            self.card = card;
            self.give(sources)?;
        }
        Ok(self.content)
    }

    fn error(&self, refused: Refused, sources: &Sources) -> DeckError {
        fail(refused, self.card.title().to_string(), sources)
    }
}

fn fail(refused: Refused, card: String, sources: &Sources) -> DeckError {
    let Refused { at: (file, line), field, problem } = refused;
    DeckError { path: sources.path(file as usize).to_path_buf(), line: line as usize, card, field, problem }
}

/// Something else is expected than the line.
fn error(line: &Line, card: &str, expected: &'static str, sources: &Sources) -> DeckError {
    let problem = Problem::Expected { expected, found: quote(line.text.trim_ascii()) };
    fail(Refused { at: line.at(), field: None, problem }, card.into(), sources)
}

/// The first field in capitals, without its `*`; empty if it is too long for a name.
fn card_name<'a>(line: &[u8], place: &'a mut [u8; 8]) -> &'a [u8] {
    let first = &line[..line.len().min(9)];
    let end = first.iter().position(|&byte| byte == b',').unwrap_or(first.len().min(8));
    let word = first[..end].trim_ascii();
    let word = word.strip_suffix(b"*").unwrap_or(word).trim_ascii();
    let Some(place) = place.get_mut(..word.len()) else { return b"" };
    place.copy_from_slice(word);
    place.make_ascii_uppercase();
    place
}
