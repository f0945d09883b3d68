//! What a card is called, in no more room than a word takes: decks have millions of cards that differ by their number alone.

use std::borrow::Cow;
use std::fmt;

/// A card's name as the deck has it, such as `*EQUATION` or `RBE2 12`.
///
/// ```
/// use qless_io::deck::CardName;
/// let name = CardName::numbered("RBE2", 12);
/// assert_eq!((name.to_string().as_str(), name == CardName::from("RBE2 12".to_owned())), ("RBE2 12", true));
/// ```
#[derive(Clone, Debug)]
pub struct CardName(Parts);

#[derive(Clone, Debug)]
enum Parts {
    Word(&'static str),
    Numbered(&'static str, u32),
    Text(Box<str>),
}

impl CardName {
    /// A word and a number.
    pub fn numbered(word: &'static str, number: u32) -> Self {
        Self(Parts::Numbered(word, number))
    }

    /// Whether it is this word and a number.
    pub(super) fn is_numbered(&self, word: &str) -> bool {
        matches!(self.0, Parts::Numbered(own, _) if own == word)
    }

    /// The name with a number that is higher by `more`.
    pub(super) fn counted(&self, more: u32) -> Self {
        match self.0 {
            Parts::Numbered(word, number) => Self(Parts::Numbered(word, number.wrapping_add(more))),
            _ => self.clone(),
        }
    }

    /// Whether the other is this name with a number that is higher by `more`.
    pub(super) fn is_counted(&self, more: u32, other: &Self) -> bool {
        match (&self.0, &other.0) {
            (Parts::Numbered(word, number), Parts::Numbered(other, count)) => {
                number.wrapping_add(more) == *count && word == other
            }
            _ => self.counted(more) == *other,
        }
    }

    /// By how much the number of the other is higher; 0 where one has none.
    pub(super) fn distance(&self, other: &Self) -> u32 {
        match (&self.0, &other.0) {
            (Parts::Numbered(_, number), Parts::Numbered(_, other)) => other.wrapping_sub(*number),
            _ => 0,
        }
    }

    fn text(&self) -> Cow<'_, str> {
        match &self.0 {
            Parts::Word(word) => Cow::Borrowed(word),
            Parts::Numbered(word, number) => Cow::Owned(format!("{word} {number}")),
            Parts::Text(text) => Cow::Borrowed(text),
        }
    }
}

impl fmt::Display for CardName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.0 {
            Parts::Numbered(word, number) => write!(f, "{word} {number}"),
            _ => f.write_str(&self.text()),
        }
    }
}

impl PartialEq for CardName {
    fn eq(&self, other: &Self) -> bool {
        match (&self.0, &other.0) {
            (Parts::Numbered(word, number), Parts::Numbered(other, last)) => number == last && word == other,
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
        Self(Parts::Word(word))
    }
}

impl From<String> for CardName {
    fn from(text: String) -> Self {
        Self(Parts::Text(text.into()))
    }
}
