//! The checks of `tests/fuzz`, run by libFuzzer on inputs of its own.

#[path = "../../tests/fuzz/mod.rs"]
mod checks;

pub use checks::{ansys, api, calculix, case, folder, lsdyna, nastran, radioss, relations};
