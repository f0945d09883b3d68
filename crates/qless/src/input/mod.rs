//! Turns the user's equations into scaled ones over the DOFs that occur, and finds their connected components.

pub mod components;
pub mod incidence;
pub mod noise;
pub mod numbering;
pub mod preferences;
pub mod reading;
pub mod scale;
pub mod system;
