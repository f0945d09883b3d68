//! What presolve leaves: factored block by block, by any backend, and by sparse LU where slaves are wanted.

pub(crate) mod block;
pub(crate) mod lu;
pub mod qr;
pub(crate) mod solver;
