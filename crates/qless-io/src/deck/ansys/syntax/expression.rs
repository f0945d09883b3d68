//! Evaluates expressions: numbers, `+ - * / **`, parentheses, parameters, elements of arrays and a few functions.
//!
//! Operators of equal precedence are evaluated from left to right, as in ANSYS. A word without a known meaning has no value.

/// Why a text has no value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoValue {
    /// The text is no expression, or it names a parameter that is not defined.
    NotAnExpression,
    /// The value depends on something that this reader does not know.
    Unknown,
}

/// Looks up the values of names in expressions.
pub trait NameLookup {
    /// The value of a parameter.
    fn scalar(&self, name: &str) -> Result<f64, NoValue>;
    /// The value of an array element, or of a function with these arguments.
    fn call(&self, name: &str, arguments: &[f64]) -> Result<f64, NoValue>;
}

/// Limit on nested parentheses.
const DEPTH: usize = 50;

/// The value of an expression.
pub fn value(text: &[u8], names: &impl NameLookup) -> Result<f64, NoValue> {
    let mut parser = ExpressionParser { rest: text, names, depth: 0 };
    let value = parser.sum()?;
    parser.blanks();
    if !parser.rest.is_empty() {
        return Err(NoValue::NotAnExpression);
    }
    if value.is_finite() { Ok(value) } else { Err(NoValue::Unknown) }
}

struct ExpressionParser<'a, N> {
    rest: &'a [u8],
    names: &'a N,
    depth: usize,
}

impl<N: NameLookup> ExpressionParser<'_, N> {
    fn sum(&mut self) -> Result<f64, NoValue> {
        let negative = self.take(b"-");
        let _ = negative || self.take(b"+");
        let first = self.product()?;
        let mut value = if negative { -first } else { first };
        loop {
            if self.take(b"+") {
                value += self.product()?;
            } else if self.take(b"-") {
                value -= self.product()?;
            } else {
                return Ok(value);
            }
        }
    }

    fn product(&mut self) -> Result<f64, NoValue> {
        let mut value = self.power()?;
        loop {
            if self.take(b"*") {
                value *= self.power()?;
            } else if self.take(b"/") {
                value /= self.power()?;
            } else {
                return Ok(value);
            }
        }
    }

    fn power(&mut self) -> Result<f64, NoValue> {
        let mut value = self.item()?;
        while self.take(b"**") {
            value = value.powf(self.item()?);
        }
        Ok(value)
    }

    fn item(&mut self) -> Result<f64, NoValue> {
        self.blanks();
        match self.rest.first() {
            Some(b'(') => Ok(self.arguments()?[0]),
            Some(b'-') => {
                self.rest = &self.rest[1..];
                self.deeper(Self::item).map(|value| -value)
            }
            Some(byte) if byte.is_ascii_digit() || *byte == b'.' => self.number(),
            Some(byte) if is_first(*byte) => self.word(),
            _ => Err(NoValue::NotAnExpression),
        }
    }

    fn number(&mut self) -> Result<f64, NoValue> {
        let digits = |from: usize| self.rest[from..].iter().take_while(|byte| byte.is_ascii_digit()).count();
        let mut end = digits(0);
        if self.rest.get(end) == Some(&b'.') {
            end += 1 + digits(end + 1);
        }
        if matches!(self.rest.get(end), Some(b'e' | b'E' | b'd' | b'D')) {
            let sign = usize::from(matches!(self.rest.get(end + 1), Some(b'+' | b'-')));
            let count = if end + 1 + sign <= self.rest.len() { digits(end + 1 + sign) } else { 0 };
            end += if count > 0 { 1 + sign + count } else { 0 };
        }
        let (text, rest) = self.rest.split_at(end);
        self.rest = rest;
        crate::number::real(text).map_err(|_| NoValue::NotAnExpression)
    }

    fn word(&mut self) -> Result<f64, NoValue> {
        let end = self.rest.iter().position(|byte| !is_later(*byte)).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        let name = String::from_utf8_lossy(word).to_ascii_uppercase();
        self.blanks();
        if self.rest.first() == Some(&b'(') {
            let arguments = self.arguments()?;
            return self.names.call(&name, &arguments);
        }
        self.names.scalar(&name)
    }

    /// Reads the arguments in `(a, b, c)`; there must be at least one.
    fn arguments(&mut self) -> Result<Vec<f64>, NoValue> {
        self.take(b"(");
        let mut values = vec![self.deeper(Self::sum)?];
        while self.take(b",") {
            values.push(self.deeper(Self::sum)?);
        }
        if self.take(b")") { Ok(values) } else { Err(NoValue::NotAnExpression) }
    }

    fn deeper(&mut self, read: impl FnOnce(&mut Self) -> Result<f64, NoValue>) -> Result<f64, NoValue> {
        if self.depth == DEPTH {
            return Err(NoValue::Unknown);
        }
        self.depth += 1;
        let value = read(self);
        self.depth -= 1;
        value
    }

    /// Skips an operator if it comes next; `*` does not match the start of `**`.
    fn take(&mut self, operator: &[u8]) -> bool {
        self.blanks();
        let Some(rest) = self.rest.strip_prefix(operator) else { return false };
        if operator == b"*" && rest.first() == Some(&b'*') {
            return false;
        }
        self.rest = rest;
        true
    }

    fn blanks(&mut self) {
        self.rest = self.rest.trim_ascii_start();
    }
}

/// Whether names may begin with this byte.
pub fn is_first(byte: u8) -> bool {
    byte.is_ascii_alphabetic() || byte == b'_'
}

/// Whether names may contain this byte after the first.
pub fn is_later(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || byte == b'_'
}

/// An array that `*DIM` defines: numbers with up to three indices from 1. The first index varies fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct ApdlArray {
    pub sizes: [usize; 3],
    /// The elements; NaN for an unknown one.
    pub values: Vec<f64>,
    /// Whether the elements are known: false after a command has set an element whose index is unknown.
    pub is_known: bool,
}

impl ApdlArray {
    /// An array of zeros; `count` is the product of the sizes.
    pub fn zeros(sizes: [usize; 3], count: usize) -> Self {
        Self { sizes, values: vec![0.0; count], is_known: true }
    }

    /// Index of an element in `values`.
    pub fn index(&self, indices: &[f64]) -> Result<usize, NoValue> {
        let mut position = 0;
        let mut stride = 1;
        for (k, size) in self.sizes.iter().enumerate() {
            let index = indices.get(k).map_or(1.0, |index| index.round());
            if !(1.0..=*size as f64).contains(&index) {
                return Err(NoValue::Unknown);
            }
            position += (index as usize - 1) * stride;
            stride *= size;
        }
        Ok(position)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Names;

    impl NameLookup for Names {
        fn scalar(&self, name: &str) -> Result<f64, NoValue> {
            match name {
                "A" => Ok(3.0),
                "G" => Err(NoValue::Unknown),
                _ => Err(NoValue::NotAnExpression),
            }
        }

        fn call(&self, name: &str, arguments: &[f64]) -> Result<f64, NoValue> {
            if name == "SUM" { Ok(arguments.iter().sum()) } else { Err(NoValue::Unknown) }
        }
    }

    #[test]
    fn expressions_have_the_values_of_the_program() {
        for (text, expected) in [
            ("2*a", 6.0),
            ("-A", -3.0),
            ("1-A-1", -3.0),
            ("12/2/A", 2.0),
            ("2**A*2", 16.0),
            ("-2**2", -4.0),
            ("(1+A)*-2", -8.0),
            ("1e+1+1.5D0", 11.5),
            (" sum(1, A ,2*(A)) ", 10.0),
            ("2.", 2.0),
            (".5e1", 5.0),
        ] {
            assert_eq!(value(text.as_bytes(), &Names), Ok(expected), "{text}");
        }
        for text in ["", "UX", "2*", "(1", "1)", "2 3", "A B", "%A%", "'A'", "1+*2", "SUM()", "2e"] {
            assert_eq!(value(text.as_bytes(), &Names), Err(NoValue::NotAnExpression), "{text}");
        }
        for text in ["G", "2*G", "NX(3)", "1/0", "SUM(G)"] {
            assert_eq!(value(text.as_bytes(), &Names), Err(NoValue::Unknown), "{text}");
        }
        assert!(value("(".repeat(100_000).as_bytes(), &Names).is_err());
        assert!(value("-".repeat(100_000).as_bytes(), &Names).is_err());
    }
}
