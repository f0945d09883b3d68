//! Handles commands that this reader does not support, and warns of them; executes selections and options that change the meaning of later
//! commands.

use rustc_hash::{FxHashMap, FxHashSet};

use super::AnsysReader;
use crate::deck::ansys::model::events::{ComponentList, EventAction, NodeChoice};
use crate::deck::ansys::model::selection::SelectedNodes;
use crate::deck::ansys::syntax::command::{AnsysCommand, CommandKey};
use crate::deck::ansys::syntax::known::{CommandEffect, effect};

/// Limit on warnings; further ones are only counted.
const WARNINGS: usize = 1000;

/// The effects of the unsupported commands so far, and the number of warnings beyond the limit.
#[derive(Debug, Default)]
pub struct UnreadCommands {
    effects: FxHashMap<CommandKey, CommandEffect>,
    warned: FxHashSet<Vec<u8>>,
    /// Lines and titles of commands that replace the model, while nothing that comes later uses it.
    replaced: Vec<(u32, String)>,
    /// Lines of commands that are left out and matter only to a model with equations, with the reason; and the number of those beyond the
    /// limit.
    doubts: Vec<(u32, String)>,
    omitted_doubts: usize,
    /// Number of warnings beyond the limit, which are not stored.
    pub omitted: usize,
    /// Whether one of the omitted warnings is about a constraint that is left out.
    pub leaves_out: bool,
}

impl AnsysReader {
    /// Handles a command that is not among the supported constraints.
    pub fn other(&mut self, command: &AnsysCommand) {
        match &command.key {
            b"*IF " => {
                let text = "*IF jumps to another line, which this reader does not follow: constraints that depend on it are left out";
                self.leave_out(command.line, text.to_owned());
            }
            b"NUMC" | b"NUMO" if self.renumbers(command) => {
                self.made.unread |= self.made.line > 0;
                let title = command.title();
                let text = format!(
                    "{title} renumbers, which this reader does not follow: later commands with new numbers are left out"
                );
                self.doubt(command.line, text);
            }
            b"NDEL" if self.made.line > 0 || !self.events.is_empty() => {
                let text = "NDELE deletes nodes with their constraints, which this reader does not follow: left out";
                self.doubt(command.line, text.to_owned());
            }
            b"LSCL" if ["ALL", "FE"].iter().any(|word| command.is(1, word)) => {
                self.push(command, EventAction::Release, NodeChoice::All, ComponentList::default());
                self.push(command, EventAction::Unload, NodeChoice::All, ComponentList::default());
            }
            b"/EOF" | b"/EXI" => self.ended = true,
            b"NSEL" => self.selection.nodes_by(command),
            b"ALLS" if selects_nodes(command) => self.selection.nodes = SelectedNodes::All,
            b"ALLS" if command.is(1, "BELOW") => self.selection.nodes = SelectedNodes::Unknown,
            b"NSLE" | b"NSLK" | b"NSLL" | b"NSLA" | b"NSLV" => self.selection.nodes = SelectedNodes::Unknown,
            b"CMSE" => self.selection.components_by(command, &self.nodes),
            b"NROT" | b"NANG" | b"NMOD" | b"NORA" => self.nodes.positions.rotate(),
            b"LSSO" if self.solved_at.is_some() => {}
            b"DOFS" => self.selection.dofs = command.is(1, "ALL") || command.fields.is_empty(),
            b"DCUM" if !command.is(1, "REPL") && !command.field(1).is_empty() => {
                self.warn(command.line, "DCUM is not followed: a later value of D replaces an earlier one".to_owned());
            }
            b"ALLS" | b"DCUM" => {}
            b"ET  " if self.nodes.are_in_files && !command.field(2).iter().any(u8::is_ascii_digit) => {
                let text = "ET names a type that a file may define: equations of its elements are left out";
                self.leave_out(command.line, text.to_owned());
            }
            b"ET  " => {
                let warning = self.elements.element_type(command);
                warning.into_iter().for_each(|text| self.leave_out(command.line, text.to_owned()));
            }
            b"KEYO" => {
                let warning = self.elements.option(command);
                warning.into_iter().for_each(|text| self.leave_out(command.line, text.to_owned()));
            }
            b"ETBL" => self.elements.in_block = true,
            b"CM  " => self.selection.name_group(command, &mut self.nodes),
            b"NUMM" if ["ELEM", "TYPE", "REAL", "MAT", "MP", "SECN"].iter().any(|word| command.is(1, word)) => {}
            b"NUMM" => {
                self.made.unread |= self.made.line > 0;
                let text = format!(
                    "{} merges nodes or equations, which this reader does not follow: left out",
                    command.title()
                );
                self.doubt(command.line, text);
            }
            // The mode combination phase of a spectrum analysis writes this file. It holds commands of POST1, which constrain nothing.
            b"/INP" if self.in_post1 && command.is(2, "MCOM") => {}
            _ => self.unread(command),
        }
    }

    /// Whether `NUMCMP, Label` or `NUMOFF, Label` changes numbers that commands have. `NUMOFF` does not if nothing has a number yet.
    fn renumbers(&self, command: &AnsysCommand) -> bool {
        let changes = ["CE", "CP", "NODE", "ALL"].iter().any(|word| command.is(1, word));
        changes && (command.key == *b"NUMC" || !self.is_empty())
    }

    /// Whether no command so far has made, or may have made, a node, an equation or a value.
    pub fn is_empty(&self) -> bool {
        let is_made = self.made.line > 0 || self.made.unread || self.nodes.are_generated;
        !is_made && self.nodes.numbers.is_empty() && self.events.is_empty()
    }

    /// Whether no command since the model began has made, or may have made, an equation, and none has prescribed, loaded or solved anything.
    pub fn holds_nothing(&self) -> bool {
        self.made.line < self.begins.line.max(1) && !self.made.unread && self.events.len() == self.saved_events
    }

    /// Records the effect of an unsupported command. Warns if the command makes, or may make, constraints. Warns of an unknown command only
    /// the first time.
    fn unread(&mut self, command: &AnsysCommand) {
        self.nodes.positions.coordinate_system(command);
        let title = command.title();
        match self.effect(command.key) {
            CommandEffect::Nothing => {}
            CommandEffect::MakesNodes => self.nodes.are_generated = true,
            CommandEffect::Constrains => {
                self.made.unread = true;
                self.leave_out(
                    command.line,
                    format!("{title} constrains, but this reader does not support it: left out"),
                );
            }
            CommandEffect::Prescribes => {
                let text =
                    format!("{title} prescribes or releases values, but this reader does not support it: left out");
                self.doubt(command.line, text);
            }
            CommandEffect::RunsOthers if command.key == *b"*REP" && !self.constrained => {}
            CommandEffect::Replaces => {
                self.replace(command.line, title);
            }
            CommandEffect::RunsOthers => {
                (self.nodes.are_generated, self.nodes.are_in_files, self.made.unread) = (true, true, true);
                self.leave_out(
                    command.line,
                    format!("{title} is not followed: constraints that it makes are left out"),
                );
            }
            CommandEffect::Unknown => {
                self.nodes.are_generated = true;
                let text = format!("{title} is not known to this reader: if it makes constraints, they are left out");
                self.warn_once(command.line, title.as_bytes(), text);
            }
        }
    }

    /// Records that a command replaces the model, or a part of it, by what this reader does not know.
    pub fn replace(&mut self, line: u32, title: String) {
        (self.nodes.are_generated, self.nodes.are_in_files) = (true, true);
        self.unread.replaced.push((line, title));
    }

    /// Records that a command may have deleted the model in a block, or on a line with other commands, where this reader does not follow it.
    pub fn lose(&mut self, command: &AnsysCommand) {
        if !std::mem::replace(&mut self.is_lost, true) {
            self.replace(command.line, command.title());
        }
    }

    /// Whether `/CLEAR` or `RESUME` deletes what comes after the last solution, and no command may have solved it or written it to a file.
    pub fn deletes_rest(&self) -> bool {
        let is_known = self.unread.warned.is_empty() && !self.made.unread && self.model.left_out().next().is_none();
        self.cleared.is_some() && is_known && !self.is_written && !self.is_lost
    }

    /// Whether a command makes or changes constraints.
    pub fn constrains(&mut self, key: CommandKey) -> bool {
        let read = [
            b"CE  ", b"CECM", b"CEDE", b"CP  ", b"CPDE", b"CPNG", b"CPLG", b"CPSG", b"D   ", b"DDEL", b"CERI", b"RBE3",
        ];
        read.contains(&&key) || matches!(self.effect(key), CommandEffect::Constrains | CommandEffect::Prescribes)
    }

    pub fn effect(&mut self, key: CommandKey) -> CommandEffect {
        *self.unread.effects.entry(key).or_insert_with(|| effect(key))
    }

    pub fn warn(&mut self, line: u32, text: String) {
        if self.model.warnings.len() < WARNINGS {
            self.model.warn(0, line, text);
        } else {
            self.unread.omitted += 1;
        }
    }

    /// Warns that a constraint is left out, which makes the model incomplete. A loop may leave out the same one again, which is said once.
    pub fn leave_out(&mut self, line: u32, text: String) {
        if self.model.warnings.iter().any(|warning| warning.line == line && warning.text == text) {
            return;
        }
        if self.model.warnings.len() < WARNINGS {
            self.model.leave_out(0, line, text);
        } else {
            self.unread.omitted += 1;
            self.unread.leaves_out = true;
        }
    }

    /// Leaves out the constraints of a model that replaced the one before, and that a command uses now.
    pub fn use_replaced(&mut self) {
        for (line, title) in std::mem::take(&mut self.unread.replaced) {
            self.made.unread = true;
            self.leave_out(line, format!("{title} is not followed: constraints that it makes are left out"));
        }
    }

    /// What is replaced after the last solution only serves output. A deck without a solution is a model that others solve.
    pub fn end_replaced(&mut self) {
        if self.solved_at.is_none() && !self.follows_solution {
            self.use_replaced();
        }
        for (line, title) in std::mem::take(&mut self.unread.replaced) {
            self.warn(line, format!("{title} is not followed: nothing is constrained or solved after it"));
        }
    }

    /// Notes that a command is left out which matters only if the model has equations.
    pub fn doubt(&mut self, line: u32, text: String) {
        if self.unread.doubts.iter().any(|(known, before)| *known == line && *before == text) {
            return;
        }
        if self.unread.doubts.len() < WARNINGS {
            self.unread.doubts.push((line, text));
        } else {
            self.unread.omitted_doubts += 1;
        }
    }

    /// Says which commands that matter only to equations are left out. Without equations nothing can be redundant: a later value replaces an
    /// earlier one, and merged or renumbered nodes stay without equations. Then the model lacks nothing that matters.
    pub fn say_doubts(&mut self) {
        let matter = self.made.line > 0 || self.made.unread;
        let UnreadCommands { doubts, omitted_doubts, .. } = &mut self.unread;
        let (doubts, omitted) = (std::mem::take(doubts), std::mem::take(omitted_doubts));
        (self.unread.omitted, self.unread.leaves_out) =
            (self.unread.omitted + omitted, self.unread.leaves_out || matter && omitted > 0);
        for (line, text) in doubts {
            if matter {
                self.leave_out(line, text);
            } else {
                self.warn(line, format!("{text}; the model has no equations, so nothing is redundant"));
            }
        }
    }

    pub fn warn_once(&mut self, line: u32, about: &[u8], text: String) {
        if self.unread.warned.insert(about.to_vec()) {
            self.warn(line, text);
        }
    }
}

/// Whether `ALLSEL, LabT, Entity` selects all nodes: those of all elements belong to them.
fn selects_nodes(command: &AnsysCommand) -> bool {
    let among =
        |at: usize, words: &[&str]| command.field(at).is_empty() || words.iter().any(|word| command.is(at, word));
    among(1, &["ALL"]) && among(2, &["ALL", "NODE", "ELEM"])
}
