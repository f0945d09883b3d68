//! Numbers that a constraint can be evaluated in: `f64`, or one that carries derivatives or a bound on its rounding along.

mod bounded;
mod dual;
mod hyper;
pub mod vector;

use std::ops::{Add, Div, Mul, Neg, Sub};

pub use bounded::Bounded;
pub use dual::Dual;
pub use hyper::HyperDual;

/// What sums and products are made of: a number, with or without derivatives, or several side by side.
pub trait Arithmetic:
    Copy + From<f64> + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
}

impl<S> Arithmetic for S where
    S: Copy + From<f64> + Add<Output = S> + Sub<Output = S> + Mul<Output = S> + Neg<Output = S>
{
}

/// A real number, with or without derivatives and bounds.
///
/// A constraint whose value is written for every `Scalar` gets its Jacobian and Hessian without a second formula, exact to
/// rounding: `f(x + e) = f(x) + f'(x) e` where `e^2 = 0`.
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
    /// The number without its derivatives; branches may depend on it.
    fn real(self) -> f64;
    /// Square root, of a positive number.
    #[must_use]
    fn sqrt(self) -> Self;
    /// Sine.
    #[must_use]
    fn sin(self) -> Self;
    /// Cosine.
    #[must_use]
    fn cos(self) -> Self;
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
}
