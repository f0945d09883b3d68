//! Assembles lines of bulk data into cards, with their continuations and copies.

use super::bulk::BulkData;
use super::quick::QuickCard;
use crate::deck::limits::COPIES;
use crate::deck::nastran::syntax::card::{BulkCard, CardRefusal, NamedRefusal};
use crate::deck::nastran::syntax::continuations::{Continuations, LineBefore, is_always_one_line, name_of};
use crate::deck::nastran::syntax::copies::{self, CopyRule};
use crate::deck::nastran::syntax::fields::{is_copy, mark, name_in};
use crate::deck::nastran::syntax::lines::DeckLine;
use crate::deck::{CardFault, Problem, Solver};
use crate::fault::quote;

/// The card that is being read, and the bulk data that were read before it.
pub struct CardAssembly {
    pub bulk: BulkData,
    card: BulkCard,
    /// The kind of the line that was read last.
    before: LineBefore,
    /// The continuation mark of the last line, if the card of that line is skipped.
    mark: Vec<u8>,
    continuations: Continuations,
    /// The rule of the copies that the last line made; `None` if it made none.
    copies: Option<CopyRule>,
    /// Number of copies made so far.
    copied: usize,
    solver: Solver,
}

impl CardAssembly {
    pub fn new(solver: Solver) -> Self {
        Self {
            bulk: BulkData::for_solver(solver),
            card: BulkCard::default(),
            before: LineBefore::Nothing,
            mark: Vec::new(),
            continuations: Continuations::default(),
            copies: None,
            copied: 0,
            solver,
        }
    }

    /// Whether names of continuations matter. They do not in OptiStruct, which always takes the next line.
    fn goes_by_name(&self) -> bool {
        self.solver != Solver::Optistruct
    }

    /// Stores a card that the fast path has read. No continuation line and no copy follows it.
    pub fn quick(&mut self, card: &QuickCard, line: &DeckLine) -> Result<(), NamedRefusal> {
        self.end_card()?;
        self.bulk.quick(card, line);
        Ok(())
    }

    /// Starts a card. `name` is `None` for a card that is skipped.
    pub fn begin(&mut self, name: Option<&'static str>, line: &DeckLine) -> Result<(), NamedRefusal> {
        let Some(name) = name else {
            self.skip(line);
            return Ok(());
        };
        self.before = LineBefore::Read;
        self.card.begin(name, line.text, line.at()).map_err(|refused| self.failed(refused))
    }

    /// Skips a line of a card that is not read.
    fn skip(&mut self, line: &DeckLine) {
        self.before = LineBefore::Unread;
        self.mark.clear();
        self.mark.extend_from_slice(mark(line.text));
    }

    /// Adds a continuation line to its card, or stores the line until its card is known.
    pub fn go_on(&mut self, line: &DeckLine) -> Result<(), NamedRefusal> {
        let name = if self.goes_by_name() { name_of(line.text) } else { Vec::new() };
        let own = match self.before {
            LineBefore::Read => self.card.continues_in(),
            LineBefore::Unread => name_in(&self.mark),
            LineBefore::Nothing | LineBefore::Piece => Vec::new(),
        };
        let is_next = name.is_empty() || own == name;
        match self.before {
            LineBefore::Nothing if name.is_empty() => {
                Err(expected(line, "continuation", "a card before the line that continues it"))
            }
            LineBefore::Read if is_next && self.copies.is_some() => {
                Err(expected(line, "continuation", "a card of one line, since `=` copies it"))
            }
            LineBefore::Read if is_next => {
                self.card.extend(line.text, line.at(), false).map_err(|refused| self.failed(refused))
            }
            LineBefore::Unread if is_next => {
                self.skip(line);
                Ok(())
            }
            LineBefore::Piece if self.continuations.goes_on(&name) => {
                self.continuations.extend(line.text, line.at());
                Ok(())
            }
            LineBefore::Piece => {
                self.continuations.start_next(name, line.text, line.at());
                Ok(())
            }
            // The line continues neither a card nor a piece before it.
            before => {
                if before == LineBefore::Read && own.is_empty() && self.copies.is_none() {
                    self.continuations.claim_next(std::mem::take(&mut self.card));
                } else {
                    self.end_card()?;
                }
                let may_be_unread = before == LineBefore::Unread && own.is_empty();
                self.continuations.start(name, line.text, line.at(), may_be_unread);
                self.before = LineBefore::Piece;
                Ok(())
            }
        }
    }

    /// Whether the line makes copies that this reader must handle. Copies of a skipped card are skipped with it.
    pub fn is_copied_by(&self, line: &DeckLine) -> bool {
        is_copy(line.text) && (self.before == LineBefore::Read || self.solver == Solver::Mystran)
    }

    /// Makes the copies of the previous card that the line asks for.
    pub fn copy(&mut self, line: &DeckLine) -> Result<(), NamedRefusal> {
        if self.solver == Solver::Mystran {
            self.note_skipped_copy(line);
            return Ok(());
        }
        if !self.card.is_one_line() || !self.card.continues_in().is_empty() {
            return Err(expected(line, "=", "a card of one line before its copies"));
        }
        if self.copies.is_none() {
            self.bulk.fixed.insert((self.card.file, self.card.line));
            self.hand_over()?;
        }
        let read = copies::read(line.text, self.copies.as_ref(), line.at());
        let (count, change) = read.map_err(|refused| self.failed(refused))?;
        self.copied = self.copied.saturating_add(count);
        if self.copied > COPIES {
            let advice = "write fewer of them";
            let problem = Problem::Limit { what: "the number of copies", limit: COPIES, advice };
            return Err(self.failed(CardRefusal::of_line(line.at(), problem)));
        }
        self.bulk.fixed.insert(line.at());
        for _ in 0..count {
            change.apply(&mut self.card, line.at()).map_err(|refused| self.failed(refused))?;
            self.hand_over()?;
        }
        self.copies = Some(change);
        Ok(())
    }

    /// Notes that MYSTRAN makes no copies. It ignores most lines that ask for them. But it takes a line in free field with an asterisk for
    /// one in large field, and stops.
    fn note_skipped_copy(&mut self, line: &DeckLine) {
        if line.text.contains(&b',') && line.text.contains(&b'*') {
            self.bulk.notes.refuse(line.at(), "MYSTRAN stops at this line of copies; write the cards out".into());
        } else {
            self.bulk.notes.warn(line.at(), "MYSTRAN ignores this line of copies; write the cards out".into());
        }
    }

    /// Ends the card that is being read, if there is one.
    pub fn end_card(&mut self) -> Result<(), NamedRefusal> {
        // If the card was copied, the bulk data already have the card and its copies.
        let is_complete = self.copies.take().is_some();
        match std::mem::replace(&mut self.before, LineBefore::Nothing) {
            LineBefore::Read if !is_complete => {
                let name = if self.goes_by_name() { self.card.continues_in() } else { Vec::new() };
                if name.is_empty() || self.card.is_full_line() && is_always_one_line(self.card.name) {
                    return self.hand_over();
                }
                self.continuations.claim(name, Some(std::mem::take(&mut self.card)));
            }
            LineBefore::Unread if self.goes_by_name() => {
                let name = name_in(&self.mark);
                if !name.is_empty() {
                    self.continuations.claim(name, None);
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// Adds the card that is being read to the bulk data.
    fn hand_over(&mut self) -> Result<(), NamedRefusal> {
        if self.solver == Solver::Mystran && self.card.goes_beyond {
            let at = (self.card.file, self.card.line);
            return Err(self.failed(CardRefusal::of_line(at, CardFault::FieldsDropped)));
        }
        self.bulk.card(&self.card).map_err(|refused| self.failed(refused))
    }

    /// Returns the complete bulk data, with the cards whose continuation lines stand elsewhere.
    pub fn finish(mut self) -> Result<BulkData, NamedRefusal> {
        self.end_card()?;
        let cards = std::mem::take(&mut self.continuations).finish(self.solver)?;
        for card in cards {
            self.card = card;
            self.hand_over()?;
        }
        Ok(self.bulk)
    }

    fn failed(&self, refused: CardRefusal) -> NamedRefusal {
        refused.in_card(&self.card)
    }
}

/// The error that something other than this line was expected.
fn expected(line: &DeckLine, card: &str, expected: &'static str) -> NamedRefusal {
    let problem = Problem::Expected { expected, found: quote(line.text.trim_ascii()) };
    NamedRefusal { card: card.into(), refused: CardRefusal::of_line(line.at(), problem) }
}
