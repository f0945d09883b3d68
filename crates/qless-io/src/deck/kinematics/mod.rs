//! Equations of points that move together, for decks of all formats: coordinate frames, rigid elements, rods, weighted means and ties to
//! faces.

pub mod axes;
pub mod body;
pub mod components;
mod dense;
pub mod mean;
pub mod mystran_mean;
pub mod project;
pub mod rigid;
pub mod vector;
