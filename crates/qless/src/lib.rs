//! Constraints `C u = b` that a finite-element solver can trust.

pub mod qr;
mod system;

pub use system::{ConstraintSystem, Csr, Place, SystemBuilder, SystemError};
