//! Constraints `C u = b` of models that are distributed over ranks: redundant and conflicting equations, and
//! `u_s = T u_q + G u_p + g` on the DOFs that each rank asks for.
//!
//! The result equals that of [`qless::analyse`] and [`qless::Analysis::reduction`] for all equations on one machine, to the last bit,
//! for any distribution of the equations. The stages, in order: [`Share`] (the input of a rank), `components` (owners of DOFs, connected
//! components across ranks), `distribute` (which rank analyses which equations), `solve` (the serial library on each rank; returns the
//! results), [`Analysis`], [`DistributedElimination`]. All communication goes through [`Ranks`]: `World` on MPI with the feature `mpi`,
//! [`on_threads`] within one process.
//!
//! ```
//! use qless::{Kind, Options};
//! use qless_mpi::{Share, analyse, on_threads};
//! // Both ranks hold the same tie of u0 and u1.
//! let kinds = on_threads(2, |ranks| {
//!     let rank = ranks.rank() as u64;
//!     let mut share = Share::new(rank..rank + 1);
//!     share.equation(rank, [(0, 1.0), (1, -1.0)], 0.0);
//!     analyse(ranks, &share, &Options::default()).expect("valid").kinds().to_vec()
//! });
//! assert_eq!(kinds, [[Kind::Independent], [Kind::Redundant]]);
//! ```

mod analysis;
mod components;
mod distribute;
mod elimination;
mod error;
mod exact;
#[cfg(feature = "files")]
mod files;
mod ranks;
mod share;
mod solve;

pub use analysis::{Analysis, JobCounts, Term, WorkCounts, analyse};
pub use elimination::DistributedElimination;
pub use error::{CodedError, Error, ErrorWords, OptionName, agree};
pub use exact::exact_sum;
#[cfg(feature = "files")]
pub use files::{Case, CaseError, Equation, Facts, GatheredFindings, read_case};
pub use ranks::{Alone, Counted, Message, Ranks, Sent, on_threads};
#[cfg(feature = "mpi")]
pub use ranks::{World, WorldError};
pub use share::{Share, ShareError, SharePlace};
pub use solve::{DistributedCertificateTerm, DistributedDependent};

/// The example of the README, as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
