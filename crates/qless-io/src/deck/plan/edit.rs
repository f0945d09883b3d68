//! Replaces lines of a text; all other lines stay byte for byte.

/// Changes of a text. Each replaces lines or inserts new ones.
#[derive(Debug, Default)]
pub struct Edits {
    /// For each change: the first line (from 1), the number of lines that it replaces, and the new text.
    changes: Vec<(u32, u32, Vec<u8>)>,
}

impl Edits {
    /// Replaces `lines` lines, from `line` on, by `text`. With 0 lines, inserts `text` before `line`.
    pub fn replace(&mut self, line: u32, lines: u32, text: Vec<u8>) {
        self.changes.push((line, lines, text));
    }

    /// Returns the text with all changes. New lines get the same kind of line end as the text.
    pub fn apply(mut self, text: &[u8]) -> Vec<u8> {
        self.changes.sort_by_key(|&(line, lines, _)| (line, lines));
        let crlf = memchr::memchr(b'\n', text).is_some_and(|end| end > 0 && text[end - 1] == b'\r');
        let mut result = Vec::with_capacity(text.len());
        let (mut at, mut line) = (0, 1);
        for (first, count, new) in self.changes {
            let start = skip(text, at, first.saturating_sub(line));
            result.extend_from_slice(&text[at..start]);
            if !result.is_empty() && !result.ends_with(b"\n") {
                result.extend_from_slice(if crlf { b"\r\n" } else { b"\n" });
            }
            append(&mut result, &new, crlf);
            at = skip(text, start, count);
            line = line.max(first) + count;
        }
        result.extend_from_slice(&text[at..]);
        result
    }
}

/// The byte at which a line starts: the one that is `lines` lines below the line that starts at byte `at`.
fn skip(text: &[u8], at: usize, lines: u32) -> usize {
    let mut ends = memchr::memchr_iter(b'\n', &text[at..]);
    match lines {
        0 => at,
        _ => ends.nth(lines as usize - 1).map_or(text.len(), |end| at + end + 1),
    }
}

/// Appends a text whose lines end in LF. If `crlf` is true, the appended lines end in CRLF.
fn append(result: &mut Vec<u8>, text: &[u8], crlf: bool) {
    for &byte in text {
        if byte == b'\n' && crlf {
            result.push(b'\r');
        }
        result.push(byte);
    }
}

#[cfg(test)]
mod tests {
    use super::Edits;

    #[test]
    fn lines_are_replaced_and_put_in() {
        let mut edits = Edits::default();
        edits.replace(4, 0, b"new\n".to_vec());
        edits.replace(2, 2, b"x\n".to_vec());
        assert_eq!(edits.apply(b"a\r\nb\r\nc\r\nd"), b"a\r\nx\r\nnew\r\nd");
        let mut edits = Edits::default();
        edits.replace(9, 0, b"end\n".to_vec());
        assert_eq!(edits.apply(b"a\nb"), b"a\nb\nend\n");
    }
}
