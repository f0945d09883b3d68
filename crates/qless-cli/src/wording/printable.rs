//! Makes names from files and command lines safe to show: they may hold characters that move a terminal's cursor, or change the
//! direction of the text around them. Everything that the program shows or writes as a report passes [`text`] or [`json`].

use std::borrow::Cow;
use std::fmt::Write;

/// Whether a character is safe to show. Unsafe are control characters except line break and tab, line and paragraph separators, and
/// characters that change the direction of text.
fn is_plain(c: char) -> bool {
    let turns = matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    let breaks = matches!(c, '\u{2028}' | '\u{2029}');
    !(turns || breaks || (c.is_control() && c != '\n' && c != '\t'))
}

/// Replaces every unsafe character by a question mark.
pub fn text(text: &str) -> Cow<'_, str> {
    replace(text, |out, _| out.push('?'))
}

/// Makes a report safe to show; it may be JSON. Bytes that are not UTF-8 are left alone.
pub fn report(bytes: Vec<u8>, is_json: bool) -> Vec<u8> {
    let harmless = match std::str::from_utf8(&bytes) {
        Ok(found) => {
            if is_json {
                json(found)
            } else {
                text(found)
            }
        }
        Err(_) => return bytes,
    };
    match harmless {
        Cow::Borrowed(_) => bytes,
        Cow::Owned(text) => text.into_bytes(),
    }
}

/// A label in one line, with unsafe characters replaced.
pub fn line(label: &str) -> String {
    text(label).replace(['\n', '\t'], "?")
}

/// Escapes the unsafe characters in the strings of JSON, so that a parser restores them.
pub fn json(text: &str) -> Cow<'_, str> {
    replace(text, |out, c| {
        // No unsafe character needs more than 16 bits, so each is one escape. Writing to a string cannot fail.
        let _ = write!(out, "\\u{:04x}", c as u32);
    })
}

fn replace(text: &str, other: impl Fn(&mut String, char)) -> Cow<'_, str> {
    if text.chars().all(is_plain) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len());
    text.chars().for_each(|c| if is_plain(c) { out.push(c) } else { other(&mut out, c) });
    Cow::Owned(out)
}

#[cfg(test)]
mod tests {
    use super::{json, line, text};

    #[test]
    fn nothing_moves_the_cursor_or_turns_the_text() {
        let name = "Größe \u{1b}]0;x\u{7}\u{9b}2J a\u{202e}b\u{2066}\u{2028}";
        assert_eq!(text(name), "Größe ?]0;x??2J a?b??");
        assert_eq!(text("two\nlines\t"), "two\nlines\t");
        assert_eq!(line("two\nlines"), "two?lines");
        let quoted = format!("\"{}\"", &name[name.len() - 12..]);
        let read: String = serde_json::from_str(&json(&quoted)).expect("still JSON");
        assert_eq!(read, name[name.len() - 12..]);
    }

    #[test]
    fn every_character_that_is_replaced_has_one_escape() {
        for c in (0..=u32::from(char::MAX)).filter_map(char::from_u32) {
            let one = c.to_string();
            assert!(text(&one) == one || u32::from(c) <= 0xffff, "{c:?}");
        }
    }
}
