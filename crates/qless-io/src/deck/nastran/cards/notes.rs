//! What a user should know of the cards read.

use crate::deck::Model;
use crate::deck::nastran::syntax::content::At;

/// What is said of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// Something that the user should know.
    Warning,
    /// Something that constrains was left out.
    LeftOut,
    /// The solver refuses it.
    Refusal,
}

/// All that is said, in the order of the cards.
#[derive(Debug, Default)]
pub struct Notes(Vec<(At, Kind, String)>);

impl Notes {
    pub fn warn(&mut self, at: At, text: String) {
        self.0.push((at, Kind::Warning, text));
    }

    pub fn leave_out(&mut self, at: At, text: String) {
        self.0.push((at, Kind::LeftOut, text));
    }

    pub fn refuse(&mut self, at: At, text: String) {
        self.0.push((at, Kind::Refusal, text));
    }

    /// Tells the model.
    pub fn tell(self, model: &mut Model) {
        for ((file, line), kind, text) in self.0 {
            match kind {
                Kind::Warning => model.warn(file, line, text),
                Kind::LeftOut => model.leave_out(file, line, text),
                Kind::Refusal => model.refuse(file, line, text),
            }
        }
    }
}
