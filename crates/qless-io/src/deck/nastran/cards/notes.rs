//! What a user should know of the cards read.

use crate::deck::nastran::syntax::content::At;

/// Something about a line.
#[derive(Debug)]
pub struct Note {
    pub at: At,
    pub text: String,
    /// Whether something that constrains was left out.
    pub leaves_out: bool,
}

/// All of them.
#[derive(Debug, Default)]
pub struct Notes(pub Vec<Note>);

impl Notes {
    pub fn warn(&mut self, at: At, text: String) {
        self.0.push(Note { at, text, leaves_out: false });
    }

    pub fn leave_out(&mut self, at: At, text: String) {
        self.0.push(Note { at, text, leaves_out: true });
    }
}
