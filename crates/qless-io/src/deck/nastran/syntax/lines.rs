//! Visits the lines of a deck in the order of reading. The lines of an `INCLUDE` file take the place of the statement.

use super::fields::content;
use crate::bytes::LINE;
use crate::deck::{DeckError, Problem, Sources};
use crate::fault::quote;

/// The index of a file, and the number of a line in it, from 1.
pub type FileLine = (u32, u32);

/// A line of a deck. Its comment is removed, except if [`LineVisitor::quick`] receives the line.
pub struct DeckLine<'a> {
    pub file: u32,
    /// The number of the line, from 1.
    pub number: u32,
    pub text: &'a [u8],
}

impl DeckLine<'_> {
    pub fn at(&self) -> FileLine {
        (self.file, self.number)
    }
}

/// An `INCLUDE` statement whose file could be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct IncludeLine {
    pub file: u32,
    /// The first line of the statement, from 1.
    pub line: u32,
    pub lines: u32,
    /// Index of the included file.
    pub inner: u32,
}

/// Receives the lines of a deck one by one.
pub trait LineVisitor {
    /// Receives a raw line, comment included, that no other line continues. Returns true if that is all; if false, `line` receives the line
    /// too.
    fn quick(&mut self, line: &DeckLine, sources: &Sources) -> Result<bool, DeckError>;

    /// Receives a line that is not an `INCLUDE`. Returns false to end the reading.
    fn line(&mut self, line: &DeckLine, sources: &Sources) -> Result<bool, DeckError>;

    /// Receives an `INCLUDE` statement, before the lines of its file.
    fn included(&mut self, include: IncludeLine);

    /// Decides what happens if an included file cannot be read. Returns the error to stop, or `Ok` to continue without the file.
    fn unreadable(&mut self, at: FileLine, error: DeckError) -> Result<(), DeckError>;
}

/// Visits all lines of a deck except blank lines and comments.
pub fn walk(sources: &mut Sources, visitor: &mut impl LineVisitor) -> Result<(), DeckError> {
    file(sources, 0, 0, visitor).map(|_| ())
}

/// Visits the lines of one file. Returns false if the visitor ended the reading.
fn file(sources: &mut Sources, number: usize, depth: usize, visitor: &mut impl LineVisitor) -> Result<bool, DeckError> {
    let bytes = sources.text(number);
    let mut rest = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes);
    let mut line = 0;
    while !rest.is_empty() {
        let (first, text) = (line + 1, next(&mut rest, &mut line));
        // If the next line begins with a letter, it starts another card. `INCLUDE` is the exception: its file may continue this card.
        let is_last = rest.first().is_some_and(|&byte| byte.is_ascii_alphabetic() && !matches!(byte, b'I' | b'i'));
        if is_last && visitor.quick(&DeckLine { file: number as u32, number: first as u32, text }, sources)? {
            continue;
        }
        if text.len() > LINE {
            let problem = Problem::Limit { what: "the length of a line", limit: LINE, advice: "break it" };
            return Err(error(sources, number, first, problem));
        }
        let text = content(text);
        if text.trim_ascii_start().is_empty() {
            continue;
        }
        if !is_include(&text) {
            let line = DeckLine { file: number as u32, number: first as u32, text: &text };
            if !visitor.line(&line, sources)? {
                return Ok(false);
            }
            continue;
        }
        let name = file_name(&text, &mut rest, &mut line).ok_or_else(|| open_quote(sources, number, first, &text))?;
        // Decks from Windows separate folders by backslashes.
        let name = if cfg!(windows) { name } else { name.replace('\\', "/") };
        match sources.include(&name, number, first, depth) {
            Ok(inner) => {
                let (lines, inner_file) = ((line + 1 - first) as u32, inner as u32);
                visitor.included(IncludeLine { file: number as u32, line: first as u32, lines, inner: inner_file });
                if !file(sources, inner, depth + 1, visitor)? {
                    return Ok(false);
                }
            }
            Err(error) => visitor.unreadable((number as u32, first as u32), error)?,
        }
    }
    Ok(true)
}

/// Takes the next line from `rest`. Returns it without its line ending.
fn next<'a>(rest: &mut &'a [u8], line: &mut usize) -> &'a [u8] {
    let end = memchr::memchr(b'\n', rest).unwrap_or(rest.len());
    let text = &rest[..end];
    *rest = rest.get(end + 1..).unwrap_or_default();
    *line += 1;
    text.strip_suffix(b"\r").unwrap_or(text)
}

fn is_include(text: &[u8]) -> bool {
    const WORD: &[u8] = b"INCLUDE";
    let text = text.trim_ascii_start();
    text.len() > WORD.len()
        && text[..WORD.len()].eq_ignore_ascii_case(WORD)
        && matches!(text[WORD.len()], b' ' | b'\t' | b'\'' | b'"' | b'=')
}

/// The file name after `INCLUDE`: one word, or a quoted text, which may extend over several lines.
fn file_name(text: &[u8], rest: &mut &[u8], line: &mut usize) -> Option<String> {
    let word = text.trim_ascii_start()[b"INCLUDE".len()..].trim_ascii();
    let word = word.strip_prefix(b"=").unwrap_or(word).trim_ascii();
    let Some(quote) = word.first().copied().filter(|byte| matches!(byte, b'\'' | b'"')) else {
        return Some(String::from_utf8_lossy(word).into_owned());
    };
    let mut name = word[1..].to_vec();
    loop {
        if let Some(end) = name.iter().position(|&byte| byte == quote) {
            return Some(String::from_utf8_lossy(&name[..end]).into_owned());
        }
        if rest.is_empty() || name.len() > LINE {
            return None;
        }
        name.extend_from_slice(next(rest, line).trim_ascii());
    }
}

fn open_quote(sources: &Sources, file: usize, line: usize, text: &[u8]) -> DeckError {
    let expected = "a file name between quotes, as in INCLUDE 'mesh.bdf'";
    error(sources, file, line, Problem::Expected { expected, found: quote(text.trim_ascii()) })
}

fn error(sources: &Sources, file: usize, line: usize, problem: Problem) -> DeckError {
    DeckError { path: sources.path(file).to_path_buf(), line, card: "deck".into(), field: None, problem }
}

/// The first word of a line in capitals, and the rest of the line.
pub fn keyword(text: &[u8]) -> (String, &[u8]) {
    let text = text.trim_ascii();
    let end = text.iter().position(|byte| !byte.is_ascii_alphanumeric()).unwrap_or(text.len());
    (String::from_utf8_lossy(&text[..end]).to_ascii_uppercase(), &text[end..])
}
