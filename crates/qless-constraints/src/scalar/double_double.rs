//! Double-double arithmetic, `hi + lo` with 106 bits, as a reference for rounding bounds (Dekker, Knuth).

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::Scalar;

#[derive(Clone, Copy, Debug)]
pub struct DoubleDouble {
    pub hi: f64,
    pub lo: f64,
}

/// 2 pi, to 106 bits.
const TURN: DoubleDouble = DoubleDouble { hi: std::f64::consts::TAU, lo: 2.449_293_598_294_706_4e-16 };

impl DoubleDouble {
    /// `a + b` with its exact rounding error.
    pub fn sum(a: f64, b: f64) -> Self {
        let hi = a + b;
        let of_b = hi - a;
        Self { hi, lo: (a - (hi - of_b)) + (b - of_b) }
    }

    /// Distance from a double.
    pub fn distance(self, x: f64) -> f64 {
        ((x - self.hi) - self.lo).abs()
    }

    /// `sum_k (-1)^k x^(2k + first) / (2k + first)!`, after x is reduced by multiples of 2 pi.
    fn series(self, first: u32) -> Self {
        let turns = (self.hi / TURN.hi).round();
        let x = self - Self::from(turns) * TURN;
        let square = x * x;
        let (mut sum, one) = (Self::from(0.0), Self::from(1.0));
        for k in (0..22_u32).rev() {
            let n = f64::from(2 * k + first);
            let factor = Self::from((n + 1.0) * (n + 2.0));
            sum = one - square * sum / factor;
        }
        if first == 0 { sum } else { x * sum }
    }
}

impl From<f64> for DoubleDouble {
    fn from(hi: f64) -> Self {
        Self { hi, lo: 0.0 }
    }
}

impl Add for DoubleDouble {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        let (high, low) = (Self::sum(self.hi, b.hi), Self::sum(self.lo, b.lo));
        let once = Self::sum(high.hi, high.lo + low.hi);
        Self::sum(once.hi, once.lo + low.lo)
    }
}

impl Neg for DoubleDouble {
    type Output = Self;
    fn neg(self) -> Self {
        Self { hi: -self.hi, lo: -self.lo }
    }
}

impl Sub for DoubleDouble {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        self + -b
    }
}

impl Mul for DoubleDouble {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        let hi = self.hi * b.hi;
        Self::sum(hi, self.hi.mul_add(b.hi, -hi) + (self.hi * b.lo + self.lo * b.hi))
    }
}

impl Div for DoubleDouble {
    type Output = Self;
    fn div(self, b: Self) -> Self {
        let first = self.hi / b.hi;
        let rest = self - b * Self::from(first);
        let second = rest.hi / b.hi;
        let rest = rest - b * Self::from(second);
        Self::sum(first, second) + Self::from(rest.hi / b.hi)
    }
}

impl Scalar for DoubleDouble {
    fn real(self) -> f64 {
        self.hi
    }
    fn sqrt(self) -> Self {
        let root = Self::from(self.hi.sqrt());
        if root.hi == 0.0 {
            return root;
        }
        // One step of Newton's method doubles the digits.
        (root + self / root) * Self::from(0.5)
    }
    fn sin(self) -> Self {
        self.series(1)
    }
    fn cos(self) -> Self {
        self.series(0)
    }
}

#[test]
fn it_has_twice_the_digits() {
    let third = DoubleDouble::from(1.0) / DoubleDouble::from(3.0);
    assert!((third * DoubleDouble::from(3.0)).distance(1.0) < 1e-31);
    for x in [0.3, 1.7, 3.1, 6.3, -40.0] {
        let x = DoubleDouble::from(x);
        let (sin, cos) = (x.sin(), x.cos());
        assert!((sin * sin + cos * cos).distance(1.0) < 1e-30);
        assert!(sin.distance(x.hi.sin()) < 2e-16 && cos.distance(x.hi.cos()) < 2e-16);
        let root = (x * x).sqrt();
        assert!((root * root - x * x).hi.abs() < 1e-30 * x.hi * x.hi);
    }
}
