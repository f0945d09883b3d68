//! Sizes of whole numbers after fractions are cleared: `sum of sizes * 10^tens * 2^twos`, in bits.

use crate::input::reading::Number;

/// Common denominator `10^tens 2^twos` of some numbers, and the sum of their sizes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct NumberSize {
    tens: i32,
    twos: i32,
    sum: f64,
}

impl NumberSize {
    /// Adds a number; `size` is at least its contribution to the sum.
    pub fn add(&mut self, number: Number, size: f64) {
        let below = if number.decimal { &mut self.tens } else { &mut self.twos };
        *below = (*below).max(-number.exponent);
        self.sum += size.abs();
    }

    /// Adds the numbers of another sum.
    pub fn join(&mut self, other: Self) {
        (self.tens, self.twos) = (self.tens.max(other.tens), self.twos.max(other.twos));
        self.sum += other.sum;
    }

    /// The common denominator of all products of a number of `self` and one of `other`. The sum stays that of `self`, so its sizes must
    /// already include both factors.
    pub fn times(self, other: Self) -> Self {
        Self { tens: self.tens + other.tens, twos: self.twos + other.twos, ..self }
    }

    /// Bits of the sum times the common denominator, with its sign and the rounding of the sum; infinite if it is out of range.
    pub fn bits(&self) -> f64 {
        if self.sum == 0.0 {
            return 0.0;
        }
        f64::from(self.tens) * std::f64::consts::LOG2_10 + f64::from(self.twos) + self.sum.log2() + 2.0
    }
}
