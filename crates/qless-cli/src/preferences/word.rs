//! Parses the words of a list: `3,7,10-20,5:3,line 41,TOP,"tie A, x"`.

use std::ops::Range;

/// A list as typed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WordList(pub Vec<ListWord>);

/// One word of a list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ListWord {
    /// Indices, from 0.
    Numbers(Range<usize>),
    /// A name to look up.
    Name(String),
}

/// Largest number of indices in a list; more are a typing error.
const MOST: usize = 10_000_000;

/// Parses a list. A quoted word may contain commas, and is always a name.
pub fn words(text: &str) -> Result<WordList, String> {
    let mut all = Vec::new();
    let mut count = 0_usize;
    for (piece, is_quoted) in split(text)? {
        let word = if is_quoted { ListWord::Name(piece) } else { word(&piece)? };
        if let ListWord::Numbers(range) = &word {
            count = count.saturating_add(range.len());
            if count > MOST {
                return Err(format!("the list is longer than {MOST} numbers"));
            }
        }
        all.push(word);
    }
    Ok(WordList(all))
}

/// Splits at commas outside quotes; also returns whether each piece is quoted.
fn split(text: &str) -> Result<Vec<(String, bool)>, String> {
    let mut pieces = vec![(String::new(), false)];
    let mut is_open = false;
    for c in text.chars() {
        let last = pieces.last_mut().expect("starts with one piece");
        match c {
            '"' => (is_open, last.1) = (!is_open, true),
            ',' if !is_open => pieces.push((String::new(), false)),
            _ => last.0.push(c),
        }
    }
    if is_open {
        return Err("a quote is open at the end of the list; close it".to_owned());
    }
    Ok(pieces.into_iter().map(|(piece, is_quoted)| (piece.trim().to_owned(), is_quoted)).collect())
}

fn word(text: &str) -> Result<ListWord, String> {
    let (first, last) = text.split_once('-').unwrap_or((text, text));
    match (number(first), number(last)) {
        (Some(0), _) | (_, Some(0)) => Err(format!("`{text}`: numbers count from 1")),
        (Some(first), Some(last)) if last < first => Err(format!("`{text}` runs backwards; write {last}-{first}")),
        (Some(first), Some(last)) => Ok(ListWord::Numbers(first - 1..last)),
        _ if text.is_empty() => {
            Err("the list has an empty item; write a list such as 3,7,10-20 or 5:3,line 41,TOP".to_owned())
        }
        _ => Ok(ListWord::Name(text.to_owned())),
    }
}

fn number(text: &str) -> Option<usize> {
    text.trim().parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_and_ranges_count_from_one() {
        let name = |text: &str| ListWord::Name(text.to_owned());
        let numbers = |range| ListWord::Numbers(range);
        assert_eq!(words("3, 7,10-12").expect("a list").0, [numbers(2..3), numbers(6..7), numbers(9..12)]);
        let list = words("5-5,5:3, line 41 ,TOP-SIDE,\"tie A, x\",\"7\"").expect("a list").0;
        let expected = [numbers(4..5), name("5:3"), name("line 41"), name("TOP-SIDE"), name("tie A, x"), name("7")];
        assert_eq!(list, expected);
    }

    #[test]
    fn malformed_lists_are_refused() {
        for (text, part) in [
            ("", "empty item"),
            ("0", "`0`"),
            ("3,,4", "empty item"),
            ("9-3", "write 3-9"),
            ("1-99999999", "longer"),
            ("\"a", "close it"),
        ] {
            let error = words(text).expect_err(text);
            assert!(error.contains(part), "{text}: {error}");
        }
    }
}
