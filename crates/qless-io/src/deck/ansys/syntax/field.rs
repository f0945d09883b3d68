//! Reads fields of a command as numbers, nodes and labels.

use super::command::AnsysCommand;
use super::label;
use crate::deck::Problem;
use crate::fault::quote;
use crate::{NumberFault, number};

/// A wrong field, counted from 1 after the name of the command, and the problem.
pub type FieldFault = (Option<usize>, Problem);

/// The error that field `at` does not hold `expected`.
pub fn expected(command: &AnsysCommand, at: usize, expected: &'static str) -> FieldFault {
    (Some(at), Problem::Expected { expected, found: quote(command.field(at)) })
}

/// Reads a whole number of at least 1 that fits into 32 bits.
pub fn whole(text: &[u8]) -> Option<u32> {
    number::whole(text).and_then(|value| u32::try_from(value).ok()).filter(|&value| value > 0)
}

/// The number in field `at`. An empty field is 0, and so is a number that underflows, as in ANSYS.
pub fn real(command: &AnsysCommand, at: usize) -> Result<f64, FieldFault> {
    let text = command.field(at);
    match number::real(text) {
        _ if text.is_empty() => Ok(0.0),
        Err(NumberFault::Underflow) => Ok(0.0),
        other => other.map_err(|fault| (Some(at), Problem::Number { found: quote(text), fault })),
    }
}

/// The component of the label in field `at`.
pub fn component(command: &AnsysCommand, at: usize) -> Result<u8, FieldFault> {
    const EXPECTED: &str = "the label of a degree of freedom, such as UX, ROTZ or TEMP";
    label::component(command.field(at)).ok_or_else(|| expected(command, at, EXPECTED))
}

/// The node in field `at`, and true if its number is negative. A negative number removes the node's terms.
pub fn signed_node(command: &AnsysCommand, at: usize) -> Result<(u32, bool), FieldFault> {
    let text = command.field(at);
    let digits = text.strip_prefix(b"-").unwrap_or(text);
    let node = whole(digits).ok_or_else(|| expected(command, at, "the number of a node"))?;
    Ok((node, digits.len() < text.len()))
}

/// Whether field `at` is empty or consists of zeros.
pub fn is_nothing(command: &AnsysCommand, at: usize) -> bool {
    command.field(at).iter().all(|&byte| byte == b'0')
}

/// `(first, last, step)`; fields `at` and `at + 1` hold last and step. A blank last means `first`, a blank step means 1, and a last below
/// `first` counts as `first`.
pub fn range(command: &AnsysCommand, first: u32, at: usize) -> Result<(u32, u32, u32), FieldFault> {
    const EXPECTED: &str = "a whole number from 1";
    let or = |at: usize, default: u32| {
        if is_nothing(command, at) {
            return Ok(default);
        }
        whole(command.field(at)).ok_or_else(|| expected(command, at, EXPECTED))
    };
    Ok((first, or(at, first)?.max(first), or(at + 1, 1)?))
}
