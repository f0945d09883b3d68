//! What every stage uses.

pub mod argument;
pub mod identity;
pub mod pool;
pub mod prefetch;
pub mod random;
