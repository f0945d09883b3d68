//! `3,7,10-20`: numbers counted from 1, as the user lists them.

/// Numbers counted from 0.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Numbers(pub Vec<usize>);

/// A list with more numbers than this is a slip of the keyboard.
const MOST: usize = 10_000_000;

/// Reads a list.
pub fn numbers(text: &str) -> Result<Numbers, String> {
    let mut all = Vec::new();
    for part in text.split(',') {
        let (first, last) = part.split_once('-').unwrap_or((part, part));
        let (first, last) = (number(first)?, number(last)?);
        if last < first {
            return Err(format!("`{part}` runs backwards; write {last}-{first}"));
        }
        if all.len().saturating_add(last - first) >= MOST {
            return Err(format!("`{part}` makes the list longer than {MOST} numbers"));
        }
        all.extend(first - 1..last);
    }
    Ok(Numbers(all))
}

fn number(text: &str) -> Result<usize, String> {
    let found = text.trim().parse().ok().filter(|&number| number > 0);
    found.ok_or_else(|| format!("`{text}` is no number from 1; write a list such as 3,7,10-20"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_and_ranges_count_from_one() {
        assert_eq!(numbers("3, 7,10-12").expect("a list").0, [2, 6, 9, 10, 11]);
        assert_eq!(numbers("5-5").expect("one").0, [4]);
    }

    #[test]
    fn what_is_no_list_is_named() {
        for (text, part) in
            [("", "``"), ("0", "`0`"), ("3,,4", "``"), ("a", "`a`"), ("9-3", "write 3-9"), ("1-99999999", "longer")]
        {
            let error = numbers(text).expect_err(text);
            assert!(error.contains(part), "{text}: {error}");
        }
    }
}
