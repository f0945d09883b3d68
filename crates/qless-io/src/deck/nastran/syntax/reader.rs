//! From lines to cards: executive control, case control, `BEGIN BULK`, bulk data, `ENDDATA`.

use super::card::{Card, Refused};
use super::content::{Content, Landmarks};
use super::fields::continues;
use super::lines::{Include, Line, Visitor, walk};
use super::section::{self, Section};
use crate::deck::nastran::cards::bulk::{Bulk, known};
use crate::deck::nastran::cards::quick;
use crate::deck::nastran::control::subcases::keyword;
use crate::deck::{DeckError, Problem, Sources};
use crate::fault::quote;

/// Reads all lines of a deck.
pub fn read(sources: &mut Sources) -> Result<Content, DeckError> {
    let section = section::first(sources)?;
    let content = Content { landmarks: Landmarks::default(), bulk: Bulk::default(), control: None };
    let mut reader = Reader { content, section, card: Card::default(), passing: true, follows_read: None };
    walk(sources, &mut reader)?;
    reader.finish_card(sources)?;
    Ok(reader.content)
}

struct Reader {
    content: Content,
    section: Section,
    card: Card,
    /// Whether the lines are those of a card that is not read.
    passing: bool,
    /// Whether the last card was read; none before the first.
    follows_read: Option<bool>,
}

impl Visitor for Reader {
    fn quick(&mut self, line: &Line, sources: &Sources) -> Result<bool, DeckError> {
        if self.section != Section::Bulk {
            return Ok(false);
        }
        let Some(card) = quick::read(line.text) else { return Ok(false) };
        self.finish_card(sources)?;
        self.follows_read = Some(true);
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
        self.content.bulk.warnings.push((0, error.line as u32, text));
        Ok(())
    }
}

impl Reader {
    fn control(&mut self, line: &Line, sources: &Sources) -> Result<(), DeckError> {
        let (word, rest) = keyword(line.text);
        if self.section == Section::Control {
            self.content.landmarks.control.get_or_insert((line.file, line.number));
        }
        match word.as_str() {
            "CEND" => self.end_executive(line),
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
        if text.is_empty() || text == "BULK" || text == "BULK SUPER=0" {
            (self.section, self.follows_read) = (Section::Bulk, None);
            self.content.landmarks.bulk.get_or_insert((line.file, line.number + 1));
            return;
        }
        self.section = Section::Passed;
        let text = format!("BEGIN {text}: this part of the deck is not understood and left out");
        self.content.bulk.warnings.push((line.file, line.number, text));
    }

    fn bulk(&mut self, line: &Line, sources: &Sources) -> Result<bool, DeckError> {
        if continues(line.text) {
            if self.follows_read.is_none() {
                return Err(error(line, "continuation", "a card before the line that continues it", sources));
            }
            if !self.passing {
                let taken = self.card.extend(line.text, line.file, line.number);
                taken.map_err(|refused| self.error(refused, sources))?;
            }
            return Ok(true);
        }
        self.finish_card(sources)?;
        let mut name = [0; 8];
        let name = card_name(line.text, &mut name);
        match name {
            b"ENDDATA" => {
                self.content.landmarks.end = Some((line.file, line.number));
                return Ok(false);
            }
            name if name.starts_with(b"BEGIN") => self.begin(keyword(line.text).1, line),
            b"CEND" if self.content.control.is_none() => self.end_executive(line),
            name if name.starts_with(b"=") && self.follows_read == Some(true) => {
                return Err(error(
                    line,
                    "=",
                    "a card with all of its fields (copies by `=` are not understood)",
                    sources,
                ));
            }
            name => match known(name) {
                Some(name) => {
                    (self.passing, self.follows_read) = (false, Some(true));
                    let begun = self.card.begin(name, line.text, line.file, line.number);
                    begun.map_err(|refused| self.error(refused, sources))?;
                }
                None => self.follows_read = Some(false),
            },
        }
        Ok(true)
    }

    fn finish_card(&mut self, sources: &Sources) -> Result<(), DeckError> {
        if !std::mem::replace(&mut self.passing, true) {
            self.content.bulk.card(&self.card).map_err(|refused| self.error(refused, sources))?;
        }
        Ok(())
    }

    fn error(&self, refused: Refused, sources: &Sources) -> DeckError {
        let Refused { line, field, problem } = refused;
        let path = sources.path(self.card.file as usize).to_path_buf();
        DeckError { path, line: line as usize, card: self.card.title().to_string(), field, problem }
    }
}

/// Something else is expected than the line.
fn error(line: &Line, card: &str, expected: &'static str, sources: &Sources) -> DeckError {
    let problem = Problem::Expected { expected, found: quote(line.text.trim_ascii()) };
    let path = sources.path(line.file as usize).to_path_buf();
    DeckError { path, line: line.number as usize, card: card.into(), field: None, problem }
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
