//! From commands to what they do: equations, coupled sets, nodes, and values in the order of the deck.

mod commands;
mod unread;

use std::ops::Range;
use std::path::Path;

use super::commands::coupled::CoupledSets;
use super::commands::elements::ElementTypes;
use super::commands::equations::CeEquations;
use super::model::events::ValueEvent;
use super::model::nodes::AnsysNodes;
use super::model::selection::NodeSelection;
use super::syntax::archive;
use super::syntax::archive::ArchiveLine;
use super::syntax::command::{AnsysLine, parse};
use super::syntax::control::{Execution, FlowControl, TextPosition};
use super::syntax::field::FieldFault;
use super::syntax::parameters::ApdlParameters;
use crate::bytes::LINE;
use crate::deck::{DeckError, Model, Problem};
use unread::UnreadCommands;

/// A command that belongs to an equation or a coupled set, for those who change the text.
#[derive(Clone, Debug)]
pub struct CommandPlace {
    /// Its bytes.
    pub range: Range<usize>,
    /// Its line, from 1.
    pub line: u32,
    /// What it belongs to.
    pub of: CommandOwner,
    /// Whether a loop carries it out, or a comma repeats its name, so that its text cannot go for one equation alone.
    pub repeats: bool,
}

/// An equation or a coupled set by its number, or the region of this index, which made equations of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum CommandOwner {
    Equation(u32),
    Coupled(u32),
    Region(usize),
    /// Others, or none.
    Other,
}

/// Where equations are made.
#[derive(Debug, Default)]
pub struct EquationsMade {
    /// The line after which all of them are, and no block is open.
    pub line: u32,
    /// Whether some are since in a block that is still open.
    is_open: bool,
    /// Whether a command that is not followed may have made some.
    pub unread: bool,
}

/// What the commands read so far say.
#[derive(Debug, Default)]
pub struct AnsysReader {
    pub model: Model,
    pub equations: CeEquations,
    pub coupled: CoupledSets,
    pub nodes: AnsysNodes,
    pub events: Vec<ValueEvent>,
    /// Where equations and coupled sets are said, in order, for those who ask.
    pub places: Option<Vec<CommandPlace>>,
    pub selection: NodeSelection,
    pub elements: ElementTypes,
    pub parameters: ApdlParameters,
    pub control: FlowControl,
    pub made: EquationsMade,
    /// Whether positions of nodes are needed that were not kept.
    pub needs_positions: bool,
    /// Whether the command before constrains, which `*REPEAT` would do again.
    pub constrained: bool,
    /// The name of the command before, which a line that begins with a comma repeats.
    pub last: Vec<u8>,
    /// Whether the rest of the file is not read.
    pub ended: bool,
    /// Whether a load step came already.
    pub solved_at: Option<u32>,
    /// The tag of archives, if the deck is written as they are.
    pub archive: Option<&'static str>,
    pub unread: UnreadCommands,
}

impl AnsysReader {
    /// Reads the text of a deck.
    pub fn read(path: &Path, text: &[u8]) -> Result<Self, DeckError> {
        Self::with(path, text, |_| ())
    }

    /// The same, with the places of equations and coupled sets.
    pub fn with_places(path: &Path, text: &[u8]) -> Result<Self, DeckError> {
        Self::with(path, text, |reader| reader.places = Some(Vec::new()))
    }

    /// The same, with the positions of nodes.
    pub fn with_positions(path: &Path, text: &[u8]) -> Result<Self, DeckError> {
        Self::with(path, text, |reader| reader.nodes.positions.keep())
    }

    /// Positions take room, so that they are kept only once a command needs them.
    fn with(path: &Path, text: &[u8], set: impl Fn(&mut Self)) -> Result<Self, DeckError> {
        let new = || {
            let mut reader = Self { model: Model::new(vec![path.to_path_buf()]), ..Self::default() };
            set(&mut reader);
            reader
        };
        let reader = new().lines(text)?;
        if !reader.needs_positions {
            return Ok(reader);
        }
        let mut again = new();
        again.nodes.positions.keep();
        again.lines(text)
    }

    fn lines(mut self, text: &[u8]) -> Result<Self, DeckError> {
        let mut start = if text.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        let mut line = 0;
        while start < text.len() && !self.ended && !self.needs_positions {
            line += 1;
            if let Some(length) = self.quick(&text[start..], line) {
                start += length;
                continue;
            }
            let end = memchr::memchr(b'\n', &text[start..]).map_or(text.len(), |end| start + end);
            self.line(&text[start..end], start, line)?;
            start = end + 1;
            if let Some(here) = self.control.jump.take() {
                (start, line) = (here.start, here.line - 1);
            }
        }
        if let Some(line) = self.control.never_closed().filter(|_| !self.ended) {
            let text = "*DO, *IF or *CREATE is never closed: what it would still constrain is left out";
            self.leave_out(line, text.to_owned());
        }
        if self.unread.unsaid > 0 {
            let text = format!("and {} more warnings", self.unread.unsaid);
            if self.unread.leaves_out {
                self.model.leave_out(0, 0, text);
            } else {
                self.model.warn(0, 0, text);
            }
        }
        Ok(self)
    }

    /// Reads a line of an archive the short way and gives its length, where that can be and nobody asks for more.
    fn quick(&mut self, text: &[u8], line: u32) -> Option<usize> {
        if self.control.is_within() || self.places.is_some() || self.solved_at.is_some() {
            return None;
        }
        let ArchiveLine { tag, length, says } = archive::read(text)?;
        if !self.equations.quick(&says, line) {
            return None;
        }
        self.nodes.end();
        self.elements.in_block = false;
        (self.archive, self.constrained) = (Some(tag), true);
        self.last.clear();
        self.last.extend_from_slice(b"CE");
        let remark = self.equations.remark.take();
        remark.into_iter().for_each(|text| self.warn(line, text));
        Some(length)
    }

    fn line(&mut self, text: &[u8], start: usize, line: u32) -> Result<(), DeckError> {
        if text.len() > LINE {
            let advice = "break it up";
            let problem = Problem::Limit { what: "the length of the line", limit: LINE, advice };
            return Err(self.error(line, "a line", (None, problem)));
        }
        match parse(text, start, line) {
            AnsysLine::Data(_) if self.control.state() != Execution::CarriedOut => Ok(()),
            AnsysLine::Data(text) if self.elements.in_block => {
                let warning = self.elements.row(text);
                warning.into_iter().for_each(|text| self.leave_out(line, text.to_owned()));
                Ok(())
            }
            AnsysLine::Data(text) => self.nodes.data(text).map_err(|fault| self.error(line, "a block", fault)),
            AnsysLine::Commands(commands) => {
                let below = TextPosition { start: start + text.len() + 1, line: line + 1 };
                let next = (commands.len() == 1).then_some(below);
                commands.into_iter().try_for_each(|command| match self.control.jump {
                    None => self.command(command, next),
                    // What stands behind the end of a loop waits for its last turn.
                    Some(_) => Ok(()),
                })
            }
        }
    }

    fn error(&self, line: u32, card: &str, (field, problem): FieldFault) -> DeckError {
        DeckError { path: self.model.files[0].clone(), line: line as usize, card: card.to_owned(), field, problem }
    }
}
