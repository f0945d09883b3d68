//! Errors of an elimination, and the check for conflicting equations.

use crate::backend::BackendError;
use crate::change::RefreshError;
use crate::{AnalysisError, ArgumentError, ConstraintSystem, Kind, ReductionError, SystemError};

/// Errors of [`Elimination`](super::Elimination).
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EliminationError {
    /// Some equations conflict with others.
    #[error("equations conflict with others: {}; change their right-hand sides, or remove them", first_labels(.labels))]
    Conflicting {
        /// The conflicting equations, 0-based.
        rows: Vec<usize>,
        /// The labels of the conflicting equations.
        labels: Vec<String>,
    },
    /// The elimination was made from a reduction, without equations.
    #[error(
        "this elimination was made from T, G and g and has no equations; use `Elimination::new` to create it, or `set` to change g"
    )]
    NoEquations,
    /// The equations could not be analysed.
    #[error(transparent)]
    Analysis(#[from] AnalysisError),
    /// The equations could not be solved for slaves.
    #[error(transparent)]
    Reduction(#[from] ReductionError),
    /// New right-hand sides were refused.
    #[error(transparent)]
    Refresh(#[from] RefreshError),
    /// A list of the wrong length, or a number that is not finite.
    #[error(transparent)]
    Argument(#[from] ArgumentError),
    /// Arrays that are not a valid n x n pattern.
    #[error(transparent)]
    Matrix(#[from] SystemError),
    /// A block needs more memory than is allowed, or could not be factored.
    #[error(transparent)]
    Backend(#[from] BackendError),
}

/// The first five labels, and the number of the others.
fn first_labels(labels: &[String]) -> String {
    const MOST: usize = 5;
    let first = labels[..labels.len().min(MOST)].join(", ");
    if labels.len() > MOST { format!("{first} and {} more", labels.len() - MOST) } else { first }
}

/// Returns an error if any equation conflicts.
pub(super) fn refuse_conflicts(kinds: &[Kind], system: &ConstraintSystem) -> Result<(), EliminationError> {
    let rows: Vec<usize> = (0..kinds.len()).filter(|&i| kinds[i] == Kind::Conflicting).collect();
    if rows.is_empty() {
        return Ok(());
    }
    let labels = rows.iter().map(|&row| system.equation_label(row)).collect();
    Err(EliminationError::Conflicting { rows, labels })
}
