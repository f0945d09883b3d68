//! The source keeps its structure: no import circles, folders that import in the direction that ARCHITECTURE.md states, type names that
//! mean one thing, and files that hold a whole idea.
//!
//! Imports are read from the syntax tree (`use` items and paths that start with `crate`, `self` or `super`); tests inside of source files
//! do not count.

mod structure {
    mod circles;
    mod imports;
    mod layers;
    mod sizes;
}
