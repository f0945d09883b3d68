//! Which equations depend on which, which contradict, which DOFs they fix, and how sure all of that is.

pub(crate) mod analysis;
pub(crate) mod certificate;
pub(crate) mod classify;
pub(crate) mod confidence;
pub mod exact;
pub(crate) mod generated;
pub(crate) mod meant;
pub(crate) mod samples;
pub(crate) mod sensitivity;
pub(crate) mod wanted;

pub use crate::input::rounding::Ignored;
pub use analysis::{PresolveStatistics, Timings};
pub use meant::NearDependent;
