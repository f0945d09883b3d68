//! Text to numbers in Nastran's spelling: `12`, `7.0`, `1.5-3` for 1.5e-3, `1.D+2`.

use crate::{NumberFault, number};

/// The float nearest to the text: a sign after the first digit starts the exponent.
pub(in crate::deck) fn real(word: &[u8]) -> Result<f64, NumberFault> {
    let bare_exponent = word.iter().skip(1).position(|byte| matches!(byte, b'+' | b'-'));
    let Some(sign) = bare_exponent.map(|at| at + 1) else { return plain(word) };
    if matches!(word[sign - 1], b'e' | b'E' | b'd' | b'D') {
        return plain(word);
    }
    plain(&[&word[..sign], b"e", &word[sign..]].concat())
}

/// `inf` and `nan` are words here, not numbers.
fn plain(word: &[u8]) -> Result<f64, NumberFault> {
    let digits = word.iter().any(u8::is_ascii_digit);
    let letters = word.iter().any(|byte| byte.is_ascii_alphabetic() && !b"eEdD".contains(byte));
    if !digits || letters {
        return Err(NumberFault::NotANumber);
    }
    number::real(word)
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
}
