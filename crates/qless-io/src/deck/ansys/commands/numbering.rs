//! What equations and coupled sets have in common: their numbers, their deletion, and their earlier versions.

use crate::deck::Problem;
use crate::deck::ansys::model::numbered::NumberedSets;
use crate::deck::ansys::model::selection::{NodeSelection, SelectedNodes};
use crate::deck::ansys::syntax::command::AnsysCommand;
use crate::deck::ansys::syntax::field::{FieldFault, expected, range, whole};

/// The number of terms, nodes or numbered items that further removals and deletions may visit.
#[derive(Clone, Copy, Debug)]
pub struct SearchBudget(usize);

/// The initial budget. It suffices for any deck, and it bounds the time for a hostile one.
const SEARCHES: usize = 500_000_000;

impl SearchBudget {
    /// Takes the visits of one search from the budget; an error if they exceed it.
    pub fn spend(&mut self, visits: usize) -> Result<(), Problem> {
        let advice = "do not add what is removed again";
        let limit = Problem::Limit { what: "the work to remove terms or nodes", limit: SEARCHES, advice };
        self.0 = self.0.checked_sub(visits).ok_or(limit)?;
        Ok(())
    }
}

impl Default for SearchBudget {
    fn default() -> Self {
        Self(SEARCHES)
    }
}

/// A load step, counted from 0.
pub type StepIndex = u32;

/// The version of an equation or set that held up to load step `last`.
#[derive(Debug)]
pub struct PastVersion<T> {
    pub number: u32,
    pub last: StepIndex,
    pub value: T,
}

/// An equation or coupled set whose present version holds from some load step on.
pub trait StartsAt {
    /// The first load step in which the present version holds.
    fn from(&self) -> StepIndex;
}

/// Deletes the numbers `first, last, step` (fields 1 to 3), or `ALL`, of items with `ANY` selected node, or only if `ALL` selected nodes are
/// in the item (field 4). Moves versions that held in a load step before `now` to `past`. Returns the numbers of items that are deleted although it is not
/// known whether their `nodes` are selected.
pub fn delete<T: StartsAt>(
    command: &AnsysCommand,
    selection: &NodeSelection,
    (sets, past): (&mut NumberedSets<T>, &mut Vec<PastVersion<T>>),
    now: StepIndex,
    budget: &mut SearchBudget,
    nodes: impl Fn(&T) -> Vec<u32>,
) -> Result<Vec<u32>, FieldFault> {
    let (first, last, step) = if command.is(1, "ALL") {
        (1, u32::MAX, 1)
    } else {
        let first = whole(command.field(1)).ok_or_else(|| expected(command, 1, "a number from 1 or ALL"))?;
        range(command, first, 2)?
    };
    if command.is(1, "ALL") && !command.is(4, "ALL") && now == 0 && selection.nodes == SelectedNodes::All {
        sets.clear();
        return Ok(Vec::new());
    }
    let numbers = sets.within(first..=last);
    budget.spend(numbers.len()).map_err(|problem| (None, problem))?;
    let mut uncertain = Vec::new();
    for number in numbers.into_iter().filter(|number| (number - first).is_multiple_of(step)) {
        match sets.get_mut(number).map(|item| selection.holds(&nodes(item), command.is(4, "ALL"))) {
            Some(Some(false)) => continue,
            Some(None) => uncertain.push(number),
            _ => {}
        }
        let deleted = sets.remove(number).filter(|value| value.from() < now);
        past.extend(deleted.map(|value| PastVersion { number, last: now - 1, value }));
    }
    Ok(uncertain)
}

/// The message about a deletion that leaves items out because it is not known whether their nodes are selected.
pub fn uncertain_deletion(command: &AnsysCommand) -> String {
    let title = command.title();
    format!("{title} deletes by the selected nodes, which this reader does not know: what it may delete is left out")
}

/// The number in field `at`. The field holds a number, `HIGH` or nothing (the `highest` so far, at least 1), or `NEXT` (the one after
/// `highest`).
pub fn numbered(command: &AnsysCommand, at: usize, highest: u32) -> Result<u32, FieldFault> {
    const EXPECTED: &str = "a number from 1, HIGH or NEXT";
    match command.field(at).to_ascii_uppercase().as_slice() {
        b"" | b"HIGH" => Ok(highest.max(1)),
        b"NEXT" => highest.checked_add(1).ok_or_else(|| expected(command, at, EXPECTED)),
        digits => whole(digits).ok_or_else(|| expected(command, at, EXPECTED)),
    }
}
