//! Cleans a deck: makes its equations independent. No DOF is then the slave of two equations, and no slave is prescribed, unless the solver
//! accepts that.
//!
//! Each connected component ("part") of equations is treated alone. Equations that share free DOFs or lines of text are connected. A part
//! without faults and dependent equations keeps its text, byte for byte. If leaving out cards or nodes removes the dependent equations and
//! the faults, nothing else changes. Otherwise the whole part is rewritten as `u_s - T u_q - G u_p = g` (equations 23 to 26 of the paper),
//! in which no slave occurs twice. A cleaned deck has no faults but those that the solver accepts, so that cleaning it again changes
//! nothing.
//!
//! The new text is read again to prove that it constrains as the original: see `proof`.

mod proof;

use qless::Options;

use super::plan::{PlanOptions, plan_with};
use super::{Deck, Format, ansys, calculix, nastran};
use proof::prove;

pub use super::faults::{EquationFault, FaultKind, faults, faults_in};
pub use super::plan::{Cases, CleanError, Combination, Ended, Plan, Reason, Removed, Written, check_plan, plan};
pub(super) use super::plan::{Edits, Renamed, shortened};
pub use super::solver::{Finding, Loss, findings, loss};

/// Plans the changes of a deck and carries them out. First tries to edit cards. If this cannot be carried out or proved, rewrites equations
/// instead. [`Preferences::equations`](qless::Preferences) names equations to keep, by their places in the whole deck. Other preferences
/// have no effect: a plan prefers the slaves of the deck.
///
/// # Errors
/// As [`plan`] and [`write()`].
///
/// ```
/// # let place = tempfile::tempdir()?;
/// let path = place.path().join("links.bdf");
/// let grids = "CEND\nBEGIN BULK\nGRID,1\nGRID,2,,1.\nGRID,3,,2.\n";
/// std::fs::write(&path, format!("{grids}RBE2,8,1,123456,2,3\nRBE2,9,2,123456,3\n"))?;
/// let (plan, text) = qless_io::deck::clean::clean(&qless_io::deck::read(&path)?, &qless::Options::default())?;
/// assert_eq!((plan.removed.len(), plan.written.len()), (6, 0));
/// assert!(String::from_utf8(text)?.contains("RBE2,8,1,123456,2,3\n$ qless: line 7 RBE2 9 removed, redundant"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn clean(deck: &Deck, options: &Options) -> Result<(Plan, Vec<u8>), CleanError> {
    let made = |edits_cards| {
        let plan = plan_with(deck, PlanOptions { options, edits_cards, explains: true })?;
        write(deck, &plan).map(|text| (plan, text))
    };
    made(true).or_else(|error| made(false).map_err(|_| error))
}

/// Carries out a plan: returns the new text of the main file. The new text is read again, and a proof shows that it constrains as the deck
/// does in every load case.
///
/// # Errors
/// [`CleanError`] if text that must change cannot be changed, or if the proof fails.
pub fn write(deck: &Deck, plan: &Plan) -> Result<Vec<u8>, CleanError> {
    plan.check(&deck.model)?;
    if plan.is_empty() {
        return Ok(deck.texts[0].to_vec());
    }
    let (text, renamed) = match deck.format() {
        Format::Calculix => calculix::write(deck, plan)?,
        Format::Nastran => (nastran::write(deck, plan)?, Renamed::default()),
        Format::Ansys => (ansys::write(deck, plan)?, Renamed::default()),
        format @ (Format::LsDyna | Format::Radioss) => return Err(CleanError::ReadOnly { format }),
    };
    prove(deck, &text, &renamed)?;
    Ok(text)
}
