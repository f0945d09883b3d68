//! From commands to what they do: equations, coupled sets, nodes, and values in the order of the deck.

use std::ops::Range;
use std::path::Path;

use super::commands::coupled::CoupledSets;
use super::commands::elements::Elements;
use super::commands::equations::Equations;
use super::commands::prescribed::{Reading, Selection, load, prescribe, release};
use super::commands::unread::Unread;
use super::model::events::{Action, Components, Event, Which};
use super::model::nodes::Nodes;
use super::syntax::archive::{self, Quick};
use super::syntax::command::{Command, Line, parse};
use super::syntax::field::Fault;
use crate::bytes::LINE;
use crate::deck::{DeckError, Model, Origin, Problem};

/// A command that belongs to an equation or a coupled set, for those who change the text.
#[derive(Clone, Debug)]
pub struct Place {
    /// Its bytes.
    pub range: Range<usize>,
    /// Its line, from 1.
    pub line: u32,
    /// What it belongs to.
    pub of: Owner,
}

/// An equation or a coupled set by its number; `None` for commands that concern others or none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Owner {
    Equation(u32),
    Coupled(u32),
    Other,
}

/// What the commands read so far say.
#[derive(Debug, Default)]
pub struct Reader {
    pub model: Model,
    pub equations: Equations,
    pub coupled: CoupledSets,
    pub nodes: Nodes,
    pub events: Vec<Event>,
    /// Where equations and coupled sets are said, in order, for those who ask.
    pub places: Option<Vec<Place>>,
    pub selection: Selection,
    pub elements: Elements,
    /// How deep in `*IF`, `*DO` and `*CREATE`.
    pub depth: u32,
    /// Whether the command before constrains, which `*REPEAT` would do again.
    pub constrained: bool,
    /// Whether the rest of the file is not read.
    pub ended: bool,
    /// Whether a load step came already.
    pub solved_at: Option<u32>,
    /// The tag of archives, if the deck is written as they are.
    pub archive: Option<&'static str>,
    pub unread: Unread,
}

impl Reader {
    /// Reads the text of a deck.
    pub fn read(path: &Path, text: &[u8]) -> Result<Self, DeckError> {
        Self { model: Model::new(vec![path.to_path_buf()]), ..Self::default() }.lines(text)
    }

    /// The same, with the places of equations and coupled sets.
    pub fn with_places(path: &Path, text: &[u8]) -> Result<Self, DeckError> {
        let model = Model::new(vec![path.to_path_buf()]);
        Self { model, places: Some(Vec::new()), ..Self::default() }.lines(text)
    }

    /// The same, with the positions of nodes.
    pub fn with_positions(path: &Path, text: &[u8]) -> Result<Self, DeckError> {
        let mut reader = Self { model: Model::new(vec![path.to_path_buf()]), ..Self::default() };
        reader.nodes.positions.keep();
        reader.lines(text)
    }

    fn lines(mut self, text: &[u8]) -> Result<Self, DeckError> {
        let mut start = if text.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        let mut line = 0;
        while start < text.len() && !self.ended {
            line += 1;
            if let Some(length) = self.quick(&text[start..], line) {
                start += length;
                continue;
            }
            let end = memchr::memchr(b'\n', &text[start..]).map_or(text.len(), |end| start + end);
            self.line(&text[start..end], start, line)?;
            start = end + 1;
        }
        if self.unread.unsaid > 0 {
            let text = format!("and {} more warnings", self.unread.unsaid);
            self.model.warn(0, 0, text);
        }
        Ok(self)
    }

    /// Reads a line of an archive the short way and gives its length, where that can be and nobody asks for more.
    fn quick(&mut self, text: &[u8], line: u32) -> Option<usize> {
        if self.depth > 0 || self.places.is_some() || self.solved_at.is_some() {
            return None;
        }
        let Quick { tag, length, says } = archive::read(text)?;
        if !self.equations.quick(&says, line) {
            return None;
        }
        self.nodes.end();
        self.elements.in_block = false;
        (self.archive, self.constrained) = (Some(tag), true);
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
            Line::Data(text) if self.elements.in_block => {
                let warning = self.elements.row(text);
                warning.into_iter().for_each(|text| self.warn(line, text.to_owned()));
                Ok(())
            }
            Line::Data(text) => self.nodes.data(text).map_err(|fault| self.error(line, "a block", fault)),
            Line::Commands(commands) => commands.iter().try_for_each(|command| self.command(command)),
        }
    }

    fn command(&mut self, command: &Command) -> Result<(), DeckError> {
        self.nodes.end();
        self.elements.in_block = false;
        if self.ended || command.is_assignment() {
            return Ok(());
        }
        if let Some(tag) = command.archive_tag() {
            self.archive = Some(if tag.eq_ignore_ascii_case(b"UNBL") { "UNBL" } else { "R5.0" });
        }
        if self.depth > 0 && self.constrains(command.key) {
            let text =
                format!("{} stands inside *IF, *DO or *CREATE, which are not followed: left out", command.title());
            self.warn(command.line, text);
            return Ok(());
        }
        self.run(command).map_err(|fault| self.error(command.line, &command.title(), fault))?;
        self.constrained = self.constrains(command.key);
        Ok(())
    }

    fn run(&mut self, command: &Command) -> Result<(), Fault> {
        match &command.key {
            b"CE  " | b"CECM" | b"CEDE" | b"CP  " | b"CPDE" => self.equation(command)?,
            b"D   " => {
                let reading = prescribe(command, &self.nodes, self.selection)?;
                self.event(command, reading);
            }
            b"DDEL" => {
                let reading = release(command, &self.nodes, self.selection)?;
                self.event(command, reading);
            }
            b"F   " | b"FDEL" => {
                let reading = load(command, &self.nodes, self.selection, command.key == *b"F   ")?;
                reading.into_iter().for_each(|reading| self.event(command, reading));
            }
            b"SOLV" | b"LSWR" => {
                self.solved_at = self.solved_at.or(Some(command.line));
                self.push(command, Action::Solve, Which::All, Components::default());
            }
            b"NBLO" => {
                self.archive = self.archive.or(Some("R5.0"));
                self.nodes.block();
            }
            b"CMBL" => self.nodes.group(command)?,
            b"N   " => self.nodes.command(command)?,
            _ => self.other(command),
        }
        Ok(())
    }

    fn equation(&mut self, command: &Command) -> Result<(), Fault> {
        let of = match &command.key {
            b"CE  " => self.equations.read(command).map(Owner::Equation)?,
            b"CECM" => self.equations.change_constant(command).map(Owner::Equation)?,
            b"CP  " => self.coupled.read(command)?.map_or(Owner::Other, Owner::Coupled),
            b"CEDE" => self.equations.delete(command).map(|()| Owner::Other)?,
            _ => self.coupled.delete(command).map(|()| Owner::Other)?,
        };
        if let Some(places) = &mut self.places {
            places.push(Place { range: command.range.clone(), line: command.line, of });
        }
        let remark = self.equations.remark.take().or(self.coupled.remark.take());
        remark.into_iter().for_each(|text| self.warn(command.line, text));
        if self.solved_at.is_some() {
            let text = "equations change between load steps: every load step is judged with those at the end";
            self.warn_once(command.line, b"between steps", text.to_owned());
        }
        Ok(())
    }

    fn event(&mut self, command: &Command, reading: Reading) {
        match reading {
            Reading::Does(action, which, components) => self.push(command, action, which, components),
            Reading::Roughly(action, which, components, text) => {
                self.push(command, action, which, components);
                self.warn(command.line, text);
            }
            Reading::LeftOut(why) => self.warn(command.line, format!("{why}: left out")),
        }
    }

    fn push(&mut self, command: &Command, action: Action, which: Which, components: Components) {
        let name = match action {
            Action::Prescribe(_) => "D",
            Action::Release => "DDELE",
            Action::Load => "F",
            Action::Unload => "FDELE",
            Action::Solve => "SOLVE",
        };
        let card = self.model.cards.find(name).unwrap_or_else(|| self.model.card(name, 0, command.line));
        self.events.push(Event { action, which, components, origin: Origin { card, line: command.line, lines: 1 } });
    }

    fn error(&self, line: u32, card: &str, (field, problem): Fault) -> DeckError {
        DeckError { path: self.model.files[0].clone(), line: line as usize, card: card.to_owned(), field, problem }
    }
}
