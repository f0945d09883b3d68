//! The cards of a deck and their names. Cards with evenly increasing numbers, such as `CE 1`, `CE 2`, ..., are stored as
//! one run.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

/// Name of a card in the deck, such as `*EQUATION` or `RBE2 12`.
///
/// ```
/// use qless_io::deck::CardName;
/// let name = CardName::numbered("RBE2", 12);
/// assert_eq!((name.to_string().as_str(), name == CardName::from("RBE2 12".to_owned())), ("RBE2 12", true));
/// ```
#[derive(Clone, Debug)]
pub struct CardName(NameParts);

#[derive(Clone, Debug)]
enum NameParts {
    Word(&'static str),
    Numbered(&'static str, u32),
    Text(Box<str>),
}

impl CardName {
    /// A name that consists of a word and a number.
    pub fn numbered(word: &'static str, number: u32) -> Self {
        Self(NameParts::Numbered(word, number))
    }

    /// Whether the name consists of this word and some number.
    pub(super) fn is_numbered(&self, word: &str) -> bool {
        matches!(self.0, NameParts::Numbered(own, _) if own == word)
    }

    /// The name with its number increased by `more`.
    pub(super) fn counted(&self, more: u32) -> Self {
        match self.0 {
            NameParts::Numbered(word, number) => Self(NameParts::Numbered(word, number.wrapping_add(more))),
            _ => self.clone(),
        }
    }

    /// The number of `other` minus the number of this name; 0 if one of them has no number.
    pub(super) fn distance(&self, other: &Self) -> u32 {
        match (&self.0, &other.0) {
            (NameParts::Numbered(_, number), NameParts::Numbered(_, other)) => other.wrapping_sub(*number),
            _ => 0,
        }
    }

    fn text(&self) -> Cow<'_, str> {
        match &self.0 {
            NameParts::Word(word) => Cow::Borrowed(word),
            NameParts::Numbered(word, number) => Cow::Owned(format!("{word} {number}")),
            NameParts::Text(text) => Cow::Borrowed(text),
        }
    }
}

impl fmt::Display for CardName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.0 {
            NameParts::Numbered(word, number) => write!(f, "{word} {number}"),
            _ => f.write_str(&self.text()),
        }
    }
}

impl PartialEq for CardName {
    fn eq(&self, other: &Self) -> bool {
        match (&self.0, &other.0) {
            (NameParts::Numbered(word, number), NameParts::Numbered(other, last)) => number == last && word == other,
            _ => self.text() == other.text(),
        }
    }
}

impl Eq for CardName {}

impl PartialEq<&str> for CardName {
    fn eq(&self, other: &&str) -> bool {
        self.text() == *other
    }
}

impl From<&'static str> for CardName {
    fn from(word: &'static str) -> Self {
        Self(NameParts::Word(word))
    }
}

impl From<String> for CardName {
    fn from(text: String) -> Self {
        Self(NameParts::Text(text.into()))
    }
}

/// A card that constrains.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Card {
    /// Name in the deck, such as `*EQUATION` or `RBE2 12`.
    pub name: CardName,
    /// Index into [`Model::files`](super::Model::files).
    pub file: u32,
    /// First line, from 1.
    pub line: u32,
    /// Whether equations cannot replace the card, for example because the solver adds DOFs of its own to it.
    pub is_fixed: bool,
}

/// The cards of a deck, numbered from 0.
///
/// ```
/// # let place = tempfile::tempdir()?;
/// let path = place.path().join("ties.cdb");
/// std::fs::write(&path, "CE,4,0,1,UX,1,2,UX,-1\nCE,5,0,1,UY,1,2,UY,-1\n")?;
/// let deck = qless_io::deck::read(&path)?;
/// let cards = deck.model().cards();
/// let second = cards.get(1).expect("two cards");
/// assert_eq!((cards.len(), second.name.to_string(), second.line), (2, "CE 5".to_owned(), 2));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Cards {
    runs: Vec<CardRun>,
    count: u32,
    /// Cards that equations cannot replace. A reason is given unless the name of the card explains it.
    irreplaceable: BTreeMap<u32, Option<&'static str>>,
    /// Cards from which the writer can leave out nodes one by one.
    divisible: BTreeSet<u32>,
}

/// A run of similar cards that follow one another. The name of card `first + k` has the number of `card` plus `k * numbers`, and its line
/// is that of `card` plus `k * lines`.
#[derive(Clone, Debug)]
struct CardRun {
    first: u32,
    card: Card,
    numbers: u32,
    lines: u32,
}

impl CardRun {
    fn at(&self, i: u32) -> Card {
        let k = i - self.first;
        let name = self.card.name.counted(k.wrapping_mul(self.numbers));
        Card { name, line: self.card.line.wrapping_add(k.wrapping_mul(self.lines)), ..self.card }
    }

    /// Adds card `i` to the run if it fits. The second card of a run sets the increments.
    fn try_extend(&mut self, i: u32, card: &Card) -> bool {
        if self.first + 1 == i {
            self.numbers = self.card.name.distance(&card.name);
            self.lines = card.line.wrapping_sub(self.card.line);
        }
        self.at(i) == *card
    }
}

impl Cards {
    /// Number of cards.
    pub fn len(&self) -> usize {
        self.count as usize
    }

    /// Whether there are no cards.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Card `i`, which is a number as in [`Origin`](super::Origin); `None` if it does not exist.
    pub fn get(&self, i: u32) -> Option<Card> {
        (i < self.count).then(|| self.nth(i))
    }

    /// Card `i`, which must exist.
    pub(super) fn nth(&self, i: u32) -> Card {
        let run = &self.runs[self.runs.partition_point(|run| run.first <= i) - 1];
        Card { is_fixed: self.irreplaceable.contains_key(&i), ..run.at(i) }
    }

    /// The card added last.
    pub(super) fn last(&self) -> Option<Card> {
        self.runs.last().map(|run| run.at(self.count - 1))
    }

    /// The number of the first card with this name.
    pub(super) fn find(&self, name: &str) -> Option<u32> {
        (0..self.count).find(|&i| self.nth(i).name == name)
    }

    /// Adds a card and returns its number.
    pub(super) fn push(&mut self, name: CardName, file: u32, line: u32) -> u32 {
        let card = Card { name, file, line, is_fixed: false };
        if !self.runs.last_mut().is_some_and(|run| run.try_extend(self.count, &card)) {
            self.runs.push(CardRun { first: self.count, card, numbers: 0, lines: 0 });
        }
        self.count += 1;
        self.count - 1
    }

    /// Sets whether card `i` is one that equations cannot replace.
    pub(super) fn mark_irreplaceable(&mut self, i: u32, is_irreplaceable: bool) {
        if is_irreplaceable {
            self.irreplaceable.insert(i, None);
        } else {
            self.irreplaceable.remove(&i);
        }
    }

    /// Records that the writer can leave out nodes of card `i` one by one.
    pub(super) fn mark_divisible(&mut self, i: u32) {
        self.divisible.insert(i);
    }

    /// Forgets which cards are divisible, so that no nodes are left out of them.
    pub(super) fn keep_whole(&mut self) {
        self.divisible.clear();
    }

    /// Whether the writer can leave out slave nodes of card `i` one by one, with their equations.
    pub(super) fn is_divisible(&self, i: u32) -> bool {
        self.divisible.contains(&i) || self.nth(i).name.is_numbered("RBE2")
    }

    /// Records that equations cannot replace card `i`. The text `why` gives the reason, and how to change the card.
    pub(super) fn fix_because(&mut self, i: u32, why: &'static str) {
        self.irreplaceable.insert(i, Some(why));
    }

    /// Why equations cannot replace card `i`; `None` if they can, or if the name of the card explains it.
    pub fn why_fixed(&self, i: u32) -> Option<&'static str> {
        self.irreplaceable.get(&i).copied().flatten()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cards_are_stored_in_order() {
        let numbered = |word, number| CardName::numbered(word, number);
        let added = [
            (numbered("CE", 1), 0, 2),
            (numbered("CE", 2), 0, 4),
            (numbered("CE", 3), 0, 6),
            (numbered("CE", 5), 0, 8),
            (numbered("CE", 7), 0, 10),
            (numbered("CE", 9), 1, 12),
            (numbered("CP", 10), 1, 12),
            ("D".into(), 1, 13),
            ("D".into(), 1, 14),
            ("F 1".to_owned().into(), 1, 15),
            (numbered("F", 2), 1, 16),
            (numbered("F", u32::MAX), 1, 17),
        ];
        let mut cards = Cards::default();
        for (i, (name, file, line)) in added.iter().enumerate() {
            assert_eq!(cards.push(name.clone(), *file, *line), i as u32);
            assert_eq!(cards.last().map(|card| card.name), Some(name.clone()));
        }
        cards.mark_irreplaceable(4, true);
        cards.mark_irreplaceable(5, true);
        cards.mark_irreplaceable(5, false);
        cards.fix_because(4, "it moves");
        assert_eq!((cards.why_fixed(4), cards.why_fixed(5)), (Some("it moves"), None));
        for (i, (name, file, line)) in added.into_iter().enumerate() {
            assert_eq!(cards.nth(i as u32), Card { name, file, line, is_fixed: i == 4 });
        }
        assert_eq!((cards.find("D"), cards.find("E"), cards.len(), cards.is_empty()), (Some(7), None, 12, false));
        assert_eq!(cards.runs.len(), 7);
    }
}
