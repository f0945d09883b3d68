//! Equations of points that move together: coordinate frames, rigid elements, rods and weighted means, for decks of all
//! formats.

pub mod axes;
pub mod body;
pub mod components;
mod dense;
pub mod mean;
pub mod rigid;
pub mod vector;
