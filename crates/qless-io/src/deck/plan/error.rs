//! The reasons why a deck cannot be cleaned.

use std::path::PathBuf;

use qless::{AnalysisError, ReductionError, SystemError};
use rustc_hash::FxHashMap;

use crate::deck::{DeckError, Dof, Format};

/// Why a deck cannot be cleaned.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CleanError {
    /// The equations contradict each other in a load case.
    #[error("the equations conflict in {case}: see `qless check`")]
    Conflicting {
        /// The name of the load case.
        case: String,
    },
    /// Load cases prescribe different DOFs or have different equations, so that no single set of equations fits all of them.
    #[error(
        "{case} needs {found} independent equations, but only {common} of them can be kept in all load cases; make a deck for each load case"
    )]
    CasesDiffer {
        /// The name of the load case.
        case: String,
        /// The rank of this load case.
        found: usize,
        /// The rank of this load case if every DOF is prescribed that any load case prescribes.
        common: usize,
    },
    /// Equations return in a later load case, or hold in some load cases only. The format of the deck cannot express this for new
    /// equations.
    #[error(
        "{case} has other equations than earlier load cases, which the format cannot express for new equations; make a deck for each load case"
    )]
    Apart {
        /// The name of the load case.
        case: String,
    },
    /// A DOF would have to become a slave although another card claims it, or although its node has local axes and a prescribed DOF.
    #[error("{case}: {slave} would have to be a slave, but another card claims it; change that card by hand")]
    Claimed {
        /// The name of the load case.
        case: String,
        /// The name of the DOF.
        slave: String,
    },
    /// The rank of the equations depends on numbers that may be rounding errors. Then no cleaned deck is certain to be correct.
    #[error("{}", doubtful(case, place, term.as_ref(), *ranks))]
    Doubtful {
        /// The name of the load case.
        case: String,
        /// The line and card of an equation with a coefficient that may be a rounding error, or the name of the load case.
        place: String,
        /// If a single coefficient decides the rank: the DOF of its term, and the coefficient.
        term: Option<(String, f64)>,
        /// Two ranks: with the numbers as given, and without those that may be rounding errors.
        ranks: (usize, usize),
    },
    /// The new text does not constrain as the deck does. This is an error in this program.
    #[error("{case}: the cleaned deck would not constrain the same ({what}); please report this deck")]
    Unproven {
        /// The name of the load case.
        case: String,
        /// What differs between the new text and the deck.
        what: String,
    },
    /// Cleaning would have to replace or leave out a card that equations cannot replace.
    #[error(
        "{place} cannot be replaced by equations: {why}; change it, or the equations that share DOFs with it, by hand"
    )]
    Fixed {
        /// The file, line and card.
        place: String,
        /// Why the card would have to be replaced or left out.
        why: String,
    },
    /// The solver stops when it reads the deck, whatever its equations are.
    #[error("{place}: {why} (correct this by hand before cleaning the deck)")]
    Refused {
        /// The file and line at which the solver stops.
        place: String,
        /// Why the solver stops, and what to do.
        why: String,
    },
    /// Decks of this format can be read but not written.
    #[error("decks of {format} are read, but not written; change the cards that `qless check` names by hand")]
    ReadOnly {
        /// The format.
        format: Format,
    },
    /// A text must change in a place where this is not possible.
    #[error("{}:{line}: {why}", path.display())]
    Place {
        /// The file.
        path: PathBuf,
        /// The line of the place.
        line: usize,
        /// What to do.
        why: &'static str,
    },
    /// The plan belongs to another deck, or someone changed it.
    #[error(
        "the plan names equation {equation} (from 0), but the deck has {count}, each of which can be removed only once; make a plan of this deck"
    )]
    Foreign {
        /// The index of the equation. The deck does not have it, or the plan removes it twice or out of order.
        equation: usize,
        /// Number of equations in the deck.
        count: usize,
    },
    /// The deck's numbers cannot be analysed.
    #[error(transparent)]
    Analysis(#[from] AnalysisError),
    /// The deck's equations cannot be solved for slaves.
    #[error("{0} (rows count from 0 in the order of the deck)")]
    Reduction(#[from] ReductionError),
    /// The deck's equations form no valid system.
    #[error(transparent)]
    System(#[from] SystemError),
    /// A deck could not be read.
    #[error(transparent)]
    Deck(#[from] DeckError),
}

/// The text of the message for [`CleanError::Doubtful`].
fn doubtful(case: &str, place: &str, term: Option<&(String, f64)>, (given, rounded): (usize, usize)) -> String {
    let ranks = if given == rounded {
        format!("the rank {given} is in doubt")
    } else {
        format!("the rank is {given} or, without numbers that may be rounding, {rounded}")
    };
    match term {
        Some((dof, coefficient)) => format!(
            "{case}: {ranks}; {place} has the coefficient {coefficient:e} of {dof}, which is tiny beside its others: if it is rounding, \
             write 0 or correct the positions of its nodes, else give the DOFs units in which the coefficients are of like size"
        ),
        None => format!("{case}: {ranks}; write the coefficients of {place} with more digits, see `qless check`"),
    }
}

/// DOFs of a cleaned deck that have another name there, each with its DOF in the original deck.
pub(crate) type Renamed = FxHashMap<Dof, Dof>;

#[cfg(test)]
mod tests {
    use super::doubtful;

    #[test]
    fn both_ranks_are_told_if_they_differ() {
        let same = doubtful("step 1", "line 7", None, (5, 5));
        assert!(same.contains("the rank 5 is in doubt") && !same.contains("or,"), "{same}");
        let other = doubtful("step 1", "line 7", None, (5, 4));
        assert!(other.contains("the rank is 5 or, without numbers that may be rounding, 4"), "{other}");
    }
}
