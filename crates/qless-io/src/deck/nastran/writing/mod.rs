//! A deck with other constraints.

pub mod select;
pub mod target;
pub mod wide;
pub mod write;
