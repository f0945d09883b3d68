//! Derivatives of every type against dual numbers and differences, rounding bounds against double-double arithmetic, linear equations,
//! and independence of the number of threads.

pub(crate) mod compare;
mod derivatives;
mod every_type;
mod linear;
mod rounding;
mod threads;
