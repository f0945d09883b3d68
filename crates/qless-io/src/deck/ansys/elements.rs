//! Element types that constrain by equations of their own, which no deck lists.

use rustc_hash::FxHashSet;

use super::command::Command;
use super::field::whole;

/// Types of contact elements met so far; an option of theirs ties by equations.
#[derive(Debug, Default)]
pub struct Elements {
    contact: FxHashSet<u32>,
}

impl Elements {
    /// `ET, ITYPE, Ename`: a warning for elements that constrain.
    pub fn element_type(&mut self, command: &Command) -> Option<String> {
        let name = command.field(2);
        let digits = name.iter().rposition(|byte| !byte.is_ascii_digit()).map_or(name, |at| &name[at + 1..]);
        match whole(digits)? {
            179 => Some("PRETS179 elements constrain by equations of their own: left out".to_owned()),
            184 => Some("MPC184 elements constrain by equations of their own: left out".to_owned()),
            171..=178 => {
                self.contact.extend(whole(command.field(1)));
                None
            }
            _ => None,
        }
    }

    /// `KEYOPT, ITYPE, KNUM, VALUE`: a warning for contact by equations.
    pub fn option(&self, command: &Command) -> Option<String> {
        let of_contact = whole(command.field(1)).is_some_and(|number| self.contact.contains(&number));
        let text = "contact elements with KEYOPT(2) = 2 constrain by equations of their own: left out";
        (of_contact && command.is(2, "2") && command.is(3, "2")).then(|| text.to_owned())
    }
}
