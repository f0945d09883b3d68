//! Numbers of equations and coupled sets: given, `HIGH` or `NEXT`.

use std::collections::BTreeMap;

use super::command::Command;
use super::field::{Fault, expected, whole};

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
