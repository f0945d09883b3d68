//! What each card of bulk data says.

pub mod bulk;
pub mod coordinates;
pub mod elements;
pub mod exclusive;
pub mod grid;
pub mod joints;
pub mod loads;
pub mod mpc;
pub mod mystran;
pub mod notes;
pub mod quick;
pub mod sets;
pub mod spans;
pub mod supports;
pub mod unknown;
pub mod unread;
