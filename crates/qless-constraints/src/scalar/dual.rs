//! `a + sum_k a_k e_k` with `e_k e_l = 0`: a value and N first derivatives.

use std::array::from_fn;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::{Scalar, Univariate};

/// A value and its derivatives in N directions. With [`super::Bounded`] as S, each has an error bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<const N: usize, S = f64> {
    /// The value.
    pub real: S,
    /// Its derivative in each direction.
    pub slope: [S; N],
}

impl<const N: usize, S: Scalar> Dual<N, S> {
    /// The variable of direction `k`, or a constant if `k` is not below N.
    pub fn variable(real: S, k: usize) -> Self {
        Self { real, slope: from_fn(|i| S::from(f64::from(u8::from(i == k)))) }
    }

    /// Chain rule: `f(self)`, from f and f' at its value.
    fn chain(self, f: S, slope: S) -> Self {
        Self { real: f, slope: self.slope.map(|s| slope * s) }
    }
}

impl<const N: usize, S: Scalar> From<f64> for Dual<N, S> {
    fn from(real: f64) -> Self {
        Self { real: S::from(real), slope: [S::from(0.0); N] }
    }
}

impl<const N: usize, S: Scalar> Add for Dual<N, S> {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        Self { real: self.real + b.real, slope: from_fn(|k| self.slope[k] + b.slope[k]) }
    }
}

impl<const N: usize, S: Scalar> Sub for Dual<N, S> {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        Self { real: self.real - b.real, slope: from_fn(|k| self.slope[k] - b.slope[k]) }
    }
}

impl<const N: usize, S: Scalar> Mul for Dual<N, S> {
    type Output = Self;
    #[allow(clippy::suspicious_arithmetic_impl, reason = "the rule of products and quotients")]
    fn mul(self, b: Self) -> Self {
        Self { real: self.real * b.real, slope: from_fn(|k| self.real * b.slope[k] + self.slope[k] * b.real) }
    }
}

impl<const N: usize, S: Scalar> Div for Dual<N, S> {
    type Output = Self;
    #[allow(clippy::suspicious_arithmetic_impl, reason = "the rule of products and quotients")]
    fn div(self, b: Self) -> Self {
        let real = self.real / b.real;
        Self { real, slope: from_fn(|k| (self.slope[k] - real * b.slope[k]) / b.real) }
    }
}

impl<const N: usize, S: Scalar> Neg for Dual<N, S> {
    type Output = Self;
    fn neg(self) -> Self {
        Self { real: -self.real, slope: self.slope.map(|s| -s) }
    }
}

impl<const N: usize, S: Scalar> Scalar for Dual<N, S> {
    fn real(self) -> f64 {
        self.real.real()
    }
    fn sqrt(self) -> Self {
        let root = self.real.sqrt();
        self.chain(root, S::from(0.5) / root)
    }
    fn sin(self) -> Self {
        self.chain(self.real.sin(), self.real.cos())
    }
    fn cos(self) -> Self {
        self.chain(self.real.cos(), -self.real.sin())
    }
    fn map(self, f: impl Univariate) -> Self {
        let of = f.at(Dual::<1, S>::variable(self.real, 0));
        self.chain(of.real, of.slope[0])
    }
}
