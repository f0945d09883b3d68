//! After the first analysis: other values, other equations.
//!
//! | what changes | use | cost |
//! | --- | --- | --- |
//! | b and `u_p`, for a code that works with `u = L u_q + u_0` | [`crate::Elimination::update`] | O(nnz C) |
//! | b and `u_p`, for a bare [`crate::Reduction`] | [`Refresher`], on which `update` is built | O(nnz C) |
//! | equations come and go, coefficients change | [`ChangingSystem`] | a new analysis of the parts touched |

mod changing_system;
mod network;
mod refresher;
mod replay;
mod solved_block;

use crate::common::argument::ArgumentError;
use crate::common::identity::Identity;
use crate::{AnalysisError, ReductionError, SystemError};

pub use changing_system::ChangingSystem;
pub use refresher::{RefreshError, Refreshed, Refresher};
pub use solved_block::SolvedBlock;

/// An equation of a [`ChangingSystem`]; it keeps its meaning until the equation is removed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct EquationId {
    /// The set that gave it.
    set: Identity,
    number: u32,
}

/// Why a change or an update was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ChangeError {
    /// A DOF beyond the number given at the start.
    #[error("DOF {dof} is out of range: there are {dofs}; correct the DOF or start with more")]
    DofOutOfRange {
        /// The DOF.
        dof: usize,
        /// How many there are.
        dofs: usize,
    },
    /// An equation that was removed before.
    #[error("equation {0} is not there any more; use the number that adding it gave")]
    Gone(u32),
    /// An equation of another set.
    #[error("equation {0} is one of another set; use the number that adding it to this one gave")]
    Foreign(u32),
    /// More than can be counted, or than the memory holds.
    #[error("{what}: {found} are more than can be held")]
    TooMany {
        /// What there is too much of.
        what: &'static str,
        /// How many.
        found: usize,
    },
    /// A number that is not finite.
    #[error("{0} is no finite number; correct it")]
    NotFinite(f64),
    /// A block's numbers are no system.
    #[error(transparent)]
    System(#[from] SystemError),
    /// A block could not be analysed.
    #[error(transparent)]
    Analysis(#[from] AnalysisError),
    /// A block could not be reduced; rows and DOFs of the error are counted within the block.
    #[error(transparent)]
    Reduction(#[from] ReductionError),
    /// The values given do not fit.
    #[error(transparent)]
    Argument(#[from] ArgumentError),
}
