//! What other cards refer to: nodes, sets, surfaces, parts and instances, axes, faces.

pub mod definitions;
pub mod elements;
pub mod frames;
pub mod instances;
pub mod mesh;
pub mod project;
pub mod sets;
pub mod text;
