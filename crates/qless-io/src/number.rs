//! Text to numbers: `12` to an index, `1.5`, `1e-3` or Fortran's `1.0D+3` to a float.

use crate::NumberFault;

/// A whole number; one too large for `usize` becomes `usize::MAX`, which is out of every range.
pub(crate) fn whole(word: &[u8]) -> Option<usize> {
    let mut value = 0_usize;
    for &byte in word {
        if !byte.is_ascii_digit() {
            return None;
        }
        value = value.saturating_mul(10).saturating_add(usize::from(byte - b'0'));
    }
    (!word.is_empty()).then_some(value)
}

/// The float nearest to the text, if it is finite and not zero by underflow.
pub(crate) fn real(word: &[u8]) -> Result<f64, NumberFault> {
    if let Some(value) = short(word) {
        return Ok(value);
    }
    let text = std::str::from_utf8(word).map_err(|_| NumberFault::NotANumber)?;
    let value = text.parse().or_else(|_| fortran(text))?;
    if f64::is_normal(value) { Ok(value) } else { not_normal(text, value) }
}

/// A number of at most 15 digits without exponent: an integer over a power of ten, both exact, so that the quotient is the
/// nearest float. Most numbers of a deck are such.
fn short(word: &[u8]) -> Option<f64> {
    const TENS: [f64; 16] = [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15];
    let (negative, digits) = match word {
        [b'-', rest @ ..] => (true, rest),
        _ => (false, word),
    };
    if digits.is_empty() || digits.len() > 16 {
        return None;
    }
    let (mut whole, mut count, mut decimals) = (0_u64, 0, None);
    for &byte in digits {
        match byte {
            b'0'..=b'9' => (whole, count) = (10 * whole + u64::from(byte - b'0'), count + 1),
            b'.' if decimals.is_none() => decimals = Some(count),
            _ => return None,
        }
    }
    if count == 0 || count > 15 {
        return None;
    }
    let value = whole as f64 / TENS[count - decimals.unwrap_or(count)];
    Some(if negative { -value } else { value })
}

/// `1.0D+3` is `1.0e+3`.
fn fortran(text: &str) -> Result<f64, NumberFault> {
    let text = text.replacen(['d', 'D'], "e", 1);
    if text.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c)) {
        return text.parse().map_err(|_| NumberFault::NotANumber);
    }
    Err(NumberFault::NotANumber)
}

/// Tells `inf` from `1e999` and `0.0` from `1e-999`.
fn not_normal(text: &str, value: f64) -> Result<f64, NumberFault> {
    let mantissa = text.split(['e', 'E', 'd', 'D']).next().unwrap_or_default();
    let nonzero = mantissa.bytes().any(|byte| matches!(byte, b'1'..=b'9'));
    if value == 0.0 && nonzero {
        return Err(NumberFault::Underflow);
    }
    if value.is_finite() {
        return Ok(value);
    }
    Err(if nonzero { NumberFault::Overflow } else { NumberFault::NotFinite })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers() {
        assert_eq!(whole(b"0012"), Some(12));
        assert_eq!(whole(b"99999999999999999999999"), Some(usize::MAX));
        for text in [&b""[..], b"-1", b"+1", b"1.0", b"1e3", b"x"] {
            assert_eq!(whole(text), None);
        }
    }

    #[test]
    fn reals_in_every_spelling() {
        for (text, value) in [
            ("1.0D+3", 1e3),
            ("-1.5d-2", -1.5e-2),
            ("2.D0", 2.0),
            (".5", 0.5),
            ("+7", 7.0),
            ("-0.0", -0.0),
            ("0e999", 0.0),
            ("5e-324", 5e-324),
            ("1.7976931348623157E308", f64::MAX),
        ] {
            assert_eq!(real(text.as_bytes()).map(f64::to_bits), Ok(value.to_bits()), "{text}");
        }
    }

    #[test]
    fn short_numbers_are_the_nearest_floats() {
        for text in ["0", "-0.0", "1.", ".5", "-.25", "0.1", "123456789.012345", "999999999999999", "0.00000000000001"]
        {
            assert_eq!(super::short(text.as_bytes()).map(f64::to_bits), text.parse().ok().map(f64::to_bits), "{text}");
        }
        for text in ["", "-", ".", "1.2.3", "1234567890123456", "1e3", "+1", "--1"] {
            assert_eq!(super::short(text.as_bytes()), None, "{text}");
        }
    }

    #[test]
    fn what_is_no_finite_number_is_told_apart() {
        use NumberFault::{NotANumber, NotFinite, Overflow, Underflow};
        for (text, fault) in [
            ("nan", NotFinite),
            ("-NaN", NotFinite),
            ("inf", NotFinite),
            ("-Infinity", NotFinite),
            ("1e400", Overflow),
            ("-1.0D+400", Overflow),
            ("1e-400", Underflow),
            ("1.0D-400", Underflow),
            ("1..0", NotANumber),
            ("D", NotANumber),
            ("D5", NotANumber),
            ("1,5", NotANumber),
            ("0x10", NotANumber),
            ("1.#INF", NotANumber),
            ("one", NotANumber),
        ] {
            assert_eq!(real(text.as_bytes()), Err(fault), "{text}");
        }
        assert_eq!(real(b"\xff"), Err(NotANumber));
    }
}
