//! Lines as commands, and commands as fields.

pub mod archive;
pub mod array;
pub mod command;
pub mod control;
pub mod expression;
pub mod field;
pub mod format;
pub mod known;
pub mod label;
pub mod parameters;
