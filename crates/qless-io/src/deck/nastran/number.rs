//! Text to numbers in Nastran's spelling: `12`, `7.0`, `1.5-3` for 1.5e-3, `1.D+2`, components `1246`.

use crate::{NumberFault, number};

/// Components 1 to 6 of a grid point as a set; the empty set is a scalar point's `0`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(in crate::deck) struct Components(u8);

impl Components {
    pub const ALL: Self = Self(0b111_1110);

    /// The set of one component, 1 to 6.
    pub fn one(component: u8) -> Self {
        Self(1 << component)
    }

    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    pub fn len(self) -> usize {
        self.0.count_ones() as usize
    }

    pub fn contains(self, component: u8) -> bool {
        self.0 >> component & 1 == 1
    }

    /// Those of `self` that are not in `other`.
    pub fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    pub fn and(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }

    /// The components in ascending order, 1 to 6.
    pub fn iter(self) -> impl Iterator<Item = u8> {
        (1..=6).filter(move |&component| self.contains(component))
    }

    /// `246` as a set; `0` and no text are the empty set.
    pub fn parse(word: &[u8]) -> Option<Self> {
        if word == b"0" {
            return Some(Self(0));
        }
        word.iter()
            .try_fold(Self(0), |set, &digit| matches!(digit, b'1'..=b'6').then(|| Self(set.0 | 1 << (digit - b'0'))))
    }
}

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

    #[test]
    fn components_are_digits() {
        let set = Components::parse(b"2461").expect("components");
        assert_eq!(set.iter().collect::<Vec<_>>(), [1, 2, 4, 6]);
        assert_eq!((set.len(), set.contains(3), set.contains(6)), (4, false, true));
        assert_eq!(Components::ALL.without(set).iter().collect::<Vec<_>>(), [3, 5]);
        assert_eq!(Components::parse(b"0"), Some(Components::default()));
        assert!(Components::parse(b"7").is_none() && Components::parse(b"1.").is_none());
        assert!(Components::parse(b"10").is_none());
    }
}
