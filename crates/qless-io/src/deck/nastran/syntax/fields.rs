//! Splits a line of bulk data into fields.
//!
//! A line has a name, data fields and a continuation mark, in one of three forms. Numbers below are columns.
//!
//! | form  | when                       | name    | data                  | continuation mark |
//! | ----- | -------------------------- | ------- | --------------------- | ----------------- |
//! | small | otherwise                  | 1 to 8  | 8 fields of 8 columns | 73 to 80          |
//! | large | the first field has a `*`  | 1 to 8  | 4 fields of 16        | 73 to 80          |
//! | free  | a comma among the first 16 | first   | 8, or 4 with a `*`    | the field after   |
//!
//! In free field, data may continue after the last data field, as if they were on the next line. A tab fills up with blanks to the next
//! multiple of 8 columns. A comment starts with `$`.

use std::borrow::Cow;

use super::number::real;
use crate::deck::{CardFault, Problem};
use crate::fault::quote;

const NAME: usize = 8;
const END_OF_DATA: usize = 72;
const END: usize = 80;

/// The fields of a line, each without surrounding blanks.
#[derive(Debug, PartialEq)]
pub struct LineFields<'a> {
    /// The first field without its `*` or `+`. In a continuation line, this is the name of the continuation.
    pub name: &'a [u8],
    /// The data fields, of which the first `count` are used.
    data: [&'a [u8]; 8],
    /// Number of data fields of the line: 8, or 4 in large field.
    count: usize,
    /// Further data of a line in free field, which would otherwise stand on continuation lines.
    pub more: Vec<&'a [u8]>,
    /// The continuation mark: the field after the data, which names the continuation line.
    pub mark: &'a [u8],
}

impl<'a> LineFields<'a> {
    pub fn data(&self) -> &[&'a [u8]] {
        &self.data[..self.count]
    }
}

/// The line without its comment. Tabs are expanded to blanks unless the line is in free field.
pub fn content(line: &[u8]) -> Cow<'_, [u8]> {
    // A fast exit, because most lines have neither a comment nor a tab.
    let Some(first) = memchr::memchr2(b'$', b'\t', line) else { return Cow::Borrowed(line.trim_ascii_end()) };
    let end = memchr::memchr(b'$', &line[first..]).map_or(line.len(), |end| first + end);
    let line = line[..end].trim_ascii_end();
    if line.contains(&b'\t') && !is_free(line) { Cow::Owned(expand_tabs(line)) } else { Cow::Borrowed(line) }
}

fn expand_tabs(line: &[u8]) -> Vec<u8> {
    let mut wide = Vec::with_capacity(line.len() + 64);
    for &byte in line {
        if byte == b'\t' {
            wide.resize(wide.len() / NAME * NAME + NAME, b' ');
        } else {
            wide.push(byte);
        }
    }
    wide
}

/// Whether the line continues a card: its first field is blank, or starts with `+` or `*`.
pub fn continues(line: &[u8]) -> bool {
    matches!(line.first(), Some(b' ' | b'+' | b'*' | b',' | b'\t')) && !starts_late(line)
}

/// Whether the line is an indented card: its first field has blanks before a name.
fn starts_late(line: &[u8]) -> bool {
    let first = &line[..line.len().min(NAME)];
    line[0] == b' ' && first.iter().find(|&&byte| byte != b' ').is_some_and(u8::is_ascii_alphabetic)
}

/// Splits a line into fields. [`content`] must have removed its comment.
pub fn split(line: &[u8]) -> Result<LineFields<'_>, Problem> {
    if is_free(line) { free(line) } else { Ok(fixed(line)) }
}

/// Whether the line is in free field, that is, has a comma in its name or first data field. Later commas may be part of a text.
fn is_free(line: &[u8]) -> bool {
    line[..line.len().min(2 * NAME)].contains(&b',')
}

fn fixed(line: &[u8]) -> LineFields<'_> {
    let (name, wide) = name(columns(line, 0, NAME));
    let (count, width) = if wide { (4, 16) } else { (8, 8) };
    let mut data = [&b""[..]; 8];
    for (k, field) in data[..count].iter_mut().enumerate() {
        *field = columns(line, NAME + k * width, NAME + (k + 1) * width);
    }
    LineFields { name, data, count, more: Vec::new(), mark: columns(line, END_OF_DATA, END) }
}

fn columns(line: &[u8], from: usize, to: usize) -> &[u8] {
    line.get(from..to.min(line.len())).unwrap_or_default().trim_ascii()
}

fn free(line: &[u8]) -> Result<LineFields<'_>, Problem> {
    let mut words = line.split(|&byte| byte == b',').map(<[u8]>::trim_ascii);
    let (name, wide) = name(words.next().unwrap_or_default());
    let count = if wide { 4 } else { 8 };
    let mut data = [&b""[..]; 8];
    for (field, word) in data[..count].iter_mut().zip(words.by_ref()) {
        *field = word;
    }
    let (more, mark) = beyond(&words.collect::<Vec<_>>(), count)?;
    let fields = LineFields { name, data, count, more, mark };
    // On a line of copies, an asterisk marks an increment, not a continuation.
    Ok(if is_copy(name) { fields } else { without_early_mark(fields) })
}

/// Splits the words after the data fields of a line in free field into further data and the continuation mark.
fn beyond<'a>(words: &[&'a [u8]], count: usize) -> Result<(Vec<&'a [u8]>, &'a [u8]), Problem> {
    let filled = words.iter().rposition(|word| !word.is_empty()).map_or(0, |last| last + 1);
    let words = &words[..filled];
    // The words are further data only if the first one is clearly a datum. A blank may be an empty mark, and a mark ends the data.
    let is_data = words.first().is_some_and(|word| !word.is_empty() && !is_mark(word));
    let (more, mark) = match words.split_last() {
        Some((mark, more)) if more.is_empty() && is_mark(mark) || is_name(mark) => (more, *mark),
        _ => (words, &b""[..]),
    };
    match more.iter().find(|word| !word.is_empty() && (!is_data || is_name(word))) {
        Some(found) => Err(CardFault::TooManyFields { count, found: quote(found) }.into()),
        None => Ok((more.to_vec(), mark)),
    }
}

/// Whether a word after data can only be a continuation mark: it begins like one, and is not a number.
fn is_name(word: &[u8]) -> bool {
    is_mark(word) && real(word).is_err()
}

/// Whether a line with this first field copies the card before it.
pub fn is_copy(name: &[u8]) -> bool {
    name.first() == Some(&b'=')
}

/// The continuation mark of a line. Finds it without splitting the line into fields.
pub fn mark(line: &[u8]) -> &[u8] {
    if !is_free(line) {
        return columns(line, END_OF_DATA, END);
    }
    let last = line.trim_ascii_end().rsplit(|&byte| byte == b',').find(|word| !word.trim_ascii().is_empty());
    last.map(<[u8]>::trim_ascii).filter(|word| is_mark(word) && real(word).is_err()).unwrap_or_default()
}

/// The name in a continuation mark, in capitals: the text after its `+` or `*`. Empty if there is none.
pub fn name_in(mark: &[u8]) -> Vec<u8> {
    let name = mark.strip_prefix(b"+").or(mark.strip_prefix(b"*")).unwrap_or_default();
    name.trim_ascii().to_ascii_uppercase()
}

fn is_mark(word: &[u8]) -> bool {
    matches!(word.first(), None | Some(b'+' | b'*'))
}

/// A mark may stand among the data, as in `MPC,1,2,3,1.0,+`. If the last field that is not blank starts with `+` or `*` and is no number,
/// it is such a mark: moves it to the place of the continuation mark.
fn without_early_mark(mut fields: LineFields<'_>) -> LineFields<'_> {
    let Some(last) = fields.data.iter().rposition(|field| !field.is_empty()) else { return fields };
    let word = fields.data[last];
    if matches!(word[0], b'+' | b'*') && real(word).is_err() {
        fields.mark = word;
        fields.data[last] = b"";
    }
    fields
}

/// The name in the first field of a line, and whether the line is in large field.
fn name(first: &[u8]) -> (&[u8], bool) {
    if let Some(rest) = first.strip_prefix(b"*") {
        return (rest.trim_ascii(), true);
    }
    let first = first.strip_prefix(b"+").unwrap_or(first).trim_ascii();
    first.strip_suffix(b"*").map_or((first, false), |name| (name.trim_ascii(), true))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(line: &str) -> Vec<String> {
        let line = content(line.as_bytes());
        let fields = split(&line).expect("a line");
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let data = fields.data().iter().map(|word| text(word));
        std::iter::once(text(fields.name)).chain(data).chain([text(fields.mark)]).collect()
    }

    #[test]
    fn small_field() {
        let found = words("GRID    10611   2       0.      0.      -3.     2               123     +A $ no");
        assert_eq!(found, ["GRID", "10611", "2", "0.", "0.", "-3.", "2", "", "123", "+A"]);
        assert_eq!(words("MAT1    1   "), ["MAT1", "1", "", "", "", "", "", "", "", ""]);
        assert_eq!(
            words("CORD2R         7       013.8639613.86396    -20.")[2..6],
            ["0", "13.86396", "13.86396", "-20."]
        );
    }

    #[test]
    fn large_field() {
        let found = words("CORD2R*                2               0             0.0             0.5+ ");
        assert_eq!(found, ["CORD2R", "2", "0", "0.0", "0.5", "+"]);
        assert_eq!(words("*X                   0.0")[..2], ["X", "0.0"]);
    }

    #[test]
    fn free_field() {
        assert_eq!(words("grid, 124,12 ,31.,4.,-165.,12")[..7], ["grid", "124", "12", "31.", "4.", "-165.", "12"]);
        assert_eq!(words("GRID*,1,,1.5,2.5,+a"), ["GRID", "1", "", "1.5", "2.5", "+a"]);
        assert_eq!(words(",5,1,-1.0,+")[..5], ["", "5", "1", "-1.0", ""]);
        assert_eq!(words("+a,5")[..2], ["a", "5"]);
        assert_eq!(words("MPC,1,2,3,+1.0")[4], "+1.0");
        assert_eq!(
            words("SPC1    1       123     4                                               a,b")[..4],
            ["SPC1", "1", "123", "4"]
        );
    }

    #[test]
    fn tabs_reach_the_next_field() {
        assert_eq!(words("EIGC\t2\thess\t\t\t\t\t3 \t")[..9], ["EIGC", "2", "hess", "", "", "", "", "3", ""]);
        assert_eq!(words("GRID,\t1,\t,2.0")[..4], ["GRID", "1", "", "2.0"]);
    }

    #[test]
    fn too_many_words_are_refused() {
        assert!(split(b"RBE2,1,2,3,4,5,6,7,8,,9").is_err());
        assert!(split(b"RBE2,1,2,3,4,5,6,7,8,+,9").is_err());
        assert!(split(b"RBE2,1,2,3,4,5,6,7,8,,").is_ok());
    }

    #[test]
    fn data_go_on_beyond_the_last_field() {
        let fields = split(b"RBE2,1,2,3,4,5,6,7,8,9,10,,12,+A").expect("a line");
        assert_eq!((fields.more, fields.mark), (vec![&b"9"[..], b"10", b"", b"12"], &b"+A"[..]));
        for (line, found) in [("MPC,1,2,+A", "+A"), ("MPC,1,2,+1.", ""), ("MPC,1,2,3", ""), ("CBAR    1   2", "")] {
            assert_eq!(mark(line.as_bytes()), found.as_bytes(), "{line}");
        }
        assert_eq!(name_in(b"+ ab 1"), b"AB 1");
        assert_eq!(name_in(b"12"), b"");
    }

    #[test]
    fn continuations_are_told_from_cards() {
        for line in ["+       1", "*       1", "        1", "\tUM\t1", ",1,2", "+a,1", "      "] {
            assert!(continues(line.as_bytes()), "{line}");
        }
        for line in ["GRID", "  GRID,1", " MPC    1"] {
            assert!(!continues(line.as_bytes()), "{line}");
        }
    }
}
