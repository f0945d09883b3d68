//! Reads numbers in Nastran's spelling: `12`, `7.0`, `1.5-3` for 1.5e-3, `1.D+2`.
//!
//! [`real`] reads a number of any length. [`small_whole`] and [`small_real`] read plain numbers in a field of eight columns. They treat the
//! field as one 64-bit word, without a loop over its characters.

use crate::{NumberFault, number};

/// The nearest float to the number in the text. A sign after the first character starts the exponent.
pub(in crate::deck) fn real(word: &[u8]) -> Result<f64, NumberFault> {
    let bare_exponent = word.iter().skip(1).position(|byte| matches!(byte, b'+' | b'-'));
    let Some(sign) = bare_exponent.map(|at| at + 1) else { return plain(word) };
    if matches!(word[sign - 1], b'e' | b'E' | b'd' | b'D') {
        return plain(word);
    }
    plain(&[&word[..sign], b"e", &word[sign..]].concat())
}

/// The float for a text with an ordinary exponent. `inf` and `nan` count as words, not numbers.
fn plain(word: &[u8]) -> Result<f64, NumberFault> {
    let digits = word.iter().any(u8::is_ascii_digit);
    let letters = word.iter().any(|byte| byte.is_ascii_alphabetic() && !b"eEdD".contains(byte));
    if !digits || letters {
        return Err(NumberFault::NotANumber);
    }
    number::real(word)
}

/// A data field in small-field format: eight columns.
pub type SmallField = [u8; 8];

pub const BLANK: SmallField = [b' '; 8];

const ZEROS: u64 = u64::from_le_bytes([b'0'; 8]);
const LOW: u64 = u64::from_le_bytes([0x7f; 8]);

/// Reads a whole number. `None` for any other text and for a blank field.
pub fn small_whole(field: SmallField) -> Option<u32> {
    let (text, length) = small_text(field);
    small_digits(text, length)
}

/// Reads `[-]digits[.digits]` as the nearest float. `None` for any other text, such as a number with an exponent.
pub fn small_real(field: SmallField) -> Option<f64> {
    const TENS: [f64; 8] = [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7];
    let (mut text, mut length) = small_text(field);
    let is_negative = text as u8 == b'-';
    (text, length) = (text >> (8 * u32::from(is_negative)), length - u32::from(is_negative));
    let point = small_point(text).min(length);
    let decimals = length.saturating_sub(point + 1);
    // Remove the decimal point: shift the characters after it by one.
    let before = 1_u64.checked_shl(8 * point).map_or(u64::MAX, |bit| bit - 1);
    let text = if point < length { (text & before) | (text >> 8 & !before) } else { text };
    let whole = small_digits(text, length - u32::from(point < length))?;
    // Numerator and denominator are exact, so the quotient is correctly rounded.
    let size = f64::from(whole) / TENS[decimals as usize];
    Some(if is_negative { -size } else { size })
}

/// The text of the field without surrounding blanks, and its length. The text is a 64-bit word with the first character in the lowest byte.
fn small_text(field: SmallField) -> (u64, u32) {
    let bits = u64::from_le_bytes(field);
    let filled = bits ^ u64::from_le_bytes(BLANK);
    let (start, end) = (filled.trailing_zeros() / 8, 8 - filled.leading_zeros() / 8);
    // For a blank field, this gives length 0.
    let length = end.saturating_sub(start);
    let text = bits.checked_shr(8 * start).unwrap_or(0);
    (text & (u64::MAX >> (8 * (8 - length)).min(63)), length)
}

/// Index of the first decimal point; 8 if there is none.
fn small_point(text: u64) -> u32 {
    let other = text ^ u64::from_le_bytes([b'.'; 8]);
    // The highest bit of a byte of `zero` is set exactly if that byte of `other` is zero, that is, a decimal point.
    let zero = !(((other & LOW) + LOW) | other | LOW);
    zero.trailing_zeros() / 8
}

/// The number that the first `count` characters of `text` spell; `None` unless all of them are digits.
fn small_digits(text: u64, count: u32) -> Option<u32> {
    if count == 0 {
        return None;
    }
    // Pad the number with leading zeros to eight digits. The last digit is then in the highest byte.
    let all = (text << (8 * (8 - count))) | ZEROS.checked_shr(8 * count).unwrap_or(0);
    let high = 0xf0f0_f0f0_f0f0_f0f0;
    // A byte is a digit if and only if its upper half is 3, both before and after adding 6.
    if (all & high) | (all.wrapping_add(0x0606_0606_0606_0606) & high) >> 4 != 0x3333_3333_3333_3333 {
        return None;
    }
    // One multiplication combines digits into pairs; two more combine the pairs.
    let pairs = (all - ZEROS).wrapping_mul(10).wrapping_add((all - ZEROS) >> 8);
    let (odd, even) = (pairs & 0x0000_00ff_0000_00ff, pairs >> 16 & 0x0000_00ff_0000_00ff);
    let sum = odd.wrapping_mul(0x000f_4240_0000_0064).wrapping_add(even.wrapping_mul(0x0000_2710_0000_0001));
    Some((sum >> 32) as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reals_in_nastran_spelling() {
        for (text, value) in [
            ("7.0", 7.0),
            (".7", 0.7),
            ("-7.", -7.0),
            ("1.5-3", 1.5e-3),
            ("-.15+4", -1.5e3),
            ("1.D+2", 100.0),
            ("1.5E-3", 1.5e-3),
            ("1.5d3", 1500.0),
            ("+1.", 1.0),
            ("-2.19-15", -2.19e-15),
            ("3", 3.0),
        ] {
            assert_eq!(real(text.as_bytes()), Ok(value), "{text}");
        }
        for text in ["", "+", "-", ".", "1.0.0", "1-2-3", "THRU", "inf", "NaN", "1.e", "0x10", "1_0"] {
            assert_eq!(real(text.as_bytes()), Err(NumberFault::NotANumber), "{text}");
        }
        assert_eq!(real(b"1.+400"), Err(NumberFault::Overflow));
        assert_eq!(real(b"1.-400"), Err(NumberFault::Underflow));
    }

    /// All fields of eight columns that hold this text, at each possible position.
    fn fields(text: &str) -> impl Iterator<Item = SmallField> {
        let places = 0..=8 - text.len();
        places.map(move |place| {
            format!("{:place$}{text:<width$}", "", width = 8 - place).as_bytes().try_into().expect("eight")
        })
    }

    #[test]
    fn the_fast_path_agrees_with_the_general_path() {
        let mut state = 1_u64;
        let mut next = |below: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as usize % below
        };
        let mut read = [0; 2];
        for _ in 0..200_000 {
            let letters: &[u8] = [b"0123456789.-".as_slice(), b"0123456789", b"09.-+eE dD:/,\xb0\x80"][next(3)];
            let text: String = (0..=next(8)).map(|_| char::from(letters[next(letters.len())] & 0x7f)).collect();
            for field in fields(&text) {
                let word = field.trim_ascii();
                if let Some(value) = small_whole(field) {
                    read[0] += 1;
                    assert_eq!(number::whole(word), Some(value as usize), "{text}");
                }
                if let Some(value) = small_real(field) {
                    read[1] += 1;
                    assert_eq!(number::real(word).map(f64::to_bits), Ok(value.to_bits()), "{text}");
                }
                let plain = word.iter().all(u8::is_ascii_digit) && !word.is_empty();
                assert_eq!(small_whole(field).is_some(), plain, "{text}");
            }
        }
        assert!(read[0] > 50_000 && read[1] > 100_000, "{read:?}");
    }

    #[test]
    fn plain_decimals_are_read() {
        for text in
            ["0", "-0.", ".5", "-.5", "1.", "12345678", "-1234567", "1.234567", "0.000001", "-1.23456", "1234567."]
        {
            for field in fields(text) {
                assert_eq!(small_real(field).map(f64::to_bits), text.parse().ok().map(f64::to_bits), "{text}");
            }
        }
        for text in ["", ".", "-", "-.", "1.2.3", "--1", "1-", "1.5-3", "1e3", "1 2", "+1", "inf", "0x1"] {
            assert!(fields(text).all(|field| small_real(field).is_none()), "{text}");
        }
    }
}
