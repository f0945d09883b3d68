//! Evaluates expressions: numbers, `+ - * / **`, parentheses, names and functions. A word without a known meaning has no value.
//!
//! Operators of equal precedence are evaluated from left to right, as in ANSYS. For other programs, an expression has a value only if it does
//! not depend on the program's rules ([`NameLookup::IS_STRICT`]):
//!
//! | expression | values |
//! | --- | --- |
//! | `7/2` | 3 with division of whole numbers, or 3.5 |
//! | `2**-1` | 0 with powers of whole numbers, or 0.5 |
//! | `2**3**2` | 512 from right to left, or 64 |
//! | `-2**2` | -4, or 4 if the sign comes first |
//! | `010` | 8 with octal numbers, or 10 |

/// Why a text has no value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoValue {
    /// The text is no expression, or it names a parameter that is not defined.
    NotAnExpression,
    /// The value depends on something that this reader does not know.
    Unknown,
}

/// A value in an expression.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Operand {
    pub value: f64,
    /// Whether the program may store the value as a whole number.
    pub is_whole: bool,
}

impl Operand {
    /// A value that is no whole number to the program.
    pub fn real(value: f64) -> Self {
        Self { value, is_whole: false }
    }
}

/// Looks up the values of names in expressions.
pub trait NameLookup {
    /// Whether an expression whose value depends on the program's rules has no value.
    const IS_STRICT: bool;
    /// The value of a parameter.
    fn scalar(&self, name: &str) -> Result<Operand, NoValue>;
    /// The value of an array element, or of a function with these arguments.
    fn call(&self, name: &str, arguments: &[Operand]) -> Result<Operand, NoValue>;
}

/// The value of a function that all programs have; angles are in radians.
pub fn function(name: &str, arguments: &[Operand]) -> Result<Operand, NoValue> {
    let values: Vec<f64> = arguments.iter().map(|argument| argument.value).collect();
    let value = match (name, values.as_slice()) {
        ("ABS", [x]) => x.abs(),
        ("SQRT", [x]) => x.sqrt(),
        ("EXP", [x]) => x.exp(),
        ("LOG", [x]) => x.ln(),
        ("LOG10", [x]) => x.log10(),
        ("SIN", [x]) => x.sin(),
        ("COS", [x]) => x.cos(),
        ("TAN", [x]) => x.tan(),
        ("ASIN", [x]) => x.asin(),
        ("ACOS", [x]) => x.acos(),
        ("ATAN", [x]) => x.atan(),
        ("ATAN2", [y, x]) => y.atan2(*x),
        ("SINH", [x]) => x.sinh(),
        ("COSH", [x]) => x.cosh(),
        ("TANH", [x]) => x.tanh(),
        ("MIN", [first, rest @ ..]) => rest.iter().fold(*first, |least, x| least.min(*x)),
        ("MAX", [first, rest @ ..]) => rest.iter().fold(*first, |most, x| most.max(*x)),
        ("INT", [x]) => x.trunc(),
        ("FLOAT", [x]) => *x,
        _ => return Err(NoValue::Unknown),
    };
    let keeps = matches!(name, "ABS" | "MIN" | "MAX") && arguments.iter().any(|argument| argument.is_whole);
    known(Operand { value, is_whole: keeps || name == "INT" })
}

/// The operand, unless it is no number: programs stop there, and a function such as `MIN` would hide it.
fn known(operand: Operand) -> Result<Operand, NoValue> {
    if operand.value.is_finite() { Ok(operand) } else { Err(NoValue::Unknown) }
}

/// Limit on nested parentheses.
const DEPTH: usize = 50;

/// The value of an expression.
pub fn value(text: &[u8], names: &impl NameLookup) -> Result<f64, NoValue> {
    operand(text, names).map(|operand| operand.value)
}

/// The value of an expression, and whether the program may store it as a whole number.
pub fn operand(text: &[u8], names: &impl NameLookup) -> Result<Operand, NoValue> {
    let mut parser = ExpressionParser { rest: text, names, depth: 0 };
    let operand = parser.sum()?;
    parser.blanks();
    if !parser.rest.is_empty() {
        return Err(NoValue::NotAnExpression);
    }
    known(operand)
}

/// The value of an operation on two operands, which is whole if both are. If `is_strict`, a value from two whole numbers is unknown if it has
/// a fraction, or does not fit into 32 bits, in which a program may store it.
fn both(a: Operand, b: Operand, value: f64, is_strict: bool) -> Result<Operand, NoValue> {
    let is_whole = a.is_whole && b.is_whole;
    if is_strict && is_whole && (value.fract() != 0.0 || value.abs() > f64::from(i32::MAX)) {
        return Err(NoValue::Unknown);
    }
    known(Operand { value, is_whole })
}

struct ExpressionParser<'a, N> {
    rest: &'a [u8],
    names: &'a N,
    depth: usize,
}

impl<N: NameLookup> ExpressionParser<'_, N> {
    fn sum(&mut self) -> Result<Operand, NoValue> {
        // By strict rules, a sign belongs to the item after it, where `power` sees it.
        let negative = !N::IS_STRICT && self.take(b"-");
        let _ = negative || self.take(b"+");
        let first = self.product()?;
        let mut sum = if negative { Operand { value: -first.value, ..first } } else { first };
        loop {
            let sign = if self.take(b"+") {
                1.0
            } else if self.take(b"-") {
                -1.0
            } else {
                return Ok(sum);
            };
            let next = self.product()?;
            sum = both(sum, next, sum.value + sign * next.value, N::IS_STRICT)?;
        }
    }

    fn product(&mut self) -> Result<Operand, NoValue> {
        let mut product = self.power()?;
        loop {
            let divides = !self.take(b"*");
            if divides && !self.take(b"/") {
                return Ok(product);
            }
            let next = self.power()?;
            let value = if divides { product.value / next.value } else { product.value * next.value };
            product = both(product, next, value, N::IS_STRICT)?;
        }
    }

    fn power(&mut self) -> Result<Operand, NoValue> {
        self.blanks();
        let mut is_clear = !self.rest.starts_with(b"-");
        let mut power = self.item()?;
        while self.take(b"**") {
            if N::IS_STRICT && !is_clear {
                return Err(NoValue::Unknown);
            }
            let next = self.item()?;
            power = both(power, next, power.value.powf(next.value), N::IS_STRICT)?;
            is_clear = false;
        }
        Ok(power)
    }

    fn item(&mut self) -> Result<Operand, NoValue> {
        self.blanks();
        match self.rest.first() {
            Some(b'(') => match self.arguments()?[..] {
                [value] => Ok(value),
                _ if N::IS_STRICT => Err(NoValue::NotAnExpression),
                ref values => Ok(values[0]),
            },
            Some(b'-') => {
                self.rest = &self.rest[1..];
                self.deeper(Self::item).map(|operand| Operand { value: -operand.value, ..operand })
            }
            Some(byte) if byte.is_ascii_digit() || *byte == b'.' => self.number(),
            Some(byte) if is_first(*byte) => self.word(),
            _ => Err(NoValue::NotAnExpression),
        }
    }

    fn number(&mut self) -> Result<Operand, NoValue> {
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
        let is_whole = text.iter().all(u8::is_ascii_digit);
        if N::IS_STRICT && is_whole && text.len() > 1 && text[0] == b'0' {
            return Err(NoValue::Unknown);
        }
        let value = crate::number::real(text).map_err(|_| NoValue::NotAnExpression)?;
        Ok(Operand { value, is_whole })
    }

    fn word(&mut self) -> Result<Operand, NoValue> {
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
    fn arguments(&mut self) -> Result<Vec<Operand>, NoValue> {
        self.take(b"(");
        let mut values = vec![self.deeper(Self::sum)?];
        while self.take(b",") {
            values.push(self.deeper(Self::sum)?);
        }
        if self.take(b")") { Ok(values) } else { Err(NoValue::NotAnExpression) }
    }

    fn deeper(&mut self, read: impl FnOnce(&mut Self) -> Result<Operand, NoValue>) -> Result<Operand, NoValue> {
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

#[cfg(test)]
mod tests {
    use super::*;

    struct Names<const STRICT: bool>;

    impl<const STRICT: bool> NameLookup for Names<STRICT> {
        const IS_STRICT: bool = STRICT;

        fn scalar(&self, name: &str) -> Result<Operand, NoValue> {
            match name {
                "A" => Ok(Operand { value: 3.0, is_whole: true }),
                "G" => Err(NoValue::Unknown),
                _ => Err(NoValue::NotAnExpression),
            }
        }

        fn call(&self, name: &str, arguments: &[Operand]) -> Result<Operand, NoValue> {
            let sum = arguments.iter().map(|argument| argument.value).sum();
            if name == "SUM" { Ok(Operand::real(sum)) } else { function(name, arguments) }
        }
    }

    const ANSYS: Names<false> = Names;

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
            assert_eq!(value(text.as_bytes(), &ANSYS), Ok(expected), "{text}");
        }
        for text in ["", "UX", "2*", "(1", "1)", "2 3", "A B", "%A%", "'A'", "1+*2", "SUM()", "2e"] {
            assert_eq!(value(text.as_bytes(), &ANSYS), Err(NoValue::NotAnExpression), "{text}");
        }
        for text in ["G", "2*G", "NX(3)", "1/0", "SUM(G)"] {
            assert_eq!(value(text.as_bytes(), &ANSYS), Err(NoValue::Unknown), "{text}");
        }
        assert!(value("(".repeat(100_000).as_bytes(), &ANSYS).is_err());
        assert!(value("-".repeat(100_000).as_bytes(), &ANSYS).is_err());
    }

    #[test]
    fn values_that_depend_on_the_rules_of_a_program_are_unknown() {
        let strict = |text: &str| value(text.as_bytes(), &Names::<true>);
        for (text, expected) in [
            ("-A+1", -2.0),
            ("6/A", 2.0),
            ("7/2.", 3.5),
            ("2**A", 8.0),
            ("(-2)**2", 4.0),
            ("2.**(-1)", 0.5),
            ("+1.", 1.0),
            ("0.5*sqrt(16)", 2.0),
            ("max(1,A,2)", 3.0),
            ("int(7.5)", 7.0),
            ("atan2(0.,1.)", 0.0),
        ] {
            assert_eq!(strict(text), Ok(expected), "{text}");
        }
        let rules =
            ["7/2", "A/2", "max(A,1)/2", "abs(7)/2", "int(7.5)/2", "2**(-1)", "2**3**2", "-2**2", "1*-2**2", "010"];
        for text in rules.into_iter().chain(["sqrt(-1)", "min(3,sqrt(-1))", "1/exp(800)", "100000*100000", "ln(2)"]) {
            assert_eq!(strict(text), Err(NoValue::Unknown), "{text}");
        }
        assert_eq!(strict("(1,2)"), Err(NoValue::NotAnExpression));
    }
}
