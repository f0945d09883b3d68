//! Factors the equations that remain after presolve: block by block with any backend, and by sparse LU if slaves are needed.

pub mod backend;
pub(crate) mod block;
pub(crate) mod lu;
pub(crate) mod solver;
