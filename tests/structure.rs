//! The structure of the source: no import circles, imports in the direction that ARCHITECTURE.md states, few type names that are defined
//! twice, and few short files.
//!
//! Imports are read from the syntax tree (`use` items and paths that start with `crate`, `self` or `super`), without tests inside source
//! files.

mod structure {
    mod circles;
    mod imports;
    mod layers;
    mod sizes;
}
