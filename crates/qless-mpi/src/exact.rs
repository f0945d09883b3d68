//! The exact sum of numbers that are spread over ranks, rounded once.
//!
//! Any double is an integer multiple of 2^-1074 with at most 2098 bits. Such integers are added without rounding, in digits of 32 bits
//! that are stored in words of 64 bits, so that carries can be deferred. The digits of all ranks are added as integers and the sum is
//! rounded once, so it depends only on the numbers (Kulisch, Computer Arithmetic and Validity, 2013).

use crate::ranks::Ranks;

/// Bits of a digit.
const BITS: usize = 32;
/// Digits for the 2098 bits of a number, 64 bits for carries, and the sign.
const DIGITS: usize = 69;
/// The number of additions after which carries are propagated. An addition changes a digit by less than 2^32, so 2^31 additions would fit
/// into its 64-bit word.
const PATIENCE: u32 = 1 << 16;
/// This number is added to the word of the highest digit while the words of the ranks are summed. The digit is a small signed carry, but
/// its word must not be negative.
const LIFT: u64 = 1 << 40;

/// The sum of the numbers of all ranks, rounded to the nearest double. Its bits are the same on all ranks, for any distribution and
/// order of the numbers. Collective: one [`Ranks::sum`] of 576 bytes.
///
/// Applied to products, it gives a dot product whose bits do not depend on the distribution. Infinite numbers and NaN give the same result
/// as with `+`.
///
/// ```
/// use qless_mpi::{Alone, exact_sum, on_threads};
/// let numbers = [1e100, 1.0, 1e-30, -1e100];
/// assert_eq!(exact_sum(&Alone, numbers), 1.0);
/// assert_eq!(on_threads(4, |ranks| exact_sum(ranks, [numbers[ranks.rank()]])), [1.0; 4]);
/// ```
pub fn exact_sum(ranks: &dyn Ranks, numbers: impl IntoIterator<Item = f64>) -> f64 {
    let mut own = ExactSum::default();
    numbers.into_iter().for_each(|number| own.add(number));
    let mut words = own.into_words();
    ranks.sum(&mut words);
    ExactSum::from_words(&words, ranks.size()).rounded()
}

struct ExactSum {
    /// The least significant digit comes first.
    digits: [i64; DIGITS],
    /// Additions since carries were last propagated.
    added: u32,
    /// Numbers of positive infinities, negative infinities and NaNs that were added.
    others: [u64; 3],
}

impl Default for ExactSum {
    fn default() -> Self {
        Self { digits: [0; DIGITS], added: 0, others: [0; 3] }
    }
}

impl ExactSum {
    fn add(&mut self, number: f64) {
        if !number.is_finite() {
            self.others[if number.is_nan() { 2 } else { usize::from(number < 0.0) }] += 1;
            return;
        }
        let bits = number.to_bits();
        let (exponent, fraction) = ((bits >> 52 & 0x7ff) as usize, bits & ((1 << 52) - 1));
        // A subnormal number has the exponent bits 0, which mean the exponent 1, and no implicit leading bit.
        let (mantissa, shift) = if exponent == 0 { (fraction, 0) } else { (fraction | 1 << 52, exponent - 1) };
        let mut rest = u128::from(mantissa) << (shift % BITS);
        for digit in &mut self.digits[shift / BITS..][..3] {
            let bits = (rest & 0xffff_ffff) as i64;
            *digit += if number < 0.0 { -bits } else { bits };
            rest >>= BITS;
        }
        self.added += 1;
        if self.added == PATIENCE {
            self.carry();
        }
    }

    /// Propagates the carries. Then all digits are at least 0 and below 2^32, except the highest, which holds the sign.
    fn carry(&mut self) {
        let mut carry = 0;
        for digit in &mut self.digits[..DIGITS - 1] {
            let sum = *digit + carry;
            *digit = sum & 0xffff_ffff;
            carry = sum >> BITS;
        }
        self.digits[DIGITS - 1] += carry;
        self.added = 0;
    }

    /// This rank's sum as words, which [`Ranks::sum`] can add to those of the other ranks.
    fn into_words(mut self) -> Vec<u64> {
        self.carry();
        let mut words: Vec<u64> = self.digits.iter().map(|&digit| digit as u64).collect();
        words[DIGITS - 1] = words[DIGITS - 1].wrapping_add(LIFT);
        words.extend(self.others);
        words
    }

    /// Decodes words that were summed over this number of ranks.
    fn from_words(words: &[u64], ranks: usize) -> Self {
        let mut sum = Self::default();
        sum.digits.iter_mut().zip(words).for_each(|(digit, &word)| *digit = word as i64);
        sum.digits[DIGITS - 1] -= (LIFT * ranks as u64) as i64;
        sum.others.copy_from_slice(&words[DIGITS..]);
        sum.carry();
        sum
    }

    fn rounded(mut self) -> f64 {
        match self.others {
            [0, 0, 0] => {}
            [_, 0, 0] => return f64::INFINITY,
            [0, _, 0] => return f64::NEG_INFINITY,
            _ => return f64::NAN,
        }
        let sign = if self.digits[DIGITS - 1] < 0 { -1.0 } else { 1.0 };
        if sign < 0.0 {
            self.digits.iter_mut().for_each(|digit| *digit = -*digit);
            self.carry();
        }
        let Some(top) = self.digits.iter().rposition(|&digit| digit != 0) else { return 0.0 };
        // The three leading digits hold at least 65 bits, more than the 53 of a double. The lowest bit records whether any lower digit is
        // nonzero.
        let first = top.saturating_sub(2);
        let mut leading = self.digits[first..=top].iter().rev().fold(0, |sum: u128, &d| sum << BITS | d as u128);
        leading |= u128::from(self.digits[..first].iter().any(|&digit| digit != 0));
        sign * scaled(leading as f64, (first * BITS) as i32)
    }
}

/// `x 2^(shift - 1074)`; exact, since x has few digits whenever the result could be subnormal.
fn scaled(x: f64, shift: i32) -> f64 {
    let power = |exponent: i32| f64::from_bits(((exponent + 1023) as u64) << 52);
    let mut exponent = shift - 1074;
    let mut x = x;
    while exponent != 0 {
        let step = exponent.clamp(-1000, 1000);
        x *= power(step);
        exponent -= step;
    }
    x
}
