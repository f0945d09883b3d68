//! Derivatives of every type, against dual numbers and against differences; bounds on their rounding, against numbers of twice the
//! digits; linear equations; sums that do not depend on the threads.

pub(super) mod compare;
mod derivatives;
pub(super) mod double_double;
mod every_type;
mod linear;
mod rounding;
mod threads;
