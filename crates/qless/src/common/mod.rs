//! What every stage uses.

pub mod pool;
pub mod prefetch;
pub mod random;
