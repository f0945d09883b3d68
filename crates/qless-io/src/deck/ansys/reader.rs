//! From commands to what they do: equations, coupled sets, nodes, and values in the order of the deck.

use std::ops::Range;
use std::path::{Path, PathBuf};

use rustc_hash::{FxHashMap, FxHashSet};

use super::command::{Command, Key, Line, parse};
use super::coupled::CoupledSets;
use super::elements::Elements;
use super::equations::Equations;
use super::events::{Action, Event, Which};
use super::field::Fault;
use super::known::{Effect, effect};
use super::nodes::Nodes;
use super::prescribed::{Reading, Selection, load, prescribe, release};
use crate::deck::source::LINE;
use crate::deck::{DeckError, Model, Origin, Problem};

/// Warnings at most; the rest is counted.
const WARNINGS: usize = 1000;

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
#[derive(Debug)]
pub struct Reader {
    pub model: Model,
    pub equations: Equations,
    pub coupled: CoupledSets,
    pub nodes: Nodes,
    pub events: Vec<Event>,
    /// Where equations and coupled sets are said, in order.
    pub places: Vec<Place>,
    path: PathBuf,
    selection: Selection,
    elements: Elements,
    /// How deep in `*IF`, `*DO` and `*CREATE`.
    depth: u32,
    /// Whether the command before constrains, which `*REPEAT` would do again.
    constrained: bool,
    ended: bool,
    /// Whether a load step came already.
    pub solved_at: Option<u32>,
    /// Whether the deck is written as archives are.
    pub is_archive: bool,
    effects: FxHashMap<Key, Effect>,
    said: FxHashSet<Vec<u8>>,
    unsaid: usize,
}

impl Reader {
    /// Reads the text of a deck.
    pub fn read(path: &Path, text: &[u8]) -> Result<Self, DeckError> {
        let mut reader = Self::new(path);
        let mut start = if text.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        let mut line = 0;
        while start < text.len() && !reader.ended {
            let end = memchr::memchr(b'\n', &text[start..]).map_or(text.len(), |end| start + end);
            line += 1;
            reader.line(&text[start..end], start, line)?;
            start = end + 1;
        }
        if reader.unsaid > 0 {
            let text = format!("and {} more warnings", reader.unsaid);
            reader.model.warn(0, 0, text);
        }
        Ok(reader)
    }

    fn new(path: &Path) -> Self {
        Self {
            model: Model::new(vec![path.to_path_buf()]),
            equations: Equations::default(),
            coupled: CoupledSets::default(),
            nodes: Nodes::default(),
            events: Vec::new(),
            places: Vec::new(),
            path: path.to_path_buf(),
            selection: Selection { nodes: true, dofs: true },
            elements: Elements::default(),
            depth: 0,
            constrained: false,
            ended: false,
            solved_at: None,
            is_archive: false,
            effects: FxHashMap::default(),
            said: FxHashSet::default(),
            unsaid: 0,
        }
    }

    fn line(&mut self, text: &[u8], start: usize, line: u32) -> Result<(), DeckError> {
        if text.len() > LINE {
            let advice = "break it up";
            let problem = Problem::Limit { what: "the length of the line", limit: LINE, advice };
            return Err(self.error(line, "a line", (None, problem)));
        }
        match parse(text, start, line) {
            Line::Data(text) => self.nodes.data(text).map_err(|fault| self.error(line, "a block", fault)),
            Line::Commands(commands) => commands.iter().try_for_each(|command| self.command(command)),
        }
    }

    fn command(&mut self, command: &Command) -> Result<(), DeckError> {
        self.nodes.end();
        let is_assignment = command.name.contains(&b'=') || command.field(1).starts_with(b"=");
        if self.ended || is_assignment {
            return Ok(());
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
                self.push(command, Action::Solve, Which::All, Vec::new());
            }
            b"NBLO" => {
                self.is_archive = true;
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
        self.places.push(Place { range: command.range.clone(), line: command.line, of });
        let remark = self.equations.remark.take().or(self.coupled.remark.take());
        remark.into_iter().for_each(|text| self.warn(command.line, text));
        self.is_archive |= command.is(1, "R5.0");
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

    fn push(&mut self, command: &Command, action: Action, which: Which, components: Vec<u8>) {
        let name = match action {
            Action::Prescribe(_) => "D",
            Action::Release => "DDELE",
            Action::Load => "F",
            Action::Unload => "FDELE",
            Action::Solve => "SOLVE",
        };
        let card = match self.model.cards.iter().position(|card| card.name == name) {
            Some(card) => card as u32,
            None => self.model.card(name, 0, command.line),
        };
        self.events.push(Event { action, which, components, origin: Origin { card, line: command.line, lines: 1 } });
    }

    /// Commands that say what others mean, and those that are not read.
    fn other(&mut self, command: &Command) {
        match &command.key {
            b"*IF " if !command.fields.iter().any(|field| field.eq_ignore_ascii_case(b"THEN")) => {}
            b"*IF " | b"*DO " | b"*DOW" | b"*CRE" => self.depth = self.depth.saturating_add(1),
            b"*END" => self.depth = self.depth.saturating_sub(1),
            b"/EOF" | b"/EXI" => self.ended = true,
            b"NSEL" => self.selection.nodes = command.is(1, "ALL"),
            b"ALLS" => self.selection.nodes |= selects_nodes(command),
            b"NSLE" | b"NSLK" | b"NSLL" | b"NSLA" | b"NSLV" | b"CMSE" => self.selection.nodes = false,
            b"DOFS" => self.selection.dofs = command.is(1, "ALL") || command.fields.is_empty(),
            b"DCUM" if !command.is(1, "REPL") && !command.field(1).is_empty() => {
                self.warn(command.line, "DCUM: values of D are taken to replace earlier ones".to_owned());
            }
            b"DCUM" => {}
            b"ET  " => self.elements.element_type(command).into_iter().for_each(|text| self.warn(command.line, text)),
            b"KEYO" => self.elements.option(command).into_iter().for_each(|text| self.warn(command.line, text)),
            _ => self.unread(command),
        }
    }

    /// A command that is not read: what is known of it, said once where it is unknown.
    fn unread(&mut self, command: &Command) {
        let title = command.title();
        match self.effect(command.key) {
            Effect::Nothing => {}
            Effect::MakesNodes => self.nodes.are_generated = true,
            Effect::Constrains => {
                self.warn(command.line, format!("{title} constrains, but is not understood: left out"));
            }
            Effect::BringsOthers if command.key == *b"*REP" && !self.constrained => {}
            Effect::BringsOthers => {
                self.nodes.are_generated = true;
                self.warn(command.line, format!("{title} is not followed: what it constrains is left out"));
            }
            Effect::Unknown => {
                self.nodes.are_generated = true;
                let text = format!("{title} is not known to this reader: if it constrains, that is left out");
                self.warn_once(command.line, title.as_bytes(), text);
            }
        }
    }

    /// Whether a command constrains, or changes what does.
    fn constrains(&mut self, key: Key) -> bool {
        let read = [b"CE  ", b"CECM", b"CEDE", b"CP  ", b"CPDE", b"D   ", b"DDEL"];
        read.contains(&&key) || self.effect(key) == Effect::Constrains
    }

    fn effect(&mut self, key: Key) -> Effect {
        *self.effects.entry(key).or_insert_with(|| effect(key))
    }

    fn warn(&mut self, line: u32, text: String) {
        if self.model.warnings.len() < WARNINGS {
            self.model.warn(0, line, text);
        } else {
            self.unsaid += 1;
        }
    }

    fn warn_once(&mut self, line: u32, about: &[u8], text: String) {
        if self.said.insert(about.to_vec()) {
            self.warn(line, text);
        }
    }

    fn error(&self, line: u32, card: &str, (field, problem): Fault) -> DeckError {
        DeckError { path: self.path.clone(), line: line as usize, card: card.to_owned(), field, problem }
    }
}

/// `ALLSEL, LabT, Entity`: whether all nodes are selected after it.
fn selects_nodes(command: &Command) -> bool {
    let among =
        |at: usize, words: &[&str]| command.field(at).is_empty() || words.iter().any(|word| command.is(at, word));
    among(1, &["ALL"]) && among(2, &["ALL", "NODE"])
}
