//! Element types. Some of them impose equations that the deck does not list.

use rustc_hash::{FxHashMap, FxHashSet};

use crate::deck::ansys::syntax::command::AnsysCommand;
use crate::deck::ansys::syntax::field::whole;

const CONTACT: &str = "contact elements with KEYOPT(2) = 2 constrain by equations of their own: left out";

/// Numbers of the elements for plane and axisymmetric models, such as 182 of PLANE182.
const PLANE: [u32; 59] = [
    1, 2, 3, 13, 23, 25, 35, 42, 53, 54, 55, 61, 67, 75, 77, 78, 82, 83, 106, 108, 115, 121, 130, 141, 145, 146, 151,
    153, 169, 171, 172, 182, 183, 192, 193, 202, 203, 208, 209, 212, 213, 217, 223, 230, 233, 238, 252, 258, 259, 272,
    273, 292, 293, 110, 129, 9, 12, 26, 48,
];

/// Numbers of the elements that occur in both plane and spatial models.
const EITHER: [u32; 15] = [7, 14, 21, 27, 37, 38, 39, 40, 50, 71, 94, 116, 124, 175, 200];

/// Element types of a deck.
#[derive(Debug, Default)]
pub struct ElementTypes {
    /// Numbers of contact element types. A type imposes equations only if its KEYOPT(2) is 2.
    contact: FxHashSet<u32>,
    /// For each number of a type: true for elements of plane models, false for elements of spatial ones.
    plane: FxHashMap<u32, bool>,
    /// Whether the next data lines are rows of `ETBLOCK`.
    pub in_block: bool,
}

impl ElementTypes {
    /// Whether the model is plane: it has plane elements and no spatial ones.
    pub fn are_plane(&self) -> bool {
        !self.plane.is_empty() && self.plane.values().all(|is_plane| *is_plane)
    }

    /// Reads `ET, ITYPE, Ename`. Returns a warning if elements of this type impose equations.
    pub fn element_type(&mut self, command: &AnsysCommand) -> Option<&'static str> {
        let name = command.field(2);
        let digits = name.iter().rposition(|byte| !byte.is_ascii_digit()).map_or(name, |at| &name[at + 1..]);
        self.add(whole(command.field(1))?, whole(digits)?)
    }

    /// Reads `KEYOPT, ITYPE, KNUM, VALUE`. Returns a warning if the option makes contact elements impose equations.
    pub fn option(&self, command: &AnsysCommand) -> Option<&'static str> {
        let of_contact = whole(command.field(1)).is_some_and(|number| self.contact.contains(&number));
        (of_contact && command.is(2, "2") && command.is(3, "2")).then_some(CONTACT)
    }

    /// Reads a row of `ETBLOCK`: the number of the type, the number of the element, then KEYOPT(1), KEYOPT(2), ... Returns a warning if
    /// elements of this type impose equations.
    pub fn row(&mut self, line: &[u8]) -> Option<&'static str> {
        let mut words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        let (number, element) = (whole(words.next()?)?, whole(words.next()?)?);
        let warning = self.add(number, element);
        let tied = self.contact.contains(&number) && words.nth(1) == Some(b"2");
        warning.or(tied.then_some(CONTACT))
    }

    fn add(&mut self, number: u32, element: u32) -> Option<&'static str> {
        self.contact.remove(&number);
        self.plane.remove(&number);
        if element > 0 && !EITHER.contains(&element) {
            self.plane.insert(number, PLANE.contains(&element));
        }
        match element {
            179 => Some("PRETS179 elements constrain by equations of their own: left out"),
            184 => Some("MPC184 elements constrain by equations of their own: left out"),
            171..=178 => {
                self.contact.insert(number);
                None
            }
            _ => None,
        }
    }
}
