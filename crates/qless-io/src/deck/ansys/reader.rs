//! From commands to what they do: equations, coupled sets, nodes, and values in the order of the deck.

use std::ops::Range;
use std::path::Path;

use super::commands::coupled::CoupledSets;
use super::commands::elements::Elements;
use super::commands::equations::Equations;
use super::commands::prescribed::{Reading, load, prescribe, release};
use super::commands::region::{Around, Made};
use super::commands::selection::{Selected, Selection};
use super::commands::unread::Unread;
use super::model::events::{Action, Components, Event, Which};
use super::model::nodes::Nodes;
use super::syntax::archive::{self, Quick};
use super::syntax::command::{Command, Key, Line, parse};
use super::syntax::control::{Control, Here, State};
use super::syntax::field::Fault;
use super::syntax::parameters::Parameters;
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
    /// Whether a loop carries it out, so that its text cannot go for one equation alone.
    pub repeats: bool,
}

/// An equation or a coupled set by its number, or the region of this index, which made equations of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Owner {
    Equation(u32),
    Coupled(u32),
    Region(usize),
    /// Others, or none.
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
    pub parameters: Parameters,
    pub control: Control,
    /// The line after which all equations are made, and no block is open.
    pub made_at: u32,
    /// Whether equations are made since in a block that is still open.
    are_open: bool,
    /// Whether a command that is not followed may have made equations.
    pub makes_unread: bool,
    /// Whether positions of nodes are needed that were not kept.
    pub needs_positions: bool,
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
        if self.unread.unsaid > 0 {
            let text = format!("and {} more warnings", self.unread.unsaid);
            match self.unread.leaves_out {
                true => self.model.leave_out(0, 0, text),
                false => self.model.warn(0, 0, text),
            }
        }
        Ok(self)
    }

    /// Reads a line of an archive the short way and gives its length, where that can be and nobody asks for more.
    fn quick(&mut self, text: &[u8], line: u32) -> Option<usize> {
        if self.control.is_within() || self.places.is_some() || self.solved_at.is_some() {
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
            Line::Data(_) if self.control.state() != State::CarriedOut => Ok(()),
            Line::Data(text) if self.elements.in_block => {
                let warning = self.elements.row(text);
                warning.into_iter().for_each(|text| self.leave_out(line, text.to_owned()));
                Ok(())
            }
            Line::Data(text) => self.nodes.data(text).map_err(|fault| self.error(line, "a block", fault)),
            Line::Commands(commands) => {
                let below = Here { start: start + text.len() + 1, line: line + 1 };
                let next = (commands.len() == 1).then_some(below);
                commands.into_iter().try_for_each(|command| match self.control.jump {
                    None => self.command(command, next),
                    // What stands behind the end of a loop waits for its last turn.
                    Some(_) => Ok(()),
                })
            }
        }
    }

    fn command(&mut self, mut command: Command, next: Option<Here>) -> Result<(), DeckError> {
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
            if was_within && !self.control.is_within() && std::mem::take(&mut self.are_open) {
                self.made_at = command.line;
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
            _ => self.makes_unread = true,
        }
        self.made(command.line);
        self.leave_out(command.line, text);
    }

    /// Notes that equations are made or changed at a line.
    fn made(&mut self, line: u32) {
        self.are_open = self.control.is_within();
        self.made_at = self.made_at.max(line);
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

    fn equation(&mut self, command: &Command) -> Result<(), Fault> {
        let of = match &command.key {
            b"CE  " => self.equations.read(command).map(Owner::Equation)?,
            b"CECM" => self.equations.change_constant(command).map(Owner::Equation)?,
            b"CP  " => self.coupled.read(command, &self.nodes, &self.selection)?.map_or(Owner::Other, Owner::Coupled),
            b"CEDE" => self.equations.delete(command).map(|()| Owner::Other)?,
            _ => self.coupled.delete(command).map(|()| Owner::Other)?,
        };
        self.place(command, of);
        let remark = self.equations.remark.take();
        remark.into_iter().for_each(|text| self.warn(command.line, text));
        let doubt = self.equations.doubt.take().or(self.coupled.doubt.take());
        doubt.into_iter().for_each(|text| self.leave_out(command.line, text));
        Ok(())
    }

    fn region(&mut self, command: &Command) -> Result<(), Fault> {
        if self.nodes.positions.kept.is_none() {
            self.needs_positions = true;
            return Ok(());
        }
        let (nodes, selection, parameters) = (&self.nodes, &self.selection, &self.parameters);
        let around = Around { nodes, selection, parameters, is_plane: self.elements.are_plane() };
        let (name, made) = match &command.key {
            b"CERI" => ("CERIG", around.rigid(command)?),
            _ => ("RBE3", around.mean(command)?),
        };
        let mut of = Owner::Other;
        match made {
            Made::Rows(node, rows) => {
                let region = self.equations.region(name, node, command.line, rows.into_iter());
                of = region.map_err(|problem| (None, problem))?.map_or(Owner::Other, Owner::Region);
            }
            Made::Ignored(text) => self.warn(command.line, text),
            Made::LeftOut(text) => {
                self.makes_unread = true;
                self.leave_out(command.line, text);
            }
        }
        self.place(command, of);
        Ok(())
    }

    fn place(&mut self, command: &Command, of: Owner) {
        self.made(command.line);
        if let Some(places) = &mut self.places {
            let repeats = self.control.repeats();
            places.push(Place { range: command.range.clone(), line: command.line, of, repeats });
        }
    }

    fn event(&mut self, command: &Command, reading: Reading) {
        match reading {
            Reading::Does(action, which, components) => self.push(command, action, which, components),
            Reading::Roughly(action, which, components, text) => {
                self.push(command, action, which, components);
                self.warn(command.line, text);
            }
            Reading::LeftOut(why) => self.leave_out(command.line, format!("{why}: left out")),
        }
    }

    fn push(&mut self, command: &Command, action: Action, which: Which, components: Components) {
        let name = match action {
            Action::Prescribe(..) => "D",
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
