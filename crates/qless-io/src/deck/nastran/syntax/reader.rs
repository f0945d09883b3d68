//! The parts of a deck in their order: executive control, case control, `BEGIN BULK`, bulk data, `ENDDATA`.

use super::assembly::Assembly;
use super::card::{Failed, Refused};
use super::content::{Content, Landmarks};
use super::fields::continues;
use super::lines::{Include, Line, Visitor, walk};
use super::section::{self, Section};
use super::word::keyword;
use crate::deck::nastran::cards::bulk::known;
use crate::deck::nastran::cards::quick;
use crate::deck::nastran::control::subcases::Control;
use crate::deck::{DeckError, Problem, Sources};

/// Reads all lines of a deck.
pub fn read(sources: &mut Sources) -> Result<Content, DeckError> {
    let section = section::first(sources)?;
    let cards = Assembly::new(sources.solver());
    let mut reader = Reader { landmarks: Landmarks::default(), control: None, section, cards };
    walk(sources, &mut reader)?;
    let Reader { landmarks, control, cards, .. } = reader;
    let bulk = cards.finish().map_err(|failed| error(failed, sources))?;
    Ok(Content { landmarks, bulk, control })
}

struct Reader {
    landmarks: Landmarks,
    control: Option<Control>,
    section: Section,
    cards: Assembly,
}

impl Visitor for Reader {
    fn quick(&mut self, line: &Line, sources: &Sources) -> Result<bool, DeckError> {
        if self.section != Section::Bulk {
            return Ok(false);
        }
        // MYSTRAN refuses coefficients that the short way reads.
        if self.cards.bulk.is_mystran && line.text.starts_with(b"MPC") {
            return Ok(false);
        }
        let Some(card) = quick::read(line.text) else { return Ok(false) };
        self.cards.quick(&card, line).map_err(|failed| error(failed, sources))?;
        Ok(true)
    }

    fn line(&mut self, line: &Line, sources: &Sources) -> Result<bool, DeckError> {
        match self.section {
            Section::Executive | Section::Control => self.control(line, sources)?,
            Section::Bulk => return self.bulk(line).map_err(|failed| error(failed, sources)),
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
        self.landmarks.includes.push(include);
    }

    /// Files of executive control hold procedures, not constraints.
    fn unreadable(&mut self, error: DeckError) -> Result<(), DeckError> {
        if self.section != Section::Executive || !matches!(error.problem, Problem::Include { .. }) {
            return Err(error);
        }
        let text = format!("{}; executive control is read on without it", error.problem);
        self.cards.bulk.notes.warn((0, error.line as u32), text);
        Ok(())
    }
}

impl Reader {
    fn control(&mut self, line: &Line, sources: &Sources) -> Result<(), DeckError> {
        let (word, rest) = keyword(line.text);
        if self.section == Section::Control {
            self.landmarks.control.get_or_insert(line.at());
        }
        match word.as_str() {
            // A second one ends nothing.
            "CEND" if self.section == Section::Executive => self.end_executive(line),
            "BEGIN" => self.begin(rest, line),
            _ if self.section == Section::Control => {
                let read = self.control.get_or_insert_default().line(line);
                let refused = |problem| Refused { at: line.at(), field: None, problem };
                read.map_err(|problem| error(Failed { card: word, refused: refused(problem) }, sources))?;
            }
            _ => {}
        }
        Ok(())
    }

    fn end_executive(&mut self, line: &Line) {
        self.section = Section::Control;
        self.control.get_or_insert_default();
        self.landmarks.control = Some((line.file, line.number + 1));
    }

    /// `BEGIN BULK`, or the part of a superelement.
    fn begin(&mut self, rest: &[u8], line: &Line) {
        let text = String::from_utf8_lossy(rest).trim().to_ascii_uppercase();
        if text.is_empty() || text == "BULK" || text == "BULK SUPER=0" {
            self.section = Section::Bulk;
            self.landmarks.bulk.get_or_insert((line.file, line.number + 1));
            return;
        }
        self.section = Section::Passed;
        let text = format!("BEGIN {text}: this part of the deck is not understood and left out");
        self.cards.bulk.notes.leave_out(line.at(), text);
    }

    fn bulk(&mut self, line: &Line) -> Result<bool, Failed> {
        if continues(line.text) {
            return self.cards.go_on(line).map(|()| true);
        }
        if self.cards.is_copied_by(line) {
            return self.cards.copy(line).map(|()| true);
        }
        self.cards.end_card()?;
        let mut name = [0; 8];
        match card_name(line.text, &mut name) {
            b"ENDDATA" => {
                self.landmarks.end = Some(line.at());
                return Ok(false);
            }
            name if name.starts_with(b"BEGIN") => self.begin(keyword(line.text).1, line),
            b"CEND" if self.control.is_none() => self.end_executive(line),
            name => {
                let known = known(name);
                if known.is_none() {
                    self.cards.bulk.unknown.meet(name, line.at(), &mut self.cards.bulk.notes);
                }
                self.cards.begin(known, line)?;
            }
        }
        Ok(true)
    }
}

fn error(Failed { card, refused }: Failed, sources: &Sources) -> DeckError {
    let Refused { at: (file, line), field, problem } = refused;
    DeckError { path: sources.path(file as usize).to_path_buf(), line: line as usize, card, field, problem }
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
