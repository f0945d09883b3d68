//! What presolve leaves: factored block by block, by any backend, and by sparse LU where slaves are wanted.

pub mod backend;
pub(crate) mod block;
pub(crate) mod lu;
pub(crate) mod solver;
