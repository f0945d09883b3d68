//! CalculiX and Abaqus decks, `.inp`.
//!
//! The deck is gone through twice: first for what it defines (nodes, sets, surfaces, elements), then, in order, for what
//! constrains. Equations are homogeneous and their first term is the slave; every step is a load case.

mod boundary;
mod card;
mod coupling;
mod cyclic;
mod data;
mod definitions;
mod equation;
mod fields;
mod frames;
mod geometric;
mod instances;
mod mesh;
mod mpc;
mod old_coupling;
mod parts;
mod project;
mod reader;
mod rigid;
mod sets;
mod shape;
mod tie;
mod unread;
mod write;

pub(super) use reader::read;
pub(super) use write::{node_set, node_set_names, positions, write};
