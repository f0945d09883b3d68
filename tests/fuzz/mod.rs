//! Checks for arbitrary input: a reader returns, and every accepted input is a valid system.
//!
//! An input is one or more files; a line `=== NAME` starts the next file. The tests run these checks on the kept inputs, libFuzzer
//! on new ones.

mod api;
mod case;
mod deck;
mod files;
mod folder;
mod relations;

pub use api::api;
pub use case::case;
pub use deck::{ansys, calculix, lsdyna, nastran, radioss};
pub use folder::folder;
pub use relations::relations;
