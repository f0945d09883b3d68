//! Which equations depend on which, which contradict, which DOFs they fix, and how sure all of that is.

pub mod analysis;
pub mod certificate;
pub mod classify;
pub mod confidence;
pub mod exact;
pub mod generated;
pub mod meant;
pub mod samples;
pub mod sensitivity;
pub mod wanted;
