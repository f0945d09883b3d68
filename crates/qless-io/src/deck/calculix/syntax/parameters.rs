//! Parameters of Abaqus: `*PARAMETER` has lines `name = expression`, and `<name>` stands for the value on any other card.
//!
//! Expressions are of Python. Those of numbers, names, operators and common functions have a value here, and quoted texts. Cards that need
//! another one are left out.

use rustc_hash::FxHashMap;

use super::{DataLine, KeywordCard, fold_name};
use crate::deck::Problem;
use crate::deck::expression::{self, NameLookup, NoValue, Operand};
use crate::number::real;

/// The parameters of a deck, by their names in capitals. A value is the text that replaces `<name>`; `None` if it is not known.
#[derive(Default)]
pub struct DeckParameters {
    values: FxHashMap<String, Option<Vec<u8>>>,
}

impl DeckParameters {
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Records `*PARAMETER`. If definitions of one name differ, the value is not known.
    pub fn define(&mut self, card: &KeywordCard) {
        for (name, text) in card.lines().filter_map(|line| definition(&line)) {
            let value = self.value_of(text);
            match self.values.get_mut(&name) {
                Some(first) if *first != value => *first = None,
                Some(_) => {}
                None => drop(self.values.insert(name, value)),
            }
        }
    }

    /// The parameters that a card defines and whose values are not known, each with the file and the line of its definition.
    pub fn without_value(&self, card: &KeywordCard) -> Vec<(u32, u32, String)> {
        if !card.is("*PARAMETER") {
            return Vec::new();
        }
        let named = card.lines().filter_map(|line| Some((line, definition(&line)?.0)));
        let is_unknown = |name: &String| self.values.get(name).is_some_and(Option::is_none);
        named.filter(|(_, name)| is_unknown(name)).map(|(line, name)| (line.file, line.number, name)).collect()
    }

    /// The text with values in place of all `<name>` that are known; `None` if it has none.
    pub fn replaced(&self, text: &[u8]) -> Option<Vec<u8>> {
        if self.is_empty() || memchr::memchr(b'<', text).is_none() {
            return None;
        }
        let mut new = Vec::with_capacity(text.len());
        for piece in text.split_inclusive(|&byte| byte == b'>') {
            let start = memchr::memrchr(b'<', piece).unwrap_or(piece.len());
            let name = piece[start..].strip_prefix(b"<").and_then(|name| name.strip_suffix(b">"));
            let value = name.and_then(|name| self.values.get(&folded(name))?.as_ref());
            new.extend_from_slice(&piece[..start]);
            new.extend_from_slice(value.map_or(&piece[start..], Vec::as_slice));
        }
        Some(new)
    }

    fn value_of(&self, text: &[u8]) -> Option<Vec<u8>> {
        for quote in [b"'", b"\""] {
            if let Some(text) = text.strip_prefix(quote).and_then(|text| text.strip_suffix(quote)) {
                return (!text.contains(&quote[0])).then(|| text.to_vec());
            }
        }
        let Operand { value, is_whole } = expression::operand(text, self).ok()?;
        let text = if is_whole && value.abs() < 1e15 { format!("{value}") } else { format!("{value:?}") };
        Some(text.into_bytes())
    }
}

impl NameLookup for DeckParameters {
    const IS_STRICT: bool = true;

    fn scalar(&self, name: &str) -> Result<Operand, NoValue> {
        let text = match self.values.get(name) {
            None if name == "PI" => return Ok(Operand::real(std::f64::consts::PI)),
            None => return Err(NoValue::NotAnExpression),
            Some(text) => text.as_ref().ok_or(NoValue::Unknown)?,
        };
        let value = real(text).map_err(|_| NoValue::Unknown)?;
        Ok(Operand { value, is_whole: !text.iter().any(|byte| matches!(byte, b'.' | b'e')) })
    }

    fn call(&self, name: &str, arguments: &[Operand]) -> Result<Operand, NoValue> {
        expression::function(name, arguments)
    }
}

/// The name and the expression on a line `name = expression # comment`; `None` for other lines.
fn definition<'a>(line: &DataLine<'a>) -> Option<(String, &'a [u8])> {
    let text = line.text.split(|&byte| byte == b'#').next()?;
    let at = memchr::memchr(b'=', text)?;
    let name = text[..at].trim_ascii();
    let is_name = expression::is_first(*name.first()?) && name.iter().all(|byte| expression::is_later(*byte));
    is_name.then(|| (folded(name), text[at + 1..].trim_ascii()))
}

fn folded(name: &[u8]) -> String {
    fold_name(&String::from_utf8_lossy(name))
}

/// The problem of a field `<name>`, whose parameter has no known value; `None` for other fields.
pub fn unknown(field: &[u8]) -> Option<Problem> {
    let name = field.trim_ascii().strip_prefix(b"<")?.strip_suffix(b">")?;
    Some(Problem::NotFollowed { what: format!("the value of the parameter {}", String::from_utf8_lossy(name)) })
}

/// The problem that nothing has this name, or that its parameter has no known value.
pub fn undefined(what: &'static str, name: String) -> Problem {
    unknown(name.as_bytes()).unwrap_or(Problem::Undefined { what, name })
}
