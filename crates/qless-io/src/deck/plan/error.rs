//! Why a deck cannot be cleaned.

use std::path::PathBuf;

use qless::{AnalysisError, ReductionError, SystemError};
use rustc_hash::FxHashMap;

use crate::deck::{DeckError, Dof, Format};

/// Why a deck cannot be cleaned.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CleanError {
    /// The equations contradict each other in this load case.
    #[error("the equations conflict in {case}: see `qless check`")]
    Conflicting {
        /// The load case.
        case: String,
    },
    /// Load cases prescribe different DOFs or remove equations, so that no single set of equations fits all of them.
    #[error(
        "{case} needs {found} independent equations, but only {common} of them can be kept in all load cases; make a deck for each load case"
    )]
    CasesDiffer {
        /// The load case.
        case: String,
        /// Its rank.
        found: usize,
        /// Its rank if every DOF is prescribed that any load case prescribes.
        common: usize,
    },
    /// Equations return in a later load case or hold in some load cases only, which the format cannot express for new
    /// equations.
    #[error(
        "{case} has other equations than earlier load cases, which the format cannot express for new equations; make a deck for each load case"
    )]
    Apart {
        /// The load case.
        case: String,
    },
    /// A DOF would have to become a slave, but another card claims it, or its node has local axes and a prescribed DOF.
    #[error("{case}: {slave} would have to be a slave, but another card claims it; change that card by hand")]
    Claimed {
        /// The load case.
        case: String,
        /// The DOF.
        slave: String,
    },
    /// The rank of the equations depends on numbers that may be rounding, so that no cleaned deck is certain to be correct.
    #[error("{}", doubtful(case, place, term.as_ref(), *ranks))]
    Doubtful {
        /// The load case.
        case: String,
        /// The card and line of an equation concerned, or the load case.
        place: String,
        /// A DOF of the equation and its coefficient, if a single coefficient decides.
        term: Option<(String, f64)>,
        /// The rank as the numbers are given, and the rank without those that may be rounding.
        ranks: (usize, usize),
    },
    /// The new text does not constrain as the deck does. This is a fault of this program.
    #[error("{case}: the cleaned deck would not constrain the same ({what}); please report this deck")]
    Unproven {
        /// The load case.
        case: String,
        /// What differs.
        what: String,
    },
    /// A card that equations cannot replace would have to be replaced or left out.
    #[error(
        "{place} cannot be replaced by equations: {why}; change it, or the equations that share DOFs with it, by hand"
    )]
    Fixed {
        /// File, line and card.
        place: String,
        /// Why it would have to be replaced.
        why: String,
    },
    /// The solver stops when it reads the deck, regardless of its equations.
    #[error("{place}: {why} (correct this by hand before cleaning the deck)")]
    Refused {
        /// File and line.
        place: String,
        /// Why it stops, and what to do.
        why: String,
    },
    /// A format that is read but not written.
    #[error("decks of {format} are read, but not written; change the cards that `qless check` names by hand")]
    ReadOnly {
        /// The format.
        format: Format,
    },
    /// Text that must change is in a place that does not permit it.
    #[error("{}:{line}: {why}", path.display())]
    Place {
        /// The file.
        path: PathBuf,
        /// The line.
        line: usize,
        /// What to do.
        why: &'static str,
    },
    /// The plan belongs to another deck, or was changed by hand.
    #[error(
        "the plan names equation {equation} (from 0), but the deck has {count}, each of which can be removed only once; make a plan of this deck"
    )]
    Foreign {
        /// The equation. The deck does not have it, or the plan removes it twice or out of order.
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

/// The message of [`CleanError::Doubtful`].
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

/// DOFs of a cleaned deck that have another name in the original deck.
pub(crate) type Renamed = FxHashMap<Dof, Dof>;
