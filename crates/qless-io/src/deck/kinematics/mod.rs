//! Equations for points that move together: frames, rigid bodies, rods and weighted means, for decks of all formats.

pub mod axes;
pub mod body;
pub mod components;
mod dense;
pub mod mean;
pub mod rigid;
pub mod rod;
pub mod row;
pub mod vector;
