//! From cards to a model: points and their axes, ties as equations, load cases.

pub mod build;
pub mod cases;
pub mod exclusive;
pub mod frames;
pub mod grids;
pub mod points;
pub mod positions;
pub mod ties;
pub mod warnings;
