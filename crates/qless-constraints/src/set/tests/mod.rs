//! Derivatives of every type, against dual numbers and against differences; bounds on their rounding, against numbers of twice the
//! digits; linear equations; sums that do not depend on the threads.

pub(crate) mod compare;
mod derivatives;
mod every_type;
mod linear;
mod rounding;
mod threads;
