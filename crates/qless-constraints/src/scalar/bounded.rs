//! A number with a bound on its rounding error: `x^ = x + e`, `|e| <= error` (running error analysis, Wilkinson).
//!
//! Each operation propagates the bounds of its operands and adds its own: `fl(x op y) = (x op y)(1 + d)`, `|d| <= 2^-53`.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::Scalar;

/// Largest relative error of one operation.
const UNIT: f64 = f64::EPSILON / 2.0;

/// A computed number, and a bound on its distance from the result of exact arithmetic.
///
/// Inputs are assumed known to one unit in the last place. Within [`super::Dual`], derivatives get bounds as well.
///
/// ```
/// use qless_constraints::scalar::{Bounded, Scalar};
/// // 1e8 + 1e-8 - 1e8 is undetermined, since 1e-8 is below the rounding error of 1e8.
/// let (large, small) = (Bounded::from(1e8), Bounded::from(1e-8));
/// let difference = large + small - large;
/// assert!(difference.real.abs() < difference.error && difference.error < 1e-7);
/// // The sine of 2 pi is zero up to rounding.
/// let sine = Bounded::from(std::f64::consts::TAU).sin();
/// assert!(sine.real != 0.0 && sine.real.abs() < sine.error);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounded {
    /// The computed number.
    pub real: f64,
    /// Bound on its absolute error; infinite if there is none.
    pub error: f64,
}

impl Bounded {
    /// A quantity known to one unit in the last place of `size`, such as a difference of two numbers of that size.
    pub fn known_to(real: f64, size: f64) -> Self {
        Self { real, error: f64::EPSILON * size.abs() }
    }

    /// The result of an operation, with the propagated error and its own rounding.
    fn rounded(real: f64, passed_on: f64) -> Self {
        Self { real, error: passed_on + UNIT * real.abs() }
    }

    /// Like [`Bounded::rounded`], for products, quotients and roots. A result below the normal range has an additional error of up to the
    /// smallest positive number, unless it is a zero that is exact (`exact_zero`).
    fn scaled(real: f64, passed_on: f64, exact_zero: bool) -> Self {
        let lost = if real.abs() < f64::MIN_POSITIVE && !exact_zero { f64::from_bits(1) } else { 0.0 };
        Self::rounded(real, passed_on + lost)
    }

    /// Sine or cosine: `f` is its value, known to one unit in the last place, `slope` its derivative, and `error` the error bound of the
    /// argument.
    fn wave(f: f64, slope: f64, error: f64) -> Self {
        let passed_on = (slope.abs() * error + 0.5 * error * error).min(error).min(2.0);
        Self { real: f, error: passed_on + f64::EPSILON * f.abs() }
    }
}

impl From<f64> for Bounded {
    fn from(real: f64) -> Self {
        Self::known_to(real, real)
    }
}

impl Add for Bounded {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        Self::rounded(self.real + b.real, self.error + b.error)
    }
}

impl Sub for Bounded {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        Self::rounded(self.real - b.real, self.error + b.error)
    }
}

impl Mul for Bounded {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        let passed_on = self.real.abs() * b.error + self.error * (b.real.abs() + b.error);
        Self::scaled(self.real * b.real, passed_on, self.real == 0.0 || b.real == 0.0)
    }
}

impl Div for Bounded {
    type Output = Self;
    fn div(self, b: Self) -> Self {
        let (real, nearest) = (self.real / b.real, b.real.abs() - b.error);
        let passed_on = if nearest > 0.0 { (self.error + real.abs() * b.error) / nearest } else { f64::INFINITY };
        Self::scaled(real, passed_on, self.real == 0.0)
    }
}

impl Neg for Bounded {
    type Output = Self;
    fn neg(self) -> Self {
        Self { real: -self.real, error: self.error }
    }
}

impl Scalar for Bounded {
    fn real(self) -> f64 {
        self.real
    }
    fn sqrt(self) -> Self {
        let root = self.real.sqrt();
        // |sqrt x - sqrt y| = |x - y| / (sqrt x + sqrt y), and sqrt y is at least `least`.
        let least = (self.real - self.error).max(0.0).sqrt();
        let passed_on = if self.error == 0.0 { 0.0 } else { self.error / (root + least) };
        Self::scaled(root, passed_on, root == 0.0)
    }
    fn sin(self) -> Self {
        Self::wave(self.real.sin(), self.real.cos(), self.error)
    }
    fn cos(self) -> Self {
        Self::wave(self.real.cos(), self.real.sin(), self.error)
    }
}
