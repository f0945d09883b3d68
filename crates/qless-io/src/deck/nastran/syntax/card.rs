//! A card of bulk data: its name, its place in the deck, and its data fields on all of its lines.

use super::fields::{LineFields, name_in, split};
use super::lines::FileLine;
use super::number::real;
use crate::deck::kinematics::components::Components;
use crate::deck::{CardName, DeckError, Model, Origin, Problem};
use crate::fault::quote;
use crate::number::whole;

/// Number of data fields on a line in small field. In large field, two lines have as many.
pub const PER_LINE: usize = 8;

/// A line of a card.
#[derive(Clone, Copy, Debug)]
struct CardLine {
    at: FileLine,
    /// Index of the first data field on this line.
    first: u32,
    /// Whether the line is apart from the first lines of its card: other cards separate them, or it is in another file.
    is_apart: bool,
}

/// A card of bulk data. The reader refills one value for every card, so allocations do not grow with the deck.
#[derive(Clone, Debug, Default)]
pub struct BulkCard {
    /// The name in capitals.
    pub name: &'static str,
    /// The file and the first line of the card.
    pub file: u32,
    pub line: u32,
    text: Vec<u8>,
    /// For each data field, its end in `text`.
    ends: Vec<u32>,
    lines: Vec<CardLine>,
    /// The continuation mark of the card's last line.
    mark: Vec<u8>,
    /// Whether a line in free field has further data after its last data field.
    pub goes_beyond: bool,
}

/// An error in a card: its place and the reason.
#[derive(Debug)]
pub struct CardRefusal {
    pub at: FileLine,
    pub field: Option<usize>,
    pub problem: Problem,
}

/// An error in a card, with the name of the card.
#[derive(Debug)]
pub struct NamedRefusal {
    pub card: String,
    pub refused: CardRefusal,
}

impl CardRefusal {
    /// An error that concerns a whole line.
    pub fn of_line(at: FileLine, problem: impl Into<Problem>) -> Self {
        Self { at, field: None, problem: problem.into() }
    }

    /// Adds the name of the card to the error.
    pub fn in_card(self, card: &BulkCard) -> NamedRefusal {
        NamedRefusal { card: card.title().to_string(), refused: self }
    }
}

impl BulkCard {
    /// Starts a new card from its first line, whose comment was removed.
    pub fn begin(&mut self, name: &'static str, line: &[u8], at: FileLine) -> Result<(), CardRefusal> {
        self.restart(name, at);
        self.take(&split(line).map_err(|problem| CardRefusal::of_line(at, problem))?, at, false);
        Ok(())
    }

    /// Appends a continuation line to the card. `is_apart` is true if other cards separate the line from the card.
    pub fn extend(&mut self, line: &[u8], at: FileLine, is_apart: bool) -> Result<(), CardRefusal> {
        let was_apart = self.lines.last().is_some_and(|last| last.is_apart);
        let fields = split(line).map_err(|problem| CardRefusal::of_line(at, problem))?;
        self.take(&fields, at, is_apart || was_apart || at.0 != self.file);
        Ok(())
    }

    /// Turns this card into one of the same name with these fields, all on one line.
    pub fn become_copy(&mut self, fields: &[Vec<u8>], at: FileLine) {
        self.restart(self.name, at);
        self.lines.push(CardLine { at, first: 0, is_apart: false });
        fields.iter().for_each(|field| self.push(field));
    }

    fn restart(&mut self, name: &'static str, at: FileLine) {
        self.text.clear();
        self.ends.clear();
        self.lines.clear();
        self.mark.clear();
        self.goes_beyond = false;
        self.name = name;
        (self.file, self.line) = at;
    }

    fn take(&mut self, fields: &LineFields, at: FileLine, is_apart: bool) {
        // A line in large field fills half of a line in small field. If a line in small field follows, blank fields fill the other half.
        if fields.data().len() == PER_LINE {
            while !self.ends.len().is_multiple_of(PER_LINE) {
                self.ends.push(self.text.len() as u32);
            }
        }
        self.lines.push(CardLine { at, first: self.ends.len() as u32, is_apart });
        fields.data().iter().chain(&fields.more).for_each(|field| self.push(field));
        self.goes_beyond |= !fields.more.is_empty();
        self.mark.clear();
        self.mark.extend_from_slice(fields.mark);
    }

    fn push(&mut self, field: &[u8]) {
        self.text.extend_from_slice(field);
        self.ends.push(self.text.len() as u32);
    }

    /// The name of the line that continues this card, in capitals; empty if the card names none.
    pub fn continues_in(&self) -> Vec<u8> {
        name_in(&self.mark)
    }

    /// Whether the card fills a line. In large field, this takes two lines.
    pub fn is_full_line(&self) -> bool {
        self.ends.len() >= PER_LINE
    }

    /// Whether the card consists of one line.
    pub fn is_one_line(&self) -> bool {
        self.lines.len() == 1 && self.ends.len() <= PER_LINE
    }

    /// Data field `i`, counted from 0. A field beyond the last one is blank.
    pub fn field(&self, i: usize) -> &[u8] {
        let Some(&end) = self.ends.get(i) else { return b"" };
        let start = if i == 0 { 0 } else { self.ends[i - 1] };
        &self.text[start as usize..end as usize]
    }

    pub fn is_blank(&self, i: usize) -> bool {
        self.field(i).is_empty()
    }

    /// Number of data fields up to the last one that is not blank.
    pub fn len(&self) -> usize {
        (0..self.ends.len()).rev().find(|&i| !self.is_blank(i)).map_or(0, |i| i + 1)
    }

    /// Number of consecutive lines of the card, from its first line on.
    pub fn span(&self) -> u32 {
        let together = self.lines.iter().take_while(|part| !part.is_apart);
        together.last().map_or(1, |part| (part.at.1 + 1).saturating_sub(self.line).max(1))
    }

    /// The place of the card's last line.
    pub fn last(&self) -> FileLine {
        self.lines.last().map_or((self.file, self.line), |part| part.at)
    }

    /// The lines of the card that other cards separate from its first lines.
    pub fn apart(&self) -> impl Iterator<Item = FileLine> {
        self.lines.iter().filter(|part| part.is_apart).map(|part| part.at)
    }

    /// The name and the number of the card, such as `RBE2 12`.
    pub fn title(&self) -> CardName {
        match whole(self.field(0)).map(|id| (id, u32::try_from(id))) {
            Some((_, Ok(id))) => CardName::numbered(self.name, id),
            Some((id, _)) => format!("{} {id}", self.name).into(),
            None => self.name.into(),
        }
    }

    /// The whole number in field `i`, at least 1.
    pub fn id(&self, i: usize, what: &'static str) -> Result<u32, CardRefusal> {
        self.optional_id(i, what)?.ok_or_else(|| self.expected(i, what))
    }

    /// The whole number in field `i`, at least 0; `None` for a blank field.
    pub fn optional_whole(&self, i: usize, what: &'static str) -> Result<Option<u32>, CardRefusal> {
        let word = self.field(i);
        if word.is_empty() {
            return Ok(None);
        }
        let number = whole(word).and_then(|value| u32::try_from(value).ok());
        number.map(Some).ok_or_else(|| self.expected(i, what))
    }

    pub fn optional_id(&self, i: usize, what: &'static str) -> Result<Option<u32>, CardRefusal> {
        match self.optional_whole(i, what)? {
            Some(0) => Err(self.expected(i, what)),
            other => Ok(other),
        }
    }

    /// The real number in field `i`; `None` for a blank field.
    pub fn real(&self, i: usize) -> Result<Option<f64>, CardRefusal> {
        let word = self.field(i);
        if word.is_empty() {
            return Ok(None);
        }
        let number = |fault| self.at(i, Problem::Number { found: quote(word), fault });
        match real(word) {
            // An underflow is read as zero, as in the solver.
            Err(crate::NumberFault::Underflow) => Ok(Some(0.0)),
            other => other.map(Some).map_err(number),
        }
    }

    /// The component numbers in field `i`, with or without blanks between them. If the field is blank or 0, the set is empty.
    pub fn components(&self, i: usize) -> Result<Components, CardRefusal> {
        const EXPECTED: &str = "component numbers: digits from 1 to 6";
        let digits: Vec<u8> = self.field(i).iter().copied().filter(|byte| !byte.is_ascii_whitespace()).collect();
        Components::parse(&digits).ok_or_else(|| self.expected(i, EXPECTED))
    }

    /// The component numbers in field `i`, at least one.
    pub fn some_components(&self, i: usize) -> Result<Components, CardRefusal> {
        const EXPECTED: &str = "one or more component numbers from 1 to 6";
        Some(self.components(i)?).filter(|set| !set.is_empty()).ok_or_else(|| self.expected(i, EXPECTED))
    }

    /// The error that field `i` does not hold `what`.
    pub fn expected(&self, i: usize, what: &'static str) -> CardRefusal {
        self.at(i, Problem::Expected { expected: what, found: quote(self.field(i)) })
    }

    /// The error that there is a problem in field `i`. Messages count fields from 1, and the name of the card is field 1.
    pub fn at(&self, i: usize, problem: Problem) -> CardRefusal {
        let own = self.lines.iter().rfind(|part| part.first as usize <= i);
        let (at, first) = own.map_or(((self.file, self.line), 0), |part| (part.at, part.first as usize));
        CardRefusal { at, field: Some(i - first + 2), problem }
    }
}

/// Where a card is: its file and lines, and its name with its number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CardLocation {
    pub name: CardName,
    pub file: u32,
    pub line: u32,
    pub lines: u32,
}

impl CardLocation {
    pub fn new(card: &BulkCard) -> Self {
        Self { name: card.title(), file: card.file, line: card.line, lines: card.span() }
    }

    /// The place of the card as an origin in the model. Consecutive cards of one name in a file share one entry in the model.
    pub fn origin(&self, model: &mut Model) -> Origin {
        let card = match model.cards.last() {
            Some(last) if last.name == self.name && last.file == self.file => model.cards.len() as u32 - 1,
            _ => model.card(self.name.clone(), self.file, self.line),
        };
        Origin { card, line: self.line, lines: self.lines }
    }

    /// The error that there is a problem in the card as a whole.
    pub fn error(&self, problem: Problem, model: &mut Model) -> DeckError {
        let origin = self.origin(model);
        model.error(origin, None, problem)
    }

    /// The name of the file and the line, such as `deck.bdf:12`.
    pub fn brief(&self, model: &Model) -> String {
        let file = model.files[self.file as usize].file_name().unwrap_or_default().to_string_lossy();
        format!("{file}:{}", self.line)
    }
}
