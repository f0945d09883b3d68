//! What equations and coupled sets share: numbers, given or `HIGH` or `NEXT`, and a limit on searches.

use crate::deck::Problem;
use crate::deck::ansys::model::numbered::NumberedSets;
use crate::deck::ansys::syntax::command::AnsysCommand;
use crate::deck::ansys::syntax::field::{FieldFault, expected, range, whole};

/// Terms or nodes that may still be gone through to find those that are taken away.
#[derive(Debug)]
pub struct SearchBudget(pub usize);

/// Enough for any deck; bounds the time that a hostile one takes.
const SEARCHES: usize = 500_000_000;

impl Default for SearchBudget {
    fn default() -> Self {
        Self(SEARCHES)
    }
}

/// A load step, counted from 0.
pub type StepIndex = u32;

/// What held up to a load step.
#[derive(Debug)]
pub struct PastVersion<T> {
    pub number: u32,
    pub last: StepIndex,
    pub value: T,
}

/// What exists from a load step on.
pub trait StartsAt {
    /// The first load step that it is solved in.
    fn from(&self) -> StepIndex;
}

/// Takes away the sets `first, last, step` of a command from field 1 on, or `ALL` of them; those that held in a load step before `now`
/// are kept for it.
pub fn delete<T: StartsAt>(
    command: &AnsysCommand,
    sets: &mut NumberedSets<T>,
    past: &mut Vec<PastVersion<T>>,
    now: StepIndex,
    left: &mut SearchBudget,
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
    left.0 = left.0.checked_sub(numbers.len()).ok_or((None, too_many_taken_away()))?;
    for number in numbers.into_iter().filter(|number| (number - first).is_multiple_of(step)) {
        let gone = sets.remove(number).filter(|value| value.from() < now);
        past.extend(gone.map(|value| PastVersion { number, last: now - 1, value }));
    }
    Ok(())
}

/// What is wrong where there are no more.
pub fn too_many_taken_away() -> Problem {
    let advice = "leave out what is taken away again";
    Problem::Limit { what: "the work of taking terms or nodes away", limit: SEARCHES, advice }
}

/// The number in field `at`: `n`, `HIGH` (the highest so far; also where the field is empty) or `NEXT` (one above).
pub fn numbered<T>(command: &AnsysCommand, at: usize, sets: &NumberedSets<T>) -> Result<u32, FieldFault> {
    const EXPECTED: &str = "a number from 1, HIGH or NEXT";
    let highest = sets.highest().unwrap_or(0);
    match command.field(at).to_ascii_uppercase().as_slice() {
        b"" | b"HIGH" => Ok(highest.max(1)),
        b"NEXT" => highest.checked_add(1).ok_or_else(|| expected(command, at, EXPECTED)),
        digits => whole(digits).ok_or_else(|| expected(command, at, EXPECTED)),
    }
}
