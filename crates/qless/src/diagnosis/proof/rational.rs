//! `c = ± p / q 2^k`: the fraction with a small denominator that a coefficient of a certificate stands for.

use crate::input::reading::Number;
use crate::input::scale::{exponent, ldexp};

/// A coefficient of a certificate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rational {
    /// The numerator `± p 2^k`.
    pub numerator: Number,
    /// The denominator q.
    pub denominator: u64,
}

/// Largest denominator. Fractions with such denominators differ by `2^-44` or more, and certificates are accurate to that.
const MOST: u64 = 1 << 22;
const NEAR: f64 = 1.0 / (1_u64 << 44) as f64;

impl Rational {
    /// The first convergent of the continued fraction of `c / 2^k`, a number between 1 and 2, that is within [`NEAR`]. It is a guess, and
    /// every result from it is verified exactly.
    pub fn near(c: f64) -> Option<Self> {
        if !c.is_normal() {
            return None;
        }
        let power = exponent(c);
        let x = ldexp(c.abs(), -power);
        let (mut p, mut q, mut rest) = ([1, x.floor() as u64], [0, 1], x - x.floor());
        loop {
            if (x - p[1] as f64 / q[1] as f64).abs() <= NEAR {
                let numerator = Number { negative: c < 0.0, digits: p[1], decimal: false, exponent: power };
                return Some(Self { numerator, denominator: q[1] });
            }
            if rest < 1e-12 {
                return None;
            }
            let whole = (1.0 / rest).floor();
            rest = 1.0 / rest - whole;
            (p, q) = ([p[1], p[0] + whole as u64 * p[1]], [q[1], q[0] + whole as u64 * q[1]]);
            if whole > MOST as f64 || q[1] > MOST {
                return None;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::common::random::randoms;

    #[test]
    fn quotients_of_whole_numbers_come_back() {
        let mut random = randoms(9).map(|x| 1 + ((x - 0.5) * 2000.0) as u64);
        for power in [-300, -20, 0, 3, 300] {
            for _ in 0..500 {
                let (p, q) = (random.next().expect("endless"), random.next().expect("endless"));
                let c = -ldexp(p as f64 / q as f64, power);
                let found = Rational::near(c).expect("a small fraction");
                let value = ldexp(found.numerator.digits as f64 / found.denominator as f64, found.numerator.exponent);
                assert!(found.numerator.negative && (value + c).abs() <= f64::EPSILON * value, "{p}/{q}: {found:?}");
                assert!(found.denominator <= 2 * q.max(p));
            }
        }
        assert_eq!(Rational::near(0.0), None);
    }
}
