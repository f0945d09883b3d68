//! Numbers, deletion and earlier versions of equations and coupled sets.

use crate::deck::Problem;
use crate::deck::ansys::model::numbered::NumberedSets;
use crate::deck::ansys::syntax::command::AnsysCommand;
use crate::deck::ansys::syntax::field::{FieldFault, expected, range, whole};

/// Number of terms, nodes or items that removals and deletions may still visit.
#[derive(Clone, Copy, Debug)]
pub struct SearchBudget(usize);

/// Enough for any deck; bounds the time for a hostile one.
const SEARCHES: usize = 500_000_000;

impl SearchBudget {
    /// Takes the visits of one search from the budget.
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

/// An equation or set whose present version holds from a load step on.
pub trait StartsAt {
    /// First load step of the version.
    fn from(&self) -> StepIndex;
}

/// Deletes `first, last, step` (fields 1 to 3) or `ALL`. Versions that held in a load step before `now` are added to `past`.
pub fn delete<T: StartsAt>(
    command: &AnsysCommand,
    sets: &mut NumberedSets<T>,
    past: &mut Vec<PastVersion<T>>,
    now: StepIndex,
    budget: &mut SearchBudget,
) -> Result<(), FieldFault> {
    let (first, last, step) = if command.is(1, "ALL") {
        (1, u32::MAX, 1)
    } else {
        let first = whole(command.field(1)).ok_or_else(|| expected(command, 1, "a number from 1 or ALL"))?;
        range(command, first, 2)?
    };
    if command.is(1, "ALL") && now == 0 {
        sets.clear();
        return Ok(());
    }
    let numbers = sets.within(first..=last);
    budget.spend(numbers.len()).map_err(|problem| (None, problem))?;
    for number in numbers.into_iter().filter(|number| (number - first).is_multiple_of(step)) {
        let deleted = sets.remove(number).filter(|value| value.from() < now);
        past.extend(deleted.map(|value| PastVersion { number, last: now - 1, value }));
    }
    Ok(())
}

/// The number in field `at`: `n`, `HIGH` (the `highest` so far; an empty field means the same) or `NEXT` (one above).
pub fn numbered(command: &AnsysCommand, at: usize, highest: u32) -> Result<u32, FieldFault> {
    const EXPECTED: &str = "a number from 1, HIGH or NEXT";
    match command.field(at).to_ascii_uppercase().as_slice() {
        b"" | b"HIGH" => Ok(highest.max(1)),
        b"NEXT" => highest.checked_add(1).ok_or_else(|| expected(command, at, EXPECTED)),
        digits => whole(digits).ok_or_else(|| expected(command, at, EXPECTED)),
    }
}
