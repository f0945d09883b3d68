//! `a + sum_k a_k e_k` with `e_k e_l = 0`: a value and N first derivatives.

use std::array::from_fn;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::Scalar;

/// A value and its derivatives in N directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<const N: usize> {
    /// The value.
    pub real: f64,
    /// Its derivative in each direction.
    pub slope: [f64; N],
}

impl<const N: usize> Dual<N> {
    /// The variable of direction `k`; a constant if there is no such direction.
    pub fn variable(real: f64, k: usize) -> Self {
        Self { real, slope: from_fn(|i| f64::from(u8::from(i == k))) }
    }

    /// `f(self)` from f and f' at its value.
    fn chain(self, f: f64, slope: f64) -> Self {
        Self { real: f, slope: self.slope.map(|s| slope * s) }
    }
}

impl<const N: usize> From<f64> for Dual<N> {
    fn from(real: f64) -> Self {
        Self { real, slope: [0.0; N] }
    }
}

impl<const N: usize> Add for Dual<N> {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        Self { real: self.real + b.real, slope: from_fn(|k| self.slope[k] + b.slope[k]) }
    }
}

impl<const N: usize> Sub for Dual<N> {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        Self { real: self.real - b.real, slope: from_fn(|k| self.slope[k] - b.slope[k]) }
    }
}

impl<const N: usize> Mul for Dual<N> {
    type Output = Self;
    #[allow(clippy::suspicious_arithmetic_impl, reason = "the rule of products and quotients")]
    fn mul(self, b: Self) -> Self {
        Self { real: self.real * b.real, slope: from_fn(|k| self.real * b.slope[k] + self.slope[k] * b.real) }
    }
}

impl<const N: usize> Div for Dual<N> {
    type Output = Self;
    #[allow(clippy::suspicious_arithmetic_impl, reason = "the rule of products and quotients")]
    fn div(self, b: Self) -> Self {
        let real = self.real / b.real;
        Self { real, slope: from_fn(|k| (self.slope[k] - real * b.slope[k]) / b.real) }
    }
}

impl<const N: usize> Neg for Dual<N> {
    type Output = Self;
    fn neg(self) -> Self {
        self.chain(-self.real, -1.0)
    }
}

impl<const N: usize> Scalar for Dual<N> {
    fn real(self) -> f64 {
        self.real
    }
    fn sqrt(self) -> Self {
        let root = self.real.sqrt();
        self.chain(root, 0.5 / root)
    }
    fn sin(self) -> Self {
        self.chain(self.real.sin(), self.real.cos())
    }
    fn cos(self) -> Self {
        self.chain(self.real.cos(), -self.real.sin())
    }
}
