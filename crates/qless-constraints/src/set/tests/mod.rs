//! Tests of a set: derivatives of every type are compared with dual numbers and differences, rounding bounds with double-double arithmetic,
//! linear equations with direct sums, and results of different numbers of threads with each other.

mod derivatives;
mod every_type;
mod linear;
mod rounding;
mod threads;
