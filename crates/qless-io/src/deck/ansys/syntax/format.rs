//! Fortran formats of blocks, such as `(3i9,6e21.13e3)`: the width of each field of a line.

use crate::number::whole;

/// Limit on the fields of a line.
const FIELDS: usize = 100;
/// Limit on the width of a field.
const WIDTH: usize = 1000;

/// The widths of the fields of a line: first whole numbers, then floats.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BlockFormat {
    integers: Vec<usize>,
    floats: Vec<usize>,
}

impl BlockFormat {
    /// Parses a format of whole numbers followed by floats; `None` for any other.
    pub fn parse(text: &[u8]) -> Option<Self> {
        let text = text.trim_ascii().strip_prefix(b"(")?.strip_suffix(b")")?;
        let mut format = Self::default();
        for item in text.split(|&byte| byte == b',') {
            format.add(&item.trim_ascii().to_ascii_lowercase())?;
        }
        (!format.integers.is_empty()).then_some(format)
    }

    /// The fields of a line that hold whole numbers, up to the end of the line.
    pub fn integers<'a>(&'a self, line: &'a [u8]) -> impl Iterator<Item = &'a [u8]> + 'a {
        fields(&self.integers, 0, line)
    }

    /// The fields of a line that hold floats, up to the end of the line.
    pub fn floats<'a>(&'a self, line: &'a [u8]) -> impl Iterator<Item = &'a [u8]> + 'a {
        fields(&self.floats, self.integers.iter().sum(), line)
    }

    /// Adds the fields of a format item such as `3i9` or `6e21.13e3`.
    fn add(&mut self, item: &[u8]) -> Option<()> {
        let at = item.iter().position(u8::is_ascii_alphabetic)?;
        let repeat = if at == 0 { 1 } else { whole(&item[..at])? };
        let rest = &item[at + 1..];
        let end = rest.iter().position(|byte| !byte.is_ascii_digit()).unwrap_or(rest.len());
        let width = whole(&rest[..end]).filter(|width| (1..=WIDTH).contains(width))?;
        let widths = match item[at] {
            b'i' if self.floats.is_empty() => &mut self.integers,
            b'e' | b'f' | b'g' | b'd' => &mut self.floats,
            _ => return None,
        };
        let room = FIELDS.checked_sub(widths.len()).filter(|&room| repeat <= room);
        room.map(|_| widths.extend(std::iter::repeat_n(width, repeat)))
    }
}

fn fields<'a>(widths: &'a [usize], from: usize, line: &'a [u8]) -> impl Iterator<Item = &'a [u8]> + 'a {
    let mut start = from;
    widths.iter().map_while(move |width| {
        let rest = line.get(start..).filter(|rest| !rest.is_empty())?;
        start += width;
        Some(rest[..rest.len().min(*width)].trim_ascii())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_by_their_width() {
        let format = BlockFormat::parse(b" (1i3,2I2,3e6.1e3) ").expect("a format");
        let line = b"  1 2 3 -1.5  2.0E";
        assert_eq!(format.integers(line).collect::<Vec<_>>(), [b"1", b"2", b"3"]);
        assert_eq!(format.floats(line).collect::<Vec<_>>(), [&b"-1.5"[..], b"2.0E"]);
        assert_eq!(format.integers(b"  1").count(), 1);
        assert_eq!(format.floats(b"").count(), 0);
    }

    #[test]
    fn other_formats_are_refused() {
        for text in [
            "",
            "3i9",
            "()",
            "(e20.3)",
            "(i9,e9.3,i9)",
            "(3x9)",
            "(i)",
            "(i0)",
            "(i99999)",
            "(101i9)",
            "(99999999999999999999i9)",
        ] {
            assert_eq!(BlockFormat::parse(text.as_bytes()), None, "{text}");
        }
    }
}
