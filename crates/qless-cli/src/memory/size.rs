//! Parses and writes sizes of memory.

use std::fmt;
use std::num::NonZeroUsize;

/// Bytes, written in MiB.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size(pub usize);

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{:.1} MiB", self.0 as f64 / f64::from(1 << 20))
    }
}

/// Parses `512`, `512MiB` or `2GiB`.
///
/// # Errors
/// The expected form.
pub fn parse(text: &str) -> Result<NonZeroUsize, String> {
    let (number, unit) = match text.find(|c: char| !c.is_ascii_digit()) {
        Some(at) => text.split_at(at),
        None => (text, "MiB"),
    };
    let shift = match unit {
        "KiB" => 10,
        "MiB" => 20,
        "GiB" => 30,
        _ => return Err(EXPECTED.to_owned()),
    };
    let bytes = number.parse::<usize>().ok().map(|number| number.saturating_mul(1 << shift));
    bytes.and_then(NonZeroUsize::new).ok_or_else(|| EXPECTED.to_owned())
}

const EXPECTED: &str = "expected a whole number of at least 1, in MiB or with a unit: 512, 512MiB, 2GiB";

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_size_is_a_number_with_or_without_unit() {
        let bytes = |text| parse(text).map(NonZeroUsize::get);
        assert_eq!([bytes("8"), bytes("8MiB"), bytes("8192KiB")], [const { Ok(8 << 20) }; 3]);
        assert_eq!(bytes("2GiB"), Ok(2 << 30));
        assert_eq!(bytes("99999999999GiB"), Ok(usize::MAX));
        for wrong in ["", "0", "MiB", "-1", "1.5GiB", "8 MiB", "8MB", "99999999999999999999999"] {
            assert_eq!(bytes(wrong), Err(EXPECTED.to_owned()), "{wrong}");
        }
    }
}
