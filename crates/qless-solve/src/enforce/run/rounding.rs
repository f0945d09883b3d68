//! What rounding does to each kind of DOFs ([`super::super::kinds`]).
//!
//! ```text
//! y = M^-1 (r (|b - A x| + e (|A| |x| + |b|)))        random r in +-[1/2, 1], e the share by which terms are wrong
//! ```
//!
//! DOFs that can be compared are as wrong as the growth of rounding says of the largest of them, or as y, if that is more: the growth is that of all
//! unknowns together by the worst x, and where multipliers are far larger than u, in units without units, their rounding is a larger share of u.
//! A number of a kind of its own may be far smaller or larger than others in any unit, and is as wrong as the largest of some y. Cost: a solve, and a few
//! more where there are such kinds. What is left of the equations is seen here however lightly it was taken.

use super::super::equations::{Equations, Settled};
use super::super::support::{Random, WRONG};
use super::Prepared;

/// Solves with errors at random.
const TRIALS: usize = 3;
/// What the largest of few may be short of the largest of all.
const SAFETY: f64 = 2.0;

/// Of one solution.
pub struct Rounding {
    /// The share of the largest number, by the growth of rounding.
    pub share: f64,
    /// The largest error of each kind, in units without units.
    pub of_kinds: Vec<f64>,
}

impl Prepared<'_> {
    /// What rounding does to a solution, where it grows so much; none where that is not to be had.
    pub fn rounding(&mut self, settled: &Settled, growth: f64) -> Option<Rounding> {
        let share = settled.rounding.max(WRONG) * growth;
        let mut of_kinds: Vec<f64> = self.sizes_and_loads(&settled.x).into_iter().map(|size| share * size).collect();
        of_kinds[1..].fill(0.0);
        for errors in self.errors(&settled.x) {
            let moved = self.inverse.solve(&errors).ok()?;
            of_kinds.iter_mut().zip(self.sizes(&moved)).for_each(|(most, moved)| *most = most.max(moved));
        }
        Some(Rounding { share, of_kinds })
    }

    /// What is left of the equations and what may be wrong in their terms, at random; where there are many kinds more of the latter.
    fn errors(&self, x: &[f64]) -> Vec<Vec<f64>> {
        let pairs = |ax: Vec<f64>, b: &[f64]| ax.into_iter().zip(b.to_vec());
        let (b, b_sizes) = (&self.part.rhs.0, &self.part.rhs.1);
        let left: Vec<f64> = pairs(self.model.apply(x), b).map(|(ax, b)| b - ax).collect();
        let sizes: Vec<f64> = pairs(self.model.size(x), b_sizes).map(|(ax, b)| WRONG * (ax + b)).collect();
        let mut random = Random::default();
        let both = left.iter().zip(&sizes).map(|(left, size)| random.next() * (left.abs() + size)).collect();
        let mut all = vec![both];
        if self.model.kinds().are_many() {
            all.push(left);
            all.extend((0..TRIALS).map(|_| sizes.iter().map(|size| random.next() * SAFETY * size).collect()));
        }
        all
    }
}
