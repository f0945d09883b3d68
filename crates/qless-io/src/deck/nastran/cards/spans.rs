//! Lists of grid points: `3 5 10 THRU 20`.

use crate::deck::nastran::syntax::card::{Card, Refused};

/// Numbers from `first` to `last`; those between, but not the two themselves, may be missing in the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    pub first: u32,
    pub last: u32,
}

/// The list in fields `from..to`; blank fields are passed over.
pub fn spans(card: &Card, from: usize, to: usize) -> Result<Vec<Span>, Refused> {
    let filled: Vec<usize> = (from..to).filter(|&i| !card.is_blank(i)).collect();
    spans_in(card, &filled)
}

/// The list in these fields, none of them blank.
pub fn spans_in(card: &Card, fields: &[usize]) -> Result<Vec<Span>, Refused> {
    const POINT: &str = "a grid or scalar point";
    let mut fields = fields.iter().copied().peekable();
    let mut spans = Vec::new();
    while let Some(i) = fields.next() {
        let first = card.id(i, POINT)?;
        if fields.next_if(|&i| card.field(i).eq_ignore_ascii_case(b"THRU")).is_none() {
            spans.push(Span { first, last: first });
            continue;
        }
        let end = fields.next().unwrap_or(i + 2);
        let last = card.id(end, "the last point of the list after THRU")?;
        if last < first {
            return Err(card.expected(end, "a number after THRU that is not below the one before it"));
        }
        spans.push(Span { first, last });
    }
    Ok(spans)
}
