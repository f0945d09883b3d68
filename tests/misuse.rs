//! Wrong arguments to every public function of the libraries give a typed error or the documented result, and no panic.
//!
//! Arguments are empty, of another object, too short, too long, NaN, huge or repeated. One module for each crate or part of a crate.

#[path = "misuse/constraints.rs"]
mod constraints;
#[path = "misuse/factors.rs"]
mod factors;
#[path = "misuse/files.rs"]
mod files;
#[path = "misuse/library.rs"]
mod library;
#[path = "misuse/scenes.rs"]
mod scenes;
#[path = "misuse/system.rs"]
mod system;

use std::panic::{AssertUnwindSafe, catch_unwind};

/// Lists of wrong lengths.
const BAD: [f64; 3] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

/// Indices and sizes that are too large.
const HUGE: [usize; 3] = [1 << 32, usize::MAX - 1, usize::MAX];

/// Calls a function; a panic fails the test with the name of the call.
fn survives<T>(what: &str, call: impl FnOnce() -> T) -> T {
    catch_unwind(AssertUnwindSafe(call)).unwrap_or_else(|_| panic!("{what} panicked"))
}

/// Calls a function, which must return an error with a message.
fn refused<T, E: std::error::Error>(what: &str, call: impl FnOnce() -> Result<T, E>) -> E {
    match survives(what, call) {
        Ok(_) => panic!("{what} was accepted"),
        Err(error) => {
            assert!(!error.to_string().is_empty(), "{what}: an error without a message");
            error
        }
    }
}

/// A ring of ties of n DOFs, one of them redundant.
fn ring(n: usize) -> qless::ConstraintSystem {
    qless_scenes::families::cycle(n, 0.0).expect("a ring").system
}
