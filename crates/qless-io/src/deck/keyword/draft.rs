//! Builds the model of a keyword deck from the meanings of its groups of lines. There is one load case.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use super::group::{Gap, GroupMeaning};
use super::line::{KeywordFault, KeywordLine};
use crate::deck::{DeckError, Dof, LoadCase, Model, Origin, Prescribed, Problem};

/// Ends the message about a group that is left out, if the rest of the card is left out too because its lines are not understood.
const REST: &str = "left out, with the rest of the card";

/// The model under construction.
pub struct KeywordDraft {
    pub model: Model,
    pub prescribed: BTreeMap<Dof, Prescribed>,
    clashes: Vec<Prescribed>,
    /// Whether some equations hold for small rotations only.
    is_linearised: bool,
}

impl KeywordDraft {
    pub fn new(files: Vec<PathBuf>) -> Self {
        let (prescribed, clashes) = (BTreeMap::new(), Vec::new());
        Self { model: Model::new(files), prescribed, clashes, is_linearised: false }
    }

    /// The error for a fault in a card with this name.
    pub fn error(&self, name: &str, file: u32, KeywordFault { line, field, problem }: KeywordFault) -> DeckError {
        let path = self.model.files[file as usize].clone();
        DeckError { path, line: line as usize, card: name.to_owned(), field, problem }
    }

    /// Adds what a group of lines means. Leaves the group out if it needs something that the reader does not read. Returns whether more groups
    /// of the card may follow.
    pub fn group(
        &mut self,
        name: &str,
        file: u32,
        lines: &[KeywordLine],
        made: Result<GroupMeaning, Gap>,
    ) -> Result<bool, DeckError> {
        let [first, ..] = lines else { return Ok(true) };
        let (why, which) = match made {
            Ok(mut made) => {
                let left_out = made.left_out.take();
                self.add(name, file, lines, made);
                let Some(why) = left_out else { return Ok(true) };
                (why, "this is left out")
            }
            Err(Gap::Fault(KeywordFault { problem: Problem::NotFollowed { what }, .. })) => {
                (format!("needs {what}, which this reader does not follow"), "left out")
            }
            Err(Gap::Fault(fault)) => return Err(self.error(name, file, fault)),
            Err(Gap::Unread(why)) => (why, "left out"),
            Err(Gap::UnreadFromHere(why)) => (why, REST),
        };
        self.model.leave_out(file, first.number, format!("{name} {why}: {which}"));
        Ok(which != REST)
    }

    /// Adds the equations and the prescribed values of a group to the model.
    fn add(&mut self, name: &str, file: u32, lines: &[KeywordLine], made: GroupMeaning) {
        let (line, last) = (lines[0].number, lines.last().map_or(0, |line| line.number));
        self.is_linearised |= made.is_linearised;
        if let Some(text) = made.warning {
            self.model.warn(file, line, format!("{name} {text}"));
        }
        if made.rows.is_empty() && made.held.is_empty() {
            return;
        }
        let number = made.number.map_or_else(String::new, |number| format!(" {number}"));
        let number = self.model.card(format!("{name}{number}"), file, line);
        let origin = Origin { card: number, line, lines: last - line + 1 };
        made.rows.into_iter().for_each(|row| self.model.push(row.terms, 0.0, origin));
        for held in made.held {
            let history = held.history.map_or(0, |name| self.model.history(&name));
            let origin = Origin { card: number, line: held.line, lines: 1 };
            let given = Prescribed { dof: held.dof, value: held.value, history, origin };
            let first = *self.prescribed.entry(held.dof).or_insert(given);
            if (first.value, first.history) != (given.value, given.history) {
                self.clashes.push(given);
            }
        }
    }

    /// Whether a DOF is held at zero.
    pub fn is_fixed(&self, dof: Dof) -> bool {
        self.prescribed.get(&dof).is_some_and(|given| given.value == 0.0)
    }

    /// Leaves out the prescribed values of these DOFs. The text `why` is a clause.
    pub fn leave_out_values(&mut self, dofs: &BTreeSet<Dof>, why: &str) {
        let left_out = dofs.iter().filter_map(|dof| self.prescribed.remove(dof));
        let origins: BTreeSet<(u32, u32)> = left_out.map(|given| (given.origin.card, given.origin.line)).collect();
        self.clashes.retain(|given| !dofs.contains(&given.dof));
        for (card, line) in origins {
            let card = self.model.cards.nth(card);
            self.model.leave_out(card.file, line, format!("{} {why}: left out", card.name));
        }
    }

    /// The model, with a warning if some equations hold for small rotations only.
    pub fn finish(mut self, linearised: &str) -> Model {
        if self.is_linearised {
            self.model.warn(0, 0, linearised);
        }
        let prescribed = self.prescribed.into_values().collect();
        let case = LoadCase { name: "model".into(), prescribed, clashes: self.clashes, ..LoadCase::default() };
        self.model.cases.push(case);
        self.model.shrink();
        self.model
    }
}
