//! A deck as cards: a keyword line and the lines of data below it, wherever includes put them.

use std::ops::Range;
use std::sync::Arc;

use crate::bytes::LINE;
use crate::deck::calculix::model::parts::{Parts, Scope};
use crate::deck::calculix::syntax::data::Lines;
use crate::deck::{DeckError, Problem, Sources};

/// A card. It is filled anew for each one, so that a deck of a million cards allocates no more than one of ten.
#[derive(Clone, Default)]
pub struct Card {
    /// Whose names and numbers it uses.
    pub scope: Scope,
    /// The keyword in capitals and without blanks: `*RIGIDBODY`.
    pub keyword: Vec<u8>,
    /// `NAME=value` or `NAME`, the name in capitals and without blanks.
    parameters: Vec<(String, String)>,
    /// File and line of the keyword.
    pub file: u32,
    /// Line of the keyword, from 1.
    pub line: u32,
    /// Where the data stands, comments and blank lines included.
    pub data: Vec<Piece>,
}

/// Consecutive lines of a file.
#[derive(Clone)]
pub struct Piece {
    pub file: u32,
    /// The first line, from 1.
    pub line: u32,
    pub range: Range<usize>,
    pub text: Arc<Vec<u8>>,
}

impl Card {
    /// The value of a parameter; empty for one without a value.
    pub fn parameter(&self, name: &str) -> Option<&str> {
        self.parameters.iter().find(|(key, _)| key == name).map(|(_, value)| value.as_str())
    }

    /// The value of a parameter in capitals and without blanks.
    pub fn word(&self, name: &str) -> Option<String> {
        self.parameter(name).map(crate::deck::calculix::syntax::data::name)
    }

    /// Whether the card has the keyword, written without blanks.
    pub fn is(&self, keyword: &str) -> bool {
        self.keyword == keyword.as_bytes()
    }

    /// The same card in another scope.
    pub fn in_scope(&self, scope: Scope) -> Self {
        Self { scope, ..self.clone() }
    }

    /// Lines of data, comments and blank ones passed over.
    pub fn lines(&self) -> Lines<'_> {
        Lines::new(&self.data)
    }

    /// Reads the keyword line.
    fn begin(&mut self, text: &[u8], file: usize, line: usize) {
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
            let name = crate::deck::calculix::syntax::data::name(name);
            if !name.is_empty() {
                self.parameters.push((name, value.trim().trim_matches('"').to_owned()));
            }
        }
    }
}

/// Cards whose data may stand in a file of its own.
const WITH_INPUT: [&str; 7] = ["*NODE", "*ELEMENT", "*NSET", "*ELSET", "*SURFACE", "*EQUATION", "*BOUNDARY"];

/// What is done with each card.
pub type Visit<'v> = &'v mut dyn FnMut(&Card) -> Result<(), DeckError>;

/// Visits every card in order; those of a part once for each of its instances.
pub fn walk(sources: &mut Sources, visit: Visit) -> Result<(), DeckError> {
    let paths = sources.paths().to_vec();
    let mut parts = Parts::default();
    let mut expand = |card: &Card| {
        let path = || paths.get(card.file as usize).cloned().unwrap_or_default();
        parts.card(card, visit).map_err(|stop| stop.at(card, path))
    };
    let mut card = Card::default();
    let mut walk = Walk { sources };
    walk.file(0, 0, &mut card, &mut expand)?;
    finish(&mut card, &mut expand)
}

struct Walk<'s, 'o> {
    sources: &'s mut Sources<'o>,
}

/// Hands on the card that is complete.
fn finish(card: &mut Card, visit: Visit) -> Result<(), DeckError> {
    if card.keyword.is_empty() {
        return Ok(());
    }
    visit(card)?;
    card.keyword.clear();
    Ok(())
}

impl Walk<'_, '_> {
    /// One file: alternately a keyword line and what stands before the next.
    fn file(&mut self, file: usize, depth: usize, card: &mut Card, visit: Visit) -> Result<(), DeckError> {
        let text = self.sources.text(file);
        let mut at = if text.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        let mut line = 1;
        while at < text.len() {
            let end = next_keyword(&text, at);
            if end > at {
                let lines = memchr::memchr_iter(b'\n', &text[at..end]).count();
                card.data.push(Piece { file: file as u32, line: line as u32, range: at..end, text: Arc::clone(&text) });
                (at, line) = (end, line + lines);
                continue;
            }
            let (end, lines) = keyword_end(&text, at);
            let keyword = &text[at..end];
            if keyword.len() > LINE {
                return Err(self.too_long(file, line));
            }
            if is_include(keyword) {
                card_input(keyword).map_or(Ok(()), |name| self.include(&name, (file, line), depth, card, visit))?;
            } else {
                finish(card, visit)?;
                card.begin(keyword, file, line);
                let name = card.parameter("INPUT").filter(|_| WITH_INPUT.iter().any(|with| card.is(with)));
                if let Some(name) = name.map(str::to_owned) {
                    self.include(&name, (file, line), depth, card, visit)?;
                }
            }
            (at, line) = (end, line + lines);
        }
        Ok(())
    }

    /// Goes on in another file; the card that is open goes on with its data.
    fn include(
        &mut self,
        name: &str,
        (file, line): (usize, usize),
        depth: usize,
        card: &mut Card,
        visit: Visit,
    ) -> Result<(), DeckError> {
        let inner = self.sources.include(name, file, line, depth)?;
        self.file(inner, depth + 1, card, visit)
    }

    fn too_long(&self, file: usize, line: usize) -> DeckError {
        let problem = Problem::Limit { what: "the length of a line", limit: LINE, advice: "break it" };
        DeckError { path: self.sources.path(file).to_path_buf(), line, card: "keyword".into(), field: None, problem }
    }
}

/// Where the next keyword line begins, at or after `from`, which is the start of a line.
pub fn next_keyword(text: &[u8], from: usize) -> usize {
    memchr::memchr_iter(b'*', &text[from..])
        .map(|k| from + k)
        .find(|&k| (k == from || text[k - 1] == b'\n') && text.get(k + 1) != Some(&b'*'))
        .unwrap_or(text.len())
}

/// Where a keyword line ends, with the lines that go on after a trailing comma; and how many lines that is.
pub fn keyword_end(text: &[u8], from: usize) -> (usize, usize) {
    let mut end = from;
    for lines in 1.. {
        let line = &text[end..];
        let length = memchr::memchr(b'\n', line).map_or(line.len(), |k| k + 1);
        end += length;
        let goes_on = line[..length].trim_ascii_end().ends_with(b",") && !matches!(text.get(end), None | Some(b'*'));
        if !goes_on {
            return (end, lines);
        }
    }
    (end, 1)
}

pub fn is_include(keyword: &[u8]) -> bool {
    let word = keyword.split(|&byte| byte == b',').next().unwrap_or_default();
    word.trim_ascii().eq_ignore_ascii_case(b"*INCLUDE")
}

pub fn card_input(keyword: &[u8]) -> Option<String> {
    let mut card = Card::default();
    card.begin(keyword, 0, 0);
    card.parameter("INPUT").map(str::to_owned)
}
