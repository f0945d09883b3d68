//! Commands that are not read: what they change for others, and what is said of them.

use rustc_hash::{FxHashMap, FxHashSet};

use super::AnsysReader;
use crate::deck::ansys::model::selection::SelectedNodes;
use crate::deck::ansys::syntax::command::{AnsysCommand, CommandKey};
use crate::deck::ansys::syntax::known::{CommandEffect, effect};

/// Warnings at most; the rest is counted.
const WARNINGS: usize = 1000;

/// What is remembered of commands that are not read.
#[derive(Debug, Default)]
pub struct UnreadCommands {
    effects: FxHashMap<CommandKey, CommandEffect>,
    said: FxHashSet<Vec<u8>>,
    /// Warnings beyond those that are kept.
    pub unsaid: usize,
    /// Whether any of these says that something that constrains is left out.
    pub leaves_out: bool,
}

impl AnsysReader {
    /// Commands that say what others mean, and those that are not read.
    pub fn other(&mut self, command: &AnsysCommand) {
        match &command.key {
            b"*IF " => {
                let text = "*IF leads to another line, which is not followed: what it constrains is left out";
                self.leave_out(command.line, text.to_owned());
            }
            b"NUMC" if ["CE", "CP", "NODE", "ALL"].iter().any(|word| command.is(1, word)) => {
                self.made.unread = true;
                let text =
                    "NUMCMP changes numbers, which is not followed: what commands below make of them is left out";
                self.leave_out(command.line, text.to_owned());
            }
            b"/EOF" | b"/EXI" => self.ended = true,
            b"NSEL" => self.selection.nodes_by(command),
            b"ALLS" if selects_nodes(command) => self.selection.nodes = SelectedNodes::All,
            b"NSLE" | b"NSLK" | b"NSLL" | b"NSLA" | b"NSLV" => self.selection.nodes = SelectedNodes::Unknown,
            b"CMSE" => self.selection.components_by(command, &self.nodes),
            b"NROT" | b"NANG" | b"NMOD" | b"NORA" => self.nodes.positions.turn(),
            b"LSSO" if self.solved_at.is_some() => {}
            b"DOFS" => self.selection.dofs = command.is(1, "ALL") || command.fields.is_empty(),
            b"DCUM" if !command.is(1, "REPL") && !command.field(1).is_empty() => {
                self.warn(command.line, "DCUM: values of D are taken to replace earlier ones".to_owned());
            }
            b"ALLS" | b"DCUM" => {}
            b"ET  " => {
                let warning = self.elements.element_type(command);
                warning.into_iter().for_each(|text| self.leave_out(command.line, text.to_owned()));
            }
            b"KEYO" => {
                let warning = self.elements.option(command);
                warning.into_iter().for_each(|text| self.leave_out(command.line, text.to_owned()));
            }
            b"ETBL" => self.elements.in_block = true,
            b"CM  " if command.is(2, "NODE") => self.selection.name_group(command, &mut self.nodes),
            _ => self.unread(command),
        }
    }

    /// A command that is not read: what is known of it, said once where it is unknown.
    fn unread(&mut self, command: &AnsysCommand) {
        self.nodes.positions.axes(command);
        let title = command.title();
        match self.effect(command.key) {
            CommandEffect::Nothing => {}
            CommandEffect::MakesNodes => self.nodes.are_generated = true,
            CommandEffect::Constrains => {
                self.made.unread = true;
                self.leave_out(command.line, format!("{title} constrains, but is not understood: left out"));
            }
            CommandEffect::BringsOthers if command.key == *b"*REP" && !self.constrained => {}
            CommandEffect::BringsOthers => {
                (self.nodes.are_generated, self.made.unread) = (true, true);
                self.leave_out(command.line, format!("{title} is not followed: what it constrains is left out"));
            }
            CommandEffect::Unknown => {
                self.nodes.are_generated = true;
                let text = format!("{title} is not known to this reader: if it constrains, that is left out");
                self.warn_once(command.line, title.as_bytes(), text);
            }
        }
    }

    /// Whether a command constrains, or changes what does.
    pub fn constrains(&mut self, key: CommandKey) -> bool {
        let read = [b"CE  ", b"CECM", b"CEDE", b"CP  ", b"CPDE", b"D   ", b"DDEL", b"CERI", b"RBE3"];
        read.contains(&&key) || self.effect(key) == CommandEffect::Constrains
    }

    fn effect(&mut self, key: CommandKey) -> CommandEffect {
        *self.unread.effects.entry(key).or_insert_with(|| effect(key))
    }

    pub fn warn(&mut self, line: u32, text: String) {
        if self.model.warnings.len() < WARNINGS {
            self.model.warn(0, line, text);
        } else {
            self.unread.unsaid += 1;
        }
    }

    /// Says that something that constrains is not read.
    pub fn leave_out(&mut self, line: u32, text: String) {
        if self.model.warnings.len() < WARNINGS {
            self.model.leave_out(0, line, text);
        } else {
            self.unread.unsaid += 1;
            self.unread.leaves_out = true;
        }
    }

    pub fn warn_once(&mut self, line: u32, about: &[u8], text: String) {
        if self.unread.said.insert(about.to_vec()) {
            self.warn(line, text);
        }
    }
}

/// `ALLSEL, LabT, Entity`: whether all nodes are selected after it.
fn selects_nodes(command: &AnsysCommand) -> bool {
    let among =
        |at: usize, words: &[&str]| command.field(at).is_empty() || words.iter().any(|word| command.is(at, word));
    among(1, &["ALL"]) && among(2, &["ALL", "NODE"])
}
