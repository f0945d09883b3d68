//! Writes JSON with one line for each key of the object and for each element of its lists, for line-based tools.

use std::io::{self, Write};

use qless::Report;
use serde::Serialize;
use serde_json::ser::{Formatter, Serializer};

use crate::deck_input::DeckReport;

/// A report, and the keys that only decks have.
#[derive(Serialize)]
struct JsonReport<'a> {
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<&'a str>,
    #[serde(flatten)]
    report: &'a Report,
    #[serde(flatten)]
    deck: Option<DeckReport<'a>>,
}

/// Writes the report and a line break; `file` is the input, if there are several.
pub fn write(out: &mut dyn Write, file: Option<&str>, report: &Report, deck: Option<DeckReport>) -> io::Result<()> {
    lines(out, &JsonReport { file, report, deck })
}

/// Writes an object and a line break.
pub fn lines(out: &mut dyn Write, object: &impl Serialize) -> io::Result<()> {
    object.serialize(&mut Serializer::with_formatter(&mut *out, JsonLines { depth: 0 }))?;
    writeln!(out)
}

/// Breaks lines before keys at depth 1 and before elements at depth 2.
struct JsonLines {
    depth: usize,
}

impl JsonLines {
    fn separate<W: Write + ?Sized>(&self, out: &mut W, first: bool, own_line_at: usize) -> io::Result<()> {
        let comma = if first { "" } else { "," };
        match (self.depth == own_line_at, first) {
            (true, _) => write!(out, "{comma}\n{:1$}", "", 2 * self.depth),
            (false, true) => Ok(()),
            (false, false) => write!(out, "{comma} "),
        }
    }

    fn open<W: Write + ?Sized>(&mut self, out: &mut W, bracket: &[u8]) -> io::Result<()> {
        self.depth += 1;
        out.write_all(bracket)
    }

    fn close<W: Write + ?Sized>(&mut self, out: &mut W, bracket: &[u8], outermost: bool) -> io::Result<()> {
        self.depth -= 1;
        if outermost {
            out.write_all(b"\n")?;
        }
        out.write_all(bracket)
    }
}

impl Formatter for JsonLines {
    fn begin_object<W: Write + ?Sized>(&mut self, out: &mut W) -> io::Result<()> {
        self.open(out, b"{")
    }

    fn end_object<W: Write + ?Sized>(&mut self, out: &mut W) -> io::Result<()> {
        self.close(out, b"}", self.depth == 1)
    }

    fn begin_array<W: Write + ?Sized>(&mut self, out: &mut W) -> io::Result<()> {
        self.open(out, b"[")
    }

    fn end_array<W: Write + ?Sized>(&mut self, out: &mut W) -> io::Result<()> {
        self.close(out, b"]", false)
    }

    fn begin_object_key<W: Write + ?Sized>(&mut self, out: &mut W, first: bool) -> io::Result<()> {
        self.separate(out, first, 1)
    }

    fn begin_array_value<W: Write + ?Sized>(&mut self, out: &mut W, first: bool) -> io::Result<()> {
        self.separate(out, first, 2)
    }

    fn begin_object_value<W: Write + ?Sized>(&mut self, out: &mut W) -> io::Result<()> {
        out.write_all(b": ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_line_for_each_key_and_each_element() {
        let value = serde_json::json!({"a": {"x": 1, "y": []}, "b": [{"c": [1, 2]}, {"d": null}], "e": []});
        let mut out = Vec::new();
        lines(&mut out, &value).expect("written");
        let expected = "{\n  \"a\": {\"x\": 1, \"y\": []},\n  \"b\": [\n    {\"c\": [1, 2]},\n    {\"d\": null}],\n  \"e\": []\n}\n";
        assert_eq!(String::from_utf8(out).expect("UTF-8"), expected);
    }
}
