//! What needs no factorization at all: most equations of real models.
//!
//! [`peel`] takes column singletons without touching a coefficient; [`eliminate`] takes what else can go
//! with little fill. The rest is the core, for the backend.

pub(crate) mod basis;
pub(crate) mod eliminate;
pub(crate) mod eliminated;
pub(crate) mod gather;
pub(crate) mod peel;
pub(crate) mod rows;
