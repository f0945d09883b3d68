//! Constraints `C u = b` of models that are spread over ranks.

mod agreed;
mod analysis;
mod deal;
mod error;
mod exact;
mod map;
mod parts;
mod ranks;
mod share;
mod solve;

pub use agreed::agreed;
pub use analysis::{Analysis, Because, Counts, Dealt, Dependent, Term, analyse};
pub use error::Error;
pub use exact::exact_sum;
pub use map::Map;
pub use ranks::{Alone, Counted, Message, Ranks, Sent, together};
#[cfg(feature = "mpi")]
pub use ranks::{World, WorldError};
pub use share::{Share, ShareError, SharePlace};
