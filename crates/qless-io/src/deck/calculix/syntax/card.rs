//! A card: a keyword line, and the lines of data below it.

use crate::deck::DeckError;
use crate::deck::calculix::syntax::{self, DataLines, DataPiece};

/// The scope of the names and numbers on a card. 0 is the deck itself, and k its instance k, from 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Scope(pub u32);

impl Scope {
    /// The scope of the deck itself, outside all instances.
    pub const DECK: Self = Self(0);
}

/// A card. One value is reused for all cards of a deck, to save allocations.
#[derive(Clone, Default)]
pub struct KeywordCard {
    /// The scope in which the names and numbers on the card are defined.
    pub scope: Scope,
    /// Keyword in capitals, without blanks: `*RIGIDBODY`.
    pub keyword: Vec<u8>,
    /// The parameters, `NAME=value` or `NAME`: the name in capitals and without blanks, and the value or an empty text.
    parameters: Vec<(String, String)>,
    /// The number of the file that holds the keyword line.
    pub file: u32,
    /// Line of the keyword, from 1.
    pub line: u32,
    /// The text of the data lines, comments and blank lines included.
    pub data: Vec<DataPiece>,
}

impl KeywordCard {
    /// The value of a parameter: empty if the parameter has none, `None` if the card lacks the parameter.
    pub fn parameter(&self, name: &str) -> Option<&str> {
        self.parameters.iter().find(|(key, _)| key == name).map(|(_, value)| value.as_str())
    }

    /// The value of a parameter, in capitals and without blanks.
    pub fn word(&self, name: &str) -> Option<String> {
        self.parameter(name).map(syntax::fold_name)
    }

    /// Whether the card has this keyword, written without blanks.
    pub fn is(&self, keyword: &str) -> bool {
        self.keyword == keyword.as_bytes()
    }

    /// The same card in another scope.
    pub fn in_scope(&self, scope: Scope) -> Self {
        Self { scope, ..self.clone() }
    }

    /// Whether the data have a parameter `<name>` without a known value.
    pub fn has_parameters(&self) -> bool {
        self.data.iter().any(|piece| memchr::memchr(b'<', &piece.text[piece.range.clone()]).is_some())
    }

    /// Lines of data, without comments and blank lines.
    pub fn lines(&self) -> DataLines<'_> {
        DataLines::new(&self.data)
    }

    /// Starts the card with this keyword line; the file and line are those of the keyword.
    pub fn begin(&mut self, text: &[u8], file: usize, line: usize) {
        self.data.clear();
        self.parameters.clear();
        self.keyword.clear();
        (self.file, self.line) = (file as u32, line as u32);
        let mut parts = text.split(|&byte| byte == b',');
        let keyword = parts.next().unwrap_or_default();
        self.keyword.extend(keyword.iter().filter(|byte| !byte.is_ascii_whitespace()).map(u8::to_ascii_uppercase));
        for part in parts {
            let part = String::from_utf8_lossy(part);
            let (name, value) = part.split_once('=').unwrap_or((&part, ""));
            let name = syntax::fold_name(name);
            if !name.is_empty() {
                self.parameters.push((name, value.trim().trim_matches('"').to_owned()));
            }
        }
    }
}

/// The function to call for each card.
pub type Visit<'v> = &'v mut dyn FnMut(&KeywordCard) -> Result<(), DeckError>;
