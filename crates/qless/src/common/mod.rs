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
