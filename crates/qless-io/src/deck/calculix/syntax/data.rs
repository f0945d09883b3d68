//! Lines of data as fields between commas.

use crate::deck::calculix::syntax::card::Piece;

/// Lines of data: neither blank nor comments.
pub struct Lines<'a> {
    pieces: std::slice::Iter<'a, Piece>,
    file: u32,
    number: u32,
    rest: &'a [u8],
}

/// One line of data.
#[derive(Clone, Copy)]
pub struct DataLine<'a> {
    pub file: u32,
    pub number: u32,
    pub text: &'a [u8],
}

impl<'a> Lines<'a> {
    pub fn new(pieces: &'a [Piece]) -> Self {
        Self { pieces: pieces.iter(), file: 0, number: 0, rest: &[] }
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = DataLine<'a>;

    fn next(&mut self) -> Option<DataLine<'a>> {
        loop {
            while self.rest.is_empty() {
                let piece = self.pieces.next()?;
                (self.file, self.number, self.rest) = (piece.file, piece.line - 1, &piece.text[piece.range.clone()]);
            }
            let end = memchr::memchr(b'\n', self.rest).unwrap_or(self.rest.len());
            let text = &self.rest[..end];
            self.rest = self.rest.get(end + 1..).unwrap_or_default();
            self.number += 1;
            if !text.starts_with(b"**") && text.iter().any(|byte| !byte.is_ascii_whitespace()) {
                return Some(DataLine { file: self.file, number: self.number, text });
            }
        }
    }
}

impl<'a> DataLine<'a> {
    /// The fields between commas, without blanks around them; one that is empty after the last comma is none.
    pub fn fields(&self) -> impl Iterator<Item = &'a [u8]> + use<'a> {
        let text = self.text.trim_ascii();
        let text = text.strip_suffix(b",").unwrap_or(text);
        text.split(|&byte| byte == b',').map(<[u8]>::trim_ascii)
    }
}

/// A name as it is compared: in capitals, without blanks or quotes.
pub fn name(text: &str) -> String {
    text.chars().filter(|c| !c.is_whitespace() && *c != '"').map(|c| c.to_ascii_uppercase()).collect()
}
