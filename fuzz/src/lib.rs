//! What every input must pass, whatever its bytes: the reader returns, and what it accepts is a system.
//!
//! An input is one or more files: a line `=== NAME` starts the next one. The same functions run under libFuzzer and, over the
//! kept corpus, in the tests of `qless-io`.

mod case;
mod deck;
mod files;
mod folder;

pub use case::case;
pub use deck::{ansys, calculix, nastran};
pub use folder::folder;
