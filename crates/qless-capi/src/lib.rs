//! `libqless`: the library for C, C++ and Fortran, declared in `include/qless.h`.
//!
//! ```text
//! arrays (starts, columns, values, b)  -> qless_analyse    -> qless_analysis      rank, kinds, explanations, digits
//! deck                                 -> qless_deck_read  -> qless_deck          load cases, warnings; analyse, clean
//! qless_analysis                       -> qless_eliminate  -> qless_elimination   slaves, T, G, g, expand, restrict, multipliers
//! qless_elimination, pattern of K      -> qless_condensed  -> qless_pattern       K_q and f_q, from K or from elements
//! messages of the caller, equations    -> qless_analyse_ranks -> qless_distributed   the same over the ranks of an MPI job
//! ```
//!
//! Every function returns a status. Handles are numbers of a table, not addresses: a null, freed or foreign handle is an error, not
//! undefined behaviour. Input is copied; output goes to arrays of the caller, whose lengths are arguments and are checked. No panic crosses
//! the language boundary. A handle may be used by several threads at once.
#![expect(unsafe_code, reason = "arrays of C come as addresses and lengths; `arrays` turns them into slices")]

/// Defines a function of C for both index types: `narrow` where I is `i32`, and `narrow_64` where I is `i64`.
macro_rules! for_both_indices {
    ($wide:ident = $(#[$doc:meta])* pub unsafe extern "C" fn $narrow:ident<$I:ident>($($arguments:tt)*) -> c_int $body:block) => {
        mod $narrow {
            use super::*;
            type $I = i32;
            $(#[$doc])*
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $narrow($($arguments)*) -> c_int $body
        }
        mod $wide {
            use super::*;
            type $I = i64;
            #[doc = concat!("[`", stringify!($narrow), "`](super::", stringify!($narrow), ") with 64-bit indices.")]
            ///
            /// # Safety
            #[doc = concat!("As [`", stringify!($narrow), "`](super::", stringify!($narrow), ").")]
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $wide($($arguments)*) -> c_int $body
        }
        pub use $narrow::$narrow;
        pub use $wide::$wide;
    };
}

mod analysis;
mod apply;
mod arrays;
mod deck;
mod distributed;
mod elements;
mod elimination;
mod findings;
mod handles;
mod options;
mod pattern;
mod ranks;
mod repairs;
mod status;

pub use analysis::*;
pub use apply::*;
pub use deck::*;
pub use distributed::*;
pub use elements::*;
pub use elimination::*;
pub use findings::*;
pub use handles::{qless_analysis, qless_deck, qless_distributed, qless_elimination, qless_options, qless_pattern};
pub use options::*;
pub use pattern::*;
pub use ranks::{qless_exchange, qless_gather, qless_ranks, qless_reduce};
pub use repairs::*;
pub use status::{qless_message, qless_version};
