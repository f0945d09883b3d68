//! Reads lines that copy the previous card: `=,*1,=,*(0.5),==` makes one copy, and `=(3)` then makes three more by the same rule.
//!
//! | field | field of the copy |
//! | --- | --- |
//! | `=` | the field of the previous card |
//! | `==` | the same, for this and all later fields |
//! | `*x`, `*(x)` | the field of the previous card plus x |
//! | anything else | this text |

use super::card::{BulkCard, CardRefusal, PER_LINE};
use super::fields::split;
use super::lines::FileLine;
use super::number::real;
use crate::deck::Problem;
use crate::fault::quote;

/// The rule of copies: how each field of a copy follows from that of the previous card.
#[derive(Clone, Debug, Default)]
pub struct CopyRule(Vec<Vec<u8>>);

/// The number of copies that a line makes, and the rule for their fields. A line without fields uses the rule `before`.
pub fn read(line: &[u8], before: Option<&CopyRule>, at: FileLine) -> Result<(usize, CopyRule), CardRefusal> {
    const EXPECTED: &str = "`=`, `=n` or `=(n)`, and for a first copy what changes in it";
    let refused = |problem| CardRefusal::of_line(at, problem);
    let fields = split(line).map_err(refused)?;
    let expected = || refused(Problem::Expected { expected: EXPECTED, found: quote(line.trim_ascii()) });
    let number = inner(fields.name.strip_prefix(b"=").unwrap_or_default());
    let count = if number.is_empty() { Some(1) } else { crate::number::whole(number) };
    let count = count.ok_or_else(expected)?;
    let own: Vec<Vec<u8>> = fields.data().iter().map(|field| field.to_vec()).collect();
    let change = if own.iter().all(Vec::is_empty) { before.cloned().ok_or_else(expected)? } else { CopyRule(own) };
    Ok((count, change))
}

impl CopyRule {
    /// Turns the card into its next copy.
    pub fn apply(&self, card: &mut BulkCard, at: FileLine) -> Result<(), CardRefusal> {
        let mut fields = Vec::with_capacity(PER_LINE);
        let mut is_rest = false;
        for i in 0..PER_LINE {
            let own = self.0.get(i).map_or(&b""[..], Vec::as_slice);
            is_rest |= own == b"==";
            let before = card.field(i);
            fields.push(match own.strip_prefix(b"*") {
                _ if is_rest || own == b"=" => before.to_vec(),
                Some(step) => sum(before, inner(step))
                    .ok_or_else(|| CardRefusal { at, ..card.expected(i, "a number to add to") })?,
                None => own.to_vec(),
            });
        }
        card.become_copy(&fields, at);
        Ok(())
    }
}

/// The text inside parentheses; the whole text if it has none.
fn inner(text: &[u8]) -> &[u8] {
    text.strip_prefix(b"(").and_then(|text| text.strip_suffix(b")")).unwrap_or(text).trim_ascii()
}

/// The sum of two numbers. It is a whole number if both are whole.
fn sum(a: &[u8], b: &[u8]) -> Option<Vec<u8>> {
    let whole = |text: &[u8]| std::str::from_utf8(text).ok()?.parse::<i64>().ok();
    if let (Some(a), Some(b)) = (whole(a), whole(b)) {
        return a.checked_add(b).map(|sum| sum.to_string().into_bytes());
    }
    Some(format!("{:?}", real(a).ok()? + real(b).ok()?).into_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copies_count_on() {
        let mut card = BulkCard::default();
        card.begin("GRID", b"GRID,101,17,1.0,10.5,,17,3456", (0, 1)).expect("a card");
        let (one, change) = read(b"=,*1,=,*(0.25),*-1.,==", None, (0, 2)).expect("a copy");
        let (three, again) = read(b"=(3)", Some(&change), (0, 3)).expect("copies");
        assert_eq!((one, three), (1, 3));
        for _ in 0..4 {
            again.apply(&mut card, (0, 3)).expect("a copy");
        }
        let words: Vec<&[u8]> = (0..8).map(|i| card.field(i)).collect();
        assert_eq!(words, [&b"105"[..], b"17", b"2.0", b"6.5", b"", b"17", b"3456", b""]);
    }

    #[test]
    fn what_cannot_be_copied_is_refused() {
        assert!(read(b"=(3)", None, (0, 2)).is_err(), "nothing says how");
        assert!(read(b"=x,*1", None, (0, 2)).is_err());
        let mut card = BulkCard::default();
        card.begin("GRID", b"GRID,1,,1.", (0, 1)).expect("a card");
        let (_, change) = read(b"=,*1,*1", None, (0, 2)).expect("a copy");
        assert!(change.apply(&mut card, (0, 2)).is_err(), "a blank has no sum");
    }
}
