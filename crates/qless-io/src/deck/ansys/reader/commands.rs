//! Each command goes to the one who reads it, unless a block passes it over.

use super::Reader;
use crate::deck::DeckError;
use crate::deck::ansys::commands::prescribed::{load, prescribe, release};
use crate::deck::ansys::commands::selection::Selected;
use crate::deck::ansys::model::events::{Action, Components, Which};
use crate::deck::ansys::syntax::command::{Command, Key};
use crate::deck::ansys::syntax::control::{Here, State};
use crate::deck::ansys::syntax::field::Fault;

impl Reader {
    /// One command; `next` is the line below, where there is no other command on the line.
    pub fn command(&mut self, command: Command, next: Option<Here>) -> Result<(), DeckError> {
        let last = std::mem::take(&mut self.last);
        let repeats = command.name.is_empty();
        let from = self.places.as_ref().map_or(0, Vec::len);
        let command = command.named_as(&last);
        let mut name = Vec::with_capacity(8);
        name.extend_from_slice(command.name);
        let result = self.named(command, next);
        self.last = name;
        if repeats {
            self.keep_text(from);
        }
        result
    }

    /// The text of a command that begins with a comma cannot go, nor can that of the one whose name it repeats.
    fn keep_text(&mut self, from: usize) {
        let places = self.places.iter_mut().flatten().skip(from.saturating_sub(1));
        places.for_each(|place| place.repeats = true);
    }

    fn named(&mut self, mut command: Command, next: Option<Here>) -> Result<(), DeckError> {
        self.nodes.end();
        self.elements.in_block = false;
        if self.ended || self.controls(&command, next)? {
            return Ok(());
        }
        let (line, title) = (command.line, command.title());
        let constrains = self.constrains(command.key);
        if constrains && self.control.state() == State::Unknown {
            let text = format!(
                "{title} stands where nobody knows whether it is carried out, in *IF, *DO or *CREATE: left out"
            );
            self.forget(&command, text);
            return Ok(());
        }
        if is_read(command.key)
            && let Err(what) = self.parameters.resolve(&mut command)
        {
            self.unresolved(&command, &what);
            return Ok(());
        }
        if let Some(tag) = command.archive_tag() {
            self.archive = Some(if tag.eq_ignore_ascii_case(b"UNBL") { "UNBL" } else { "R5.0" });
        }
        self.run(&command).map_err(|fault| self.error(line, &title, fault))?;
        self.constrained = constrains;
        Ok(())
    }

    /// Parameters and blocks of commands; true where nothing else is to be done.
    fn controls(&mut self, command: &Command, next: Option<Here>) -> Result<bool, DeckError> {
        let state = self.control.state();
        let unknown = state == State::Unknown;
        if memchr::memchr(b'=', command.text).is_some()
            && state != State::PassedOver
            && self.parameters.assign(command.text, unknown)
        {
            return Ok(true);
        }
        let was_within = self.control.is_within();
        let controls = self.control.command(command, next, &mut self.parameters);
        if controls.map_err(|problem| self.error(command.line, &command.title(), (None, problem)))? {
            if was_within && !self.control.is_within() && std::mem::take(&mut self.made.is_open) {
                self.made.line = command.line;
            }
            return Ok(true);
        }
        let sets = sets_parameters(command.key);
        if sets && state != State::PassedOver {
            self.parameters.command(command, unknown);
        }
        Ok(sets || state == State::PassedOver)
    }

    /// A command that takes values which are not known.
    fn unresolved(&mut self, command: &Command, what: &str) {
        match &command.key {
            b"N   " => self.nodes.are_generated = true,
            b"NSEL" => self.selection.nodes = Selected::Unknown,
            _ if self.constrains(command.key) => {
                let text =
                    format!("{} takes {what}, a value that this reader does not follow: left out", command.title());
                self.forget(command, text);
            }
            _ => {}
        }
    }

    /// Leaves out a command that constrains, with the equation or set that it belongs to.
    fn forget(&mut self, command: &Command, text: String) {
        match &command.key {
            b"CE  " | b"CECM" => self.equations.leave_out(command),
            b"CP  " => self.coupled.leave_out(command),
            b"D   " | b"DDEL" => {}
            _ => self.made.unread = true,
        }
        self.note(command.line);
        self.leave_out(command.line, text);
    }

    fn run(&mut self, command: &Command) -> Result<(), Fault> {
        match &command.key {
            b"CE  " | b"CECM" | b"CEDE" | b"CP  " | b"CPDE" => self.equation(command)?,
            b"CERI" | b"RBE3" => self.region(command)?,
            b"D   " => {
                let reading = prescribe(command, &self.nodes, &self.selection)?;
                self.event(command, reading);
            }
            b"DDEL" => {
                let reading = release(command, &self.nodes, &self.selection)?;
                self.event(command, reading);
            }
            b"F   " | b"FDEL" => {
                let reading = load(command, &self.nodes, &self.selection, command.key == *b"F   ")?;
                reading.into_iter().for_each(|reading| self.event(command, reading));
            }
            b"SOLV" | b"LSWR" if self.control.state() == State::Unknown => {
                let text = format!("{} stands where nobody knows whether it is carried out", command.title());
                self.leave_out(command.line, text);
            }
            b"SOLV" | b"LSWR" => self.solve(command),
            b"NBLO" => {
                self.archive = self.archive.or(Some("R5.0"));
                self.nodes.block();
            }
            b"CMBL" => self.nodes.group(command)?,
            b"N   " if self.control.state() == State::Unknown => self.nodes.are_generated = true,
            b"N   " => self.nodes.command(command)?,
            _ => self.other(command),
        }
        Ok(())
    }

    fn solve(&mut self, command: &Command) {
        self.solved_at = self.solved_at.or(Some(command.line));
        self.equations.now += 1;
        self.coupled.now += 1;
        self.push(command, Action::Solve, Which::All, Components::default());
    }
}

/// Whether the fields of a command are read, so that parameters in them matter. Those of `RBE3` name arrays.
fn is_read(key: Key) -> bool {
    const READ: [&Key; 13] = [
        b"CE  ", b"CECM", b"CEDE", b"CP  ", b"CPDE", b"CERI", b"D   ", b"DDEL", b"F   ", b"FDEL", b"N   ", b"NSEL",
        b"ET  ",
    ];
    READ.contains(&&key) || key == *b"KEYO"
}

/// Whether a command sets parameters.
fn sets_parameters(key: Key) -> bool {
    const SET: [&Key; 21] = [
        b"*SET", b"*DIM", b"*DEL", b"*GET", b"*VGE", b"*VFI", b"*VOP", b"*VFU", b"*VRE", b"*VIT", b"*VSC", b"*TRE",
        b"*ASK", b"*AFU", b"*MOP", b"*MFU", b"*MFO", b"*TOP", b"/INQ", b"*SRE", b"*VMA",
    ];
    SET.contains(&&key)
}
