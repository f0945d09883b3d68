//! Executes commands: skips those in branches that are not taken, resolves parameters, and updates equations, coupled sets
//! and values.

use super::{AnsysReader, CommandOwner, CommandPlace};
use crate::deck::ansys::commands::prescribed::{DofCommand, Rejection, dof_command, load};
use crate::deck::ansys::commands::region::{RegionContext, RegionOutcome};
use crate::deck::ansys::model::events::{ComponentList, EventAction, NodeChoice, ValueEvent};
use crate::deck::ansys::model::selection::SelectedNodes;
use crate::deck::ansys::syntax::command::{AnsysCommand, CommandKey};
use crate::deck::ansys::syntax::control::{Execution, TextPosition};
use crate::deck::ansys::syntax::field::FieldFault;
use crate::deck::ansys::syntax::known::CommandEffect;
use crate::deck::{DeckError, Origin};

impl AnsysReader {
    /// Executes one command. `next` is the start of the next line if this command is the only one on its line.
    pub fn command(&mut self, command: AnsysCommand, next: Option<TextPosition>) -> Result<(), DeckError> {
        let last = std::mem::take(&mut self.last_name);
        let repeats = command.name.is_empty();
        let from = self.places.as_ref().map_or(0, Vec::len);
        let command = command.named_as(&last);
        let mut name = Vec::with_capacity(8);
        name.extend_from_slice(command.name);
        let result = self.named(command, next);
        self.last_name = name;
        if repeats {
            // A command that begins with a comma repeats the name of the previous one, so the text of both commands must stay.
            let places = self.places.iter_mut().flatten().skip(from.saturating_sub(1));
            places.for_each(|place| place.repeats = true);
        }
        result
    }

    fn named(&mut self, mut command: AnsysCommand, next: Option<TextPosition>) -> Result<(), DeckError> {
        self.nodes.end();
        self.elements.in_block = false;
        if self.ended || self.controls(&command, next)? {
            return Ok(());
        }
        if command.key == *b"/CLE" {
            match next.filter(|_| !self.control.is_within()) {
                Some(next) => self.cleared = Some(next),
                None if self.is_empty() && self.parameters.is_empty() => {}
                None => self.lose(&command),
            }
            return Ok(());
        }
        self.is_written |= matches!(&command.key, b"SAVE" | b"CDWR");
        if uses_files(command.key) {
            self.file(&command, next);
            return Ok(());
        }
        if matches!(&command.key, b"FINI" | b"/PRE" | b"/SOL" | b"/POS") {
            let is_certain = self.control.state() == Execution::Executed;
            self.in_post1 = is_certain && command.name.eq_ignore_ascii_case(b"/POST1");
        }
        let (line, title) = (command.line, command.title());
        let constrains = self.constrains(command.key);
        let runs_others = self.effect(command.key) == CommandEffect::RunsOthers;
        if constrains || runs_others || matches!(&command.key, b"SOLV" | b"LSWR") {
            self.use_replaced();
        }
        if self.is_lost {
            return Ok(());
        }
        if constrains && self.control.state() == Execution::Unknown {
            let text =
                format!("{title} is in *IF, *DO or *CREATE, and it is not known whether it is executed: left out");
            self.leave_out_command(&command, text);
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
        match self.run(&command) {
            // A load and a node constrain nothing, whatever they are.
            Err(_) if self.nodes.are_in_files && matches!(&command.key, b"F   " | b"FDEL" | b"N   ") => {
                self.nodes.are_generated = true;
            }
            Err(_) if constrains && self.nodes.are_in_files => {
                let text = format!(
                    "{title} uses a name that may be defined in a file, which this reader does not know: left out"
                );
                self.leave_out_command(&command, text);
            }
            result => result.map_err(|fault| self.error(line, &title, fault))?,
        }
        self.constrained = constrains;
        Ok(())
    }

    /// Handles assignments and control commands. Returns true if the command needs nothing else.
    fn controls(&mut self, command: &AnsysCommand, next: Option<TextPosition>) -> Result<bool, DeckError> {
        let state = self.control.state();
        let unknown = state == Execution::Unknown;
        if memchr::memchr(b'=', command.text).is_some()
            && state != Execution::Skipped
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
        if sets && state != Execution::Skipped {
            self.parameters.command(command, unknown);
        }
        Ok(sets || state == Execution::Skipped)
    }

    /// Handles a command with a field whose value is unknown.
    fn unresolved(&mut self, command: &AnsysCommand, what: &str) {
        match &command.key {
            b"N   " => self.nodes.are_generated = true,
            b"NSEL" => self.selection.nodes = SelectedNodes::Unknown,
            b"ET  " | b"KEYO" => {
                let text = format!(
                    "{} uses {what}, whose value this reader does not know: equations of elements are left out",
                    command.title()
                );
                self.leave_out(command.line, text);
            }
            _ if self.constrains(command.key) => {
                let text = format!("{} uses {what}, whose value this reader does not know: left out", command.title());
                self.leave_out_command(command, text);
            }
            _ => {}
        }
    }

    /// Leaves out a command that constrains, and the equation or set that it belongs to.
    fn leave_out_command(&mut self, command: &AnsysCommand, text: String) {
        let prescribes =
            matches!(&command.key, b"D   " | b"DDEL") || self.effect(command.key) == CommandEffect::Prescribes;
        if prescribes {
            self.doubt(command.line, text);
            return;
        }
        match &command.key {
            b"CE  " | b"CECM" => self.equations.leave_out(command),
            b"CP  " | b"CPNG" => self.coupled.leave_out(command),
            _ => self.made.unread = true,
        }
        self.note(command.line);
        self.leave_out(command.line, text);
    }

    fn run(&mut self, command: &AnsysCommand) -> Result<(), FieldFault> {
        match &command.key {
            b"CE  " | b"CECM" | b"CEDE" | b"CP  " | b"CPDE" | b"CPNG" | b"CPLG" | b"CPSG" => {
                self.equation(command)?;
            }
            b"CERI" | b"RBE3" => self.region(command)?,
            b"D   " | b"DDEL" => match dof_command(command, &self.nodes, &self.selection) {
                Ok(read) => self.dof_command(command, read),
                Err(Rejection::LeftOut(why)) => self.doubt(command.line, format!("{why}: left out")),
                Err(Rejection::Fault(fault)) => return Err(fault),
            },
            b"F   " | b"FDEL" => match load(command, &self.nodes, &self.selection) {
                Ok(read) => read.into_iter().for_each(|read| self.dof_command(command, read)),
                // A load constrains nothing, so it does not matter which nodes it acts on.
                Err(Rejection::LeftOut(_)) => {}
                Err(Rejection::Fault(fault)) => return Err(fault),
            },
            b"SOLV" | b"LSWR" if self.control.state() == Execution::Unknown => {
                let text = format!(
                    "{} is in *IF, *DO or *CREATE, and it is not known whether it is executed",
                    command.title()
                );
                self.doubt(command.line, text);
            }
            b"SOLV" | b"LSWR" => self.solve(command),
            b"NBLO" => {
                self.archive = self.archive.or(Some("R5.0"));
                self.nodes.block();
                self.selection.define(None);
            }
            b"CMBL" => self.nodes.group(command)?,
            b"N   " if self.control.state() == Execution::Unknown => self.nodes.are_generated = true,
            b"N   " => {
                let known = self.nodes.numbers.len();
                self.nodes.command(command)?;
                self.selection.define(self.nodes.numbers.get(known).copied());
            }
            _ => self.other(command),
        }
        Ok(())
    }

    fn solve(&mut self, command: &AnsysCommand) {
        if self.repeats_saved_text {
            return;
        }
        self.solved_at = self.solved_at.or(Some(command.line));
        self.equations.now += 1;
        self.coupled.now += 1;
        self.push(command, EventAction::Solve, NodeChoice::All, ComponentList::default());
    }
}

/// Whether parameters in the fields of a command are replaced by their values before the command is executed. Those of `RBE3` are not: it
/// resolves its own fields, which may name arrays.
fn is_read(key: CommandKey) -> bool {
    const READ: [&CommandKey; 17] = [
        b"CE  ", b"CECM", b"CEDE", b"CP  ", b"CPDE", b"CPNG", b"CPLG", b"CPSG", b"CERI", b"D   ", b"DDEL", b"F   ",
        b"FDEL", b"N   ", b"NSEL", b"ET  ", b"KEYO",
    ];
    READ.contains(&&key)
}

/// Whether a command writes or reads files of the deck, or changes which files there are.
fn uses_files(key: CommandKey) -> bool {
    const FILES: [&CommandKey; 11] =
        [b"/FIL", b"SAVE", b"RESU", b"PARS", b"PARR", b"/COP", b"/REN", b"/DEL", b"/ASS", b"/SYS", b"/CWD"];
    FILES.contains(&&key)
}

/// Whether a command sets parameters.
fn sets_parameters(key: CommandKey) -> bool {
    const SET: [&CommandKey; 21] = [
        b"*SET", b"*DIM", b"*DEL", b"*GET", b"*VGE", b"*VFI", b"*VOP", b"*VFU", b"*VRE", b"*VIT", b"*VSC", b"*TRE",
        b"*ASK", b"*AFU", b"*MOP", b"*MFU", b"*MFO", b"*TOP", b"/INQ", b"*SRE", b"*VMA",
    ];
    SET.contains(&&key)
}

impl AnsysReader {
    /// Records that a line makes or changes equations.
    pub fn note(&mut self, line: u32) {
        self.made.is_open = self.control.is_within();
        self.made.line = self.made.line.max(line);
    }

    fn equation(&mut self, command: &AnsysCommand) -> Result<(), FieldFault> {
        let owner = match &command.key {
            b"CE  " => self.equations.read(command).map(CommandOwner::Equation)?,
            b"CECM" => self.equations.change_constant(command).map(CommandOwner::Equation)?,
            b"CP  " => self
                .coupled
                .read(command, &self.nodes, &self.selection)?
                .map_or(CommandOwner::Other, CommandOwner::Coupled),
            b"CPNG" => self.coupled.add_range(command)?.map_or(CommandOwner::Other, CommandOwner::Coupled),
            b"CPLG" | b"CPSG" => self.coupled.copy(command).map(|()| CommandOwner::Other)?,
            b"CEDE" => self.equations.delete(command, &self.selection).map(|()| CommandOwner::Other)?,
            _ => self.coupled.delete(command, &self.selection).map(|()| CommandOwner::Other)?,
        };
        self.place(command, owner);
        let remark = self.equations.remark.take();
        remark.into_iter().for_each(|text| self.warn(command.line, text));
        let doubt = self.equations.doubt.take().or(self.coupled.doubt.take());
        self.made.unread |= doubt.is_some() && matches!(&command.key, b"CPLG" | b"CPSG");
        doubt.into_iter().for_each(|text| self.leave_out(command.line, text));
        Ok(())
    }

    fn region(&mut self, command: &AnsysCommand) -> Result<(), FieldFault> {
        if self.nodes.positions.kept.is_none() {
            self.needs_positions = true;
            return Ok(());
        }
        let (nodes, selection, parameters) = (&self.nodes, &self.selection, &self.parameters);
        let context = RegionContext { nodes, selection, parameters, is_plane: self.elements.are_plane() };
        let (name, outcome) = match &command.key {
            b"CERI" => ("CERIG", context.rigid(command)?),
            _ => ("RBE3", context.mean(command)?),
        };
        let mut owner = CommandOwner::Other;
        match outcome {
            RegionOutcome::Equations(node, equations) => {
                let region = self.equations.region(name, node, command.line, equations.into_iter());
                owner = region.map_err(|problem| (None, problem))?.map_or(CommandOwner::Other, CommandOwner::Region);
            }
            RegionOutcome::Ignored(text) => self.warn(command.line, text),
            RegionOutcome::LeftOut(text) => {
                self.made.unread = true;
                self.leave_out(command.line, text);
            }
        }
        self.place(command, owner);
        Ok(())
    }

    fn place(&mut self, command: &AnsysCommand, owner: CommandOwner) {
        self.note(command.line);
        if let Some(places) = &mut self.places {
            let repeats = self.control.repeats();
            places.push(CommandPlace { range: command.range.clone(), line: command.line, owner, repeats });
        }
    }

    fn dof_command(&mut self, command: &AnsysCommand, DofCommand { action, nodes, components, remark }: DofCommand) {
        self.push(command, action, nodes, components);
        remark.into_iter().for_each(|text| self.warn(command.line, text));
    }

    pub fn push(&mut self, command: &AnsysCommand, action: EventAction, nodes: NodeChoice, components: ComponentList) {
        let name = match action {
            EventAction::Prescribe(..) => "D",
            EventAction::Release => "DDELE",
            EventAction::Load => "F",
            EventAction::Unload => "FDELE",
            EventAction::Solve => "SOLVE",
        };
        let card = self.model.cards.find(name).unwrap_or_else(|| self.model.card(name, 0, command.line));
        let origin = Origin { card, line: command.line, lines: 1 };
        let defined = self.nodes.numbers.len();
        self.events.push(ValueEvent { action, nodes, components, defined, origin });
    }
}
