//! APDL parameters: sets them by `A = 1.5`, `*SET` and `*DIM`, and replaces them by their values in the fields of commands.

use crate::deck::limits::ELEMENTS;
use std::borrow::Cow;

use rustc_hash::FxHashMap;

use super::array::ApdlArray;
use super::command::AnsysCommand;
use crate::deck::expression::{NameLookup, NoValue, Operand, function, is_first, is_later, value};

/// Limit on the array elements that `PARSAV` saves. Parameters with more count as unknown when they are read again.
const SAVED: usize = 10_000;

/// The value of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum ParameterValue {
    Number(f64),
    /// A quoted text.
    Text(String),
    /// A value that this reader does not know.
    Unknown,
    /// A table, which is a function of time and place.
    Table,
    Array(ApdlArray),
}

/// The parameters set so far.
#[derive(Clone, Debug, Default)]
pub struct ApdlParameters {
    values: FxHashMap<String, ParameterValue>,
    elements: usize,
    degrees: bool,
}

/// The left-hand side of an assignment: `name` or `name(1,2,3)`.
struct AssignmentTarget {
    name: String,
    indices: Option<String>,
}

impl ApdlParameters {
    /// Executes `name = value`; returns false if the text is no assignment. If `unknown` is true, it is not known whether the assignment is
    /// executed, so the new value is unknown.
    pub fn assign(&mut self, text: &[u8], unknown: bool) -> bool {
        let Some((target, rest)) = target(text) else { return false };
        let Some(values) = rest.trim_ascii_start().strip_prefix(b"=") else { return false };
        self.set(&target, &split(values), unknown);
        true
    }

    /// Executes `*SET, name, value, value, ...` and other commands that set parameters.
    pub fn command(&mut self, command: &AnsysCommand, unknown: bool) {
        let field = |at: usize| command.field(at).to_vec();
        let Some((target, _)) = target(command.field(1)) else { return };
        match &command.key {
            b"*SET" => {
                let values: Vec<Vec<u8>> = command.fields.iter().skip(1).map(|field| field.to_vec()).collect();
                self.set(&target, &values, unknown);
            }
            b"*DEL" => self.put(target.name, None),
            b"*DIM" if unknown => self.put(target.name, Some(ParameterValue::Unknown)),
            b"*DIM" => {
                let sizes = [3, 4, 5].map(|at| self.number(&field(at)));
                let value = if command.is(2, "TABL") || command.is(2, "TABLE") {
                    ParameterValue::Table
                } else {
                    self.array(sizes)
                };
                self.put(target.name, Some(value));
            }
            b"*AFU" => self.degrees = command.is(1, "DEG"),
            _ => self.forget(&target.name),
        }
    }

    /// Sets a parameter to a number.
    pub fn define(&mut self, name: &str, value: f64) {
        self.put(name.to_owned(), Some(ParameterValue::Number(value)));
    }

    /// Makes a parameter unknown.
    pub fn forget(&mut self, name: &str) {
        self.put(name.to_owned(), Some(ParameterValue::Unknown));
    }

    /// Makes all parameters unknown.
    pub fn forget_all(&mut self) {
        self.values.values_mut().for_each(|value| *value = ParameterValue::Unknown);
        self.elements = 0;
    }

    /// What `PARSAV` writes: the scalars, or `all` parameters. `None` if this would take too much memory.
    pub fn saved(&self, all: bool) -> Option<Self> {
        let is_array = |value: &ParameterValue| matches!(value, ParameterValue::Array(_) | ParameterValue::Table);
        let values = self.values.iter().filter(|(_, value)| all || !is_array(value));
        let elements = if all { self.elements } else { 0 };
        let saved =
            || Self { values: values.map(|(name, value)| (name.clone(), value.clone())).collect(), elements, ..*self };
        (elements <= SAVED).then(saved)
    }

    /// Executes `PARRES`: the saved parameters replace all, or with `change` only those of their names.
    pub fn read_saved(&mut self, saved: &Self, change: bool) {
        if !change {
            *self = Self { degrees: self.degrees, ..saved.clone() };
            return;
        }
        saved.values.iter().for_each(|(name, value)| self.put(name.clone(), Some(value.clone())));
    }

    /// Whether there are no parameters.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// Whether a parameter has this name.
    pub fn is_name(&self, text: &[u8]) -> bool {
        self.values.contains_key(&String::from_utf8_lossy(text).to_ascii_uppercase())
    }

    /// The value of a number or expression.
    pub fn number(&self, text: &[u8]) -> Result<f64, NoValue> {
        match crate::number::real(text.trim_ascii()) {
            Ok(value) => Ok(value),
            Err(_) => value(text, self),
        }
    }

    /// Replaces parameters and expressions in the fields by their values. The error is the first field whose value is unknown.
    pub fn resolve(&self, command: &mut AnsysCommand) -> Result<(), String> {
        for field in &mut command.fields {
            if let Some(text) = self.replacement(field)? {
                *field = Cow::Owned(text);
            }
        }
        Ok(())
    }

    /// The elements of an array, from the first one for `NAME`, or from element 3 for `NAME(3)`. `None` if they are unknown.
    pub fn elements(&self, text: &[u8]) -> Option<&[f64]> {
        let (target, rest) = target(text)?;
        let ParameterValue::Array(array) = self.values.get(&target.name)? else { return None };
        let first = match target.indices {
            Some(indices) => self.index(array, &indices).ok()?,
            None => 0,
        };
        (array.is_known && rest.trim_ascii().is_empty()).then(|| &array.values[first..])
    }

    /// The text that replaces a field, or `None` if the field stays. If the field's value is unknown, the error holds the first characters
    /// of the field.
    fn replacement(&self, field: &[u8]) -> Result<Option<Vec<u8>>, String> {
        let unknown = || String::from_utf8_lossy(&field[..field.len().min(32)]).into_owned();
        if let Some(quoted) = field.strip_prefix(b"'").and_then(|rest| rest.strip_suffix(b"'")) {
            return Ok(Some(quoted.to_vec()));
        }
        let forced = field.strip_prefix(b"%").and_then(|rest| rest.strip_suffix(b"%"));
        let text = forced.unwrap_or(field);
        let is_name = text.first().is_some_and(|byte| is_first(*byte)) && text.iter().all(|byte| is_later(*byte));
        if is_name {
            return match self.values.get(&String::from_utf8_lossy(text).to_ascii_uppercase()) {
                Some(ParameterValue::Number(value)) => Ok(Some(field_text(*value))),
                Some(ParameterValue::Text(text)) => Ok(Some(text.clone().into_bytes())),
                Some(ParameterValue::Unknown) => Err(unknown()),
                Some(ParameterValue::Table | ParameterValue::Array(_)) | None => Ok(None),
            };
        }
        let operates = text.iter().enumerate().any(|(at, byte)| b"+-*/(".contains(byte) && (at > 0 || *byte == b'('));
        let negated = text.first() == Some(&b'-') && text.get(1).is_some_and(|byte| is_first(*byte));
        if forced.is_some() || !(operates || negated) || crate::number::real(text).is_ok() {
            return Ok(None);
        }
        match value(text, self) {
            Ok(value) => Ok(Some(field_text(value))),
            Err(NoValue::NotAnExpression) => Ok(None),
            Err(NoValue::Unknown) => Err(unknown()),
        }
    }

    fn set(&mut self, target: &AssignmentTarget, texts: &[Vec<u8>], unknown: bool) {
        let values: Vec<ParameterValue> =
            texts.iter().map(|text| if unknown { ParameterValue::Unknown } else { self.read(text) }).collect();
        let Some(indices) = &target.indices else {
            let first = texts.first().filter(|text| !text.is_empty()).and_then(|_| values.into_iter().next());
            return self.put(target.name.clone(), first);
        };
        let index = match self.values.get(&target.name) {
            Some(ParameterValue::Array(array)) => self.index(array, indices),
            // The element of a table may be ignored: constraints do not depend on the content of tables.
            Some(ParameterValue::Table) => return,
            _ => return self.forget(&target.name),
        };
        let Some(ParameterValue::Array(array)) = self.values.get_mut(&target.name) else { return };
        let Ok(index) = index else {
            array.is_known = false;
            return;
        };
        for (to, value) in array.values[index..].iter_mut().zip(values) {
            *to = if let ParameterValue::Number(value) = value { value } else { f64::NAN };
        }
    }

    fn read(&self, text: &[u8]) -> ParameterValue {
        let text = text.trim_ascii();
        if let Some(quoted) = text.strip_prefix(b"'") {
            let end = quoted.iter().position(|byte| *byte == b'\'').unwrap_or(quoted.len());
            return ParameterValue::Text(String::from_utf8_lossy(&quoted[..end]).into_owned());
        }
        let name = String::from_utf8_lossy(text).to_ascii_uppercase();
        match (self.values.get(&name), self.number(text)) {
            (Some(ParameterValue::Text(text)), _) => ParameterValue::Text(text.clone()),
            (_, Ok(value)) => ParameterValue::Number(value),
            _ => ParameterValue::Unknown,
        }
    }

    fn put(&mut self, name: String, value: Option<ParameterValue>) {
        let size =
            |value: &ParameterValue| if let ParameterValue::Array(array) = value { array.values.len() } else { 0 };
        self.elements += value.as_ref().map_or(0, size);
        let before = match value {
            Some(value) => self.values.insert(name, value),
            None => self.values.remove(&name),
        };
        self.elements -= before.as_ref().map_or(0, size);
    }

    fn array(&self, sizes: [Result<f64, NoValue>; 3]) -> ParameterValue {
        let sizes = sizes.map(|size| size.map_or(1, |size| size.max(1.0) as usize));
        let count = sizes.iter().try_fold(1_usize, |count, size| count.checked_mul(*size));
        match count.filter(|count| count.saturating_add(self.elements) <= ELEMENTS) {
            Some(count) => ParameterValue::Array(ApdlArray::zeros(sizes, count)),
            None => ParameterValue::Unknown,
        }
    }

    /// The index in `ApdlArray::values` of the element with these indices.
    fn index(&self, array: &ApdlArray, indices: &str) -> Result<usize, NoValue> {
        let texts = split(indices.as_bytes());
        let indices: Vec<f64> = texts.iter().map(|text| self.number(text)).collect::<Result<_, _>>()?;
        array.index(&indices)
    }
}

impl NameLookup for ApdlParameters {
    const IS_STRICT: bool = false;

    fn scalar(&self, name: &str) -> Result<Operand, NoValue> {
        match self.values.get(name) {
            Some(ParameterValue::Number(value)) => Ok(Operand::real(*value)),
            Some(ParameterValue::Array(array)) if array.is_known && !array.values[0].is_nan() => {
                Ok(Operand::real(array.values[0]))
            }
            Some(ParameterValue::Array(_) | ParameterValue::Unknown | ParameterValue::Table) => Err(NoValue::Unknown),
            Some(ParameterValue::Text(_)) | None => Err(NoValue::NotAnExpression),
        }
    }

    fn call(&self, name: &str, arguments: &[Operand]) -> Result<Operand, NoValue> {
        let values: Vec<f64> = arguments.iter().map(|argument| argument.value).collect();
        if let Some(ParameterValue::Array(array)) = self.values.get(name) {
            let value = array.values[array.index(&values)?];
            return if array.is_known && !value.is_nan() { Ok(Operand::real(value)) } else { Err(NoValue::Unknown) };
        }
        let angle = |x: f64| if self.degrees { x.to_radians() } else { x };
        match (name, values.as_slice()) {
            ("NINT", [x]) => Ok(Operand::real(x.round())),
            ("MOD", [x, y]) => Ok(Operand::real(x % y)),
            ("SIN" | "COS" | "TAN", [x]) => function(name, &[Operand::real(angle(*x))]),
            ("ABS" | "SQRT" | "EXP" | "LOG" | "LOG10" | "SINH" | "COSH" | "TANH", [_]) => function(name, arguments),
            _ => Err(NoValue::Unknown),
        }
    }
}

/// Splits `name` or `name(...)` from the rest of the text.
fn target(text: &[u8]) -> Option<(AssignmentTarget, &[u8])> {
    let text = text.trim_ascii_start();
    let end = text.iter().position(|byte| !is_later(*byte)).unwrap_or(text.len());
    let (name, rest) = text.split_at(end);
    name.first().filter(|byte| is_first(**byte))?;
    let name = String::from_utf8_lossy(name).to_ascii_uppercase();
    let Some(inside) = rest.trim_ascii_start().strip_prefix(b"(") else {
        return Some((AssignmentTarget { name, indices: None }, rest));
    };
    let mut depth = 1;
    let close = inside.iter().position(|byte| {
        depth += i32::from(*byte == b'(') - i32::from(*byte == b')');
        depth == 0
    })?;
    let indices = Some(String::from_utf8_lossy(&inside[..close]).into_owned());
    Some((AssignmentTarget { name, indices }, &inside[close + 1..]))
}

/// Splits at commas outside parentheses.
fn split(text: &[u8]) -> Vec<Vec<u8>> {
    let mut depth = 0;
    text.split(|byte| {
        depth += i32::from(*byte == b'(') - i32::from(*byte == b')');
        *byte == b',' && depth <= 0
    })
    .map(|field| field.trim_ascii().to_vec())
    .collect()
}

/// Writes a value as the text of a field. Whole numbers get no decimal point, as they may be node numbers.
fn field_text(value: f64) -> Vec<u8> {
    if value.fract() == 0.0 && value.abs() < 1e15 { format!("{}", value as i64) } else { format!("{value:?}") }
        .into_bytes()
}

#[cfg(test)]
mod tests {
    use super::super::command::{AnsysLine, parse};
    use super::*;

    /// Executes lines and returns the fields of the last command that sets no parameter.
    fn fields(lines: &[&str]) -> Result<Vec<String>, String> {
        let mut parameters = ApdlParameters::default();
        let mut last = Ok(Vec::new());
        for line in lines {
            let AnsysLine::Commands(mut commands) = parse(line.as_bytes(), 0, 1) else { continue };
            for command in &mut commands {
                if parameters.assign(command.text, false) {
                    continue;
                }
                if command.key[0] == b'*' {
                    parameters.command(command, false);
                    continue;
                }
                let resolved = parameters.resolve(command);
                let text = |field: &Cow<[u8]>| String::from_utf8_lossy(field).into_owned();
                last = resolved.map(|()| command.fields.iter().map(text).collect());
            }
        }
        last
    }

    #[test]
    fn values_replace_parameters() {
        let is = |lines: &[&str], expected: &[&str]| {
            let expected: Vec<String> = expected.iter().map(|&text| text.to_owned()).collect();
            assert_eq!(fields(lines), Ok(expected), "{lines:?}");
        };
        is(&["W=3.0", "*SET,n,2", "CE,n,W/4,-N,UX,2*w"], &["2", "0.75", "-2", "UX", "6"]);
        is(&["L='ROTZ' $ w = .1", "D,1,L,w"], &["1", "ROTZ", "0.1"]);
        is(&["*DIM,A,ARRAY,3,2", "A(1)=5,6,7", "A(2,2) = 9", "X,A(3),A(2,2),A(1,2)"], &["7", "9", "0"]);
        is(
            &["*DIM,A,,2", "*SET,A(1),5,6", "B=A(2)", "X,B,%B%,1e-3,-4,R5.0,+2"],
            &["6", "6", "1e-3", "-4", "R5.0", "+2"],
        );
        is(&["B=1", "B=", "X,B,%B%"], &["B", "%B%"]);
        is(&["*AFUN,DEG", "X,ABS(-2),SQRT(9),MOD(7,4),NINT(2*COS(60))"], &["2", "3", "3", "1"]);
        is(&["X,LOG10(100),7/2,2**-1,TANH(0)"], &["2", "3.5", "0.5", "0"]);
        is(&["*DIM,T,TABLE,3", "D,1,UX,%T%"], &["1", "UX", "%T%"]);
        is(&["TITLE it's (", "X,a-b"], &["a-b"]);
    }

    #[test]
    fn unknown_parameters_have_no_value() {
        for lines in [
            &["*GET,N,NODE,,NUM,MAX", "X,N"][..],
            &["*GET,N,NODE,,NUM,MAX", "M=N+1", "X,2*M"],
            &["X,NODE(1,2,3)"],
            &["*DIM,A,ARRAY,3", "X,A(4)"],
            &["*DIM,A,ARRAY,3", "*VGET,A(1),NODE,1,LOC,X", "X,A(1)"],
            &["*DIM,A,ARRAY,4000,4000", "X,A(1)"],
            &["A(3)=1", "X,A(3)"],
            &["W=1/0", "X,W"],
        ] {
            assert!(fields(lines).is_err(), "{lines:?}");
        }
    }

    #[test]
    fn elements_of_arrays() {
        let mut parameters = ApdlParameters::default();
        let dim = parse(b"*DIM,A,ARRAY,3", 0, 1);
        let AnsysLine::Commands(commands) = dim else { panic!("commands") };
        parameters.command(&commands[0], false);
        assert!(parameters.assign(b"A(1)=4,5,6", false));
        assert_eq!(parameters.elements(b"a(2)"), Some(&[5.0, 6.0][..]));
        assert_eq!(parameters.elements(b"A").map(<[f64]>::len), Some(3));
        for text in [&b"A(4)"[..], b"B(1)", b"A(1)+1", b""] {
            assert_eq!(parameters.elements(text), None);
        }
    }
}
