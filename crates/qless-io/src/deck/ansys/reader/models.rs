//! The models of a deck. `/CLEAR` and `RESUME` delete the database, parameters included, so that a new model begins after them.
//!
//! A deck holds what the texts between its `/CLEAR` commands would hold as decks of their own.

use std::path::Path;
use std::sync::Arc;

use super::AnsysReader;
use crate::deck::ansys::model::written::{Resumed, WrittenFiles};
use crate::deck::ansys::syntax::control::TextPosition;
use crate::deck::{DeckError, Model, Problem};

/// Limit on the models of a deck. It bounds the memory: no equation of one holds in the load steps of the others.
const MODELS: usize = 100;

/// Reads one model after the other.
pub struct AnsysModels<'a, F> {
    path: &'a Path,
    text: &'a [u8],
    set: F,
    /// Where the next model begins; `None` after the last one.
    next: Option<TextPosition>,
    /// What `RESUME` lets the next model begin with.
    begins_with: Resumed,
    files: WrittenFiles,
    /// Number of models so far that hold anything.
    count: usize,
    /// Whether any model so far is solved.
    is_solved: bool,
    /// Number of bytes that loops have read again.
    again: usize,
}

impl<'a, F: Fn(&mut AnsysReader)> AnsysModels<'a, F> {
    /// The models of a text. `set` changes each reader before it reads.
    pub fn new(path: &'a Path, text: &'a [u8], set: F) -> Self {
        let start = if text.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        let next = Some(TextPosition { start, line: 1 });
        let begins_with = Ok(Arc::default());
        Self {
            path,
            text,
            set,
            next,
            begins_with,
            files: WrittenFiles::default(),
            count: 0,
            is_solved: false,
            again: 0,
        }
    }

    /// Reads a model without the positions of nodes, which cost memory. If a command needs them, reads it again and keeps them.
    fn read(&self, begins: TextPosition) -> Result<AnsysReader, DeckError> {
        let new = || {
            let mut reader = AnsysReader {
                model: Model::new(vec![self.path.to_path_buf()]),
                follows_solution: self.is_solved,
                files: self.files.clone(),
                begins,
                ..AnsysReader::default()
            };
            reader.control.again = self.again;
            match self.begins_with.clone() {
                Ok(parts) => reader.parts = parts,
                Err((line, title)) => reader.replace(line, title),
            }
            (self.set)(&mut reader);
            reader
        };
        let reader = new().model(self.text)?;
        if !reader.needs_positions {
            return Ok(reader);
        }
        let mut again = new();
        again.nodes.positions.keep();
        again.model(self.text)
    }

    fn check_count(&mut self, reader: &AnsysReader, from: TextPosition) -> Result<(), DeckError> {
        self.count += usize::from(!reader.holds_nothing());
        if self.count <= MODELS {
            return Ok(());
        }
        let problem =
            Problem::Limit { what: "the number of models", limit: MODELS, advice: "make a deck for each model" };
        Err(reader.error(from.line - 1, "/CLEAR", (None, problem)))
    }
}

impl<F: Fn(&mut AnsysReader)> Iterator for AnsysModels<'_, F> {
    type Item = Result<AnsysReader, DeckError>;

    fn next(&mut self) -> Option<Self::Item> {
        let from = self.next.take()?;
        let read = self.read(from).and_then(|reader| self.check_count(&reader, from).map(|()| reader));
        if let Ok(reader) = &read {
            self.next = reader.cleared;
            self.begins_with = reader.resumes.clone().unwrap_or_else(|| Ok(Arc::default()));
            self.files = reader.files.clone();
            if reader.resumes.is_none() {
                self.files.clear();
            }
            self.is_solved |= reader.solved_at.is_some();
            self.again = reader.control.again;
        }
        Some(read)
    }
}
