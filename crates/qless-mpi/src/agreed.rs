//! What fails on one rank fails on all.

use std::fmt::Display;

use crate::error::{Error, Failure, agree};
use crate::ranks::Ranks;

/// The result of this rank if all ranks have one, or else the error of the first rank that has none, on all of them: for what a rank
/// does by itself, since a rank that returns while others wait for it leaves them waiting for ever. Collective.
///
/// ```
/// use qless_mpi::{agreed, together};
/// let said = together(3, |ranks| {
///     let own = if ranks.rank() == 1 { Err("no mesh file") } else { Ok(ranks.rank()) };
///     agreed(ranks, own).map_err(|error| error.to_string())
/// });
/// assert_eq!(said, vec![Err("rank 1: no mesh file".to_owned()); 3]);
/// ```
///
/// # Errors
/// [`Error::Failed`] with the rank and the text of its error.
pub fn agreed<T, E: Display>(ranks: &dyn Ranks, own: Result<T, E>) -> Result<T, Error> {
    let failed = |error: E| Failure::of(&error).on(ranks.rank());
    agree(ranks, own.map_err(failed))
}
