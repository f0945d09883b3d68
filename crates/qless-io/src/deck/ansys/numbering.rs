//! What equations and coupled sets share: numbers, given or `HIGH` or `NEXT`, and a limit on searches.

use std::collections::BTreeMap;

use super::command::Command;
use super::field::{Fault, expected, whole};
use crate::deck::Problem;

/// Terms or nodes that may still be gone through to find those that are taken away.
#[derive(Debug)]
pub struct Searches(pub usize);

/// Enough for any deck; bounds the time that a hostile one takes.
const SEARCHES: usize = 500_000_000;

impl Default for Searches {
    fn default() -> Self {
        Self(SEARCHES)
    }
}

/// What is wrong where there are no more.
pub fn too_many_taken_away() -> Problem {
    let advice = "leave out what is taken away again";
    Problem::Limit { what: "the work of taking terms or nodes away", limit: SEARCHES, advice }
}

/// The number in field `at`: `n`, `HIGH` (the highest so far; also where the field is empty) or `NEXT` (one above).
pub fn numbered<T>(command: &Command, at: usize, sets: &BTreeMap<u32, T>) -> Result<u32, Fault> {
    const EXPECTED: &str = "a number from 1, HIGH or NEXT";
    let highest = sets.last_key_value().map_or(0, |(&number, _)| number);
    match command.field(at).to_ascii_uppercase().as_slice() {
        b"" | b"HIGH" => Ok(highest.max(1)),
        b"NEXT" => highest.checked_add(1).ok_or_else(|| expected(command, at, EXPECTED)),
        digits => whole(digits).ok_or_else(|| expected(command, at, EXPECTED)),
    }
}
