//! The files that a deck itself writes and reads again: databases (`SAVE`, `RESUME`) and parameters (`PARSAV`, `PARRES`).
//!
//! ```text
//! SAVE,   Fname, Ext                  RESUME, Fname, Ext, --, NOPAR
//! PARSAV, Lab, Fname, Ext             PARRES, Lab, Fname, Ext
//! ```
//!
//! A database is what the text of its model above `SAVE` makes. `RESUME` deletes the present model, as `/CLEAR` does; the next model begins
//! with this text, without its solutions.

use std::sync::Arc;

use super::AnsysReader;
use crate::deck::ansys::model::written::{FileName, TextPart};
use crate::deck::ansys::syntax::command::AnsysCommand;
use crate::deck::ansys::syntax::control::{Execution, TextPosition};
use crate::deck::limits::REREAD;

impl AnsysReader {
    /// Executes a command that writes or reads a file. `next` is the start of the next line if the command is alone on its line.
    pub fn file(&mut self, command: &AnsysCommand, next: Option<TextPosition>) {
        if self.repeats_saved_text {
            return;
        }
        match &command.key {
            b"/FIL" => self.name_job(command),
            b"SAVE" => self.save(command, next),
            b"RESU" => self.resume(command, next),
            b"PARS" => self.save_parameters(command),
            b"PARR" => self.read_parameters(command),
            b"/DEL" => self.forget_file(command, 1),
            b"/COP" => self.forget_file(command, 4),
            b"/REN" => [1, 4].into_iter().for_each(|at| self.forget_file(command, at)),
            _ => self.files.forget(),
        }
    }

    /// Fields `at` and `at + 1` name a file that a command changes: what it holds is not known any more.
    fn forget_file(&mut self, command: &AnsysCommand, at: usize) {
        let Some(name) = self.file_name(command, at, b"") else { return self.files.forget() };
        self.files.databases.remove(&name);
        self.files.parameters.remove(&name);
    }

    /// Executes `/FILNAME, Fname, Key`. A name that this reader does not know is unlike any other.
    fn name_job(&mut self, command: &AnsysCommand) {
        let is_known = self.control.state() == Execution::Executed && self.is_literal(command.field(1));
        let name = if is_known { command.field(1).to_vec() } else { format!("?{}", command.line).into_bytes() };
        if !["", "0", "OFF"].iter().any(|word| command.is(2, word)) {
            self.files.session.clone_from(&name);
        }
        self.files.job = name;
    }

    /// Within POST1, the boundary conditions of the results are saved in place of those of the model.
    fn save(&mut self, command: &AnsysCommand, next: Option<TextPosition>) {
        let Some(name) = self.file_name(command, 1, b"db") else { return self.files.databases.clear() };
        match next.filter(|_| !self.control.is_within() && !self.in_post1 && !self.has_read_parameters) {
            Some(next) => {
                let parts = self.parts.iter().copied().chain([(self.begins, next.start)]);
                self.files.databases.insert(name, parts.collect());
            }
            None => drop(self.files.databases.remove(&name)),
        }
    }

    /// Ends the model. The next one begins with what is saved, or with what this reader does not know.
    fn resume(&mut self, command: &AnsysCommand, next: Option<TextPosition>) {
        let Some(next) = next.filter(|_| !self.control.is_within()) else { return self.lose(command) };
        let keeps_parameters = !["", "0"].iter().any(|word| command.is(4, word));
        let parts = self.file_name(command, 1, b"db").and_then(|name| self.files.databases.get(&name));
        let length = |parts: &[TextPart]| parts.iter().map(|(from, until)| until - from.start).sum();
        let rest = REREAD.saturating_sub(self.control.again);
        let known = parts.filter(|parts| !keeps_parameters && length(parts) <= rest).cloned();
        self.control.again += known.as_deref().map_or(0, length);
        self.cleared = Some(next);
        self.resumes = Some(known.ok_or_else(|| (command.line, command.title())));
    }

    fn save_parameters(&mut self, command: &AnsysCommand) {
        let Some(name) = self.file_name(command, 2, b"parm") else { return self.files.parameters.clear() };
        let is_certain = self.control.state() == Execution::Executed;
        match self.parameters.saved(command.is(1, "ALL")).filter(|_| is_certain) {
            Some(saved) => drop(self.files.parameters.insert(name, Arc::new(saved))),
            None => drop(self.files.parameters.remove(&name)),
        }
    }

    /// Parameters of a file that is not known may have any name and value. A loop may depend on those that the file replaces.
    fn read_parameters(&mut self, command: &AnsysCommand) {
        self.has_read_parameters = true;
        let saved = self.file_name(command, 2, b"parm").and_then(|name| self.files.parameters.get(&name));
        if let Some(saved) = saved.filter(|_| !self.control.is_within()) {
            self.parameters.read_saved(saved, command.field(1).to_ascii_uppercase().starts_with(b"CHAN"));
            return;
        }
        self.parameters.forget_all();
        self.control.doubt_loops();
        self.nodes.are_in_files = true;
    }

    /// The file that fields `at` and `at + 1` name; `None` if parameters decide which it is.
    fn file_name(&self, command: &AnsysCommand, at: usize, extension: &[u8]) -> Option<FileName> {
        let (name, extension) = match (command.field(at), command.field(at + 1)) {
            (name, b"") => (name, extension),
            (name, own) => (name, own),
        };
        if !self.is_literal(name) || !self.is_literal(extension) {
            return None;
        }
        let name = if name.is_empty() { &self.files.job } else { name };
        Some((name.to_vec(), extension.to_vec()))
    }

    fn is_literal(&self, text: &[u8]) -> bool {
        !text.iter().any(|byte| b"%'(".contains(byte)) && !self.parameters.is_name(text)
    }
}
