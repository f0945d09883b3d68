//! A deck with an independent set of equations, each slave once and never prescribed.
//!
//! Equations are looked at by connected parts (equations that share free DOFs, or text). A part without faults stays as it is,
//! byte for byte. Where the dependent equations can simply be left out, they are. Otherwise the whole part is written
//! anew as `u_s - T u_q - G u_p = g` (Eq. 23-26), in which no slave occurs twice. A deck that was cleaned has no faults left, so
//! that a second time changes nothing.

mod edit;
mod error;
mod fault;
mod find_faults;
mod finding;
mod plan;
mod proof;

pub use error::CleanError;
pub use fault::EquationFault;
pub use find_faults::{faults, faults_in};
pub use finding::{Finding, findings};
pub use plan::{Cases, Ended, Plan, Reason, Removed, Written, plan};

pub(super) use edit::Edits;
pub(crate) use error::Renamed;

use super::{Deck, Format, ansys, calculix, nastran};

/// The text of the main file with the plan carried out, read again and proved to constrain as the deck does in every load case.
///
/// # Errors
/// [`CleanError`] where text that must change cannot, or where the proof fails.
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
    proof::prove(deck, &text, &renamed)?;
    Ok(text)
}
