//! Checks that every input must pass, whatever its bytes: a reader returns, and what it accepts is a valid system.
//!
//! An input is one or more files: a line `=== NAME` starts the next one. The tests run these checks over the kept inputs, and
//! libFuzzer over new ones.

mod api;
mod case;
mod deck;
mod files;
mod folder;

pub use api::api;
pub use case::case;
pub use deck::{ansys, calculix, nastran};
pub use folder::folder;
