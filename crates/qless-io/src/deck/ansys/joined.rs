//! Joins the models of a deck. In each load case, only the equations of one model hold.

use super::model::events::EventAction;
use super::reader::AnsysReader;
use crate::deck::limits::HELD;
use crate::deck::{DeckError, LoadCase, Model, Problem};

/// The models so far as one, in whose load cases only the equations of one model hold.
#[derive(Default)]
pub struct JoinedModels {
    model: Option<Model>,
    /// Number of models that hold anything.
    count: usize,
    is_solved: bool,
    /// The load cases that the deck deletes without a solution, each with the line of the `/CLEAR` or `RESUME`.
    deleted: Vec<(usize, u32)>,
}

impl JoinedModels {
    /// Adds the model of a reader, to which `fill` has added equations and load cases.
    pub fn add(&mut self, reader: AnsysReader) -> Result<(), DeckError> {
        let holds_nothing = reader.holds_nothing();
        let solutions = reader.events.iter().filter(|event| event.action == EventAction::Solve).count();
        let deletes_case = reader.deletes_rest() && !holds_nothing && reader.model.cases.len() > solutions;
        self.is_solved |= solutions > 0;
        self.join(reader.model, holds_nothing)?;
        if let (true, Some(next)) = (deletes_case, reader.cleared) {
            self.deleted.push((self.model.as_ref().map_or(0, |model| model.cases.len() - 1), next.line - 1));
        }
        Ok(())
    }

    /// If any model is solved, the load cases that are deleted without a solution do not count. Otherwise others solve the deck.
    pub fn finish(self) -> Model {
        let mut model = self.model.unwrap_or_default();
        for &(case, line) in self.deleted.iter().rev().filter(|_| self.is_solved) {
            model.cases.remove(case);
            model.warn(0, line, "constraints above this line are deleted without a solution: they are not checked");
        }
        model
    }

    /// Joins a model with those before it. One that holds nothing has no load cases, unless there is no other.
    fn join(&mut self, mut model: Model, holds_nothing: bool) -> Result<(), DeckError> {
        let Some(joined) = &mut self.model else {
            self.count = usize::from(!holds_nothing);
            self.model = Some(model);
            return Ok(());
        };
        if holds_nothing {
            joined.warnings.append(&mut model.warnings);
            return Ok(());
        }
        if self.count == 0 {
            model.warnings.splice(..0, joined.warnings.drain(..));
            *joined = model;
        } else {
            if self.count == 1 {
                name_cases(joined, 1);
            }
            name_cases(&mut model, self.count + 1);
            // Text that RESUME repeats gives the same warnings again.
            model.warnings.retain(|warning| !joined.warnings.contains(warning));
            joined.append(&model);
            check_held(joined)?;
        }
        self.count += 1;
        Ok(())
    }
}

fn name_cases(model: &mut Model, number: usize) {
    model.cases.iter_mut().for_each(|case| case.name = format!("model {number}, {}", case.name));
}

fn check_held(model: &Model) -> Result<(), DeckError> {
    let held = |case: &LoadCase| case.prescribed.len() + case.loads.len() + case.removed.len();
    if model.cases.iter().map(held).sum::<usize>() <= HELD {
        return Ok(());
    }
    let problem = Problem::Limit {
        what: "the number of values in all load steps, and of equations that they lack",
        limit: HELD,
        advice: "make a deck for each model",
    };
    Err(DeckError { path: model.files[0].clone(), line: 0, card: "/CLEAR".to_owned(), field: None, problem })
}
