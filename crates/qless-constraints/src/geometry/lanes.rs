//! Eight numbers side by side: the same operations for eight constraints, in as few instructions as the processor has them in.

#![expect(clippy::inline_always, reason = "in functions with wider instructions nothing else gets them")]

use std::ops::{Add, Mul, Neg, Sub};

/// Numbers side by side.
pub const LANES: usize = 8;

/// One number of each of eight constraints.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lanes(pub [f64; LANES]);

impl From<f64> for Lanes {
    #[inline(always)]
    fn from(x: f64) -> Self {
        Self([x; LANES])
    }
}

impl Add for Lanes {
    type Output = Self;
    #[inline(always)]
    fn add(mut self, other: Self) -> Self {
        (0..LANES).for_each(|k| self.0[k] += other.0[k]);
        self
    }
}

impl Sub for Lanes {
    type Output = Self;
    #[inline(always)]
    fn sub(mut self, other: Self) -> Self {
        (0..LANES).for_each(|k| self.0[k] -= other.0[k]);
        self
    }
}

impl Mul for Lanes {
    type Output = Self;
    #[inline(always)]
    fn mul(mut self, other: Self) -> Self {
        (0..LANES).for_each(|k| self.0[k] *= other.0[k]);
        self
    }
}

impl Neg for Lanes {
    type Output = Self;
    #[inline(always)]
    fn neg(mut self) -> Self {
        (0..LANES).for_each(|k| self.0[k] = -self.0[k]);
        self
    }
}
