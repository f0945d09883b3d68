//! Splits the bytes of a file into numbered lines, and lines into words, without copies.

use crate::error::FaultAt;
use crate::fault::{TextFault, quote};

/// Iterator over the lines of a file. A line ends with LF or CRLF; a byte order mark is skipped.
pub(crate) struct TextLines<'a> {
    rest: &'a [u8],
    number: usize,
}

/// One line, without its line end.
#[derive(Clone, Copy)]
pub(crate) struct TextLine<'a> {
    pub number: usize,
    pub text: &'a [u8],
}

impl<'a> TextLines<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes), number: 0 }
    }

    /// Lines that follow `number` other lines of the same file.
    pub fn after(bytes: &'a [u8], number: usize) -> Self {
        Self { rest: bytes, number }
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
        Some(TextLine { number: self.number, text: text.strip_suffix(b"\r").unwrap_or(text) })
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

    /// Bytes not yet read.
    pub fn unread_bytes(&self) -> usize {
        self.rest.len()
    }

    /// Number of the last line read.
    pub fn number(&self) -> usize {
        self.number
    }
}

impl<'a> TextLine<'a> {
    /// Words before a comment.
    pub fn words(&self) -> LineWords<'a> {
        LineWords { rest: self.text }
    }

    /// The words, if there are exactly N.
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

    pub fn fault(&self, fault: TextFault) -> FaultAt {
        FaultAt::line(self.number, fault)
    }

    /// The fault of a line that does not have the form `expected`.
    pub fn malformed(&self, expected: &'static str) -> FaultAt {
        self.fault(TextFault::Entry { expected, found: self.quote() })
    }
}

/// Words between blanks and tabs; a word that starts with `%` or `#` starts a comment.
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
        let mut lines = TextLines::new(b"\xef\xbb\xbf% head\r\n\r\n\t1  2\t3 # end\r\n #\n4");
        let line = lines.content().expect("a line");
        assert_eq!((line.number, line.fields()), (3, Some([&b"1"[..], b"2", b"3"])));
        assert!(line.fields::<2>().is_none() && line.fields::<4>().is_none());
        let line = lines.content().expect("a line");
        assert_eq!((line.number, line.fields()), (5, Some([&b"4"[..]])));
        assert!(lines.content().is_none() && lines.unread_bytes() == 0 && lines.number() == 5);
    }
}
