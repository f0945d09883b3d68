//! Lines as keyword cards, their parameters, data lines and fields.

pub mod assembly;
pub mod card;
pub mod data;
pub mod walk;
