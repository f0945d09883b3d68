//! Small helpers for all stages and for crates built on this one.

pub(crate) mod argument;
mod disjoint_sets;
pub(crate) mod identity;
pub(crate) mod pool;
pub(crate) mod prefetch;
pub(crate) mod random;

pub use disjoint_sets::DisjointSets;
pub use identity::Identity;
pub use random::SplitMix64;

/// The rounded sum, and its error (Knuth).
pub(crate) fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}
