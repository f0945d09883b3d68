//! CalculiX and Abaqus decks, `.inp`.
//!
//! The deck is gone through twice: first for what it defines (nodes, sets, surfaces, elements), then, in order, for what
//! constrains. Equations are homogeneous and their first term is the slave; every step is a load case.

mod boundary;
mod card;
mod data;
mod definitions;
mod equation;
mod fields;
mod reader;
mod write;

pub(super) use reader::read;
pub(super) use write::write;
