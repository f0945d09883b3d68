//! Abaqus parts and their instances, as Abaqus/CAE writes them: the cards of a part hold once for each of its
//! instances.
//!
//! | cards | treatment |
//! | --- | --- |
//! | `*PART, NAME=P` to `*END PART` | stored until an instance needs them |
//! | `*INSTANCE, NAME=I, PART=P` to `*END INSTANCE` | visited in a new scope; the cards of P follow `*INSTANCE` |
//! | all others, including those of the assembly | visited in the scope of the deck |

use std::path::PathBuf;

use rustc_hash::FxHashMap;

use crate::deck::calculix::syntax::{KeywordCard, Scope, card::Visit};
use crate::deck::{DeckError, Problem};
use crate::fault::quote;

/// Why the visit of a card failed.
pub enum Stop {
    /// The visitor refused the card.
    Refused(DeckError),
    /// The card itself is wrong.
    Card(Problem),
}

impl Stop {
    /// Converts the failure to an error at the line of the card.
    pub fn at(self, card: &KeywordCard, path: impl FnOnce() -> PathBuf) -> DeckError {
        match self {
            Self::Refused(error) => error,
            Self::Card(problem) => {
                let name = String::from_utf8_lossy(&card.keyword).into_owned();
                DeckError { path: path(), line: card.line as usize, card: name, field: None, problem }
            }
        }
    }
}

#[derive(Default)]
enum Enclosing {
    #[default]
    Deck,
    Part(String),
    Instance(Scope),
}

/// The cards of the parts read so far, and the block that encloses the next card.
#[derive(Default)]
pub struct AssemblyExpansion {
    cards: FxHashMap<String, Vec<KeywordCard>>,
    place: Enclosing,
    instances: u32,
}

impl AssemblyExpansion {
    /// Visits a card. After an `*INSTANCE` card, also visits the cards of its part.
    pub fn card(&mut self, card: &KeywordCard, visit: Visit) -> Result<(), Stop> {
        match card.keyword.as_slice() {
            b"*PART" => {
                let part = card.word("NAME").unwrap_or_default();
                self.cards.entry(part.clone()).or_default();
                self.place = Enclosing::Part(part);
            }
            b"*ENDPART" | b"*ENDINSTANCE" => self.place = Enclosing::Deck,
            b"*INSTANCE" => self.instance(card, visit)?,
            _ => match &self.place {
                Enclosing::Deck => visit(card).map_err(Stop::Refused)?,
                Enclosing::Part(part) => self.cards.entry(part.clone()).or_default().push(card.clone()),
                Enclosing::Instance(scope) => visit(&card.in_scope(*scope)).map_err(Stop::Refused)?,
            },
        }
        Ok(())
    }

    fn instance(&mut self, card: &KeywordCard, visit: Visit) -> Result<(), Stop> {
        for elsewhere in ["LIBRARY", "INSTANCE"] {
            if let Some(name) = card.parameter(elsewhere) {
                let expected = "an instance of a part of this deck";
                return Err(Stop::Card(Problem::Expected { expected, found: quote(name.as_bytes()) }));
            }
        }
        let part = card.word("PART").ok_or(Stop::Card(Problem::NoParameter { name: "PART" }))?;
        let Some(cards) = self.cards.get(&part) else {
            return Err(Stop::Card(Problem::Undefined { what: "part", name: part }));
        };
        self.instances += 1;
        let scope = Scope(self.instances);
        self.place = Enclosing::Instance(scope);
        visit(&card.in_scope(scope)).map_err(Stop::Refused)?;
        cards.iter().try_for_each(|card| visit(&card.in_scope(scope))).map_err(Stop::Refused)
    }
}
