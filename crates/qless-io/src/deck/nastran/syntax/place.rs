//! Where a card stands.

use super::card::Card;
use crate::deck::{CardName, Model, Origin};

/// File and lines of a card, and its name with its number.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    pub name: CardName,
    pub file: u32,
    pub line: u32,
    pub lines: u32,
}

impl Place {
    pub fn of(card: &Card) -> Self {
        Self { name: card.title(), file: card.file, line: card.line, lines: card.span() }
    }

    /// The same in a model; cards of one name that follow each other in a file are one there.
    pub fn origin(&self, model: &mut Model) -> Origin {
        let card = match model.cards.last() {
            Some(last) if last.name == self.name && last.file == self.file => model.cards.len() as u32 - 1,
            _ => model.card(self.name.clone(), self.file, self.line),
        };
        Origin { card, line: self.line, lines: self.lines }
    }

    /// `deck.bdf:12`.
    pub fn brief(&self, model: &Model) -> String {
        let file = model.files[self.file as usize].file_name().unwrap_or_default().to_string_lossy();
        format!("{file}:{}", self.line)
    }
}
