//! What commands that constrain make of the equations, coupled sets and values so far, and where they stand.

use super::{Owner, Place, Reader};
use crate::deck::Origin;
use crate::deck::ansys::commands::prescribed::Reading;
use crate::deck::ansys::commands::region::{Around, Made};
use crate::deck::ansys::model::events::{Action, Components, Event, Which};
use crate::deck::ansys::syntax::command::Command;
use crate::deck::ansys::syntax::field::Fault;

impl Reader {
    /// Notes that equations are made or changed at a line.
    pub fn note(&mut self, line: u32) {
        self.made.is_open = self.control.is_within();
        self.made.line = self.made.line.max(line);
    }

    pub fn equation(&mut self, command: &Command) -> Result<(), Fault> {
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

    pub fn region(&mut self, command: &Command) -> Result<(), Fault> {
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
                self.made.unread = true;
                self.leave_out(command.line, text);
            }
        }
        self.place(command, of);
        Ok(())
    }

    fn place(&mut self, command: &Command, of: Owner) {
        self.note(command.line);
        if let Some(places) = &mut self.places {
            let repeats = self.control.repeats();
            places.push(Place { range: command.range.clone(), line: command.line, of, repeats });
        }
    }

    pub fn event(&mut self, command: &Command, reading: Reading) {
        match reading {
            Reading::Does(action, which, components) => self.push(command, action, which, components),
            Reading::Roughly(action, which, components, text) => {
                self.push(command, action, which, components);
                self.warn(command.line, text);
            }
            Reading::LeftOut(why) => self.leave_out(command.line, format!("{why}: left out")),
        }
    }

    pub fn push(&mut self, command: &Command, action: Action, which: Which, components: Components) {
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
}
