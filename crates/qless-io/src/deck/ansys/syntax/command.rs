//! Splits lines into commands: `NAME,field,field`, several on a line separated by `$`, and a comment after `!`.

use std::borrow::Cow;
use std::ops::Range;

/// The first four characters of a command's name in capitals, filled with blanks. They identify the command.
pub type CommandKey = [u8; 4];

/// One command.
#[derive(Clone, Debug)]
pub struct AnsysCommand<'a> {
    pub key: CommandKey,
    /// The name as in the deck.
    pub name: &'a [u8],
    /// The text of the whole command, trimmed.
    pub text: &'a [u8],
    /// The fields after the name, trimmed. The reader may replace parameters in them by their values.
    pub fields: Vec<Cow<'a, [u8]>>,
    /// The line, from 1.
    pub line: u32,
    /// The bytes of the command in the file, without comment and `$`.
    pub range: Range<usize>,
}

/// The content of a line.
pub enum AnsysLine<'a> {
    /// A data line of the command above it: numbers, or the format of the following data lines.
    Data(&'a [u8]),
    /// Commands; empty for a blank line or a comment.
    Commands(Vec<AnsysCommand<'a>>),
}

/// Commands whose text extends to the end of the line.
const WHOLE_LINE: [&CommandKey; 5] = [b"/COM", b"/TIT", b"/STI", b"C***", b"/SYS"];

impl<'a> AnsysCommand<'a> {
    /// Field `at`, from 1; empty if it is missing.
    pub fn field(&self, at: usize) -> &[u8] {
        at.checked_sub(1).and_then(|k| self.fields.get(k)).map_or(&[][..], |field| field)
    }

    /// Whether field `at` is this word.
    pub fn is(&self, at: usize, word: &str) -> bool {
        self.field(at).eq_ignore_ascii_case(word.as_bytes())
    }

    /// The name in capitals, for messages.
    pub fn title(&self) -> String {
        self.name[..self.name.len().min(32)].to_ascii_uppercase().escape_ascii().to_string()
    }

    /// Field 1 if it marks a command in the format of archives: `UNBL`, or a word such as `R5.0`.
    pub fn archive_tag(&self) -> Option<&[u8]> {
        let field = self.field(1);
        (field.to_ascii_uppercase().starts_with(b"R5.") || self.is(1, "UNBL")).then_some(field)
    }

    /// If the command begins with a comma, gives it the name of the previous command.
    #[must_use]
    pub fn named_as(self, last: &'a [u8]) -> Self {
        if self.name.is_empty() { Self { key: key(last), name: last, ..self } } else { self }
    }

    fn new(text: &'a [u8], start: usize, line: u32) -> Option<Self> {
        let lead = text.iter().position(|byte| !byte.is_ascii_whitespace())?;
        let trimmed = text.trim_ascii();
        let end = trimmed.iter().position(|&byte| byte == b',' || byte.is_ascii_whitespace()).unwrap_or(trimmed.len());
        let (name, rest) = trimmed.split_at(end);
        let rest = rest.trim_ascii_start();
        let rest = rest.strip_prefix(b",").unwrap_or(rest);
        let fields = if rest.is_empty() { Vec::new() } else { split(rest) };
        let range = start + lead..start + lead + trimmed.len();
        Some(Self { key: key(name), name, text: trimmed, fields, line, range })
    }
}

/// Parses a line; `start` is its first byte in the file.
pub fn parse(text: &[u8], start: usize, line: u32) -> AnsysLine<'_> {
    let head = text.trim_ascii_start();
    match head.first() {
        Some(byte) if byte.is_ascii_digit() || b"+-.(".contains(byte) => return AnsysLine::Data(text),
        None | Some(b'!') => return AnsysLine::Commands(Vec::new()),
        _ => {}
    }
    if WHOLE_LINE.contains(&&key(head)) {
        return AnsysLine::Commands(AnsysCommand::new(text, start, line).into_iter().collect());
    }
    let end = memchr::memchr2(b'$', b'!', text);
    let mut commands = Vec::with_capacity(1);
    let mut from = 0;
    for end in end.map_or_else(|| vec![text.len()], |_| ends(text)) {
        commands.extend(AnsysCommand::new(&text[from..end], start + from, line));
        from = end + 1;
    }
    AnsysLine::Commands(commands)
}

fn key(name: &[u8]) -> CommandKey {
    let mut key = *b"    ";
    for (to, byte) in key.iter_mut().zip(name) {
        *to = byte.to_ascii_uppercase();
    }
    key
}

/// Splits at commas, except within balanced parentheses, where commas separate the indices of an array.
fn split(text: &[u8]) -> Vec<Cow<'_, [u8]>> {
    let count = |byte: u8| memchr::memchr_iter(byte, text).count();
    let nests = memchr::memchr(b'(', text).is_some() && count(b'(') == count(b')');
    let mut depth = 0;
    let is_end = |byte: &u8| {
        depth += i32::from(nests && *byte == b'(') - i32::from(nests && *byte == b')');
        *byte == b',' && depth <= 0
    };
    text.split(is_end).map(|field| Cow::Borrowed(field.trim_ascii())).collect()
}

/// The end of each command on a line: a `$`, or the `!` or line end after the last command. Characters between quotes do not count.
fn ends(text: &[u8]) -> Vec<usize> {
    // If the number of quotes is odd, they are apostrophes and do not enclose a text.
    let quotes = memchr::memchr_iter(b'\'', text).count().is_multiple_of(2);
    let mut ends = Vec::new();
    let mut quoted = false;
    for (at, &byte) in text.iter().enumerate() {
        match byte {
            b'\'' => quoted = quotes && !quoted,
            b'$' if !quoted => ends.push(at),
            b'!' if !quoted => {
                ends.push(at);
                return ends;
            }
            _ => {}
        }
    }
    ends.push(text.len());
    ends
}

#[cfg(test)]
mod tests {
    use super::*;

    fn commands(text: &str) -> Vec<(String, Vec<String>, String)> {
        let AnsysLine::Commands(commands) = parse(text.as_bytes(), 0, 1) else { return Vec::new() };
        let words =
            |fields: &[Cow<[u8]>]| fields.iter().map(|field| String::from_utf8_lossy(field).into_owned()).collect();
        commands
            .iter()
            .map(|c| (String::from_utf8_lossy(&c.key).into_owned(), words(&c.fields), text[c.range.clone()].to_owned()))
            .collect()
    }

    fn one(key: &str, fields: &[&str], text: &str) -> (String, Vec<String>, String) {
        (key.into(), fields.iter().map(|&field| field.to_owned()).collect(), text.into())
    }

    #[test]
    fn commas_separate_fields() {
        assert_eq!(commands("  ddele , 1,UX  ,, ! gone\r"), [one("DDEL", &["1", "UX", "", ""], "ddele , 1,UX  ,,")]);
        assert_eq!(commands("/PREP7  "), [one("/PRE", &[], "/PREP7")]);
        assert_eq!(commands("N,1"), [one("N   ", &["1"], "N,1")]);
        assert_eq!(commands("F,a(1, 2),3")[0].1, ["a(1, 2)", "3"]);
        assert_eq!(commands("F,a(1,2")[0].1, ["a(1", "2"]);
    }

    #[test]
    fn several_commands_on_a_line() {
        let two = [one("CE  ", &["1", "0"], "CE,1,0"), one("D   ", &["2", "UX"], "D,2,UX")];
        assert_eq!(commands("CE,1,0 $ D,2,UX ! a $ comment"), two);
        assert_eq!(commands("/TITLE, a $ b ! c").len(), 1);
        assert_eq!(commands("*SET,A,'x$y!z'"), [one("*SET", &["A", "'x$y!z'"], "*SET,A,'x$y!z'")]);
        assert_eq!(commands("A,it's $ B,it").len(), 2);
        assert!(commands(" $ $ !").is_empty() && commands("").is_empty());
    }

    #[test]
    fn numbers_and_formats_are_data() {
        for text in ["  1  2", "-1", "(3i9,6e21.13e3)", " .5", "+1"] {
            assert!(matches!(parse(text.as_bytes(), 0, 1), AnsysLine::Data(_)), "{text}");
        }
    }
}
