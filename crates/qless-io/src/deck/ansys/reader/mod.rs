//! Reads the text of a deck: collects equations, coupled sets, nodes, and values in the order of the deck.

mod commands;
mod files;
mod models;
mod unread;

use std::ops::Range;
use std::sync::Arc;

use super::commands::coupled::CoupledSets;
use super::commands::elements::ElementTypes;
use super::commands::equations::CeEquations;
use super::model::events::ValueEvent;
use super::model::nodes::AnsysNodes;
use super::model::selection::NodeSelection;
use super::model::written::{Resumed, TextPart, WrittenFiles};
use super::syntax::archive::{self, ArchiveLine};
use super::syntax::command::{AnsysLine, parse};
use super::syntax::control::{Execution, FlowControl, TextPosition};
use super::syntax::field::FieldFault;
use super::syntax::parameters::ApdlParameters;
use crate::bytes::LINE;
use crate::deck::{DeckError, Dof, Model, Problem};
pub use models::AnsysModels;
use unread::UnreadCommands;

/// The place of a command that belongs to an equation or a coupled set. `write` edits the text at these places.
#[derive(Clone, Debug)]
pub struct CommandPlace {
    /// The bytes of the command in the file.
    pub range: Range<usize>,
    /// The line of the command, from 1.
    pub line: u32,
    pub owner: CommandOwner,
    /// Whether the text of the command serves several commands, so that it cannot be removed for one equation alone. This is so in
    /// a loop, and where a command begins with a comma and so takes the name of the command before it.
    pub repeats: bool,
}

/// The owner of a command: an equation or a coupled set by number, or a `CERIG` or `RBE3` by its index among the regions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum CommandOwner {
    Equation(u32),
    Coupled(u32),
    Region(usize),
    /// The command belongs to several equations or sets, or to none.
    Other,
}

/// Where the deck makes equations.
#[derive(Debug, Default)]
pub struct EquationsMade {
    /// The last line that makes equations or closes a block of commands that makes them.
    pub line: u32,
    /// Whether a block that is still open makes equations.
    is_open: bool,
    /// Whether an unsupported command may make equations.
    pub unread: bool,
}

/// The state of the reader after the commands that it has read so far.
#[derive(Debug, Default)]
#[expect(clippy::struct_excessive_bools, reason = "each is a property that stands alone")]
pub struct AnsysReader {
    pub model: Model,
    pub equations: CeEquations,
    pub coupled: CoupledSets,
    pub nodes: AnsysNodes,
    pub events: Vec<ValueEvent>,
    /// DOFs that the model has although no equation names them.
    pub others: Vec<Dof>,
    /// The commands that belong to equations and coupled sets, in order; `None` if they are not needed.
    pub places: Option<Vec<CommandPlace>>,
    pub selection: NodeSelection,
    pub elements: ElementTypes,
    pub parameters: ApdlParameters,
    pub control: FlowControl,
    pub made: EquationsMade,
    /// Whether a command needs the positions of nodes although the reader did not keep them.
    pub needs_positions: bool,
    /// Whether the previous command constrains: then `*REPEAT` would repeat a constraint.
    pub constrained: bool,
    /// Name of the previous command; a line that begins with a comma repeats it.
    pub last_name: Vec<u8>,
    /// Whether `/EOF` or `/EXIT` has ended the deck.
    pub ended: bool,
    /// Whether the commands are those of POST1, which constrain nothing.
    pub in_post1: bool,
    /// Line of the first `SOLVE`.
    pub solved_at: Option<u32>,
    /// Whether an earlier model of the deck is solved.
    pub follows_solution: bool,
    /// Where the next model begins, if `/CLEAR` or `RESUME` has ended this one.
    pub cleared: Option<TextPosition>,
    /// What the next model begins with, if `RESUME` has ended this one.
    resumes: Option<Resumed>,
    /// Whether a command may have deleted the model where this reader cannot follow it. What comes after it is left out.
    is_lost: bool,
    /// Whether the model is written to a file, so that others may solve it.
    is_written: bool,
    /// Where this model begins; `parts` of the text come before it if `RESUME` begins the model.
    begins: TextPosition,
    parts: Arc<[TextPart]>,
    /// Whether the reader repeats the text of `parts`.
    repeats_saved_text: bool,
    /// Number of `events` of `parts`.
    saved_events: usize,
    /// Whether the deck has read parameters from a file since the model began.
    has_read_parameters: bool,
    files: WrittenFiles,
    /// The archive tag, such as `R5.0`, if the deck has the format of an archive.
    pub archive: Option<&'static str>,
    pub unread: UnreadCommands,
}

impl AnsysReader {
    /// Reads one model of a deck.
    fn model(mut self, text: &[u8]) -> Result<Self, DeckError> {
        self.repeats_saved_text = true;
        for (from, until) in self.parts.clone().iter() {
            self.lines(&text[..*until], *from)?;
        }
        self.repeats_saved_text = false;
        self.saved_events = self.events.len();
        self.lines(text, self.begins)?;
        self.end();
        Ok(self)
    }

    fn lines(&mut self, text: &[u8], from: TextPosition) -> Result<(), DeckError> {
        let (mut start, mut line) = (from.start, from.line - 1);
        while start < text.len() && !self.ended && !self.needs_positions && self.cleared.is_none() {
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
        Ok(())
    }

    /// Says what is left out for reasons that only the end of the model shows.
    fn end(&mut self) {
        if let Some(line) = self.control.never_closed().filter(|_| !self.ended) {
            let text = "*DO, *IF or *CREATE is never closed: constraints that it may still make are left out";
            self.leave_out(line, text.to_owned());
        }
        self.end_replaced();
        self.say_doubts();
        if self.unread.omitted > 0 {
            let text = format!("and {} more warnings", self.unread.omitted);
            if self.unread.leaves_out {
                self.model.leave_out(0, 0, text);
            } else {
                self.model.warn(0, 0, text);
            }
        }
    }

    /// Reads a line of an archive by the fast path and returns its length; `None` if the line needs the general path.
    fn quick(&mut self, text: &[u8], line: u32) -> Option<usize> {
        if self.control.is_within() || self.places.is_some() || self.solved_at.is_some() || self.is_lost {
            return None;
        }
        let ArchiveLine { tag, length, statement } = archive::read(text)?;
        if !self.equations.quick(&statement, line) {
            return None;
        }
        self.note(line);
        self.nodes.end();
        self.elements.in_block = false;
        (self.archive, self.constrained) = (Some(tag), true);
        self.last_name.clear();
        self.last_name.extend_from_slice(b"CE");
        let remark = self.equations.remark.take();
        remark.into_iter().for_each(|text| self.warn(line, text));
        Some(length)
    }

    fn line(&mut self, text: &[u8], start: usize, line: u32) -> Result<(), DeckError> {
        if text.len() > LINE {
            let advice = "split it";
            let problem = Problem::Limit { what: "the length of the line", limit: LINE, advice };
            return Err(self.error(line, "a line", (None, problem)));
        }
        match parse(text, start, line) {
            AnsysLine::Data(_) if self.control.state() != Execution::Executed => Ok(()),
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
                    // A command on this line has closed a loop, so reading continues at the start of the loop. The rest of this line is
                    // executed after the last iteration.
                    Some(_) => Ok(()),
                })
            }
        }
    }

    pub fn error(&self, line: u32, card: &str, (field, problem): FieldFault) -> DeckError {
        DeckError { path: self.model.files[0].clone(), line: line as usize, card: card.to_owned(), field, problem }
    }
}
