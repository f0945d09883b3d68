//! Elimination without a factorization; it handles most equations of real models.
//!
//! [`peel`] removes equations with a DOF that occurs in no other equation, without changing a coefficient. [`eliminate`] removes further
//! equations that cause little fill. The remaining equations are the core, which the backend factors.

pub(crate) mod basis;
pub(crate) mod eliminate;
pub(crate) mod eliminated;
pub(crate) mod gather;
pub(crate) mod peel;
pub(crate) mod rows;
