//! Constraints `C u = b` of models that are spread over ranks.

mod ranks;

pub use ranks::{Alone, Counted, Counts, Message, Ranks, together};
#[cfg(feature = "mpi")]
pub use ranks::{World, WorldError};
