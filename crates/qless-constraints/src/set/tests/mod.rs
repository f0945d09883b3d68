//! Derivatives of every type, against dual numbers and against differences; linear equations; sums that do not depend on the threads.

pub(super) mod compare;
mod derivatives;
mod every_type;
mod linear;
mod threads;
