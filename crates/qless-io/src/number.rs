//! Parses numbers: `12` as a whole number, and `1.5`, `1e-3` or Fortran's `1.0D+3` as a float.

use crate::NumberFault;

/// Parses a whole number; `None` for any other text. A number too large for `usize` becomes `usize::MAX`, which is out of every range.
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

/// Parses a number as the nearest float. An error if the number is not finite, or if it underflows to zero.
pub(crate) fn real(word: &[u8]) -> Result<f64, NumberFault> {
    if let Some(value) = short(word) {
        return Ok(value);
    }
    let text = std::str::from_utf8(word).map_err(|_| NumberFault::NotANumber)?;
    let value = text.parse().or_else(|_| fortran(text))?;
    if f64::is_normal(value) { Ok(value) } else { not_normal(text, value) }
}

/// Parses a number in the form that [`leading`] reads; `None` for any other text. Most numbers of a deck have this form.
pub(crate) fn short(word: &[u8]) -> Option<f64> {
    leading(word).filter(|&(_, length)| length == word.len()).map(|(value, _)| value)
}

/// Parses the number at the start of a text. Returns it with the number of its bytes. The number must be a whole number up to 2^53,
/// multiplied or divided by a power of ten up to 10^22. Floats hold both factors exactly, so the result is the nearest float. `None` for
/// any other number.
pub(crate) fn leading(text: &[u8]) -> Option<(f64, usize)> {
    const TENS: [f64; 23] = [
        1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19,
        1e20, 1e21, 1e22,
    ];
    let start = usize::from(text.first() == Some(&b'-'));
    let (mut whole, mut end, mut point) = (0_u64, start, None);
    for &byte in &text[start..] {
        match byte {
            b'0'..=b'9' => whole = whole.wrapping_mul(10).wrapping_add(u64::from(byte - b'0')),
            b'.' if point.is_none() => point = Some(end),
            _ => break,
        }
        end += 1;
    }
    let decimals = point.map_or(0, |point| end - point - 1);
    let (count, mut exponent) = (end - start - usize::from(point.is_some()), -(decimals as isize));
    // 19 digits fit into a `u64`. More digits may overflow.
    if count == 0 || count > 19 || whole > 1 << 53 {
        return None;
    }
    if matches!(text.get(end), Some(b'e' | b'E' | b'd' | b'D')) {
        let (power, after) = power(text, end + 1)?;
        (exponent, end) = (exponent + power, after);
    }
    let ten = *TENS.get(exponent.unsigned_abs())?;
    let size = if exponent < 0 { whole as f64 / ten } else { whole as f64 * ten };
    Some((if start > 0 { -size } else { size }, end))
}

/// Parses an exponent: a sign, which may be missing, and one to three digits. Returns the exponent and the index after it.
fn power(text: &[u8], from: usize) -> Option<(isize, usize)> {
    let start = from + usize::from(matches!(text.get(from), Some(b'+' | b'-')));
    let count = text[start.min(text.len())..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    let digits = text.get(start..start + count).filter(|_| (1..=3).contains(&count))?;
    let value = digits.iter().fold(0, |value, digit| 10 * value + isize::from(digit - b'0'));
    Some((if text.get(from) == Some(&b'-') { -value } else { value }, start + count))
}

/// Parses a number in Fortran's spelling, such as `1.0D+3` for `1.0e+3`.
fn fortran(text: &str) -> Result<f64, NumberFault> {
    let text = text.replacen(['d', 'D'], "e", 1);
    if text.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c)) {
        return text.parse().map_err(|_| NumberFault::NotANumber);
    }
    Err(NumberFault::NotANumber)
}

/// The result for a text whose value is zero, subnormal or not finite. Distinguishes `inf` from `1e999`, and `0.0` from `1e-999`.
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
        let short_ones = "0 -0.0 1. .5 -.25 0.1 123456789.012345 999999999999999 0.00000000000001 1e3 9007199254740992 \
                          -1.2345678901234E-05 0.500000000E-01 3e22 7.25e+02 1e-22";
        for text in short_ones.split_whitespace() {
            assert_eq!(short(text.as_bytes()).map(f64::to_bits), text.parse().ok().map(f64::to_bits), "{text}");
        }
        assert_eq!(
            (short(b"1.5D+3"), leading(b"-2.5,UX"), leading(b"3 ")),
            (Some(1500.0), Some((-2.5, 4)), Some((3.0, 1)))
        );
        let others = "- . 1.2.3 9007199254740993 0.30000000000000004 1e 1e+ 1e0001 1e23 12e-25 +1 --1 .e1";
        for text in others.split_whitespace().chain([""]) {
            assert_eq!(short(text.as_bytes()), None, "{text}");
        }
        assert_eq!(leading(b"00000000000000000001"), None);
    }

    #[test]
    fn short_numbers_agree_with_the_long_way() {
        let mut state = 1_u64;
        let mut next = |below: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) % below
        };
        for _ in 0..20_000 {
            let (whole, part, power) = (next(1 << 20), next(1 << 31), next(50) as i64 - 25);
            let text = format!("{whole}.{part:0width$}e{power}", width = next(12) as usize);
            if let Some(value) = short(text.as_bytes()) {
                assert_eq!(Some(value.to_bits()), text.parse().ok().map(f64::to_bits), "{text}");
            }
        }
    }

    #[test]
    fn texts_that_are_no_finite_number_are_told_apart() {
        use NumberFault::{NotANumber, NotFinite, Overflow, Underflow};
        for (texts, fault) in [
            ("nan -NaN inf -Infinity", NotFinite),
            ("1e400 -1.0D+400", Overflow),
            ("1e-400 1.0D-400", Underflow),
            ("1..0 D D5 1,5 0x10 1.#INF one", NotANumber),
        ] {
            for text in texts.split(' ') {
                assert_eq!(real(text.as_bytes()), Err(fault), "{text}");
            }
        }
        assert_eq!(real(b"\xff"), Err(NotANumber));
    }
}
