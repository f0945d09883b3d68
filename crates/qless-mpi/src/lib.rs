//! Constraints `C u = b` of models that are spread over ranks.

mod analysis;
mod deal;
mod error;
#[cfg(feature = "files")]
mod files;
mod parts;
mod ranks;
mod share;
mod solve;

pub use analysis::{Analysis, Because, Counts, Dealt, Dependent, Term, analyse};
pub use error::{Error, Said, Spoken, agree};
#[cfg(feature = "files")]
pub use files::{Case, CaseError, Equation, Facts, Found, read_case};
pub use ranks::{Alone, Counted, Message, Ranks, Sent, together};
#[cfg(feature = "mpi")]
pub use ranks::{World, WorldError};
pub use share::{Share, ShareError, SharePlace};
