//! After the first analysis: other right-hand sides, other equations.

pub mod changing;
pub mod refresh;
