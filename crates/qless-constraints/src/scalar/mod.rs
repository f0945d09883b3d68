//! Numbers that constraints can be evaluated in: `f64`, dual numbers for derivatives, and numbers with error bounds.

mod bounded;
#[cfg(test)]
pub(crate) mod double_double;
mod dual;
pub mod vector;

use std::ops::{Add, Div, Mul, Neg, Sub};

pub use bounded::Bounded;
pub use dual::Dual;

/// Relative rounding of a sum of a few terms: eight units in the last place. A sum that is at most this share of its absolute terms counts
/// as zero.
pub(crate) const SUM_ROUNDING: f64 = 8.0 * f64::EPSILON;
/// Half of the digits of a double. A sum smaller than this share of its absolute terms has lost more digits than it kept, so that it is not
/// relied on.
pub(crate) const HALF_DIGITS: f64 = 1e-8;
/// A length, area or volume that is smaller than this share of the geometry's size counts as zero: four digits above the rounding of
/// coordinates.
pub(crate) const NO_EXTENT: f64 = 1e-12;

/// Sets factors to zero that are at most `blur` times eight units in the last place of the largest factor. NaN stays.
pub(crate) fn clean<'a>(factors: impl Iterator<Item = &'a mut f64>, blur: f64) {
    let mut factors: Vec<&mut f64> = factors.collect();
    let largest = factors.iter().fold(0.0, |most: f64, factor| most.max(factor.abs()));
    factors.iter_mut().filter(|factor| factor.abs() <= SUM_ROUNDING * blur * largest).for_each(|factor| **factor = 0.0);
}

/// Corrects the largest factor, unless it is zero, so that all factors add up to `sum`.
pub(crate) fn complete<'a>(factors: impl Iterator<Item = &'a mut f64>, sum: f64) {
    let factors: Vec<&mut f64> = factors.collect();
    let missing = sum - factors.iter().map(|a| **a).sum::<f64>();
    let largest = factors.into_iter().max_by(|a, b| a.abs().total_cmp(&b.abs()));
    largest.into_iter().filter(|a| **a != 0.0).for_each(|a| *a += missing);
}

/// Numbers with sums and products: scalars, with or without derivatives. A type need not have quotients.
pub trait Arithmetic:
    Copy + From<f64> + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
}

impl<S> Arithmetic for S where
    S: Copy + From<f64> + Add<Output = S> + Sub<Output = S> + Mul<Output = S> + Neg<Output = S>
{
}

/// A smooth function of one number, written for any scalar.
///
/// ```
/// use qless_constraints::scalar::{Dual, Scalar, Univariate};
/// #[derive(Clone, Copy)]
/// struct Damping {
///     rate: f64,
/// }
/// impl Univariate for Damping {
///     /// `rate sin(x) / x`
///     fn at<S: Scalar>(self, x: S) -> S {
///         S::from(self.rate) * x.sin() / x
///     }
/// }
/// // The derivative of 3 sin(x) / x at x = 2 is 3 (2 cos(2) - sin(2)) / 4.
/// let x = Dual::<1>::variable(2.0, 0);
/// let slope = x.map(Damping { rate: 3.0 }).slope[0];
/// assert!((slope - 0.75 * (2.0 * 2.0_f64.cos() - 2.0_f64.sin())).abs() < 1e-15);
/// ```
pub trait Univariate: Copy {
    /// The function at x.
    fn at<S: Scalar>(self, x: S) -> S;
}

/// A real number, with or without derivatives and error bounds.
///
/// If the value of a constraint is written for any `Scalar`, dual numbers give its Jacobian and Hessian exact to rounding:
/// `f(x + e) = f(x) + f'(x) e` with `e^2 = 0`.
///
/// ```
/// use qless_constraints::scalar::{Dual, Scalar};
/// fn cube<S: Scalar>(x: S) -> S {
///     x * x * x
/// }
/// assert_eq!(cube(2.0), 8.0);
/// assert_eq!(cube(Dual::<1>::variable(2.0, 0)).slope, [12.0]);
/// ```
pub trait Scalar: Arithmetic + Div<Output = Self> {
    /// The number without derivatives and error bounds. Code may branch on it, since a branch needs a plain number.
    fn real(self) -> f64;
    /// Square root of a positive number.
    #[must_use]
    fn sqrt(self) -> Self;
    /// Sine.
    #[must_use]
    fn sin(self) -> Self;
    /// Cosine.
    #[must_use]
    fn cos(self) -> Self;
    /// `f(self)`. Dual numbers evaluate f with one derivative and apply the chain rule, which costs less than f with all derivatives.
    #[must_use]
    fn map(self, f: impl Univariate) -> Self {
        f.at(self)
    }
    /// The angle of the point `(x, self)`, in (-pi, pi].
    ///
    /// The result is `h + rest`: h is the angle computed in `f64`, and `rest = tan(angle - h)` is of the size of rounding, but has the
    /// derivatives of the angle.
    #[must_use]
    fn atan2(self, x: Self) -> Self {
        let h = self.real().atan2(x.real());
        let (sin, cos) = (Self::from(h).sin(), Self::from(h).cos());
        let rest = (self * cos - x * sin) / (x * cos + self * sin);
        Self::from(h) + rest
    }
}

impl Scalar for f64 {
    fn real(self) -> f64 {
        self
    }
    fn sqrt(self) -> Self {
        self.sqrt()
    }
    fn sin(self) -> Self {
        self.sin()
    }
    fn cos(self) -> Self {
        self.cos()
    }
    fn atan2(self, x: Self) -> Self {
        self.atan2(x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `atan2(y, x)` has the slopes `x / r^2` and `-y / r^2`, and the mixed curvature `(y^2 - x^2) / r^4`, in every quadrant.
    #[test]
    fn angles_have_their_derivatives() {
        for (y, x) in [(0.3_f64, 2.0_f64), (5.0, -0.1), (-1.0, 1.5), (-0.2, -3.0), (1e-9, 1.0)] {
            let square = x * x + y * y;
            let found = Dual::<2>::variable(y, 0).atan2(Dual::variable(x, 1));
            assert!((found.real - y.atan2(x)).abs() < 1e-15);
            assert!((found.slope[0] - x / square).abs() < 1e-15 && (found.slope[1] + y / square).abs() < 1e-15);
            let [upright, along] = [(y, 0), (x, 1)].map(|(v, k)| Dual::<2, Dual<2>>::variable(Dual::variable(v, k), k));
            let (truth, mixed) = ((y * y - x * x) / (square * square), upright.atan2(along).slope[0].slope[1]);
            assert!((mixed - truth).abs() < 1e-14 * truth.abs());
        }
    }
}
