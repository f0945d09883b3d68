//! Reads the sections of a deck in their order: executive control, case control, `BEGIN BULK`, bulk data, `ENDDATA`.
//!
//! The result, [`NastranContent`], is what `model` turns into equations and `write` edits.

use super::cards::assembly::CardAssembly;
use super::cards::bulk::{BulkData, known};
use super::cards::quick;
use super::control::subcases::CaseControl;
use super::syntax::card::{CardRefusal, NamedRefusal};
use super::syntax::fields::continues;
use super::syntax::lines::{DeckLine, FileLine, IncludeLine, LineVisitor, keyword, walk};
use crate::deck::{DeckError, Problem, Sources};

/// Reads all lines of a deck into its content.
pub fn read(sources: &mut Sources) -> Result<NastranContent, DeckError> {
    let section = first_section(sources)?;
    let cards = CardAssembly::new(sources.solver());
    let mut reader = NastranReader { landmarks: Landmarks::default(), control: None, section, cards };
    walk(sources, &mut reader)?;
    let NastranReader { landmarks, control, cards, .. } = reader;
    let bulk = cards.finish().map_err(|failed| error(failed, sources))?;
    Ok(NastranContent { landmarks, bulk, control })
}

struct NastranReader {
    landmarks: Landmarks,
    control: Option<CaseControl>,
    section: DeckSection,
    cards: CardAssembly,
}

impl LineVisitor for NastranReader {
    fn quick(&mut self, line: &DeckLine, sources: &Sources) -> Result<bool, DeckError> {
        if self.section != DeckSection::Bulk {
            return Ok(false);
        }
        // Coefficients of `MPC` take the general path for MYSTRAN, which refuses some that the fast path accepts.
        if self.cards.bulk.is_mystran && line.text.starts_with(b"MPC") {
            return Ok(false);
        }
        let Some(card) = quick::read(line.text) else { return Ok(false) };
        self.cards.quick(&card, line).map_err(|failed| error(failed, sources))?;
        Ok(true)
    }

    fn line(&mut self, line: &DeckLine, sources: &Sources) -> Result<bool, DeckError> {
        match self.section {
            DeckSection::Executive | DeckSection::Control => self.control(line, sources)?,
            DeckSection::Bulk => return self.bulk(line).map_err(|failed| error(failed, sources)),
            DeckSection::Skipped => {
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

    fn included(&mut self, include: IncludeLine) {
        self.landmarks.includes.push(include);
    }

    /// If an included file of executive control cannot be read, continues without it: such files hold procedures, not constraints.
    fn unreadable(&mut self, at: FileLine, error: DeckError) -> Result<(), DeckError> {
        if self.section != DeckSection::Executive || !matches!(error.problem, Problem::Include { .. }) {
            return Err(error);
        }
        let text = format!("{}; executive control is read on without it", error.problem);
        self.cards.bulk.notes.warn(at, text);
        Ok(())
    }
}

impl NastranReader {
    fn control(&mut self, line: &DeckLine, sources: &Sources) -> Result<(), DeckError> {
        let (word, rest) = keyword(line.text);
        if self.section == DeckSection::Control {
            self.landmarks.control.get_or_insert(line.at());
        }
        match word.as_str() {
            // A second CEND has no effect.
            "CEND" if self.section == DeckSection::Executive => self.end_executive(line),
            "BEGIN" => self.begin(rest, line),
            _ if self.section == DeckSection::Control => {
                let read = self.control.get_or_insert_default().line(line);
                let refused = |problem| CardRefusal::of_line(line.at(), problem);
                read.map_err(|problem| error(NamedRefusal { card: word, refused: refused(problem) }, sources))?;
            }
            _ => {}
        }
        Ok(())
    }

    fn end_executive(&mut self, line: &DeckLine) {
        self.section = DeckSection::Control;
        self.control.get_or_insert_default();
        self.landmarks.control = Some((line.file, line.number + 1));
    }

    /// Handles `BEGIN BULK`, and `BEGIN` of another section of bulk data.
    fn begin(&mut self, rest: &[u8], line: &DeckLine) {
        let text = String::from_utf8_lossy(rest).trim().to_ascii_uppercase();
        if text.is_empty() || text == "BULK" || text == "BULK SUPER=0" {
            self.section = DeckSection::Bulk;
            self.landmarks.bulk.get_or_insert((line.file, line.number + 1));
            return;
        }
        if self.section == DeckSection::Bulk {
            self.landmarks.end.get_or_insert(line.at());
        }
        self.section = DeckSection::Skipped;
        let text = format!("BEGIN {text}: this part of the deck is not understood and left out");
        self.cards.bulk.notes.leave_out(line.at(), text);
    }

    fn bulk(&mut self, line: &DeckLine) -> Result<bool, NamedRefusal> {
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
                self.landmarks.end.get_or_insert(line.at());
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

fn error(NamedRefusal { card, refused }: NamedRefusal, sources: &Sources) -> DeckError {
    let CardRefusal { at: (file, line), field, problem } = refused;
    DeckError { path: sources.path(file as usize).to_path_buf(), line: line as usize, card, field, problem }
}

/// The first field of a line in capitals, without its `*`; empty if the field is too long for a name.
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

/// The section of the deck to which a line belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DeckSection {
    /// Executive control, up to `CEND`.
    Executive,
    /// Case control, up to `BEGIN BULK`.
    Control,
    Bulk,
    /// Bulk data that this reader does not support, for example of a superelement.
    Skipped,
}

/// The section with which the deck begins. If neither `CEND` nor `BEGIN` occurs, in the main file or in an included one, the deck is bulk
/// data from its first line.
pub fn first_section(sources: &mut Sources) -> Result<DeckSection, DeckError> {
    let mut landmark = FirstLandmark(DeckSection::Bulk);
    walk(sources, &mut landmark)?;
    Ok(landmark.0)
}

/// Finds the section with which the deck begins. If the first landmark is CEND, it is executive control; if it is BEGIN, case control. If
/// it is ENDDATA or there is none, it is bulk data.
struct FirstLandmark(DeckSection);

impl LineVisitor for FirstLandmark {
    fn quick(&mut self, line: &DeckLine, _: &Sources) -> Result<bool, DeckError> {
        // Lines of the two most frequent kinds, grid points and equations, are no landmarks.
        Ok(matches!(line.text.first(), Some(b'G' | b'M')))
    }

    fn line(&mut self, line: &DeckLine, _: &Sources) -> Result<bool, DeckError> {
        match keyword(line.text).0.as_str() {
            "CEND" => self.0 = DeckSection::Executive,
            "BEGIN" => self.0 = DeckSection::Control,
            "ENDDATA" => {}
            _ => return Ok(true),
        }
        Ok(false)
    }

    fn included(&mut self, _: IncludeLine) {}

    /// Ignores a file that cannot be read: it is not yet known to which section it belongs. The second reading decides whether the file is
    /// needed.
    fn unreadable(&mut self, _: FileLine, error: DeckError) -> Result<(), DeckError> {
        if matches!(error.problem, Problem::Include { .. }) { Ok(()) } else { Err(error) }
    }
}

/// The lines at which the sections of a deck begin. The writer needs them.
#[derive(Debug, Default)]
pub struct Landmarks {
    /// The first line of case control.
    pub control: Option<FileLine>,
    /// The line after `BEGIN BULK`.
    pub bulk: Option<FileLine>,
    /// The line that ends bulk data: `ENDDATA`, or the start of the first section that is left out.
    pub end: Option<FileLine>,
    pub includes: Vec<IncludeLine>,
}

/// The content of a deck, section by section.
#[derive(Debug)]
pub struct NastranContent {
    pub landmarks: Landmarks,
    pub bulk: BulkData,
    /// Case control; `None` if the deck consists of bulk data alone.
    pub control: Option<CaseControl>,
}
