//! The number that a double stands for: `± digits base^exponent`.

/// How a double is read as a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "lowercase"))]
pub enum Reading {
    /// The shortest decimal that reads back as the double, so 0.1 is 1/10 and `0.1 + 0.2 = 0.3`.
    ///
    /// If the number was typed with at most 15 digits, this is the number itself; a longer one is rounded to at most 17 digits. A
    /// coefficient that was computed (a weight of a tie, a rotated direction, a sum of repeated terms) was never typed: its shortest
    /// decimal is as good as its binary value, and no better.
    Typed,
    /// The binary double itself, a whole number times a power of two.
    Stored,
}

/// An exact number, `± digits base^exponent`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Number {
    pub(crate) negative: bool,
    /// The digits as a whole number below 10^17, hence below every prime of 61 bits. Modulo such a prime, only the number 0 becomes 0.
    pub(crate) digits: u64,
    /// True for base ten, false for base two.
    pub(crate) decimal: bool,
    pub(crate) exponent: i32,
}

impl Number {
    /// The number that a finite double means.
    pub(crate) fn read(value: f64, reading: Reading) -> Self {
        let (negative, size) = (value.is_sign_negative(), value.abs());
        // A whole number below 2^53 is the same number in both readings.
        if size < (1_u64 << 53) as f64 && size.fract() == 0.0 {
            return Self { negative, digits: size as u64, decimal: false, exponent: 0 };
        }
        match reading {
            Reading::Typed => Self::shortest(negative, size),
            Reading::Stored => Self::binary(negative, size),
        }
    }

    /// Reads `d.ddde-xx`, which Rust prints with the fewest digits that read back as the same double.
    fn shortest(negative: bool, size: f64) -> Self {
        let text = format!("{size:e}");
        let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
        let digit = |digits: u64, c: u8| 10 * digits + u64::from(c - b'0');
        let digits = mantissa.bytes().filter(u8::is_ascii_digit).fold(0, digit);
        let behind_the_point = mantissa.len().saturating_sub(2) as i32;
        let exponent = exponent.parse::<i32>().unwrap_or_default() - behind_the_point;
        Self { negative, digits, decimal: true, exponent }
    }

    fn binary(negative: bool, size: f64) -> Self {
        let bits = size.to_bits();
        let (biased, fraction) = ((bits >> 52) as i32, bits & ((1 << 52) - 1));
        // Subnormal numbers have no hidden bit.
        let (digits, exponent) = if biased == 0 { (fraction, -1074) } else { (fraction | 1 << 52, biased - 1075) };
        Self { negative, digits, decimal: false, exponent }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::common::random::randoms;

    fn typed(value: f64) -> (bool, u64, i32) {
        let number = Number::read(value, Reading::Typed);
        assert!(number.decimal || number.exponent == 0);
        (number.negative, number.digits, number.exponent)
    }

    #[test]
    fn the_decimal_is_what_was_typed() {
        assert_eq!(typed(0.1), (false, 1, -1));
        assert_eq!(typed(-0.3), (true, 3, -1));
        assert_eq!(typed(12_345.678), (false, 12_345_678, -3));
        assert_eq!(typed(1e300), (false, 1, 300));
        assert_eq!(typed(1.5e-300), (false, 15, -301));
        assert_eq!(typed(5e-324), (false, 5, -324));
        assert_eq!(typed(f64::MAX), (false, 17_976_931_348_623_157, 292));
        assert_eq!(typed(-7.0), (true, 7, 0));
        assert_eq!(typed(9_007_199_254_740_991.0), (false, 9_007_199_254_740_991, 0));
        assert_eq!(typed(0.0).1, 0);
    }

    /// Both readings convert back to the double, and the digits are below 10^17, so below every prime.
    #[test]
    fn both_readings_give_the_double_back() {
        for (k, x) in randoms(3).take(20_000).enumerate() {
            let value = (x - 1.0) * 10_f64.powi(k as i32 % 600 - 300);
            let (negative, digits, exponent) = typed(value);
            let sign = if negative { "-" } else { "" };
            assert_eq!(format!("{sign}{digits}e{exponent}").parse(), Ok(value));
            assert!(digits < 100_000_000_000_000_000);
            let stored = Number::read(value, Reading::Stored);
            let half = stored.exponent / 2;
            let size = stored.digits as f64 * 2_f64.powi(half) * 2_f64.powi(stored.exponent - half);
            assert_eq!((size, stored.negative), (value.abs(), value < 0.0));
        }
    }

    #[test]
    fn numbers_of_fifteen_digits_come_back_as_typed() {
        for (k, x) in randoms(4).take(20_000).enumerate() {
            let digits = (x * 6.6e14) as u64;
            let exponent = k as i32 % 500 - 250;
            let value: f64 = format!("{digits}e{exponent}").parse().expect("a number");
            let (_, found, power) = typed(value);
            // Trailing zeros may be part of the digits or of the exponent.
            let [a, b] = [(digits, exponent), (found, power)].map(|(mut d, mut e)| {
                while d % 10 == 0 {
                    (d, e) = (d / 10, e + 1);
                }
                (d, e)
            });
            assert_eq!(a, b, "{value:e}");
        }
    }
}
