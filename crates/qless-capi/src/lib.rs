//! `libqless`: the library for C, C++ and Fortran, declared in `include/qless.h`.
//!
//! ```text
//! arrays (starts, columns, values, b)  -> qless_analyse    -> qless_analysis      rank, kinds, explanations, digits
//! qless_analysis                       -> qless_eliminate  -> qless_elimination   slaves, T, G, g, expand, restrict, multipliers
//! ```
//!
//! Every function returns a status. Handles are numbers of a table, not addresses: a null, freed or foreign handle is an error, not
//! undefined behaviour. Input is copied; output goes to arrays of the caller, whose lengths are arguments and are checked. No panic crosses
//! the language boundary. A handle may be used by several threads at once.
#![expect(unsafe_code, reason = "arrays of C come as addresses and lengths; `arrays` turns them into slices")]

mod analysis;
mod arrays;
mod elimination;
mod handles;
mod options;
mod status;

pub use analysis::*;
pub use elimination::*;
pub use handles::{qless_analysis, qless_elimination, qless_options};
pub use options::*;
pub use status::{qless_message, qless_version};
