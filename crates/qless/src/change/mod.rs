//! After the first analysis: other right-hand sides, other equations.

pub(crate) mod changing;
pub(crate) mod refresh;

pub use changing::{ChangeError, ChangingSystem, EquationId, SolvedBlock};
pub use refresh::{RefreshError, Refreshed, Refresher};
