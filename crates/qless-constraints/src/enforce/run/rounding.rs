//! What rounding of this solution leaves of u.
//!
//! ```text
//! e = A^-1 (r (|b - A x| + w (|A| |x| + |b|)))        random r in +-[1/2, 1], w the share by which numbers are wrong
//! ```
//!
//! The growth of [`super::super::support`] is that of the unknowns together, multipliers among them, by the worst x. Where multipliers are far
//! larger than u in units without units, their rounding is a larger share of u; and a row that is held against others has more left than its
//! own terms say. Cost: a solve.

use super::super::equations::Equations;
use super::super::support::{Random, WRONG};
use super::Prepared;

impl Prepared<'_> {
    /// `|e| / |u|` of the kind that feels most of it; zero where there is nothing to measure it by.
    pub fn rounding_of(&mut self, x: &[f64], noise: f64) -> f64 {
        let (left, size) = (self.model.apply(x), self.model.size(x));
        let mut random = Random::default();
        let (b, b_size) = (&self.part.rhs.0, &self.part.rhs.1);
        let wrong = |i: usize| random.next() * ((b[i] - left[i]).abs() + WRONG * (size[i] + b_size[i]));
        let wrong: Vec<f64> = (0..x.len()).map(wrong).collect();
        let Ok(e) = self.inverse.solve(&wrong) else { return f64::INFINITY };
        self.share_of(&e, x, noise)
    }
}
