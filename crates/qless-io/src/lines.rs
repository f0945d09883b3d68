//! Splits the bytes of a file into numbered lines, and lines into words, without copies.

use std::path::Path;

use crate::ReadError;
use crate::fault::{NumberFault, Quantity, TextFault, quote};
use crate::number::real;

/// The lines of a file. A line ends with LF or CRLF. A byte order mark at the start is skipped.
pub(crate) struct TextLines<'a> {
    path: &'a Path,
    rest: &'a [u8],
    number: usize,
}

/// One line, without its line end.
#[derive(Clone, Copy)]
pub(crate) struct TextLine<'a> {
    path: &'a Path,
    pub number: usize,
    pub text: &'a [u8],
}

impl<'a> TextLines<'a> {
    pub fn new(path: &'a Path, bytes: &'a [u8]) -> Self {
        Self { path, rest: bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes), number: 0 }
    }

    /// The lines in `bytes`, which `number` other lines of the same file precede.
    pub fn after(path: &'a Path, bytes: &'a [u8], number: usize) -> Self {
        Self { path, rest: bytes, number }
    }

    /// The next line; it may be blank.
    pub fn any(&mut self) -> Option<TextLine<'a>> {
        if self.rest.is_empty() {
            return None;
        }
        let end = self.rest.iter().position(|&byte| byte == b'\n').unwrap_or(self.rest.len());
        let text = &self.rest[..end];
        self.rest = self.rest.get(end + 1..).unwrap_or_default();
        self.number += 1;
        Some(TextLine { path: self.path, number: self.number, text: text.strip_suffix(b"\r").unwrap_or(text) })
    }

    /// The next line that is neither blank nor a `%` or `#` comment.
    pub fn content(&mut self) -> Option<TextLine<'a>> {
        loop {
            let line = self.any()?;
            if line.words().next().is_some() {
                return Some(line);
            }
        }
    }

    /// The next line that is not blank.
    pub fn not_blank(&mut self) -> Option<TextLine<'a>> {
        loop {
            let line = self.any()?;
            if !line.text.trim_ascii().is_empty() {
                return Some(line);
            }
        }
    }

    /// Makes an error at the last line that was read.
    pub fn fault(&self, fault: TextFault) -> ReadError {
        ReadError::malformed(self.path, Some(self.number).filter(|&number| number > 0), fault)
    }

    /// Number of bytes that are not yet read.
    pub fn unread_bytes(&self) -> usize {
        self.rest.len()
    }

    /// Number of the last line that was read.
    pub fn number(&self) -> usize {
        self.number
    }
}

impl<'a> TextLine<'a> {
    /// The words of the line, up to a comment.
    pub fn words(&self) -> LineWords<'a> {
        LineWords { rest: self.text }
    }

    /// The words of the line if there are exactly N, else `None`.
    pub fn fields<const N: usize>(&self) -> Option<[&'a [u8]; N]> {
        let mut words = self.words();
        let mut fields = [&b""[..]; N];
        for field in &mut fields {
            *field = words.next()?;
        }
        words.next().is_none().then_some(fields)
    }

    pub fn quote(&self) -> String {
        quote(self.text.trim_ascii())
    }

    pub fn fault(&self, fault: TextFault) -> ReadError {
        ReadError::malformed(self.path, Some(self.number), fault)
    }

    /// The error that the line does not have the form `expected`.
    pub fn malformed(&self, expected: &'static str) -> ReadError {
        self.fault(TextFault::Entry { expected, found: self.quote() })
    }

    /// Parses a number. `is_integer` is true if the header of the file says `integer`.
    pub fn number(&self, word: &[u8], what: Quantity, is_integer: bool) -> Result<f64, ReadError> {
        let problem = match real(word) {
            Ok(number) if !is_integer || number.fract() == 0.0 => return Ok(number),
            other => other.err().unwrap_or(NumberFault::NotAnInteger),
        };
        Err(self.fault(TextFault::Number { what, found: quote(word), problem }))
    }
}

/// The words of a line, separated by blanks and tabs. A word that starts with `%` or `#` starts a comment.
pub(crate) struct LineWords<'a> {
    rest: &'a [u8],
}

impl<'a> Iterator for LineWords<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        let start = self.rest.iter().position(|byte| !byte.is_ascii_whitespace())?;
        let word = &self.rest[start..];
        if matches!(word[0], b'%' | b'#') {
            return None;
        }
        let end = word.iter().position(u8::is_ascii_whitespace).unwrap_or(word.len());
        self.rest = &word[end..];
        Some(&word[..end])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_numbered_and_comments_are_passed_over() {
        let mut lines = TextLines::new(Path::new("x"), b"\xef\xbb\xbf% head\r\n\r\n\t1  2\t3 # end\r\n #\n4");
        let line = lines.content().expect("a line");
        assert_eq!((line.number, line.fields()), (3, Some([&b"1"[..], b"2", b"3"])));
        assert!(line.fields::<2>().is_none() && line.fields::<4>().is_none());
        let line = lines.content().expect("a line");
        assert_eq!((line.number, line.fields()), (5, Some([&b"4"[..]])));
        assert!(lines.content().is_none() && lines.unread_bytes() == 0 && lines.number() == 5);
    }
}
