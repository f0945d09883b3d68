//! `libqless`: the library for C, C++ and Fortran, declared in `include/qless.h`.
//!
//! ```text
//! arrays (starts, columns, values, b)  -> qless_analyse    -> qless_analysis      rank, kinds, explanations, digits
//! deck                                 -> qless_deck_read  -> qless_deck          load cases, warnings; analyse, clean
//! qless_analysis                       -> qless_eliminate  -> qless_elimination   slaves, T, G, g, expand, restrict, multipliers
//! qless_elimination, pattern of K      -> qless_condensed  -> qless_pattern       K_q and f_q, from K or from elements
//! ```
//!
//! Every function returns a status. Handles are numbers of a table, not addresses: a null, freed or foreign handle is an error, not
//! undefined behaviour. Input is copied; output goes to arrays of the caller, whose lengths are arguments and are checked. No panic crosses
//! the language boundary. A handle may be used by several threads at once.
#![expect(unsafe_code, reason = "arrays of C come as addresses and lengths; `arrays` turns them into slices")]

mod analysis;
mod apply;
mod arrays;
mod deck;
mod elements;
mod elimination;
mod findings;
mod handles;
mod options;
mod pattern;
mod repairs;
mod status;

pub use analysis::*;
pub use apply::*;
pub use deck::*;
pub use elements::*;
pub use elimination::*;
pub use findings::*;
pub use handles::{qless_analysis, qless_deck, qless_elimination, qless_options, qless_pattern};
pub use options::*;
pub use pattern::*;
pub use repairs::*;
pub use status::{qless_message, qless_version};
