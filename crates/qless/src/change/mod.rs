//! Changes after the first analysis: new values, new equations.
//!
//! | what changes | use | cost |
//! | --- | --- | --- |
//! | b and `u_p`, for a code that works with `u = L u_q + u_0` | [`crate::Elimination::update`] | O(nnz C) |
//! | b and `u_p`, for a [`crate::Reduction`] alone | [`Refresher`], which `update` uses | O(nnz C) |
//! | equations are added or removed, coefficients change | [`ChangingSystem`] | a new analysis of the affected parts |

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

/// Identifies an equation of a [`ChangingSystem`] until it is removed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct EquationId {
    /// The set that the equation belongs to.
    set: Identity,
    number: u32,
}

/// Why a change or an update was refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ChangeError {
    /// A DOF that is not below the number of DOFs of the set.
    #[error("DOF {dof} is out of range: there are {dofs}; correct the DOF or create the set with more DOFs")]
    DofOutOfRange {
        /// The DOF that is out of range.
        dof: usize,
        /// How many DOFs there are.
        dofs: usize,
    },
    /// An equation that was removed.
    #[error("equation {0} was removed; use an equation that `add` returned and that is still in the set")]
    Gone(u32),
    /// An equation of another set.
    #[error("equation {0} belongs to another set; use an equation that `add` of this set returned")]
    Foreign(u32),
    /// More DOFs or equations than 32-bit indices can count, or than fit into memory.
    #[error("{found} {what} are too many: indices have 32 bits, and the memory is limited")]
    TooMany {
        /// What there are too many of: "DOFs" or "equations".
        what: &'static str,
        /// How many DOFs or equations there are.
        found: usize,
    },
    /// A number that is not finite.
    #[error("{0} is not a finite number; correct it")]
    NotFinite(f64),
    /// The equations of a block are not a valid system.
    #[error(transparent)]
    System(#[from] SystemError),
    /// A block could not be analysed.
    #[error(transparent)]
    Analysis(#[from] AnalysisError),
    /// A block could not be reduced; the error has row and DOF numbers of the block.
    #[error(transparent)]
    Reduction(#[from] ReductionError),
    /// A list of the wrong length, or a number that is not finite.
    #[error(transparent)]
    Argument(#[from] ArgumentError),
}
