//! Equations of points that move together: coordinate frames, rigid elements, rods, weighted means and ties to faces, for
//! decks of all formats.

pub mod axes;
pub mod body;
pub mod components;
mod dense;
pub mod mean;
pub mod project;
pub mod rigid;
pub mod vector;
