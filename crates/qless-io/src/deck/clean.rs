//! Cleans a deck: makes its equations independent, with each slave once and never prescribed.
//!
//! Equations are treated by connected component ("part"); equations that share free DOFs or text belong together. A
//! part without faults stays byte for byte. If its dependent equations can simply be removed, they are. Otherwise the
//! whole part is rewritten as `u_s - T u_q - G u_p = g` (Eq. 23-26), in which no slave occurs twice. A cleaned deck
//! has no faults, so that cleaning it again changes nothing.
//!
//! The new text is read again to prove that it constrains as the original: see `proof`.

mod proof;

use super::{Deck, Format, ansys, calculix, nastran};
use proof::prove;

pub use super::faults::{EquationFault, FaultKind, faults, faults_in};
pub use super::plan::{Cases, CleanError, Ended, Plan, Reason, Removed, Written, plan};
pub(super) use super::plan::{Edits, Renamed};
pub use super::solver::{Finding, Loss, findings, loss};

/// Carries out a plan: returns the new text of the main file. It is read again, and proved to constrain as the deck
/// does in every load case.
///
/// # Errors
/// [`CleanError`]: text that must change cannot, or the proof fails.
pub fn write(deck: &Deck, plan: &Plan) -> Result<Vec<u8>, CleanError> {
    plan.check(&deck.model)?;
    if plan.is_empty() {
        return Ok(deck.texts[0].to_vec());
    }
    let (text, renamed) = match deck.format() {
        Format::Calculix => calculix::write(deck, plan)?,
        Format::Nastran => (nastran::write(deck, plan)?, Renamed::default()),
        Format::Ansys => (ansys::write(deck, plan)?, Renamed::default()),
    };
    prove(deck, &text, &renamed)?;
    Ok(text)
}
