//! What each rank does with its guests, by the serial library, and how the results come home.

mod ask;
mod gate;
mod guests;
mod home;
mod lines;
mod substitute;

pub(crate) use ask::ask;
pub(crate) use guests::{Solved, Soundness};
pub(crate) use home::{Findings, send_home};
pub(crate) use lines::{GIVEN, Line, Lines};
pub(crate) use substitute::{Slaves, substitute};
