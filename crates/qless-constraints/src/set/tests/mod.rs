//! Derivatives of every type against dual numbers and differences, rounding bounds against double-double arithmetic, linear equations,
//! and independence of the number of threads.

mod derivatives;
mod every_type;
mod linear;
mod rounding;
mod threads;
