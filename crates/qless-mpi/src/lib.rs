//! Constraints `C u = b` of models that are spread over ranks: redundant and conflicting equations, and
//! `u_s = T u_q + G u_p + g` on the DOFs that each rank asks for.
//!
//! The result equals that of [`qless::analyse`] and [`qless::Analysis::reduction`] for all equations on one machine, to the last bit,
//! whichever rank holds which equation. The stages, in order: [`Share`] (the input of a rank), `parts` (owners of DOFs, components across
//! ranks), `distribute` (which rank analyses which equations), `solve` (the serial library on each rank, results returned), [`Analysis`],
//! [`DistributedElimination`]. All communication goes through [`Ranks`]: `World` on MPI with the feature `mpi`, [`together`] within one
//! process.
//!
//! ```
//! use qless::{Kind, Options};
//! use qless_mpi::{Share, analyse, together};
//! // The same tie of u0 and u1, said by both ranks.
//! let kinds = together(2, |ranks| {
//!     let rank = ranks.rank() as u64;
//!     let mut share = Share::new(rank..rank + 1);
//!     share.equation(rank, [(0, 1.0), (1, -1.0)], 0.0);
//!     analyse(ranks, &share, &Options::default()).expect("valid").kinds().to_vec()
//! });
//! assert_eq!(kinds, [[Kind::Independent], [Kind::Redundant]]);
//! ```

mod analysis;
mod distribute;
mod elimination;
mod error;
mod exact;
#[cfg(feature = "files")]
mod files;
mod parts;
mod ranks;
mod share;
mod solve;

pub use analysis::{Analysis, Counts, Dealt, Term, analyse};
pub use elimination::DistributedElimination;
pub use error::{Error, Said, Spoken, agree};
pub use exact::exact_sum;
#[cfg(feature = "files")]
pub use files::{Case, CaseError, Equation, Facts, Found, read_case};
pub use ranks::{Alone, Counted, Message, Ranks, Sent, together};
#[cfg(feature = "mpi")]
pub use ranks::{World, WorldError};
pub use share::{Share, ShareError, SharePlace};
pub use solve::{DistributedCertificateTerm, DistributedDependent};

/// The example of the README, as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
