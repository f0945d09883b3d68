//! `a + a_1 e_1 + a_2 e_2 + a_12 e_1 e_2` with `e_1^2 = e_2^2 = 0`: one mixed second derivative, exact to rounding.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::Scalar;

/// A value, its derivatives in two directions and the mixed second derivative.
///
/// ```
/// use qless_constraints::scalar::HyperDual;
/// let x = HyperDual { real: 2.0, first: 1.0, second: 1.0, mixed: 0.0 };
/// assert_eq!((x * x * x).mixed, 12.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HyperDual {
    /// The value.
    pub real: f64,
    /// Its derivative in the first direction.
    pub first: f64,
    /// Its derivative in the second direction.
    pub second: f64,
    /// Its derivative in both directions.
    pub mixed: f64,
}

impl HyperDual {
    /// Chain rule: `f(self)`, from f, f' and f'' at its value.
    fn chain(self, f: f64, slope: f64, curvature: f64) -> Self {
        Self {
            real: f,
            first: slope * self.first,
            second: slope * self.second,
            mixed: slope * self.mixed + curvature * self.first * self.second,
        }
    }
}

impl From<f64> for HyperDual {
    fn from(real: f64) -> Self {
        Self { real, first: 0.0, second: 0.0, mixed: 0.0 }
    }
}

impl Add for HyperDual {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        Self {
            real: self.real + b.real,
            first: self.first + b.first,
            second: self.second + b.second,
            mixed: self.mixed + b.mixed,
        }
    }
}

impl Sub for HyperDual {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        self + -b
    }
}

impl Mul for HyperDual {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        Self {
            real: self.real * b.real,
            first: self.real * b.first + self.first * b.real,
            second: self.real * b.second + self.second * b.real,
            mixed: self.real * b.mixed + self.first * b.second + self.second * b.first + self.mixed * b.real,
        }
    }
}

impl Div for HyperDual {
    type Output = Self;
    #[allow(clippy::suspicious_arithmetic_impl, reason = "a / b = a (1 / b)")]
    fn div(self, b: Self) -> Self {
        let inverse = 1.0 / b.real;
        self * b.chain(inverse, -inverse * inverse, 2.0 * inverse * inverse * inverse)
    }
}

impl Neg for HyperDual {
    type Output = Self;
    fn neg(self) -> Self {
        self.chain(-self.real, -1.0, 0.0)
    }
}

impl Scalar for HyperDual {
    fn real(self) -> f64 {
        self.real
    }
    fn sqrt(self) -> Self {
        let root = self.real.sqrt();
        self.chain(root, 0.5 / root, -0.25 / (root * self.real))
    }
    fn sin(self) -> Self {
        let (sin, cos) = self.real.sin_cos();
        self.chain(sin, cos, -sin)
    }
    fn cos(self) -> Self {
        let (sin, cos) = self.real.sin_cos();
        self.chain(cos, -sin, -cos)
    }
}
