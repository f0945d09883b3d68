//! How points move together: positions, axes, rigid bodies and weighted means as equations, whatever the deck's language.

pub mod axes;
pub mod body;
pub mod components;
mod dense;
pub mod mean;
pub mod rigid;
pub mod rod;
pub mod row;
pub mod vector;
