//! Writes equations, DOFs and numbers in limited space.

pub mod layout;
pub mod printable;

use qless::ConstraintSystem;

use layout::shorten;
use qless::report::ChangeFinding;

/// Labels and facts of equations, by index.
pub trait EquationLookup {
    /// The label of the equation, or `row 5` if it has none.
    fn label(&self, row: usize) -> String;

    fn facts(&self, row: usize) -> EquationFacts;
}

/// Facts about one equation.
#[derive(Clone, Copy)]
pub struct EquationFacts {
    pub rhs: f64,
    /// Largest magnitude of the coefficients of the equation.
    pub largest: f64,
    /// Number of DOFs in the equation.
    pub dofs: usize,
    /// Number of prescribed DOFs in the equation.
    pub prescribed: usize,
}

impl EquationLookup for ConstraintSystem {
    fn label(&self, row: usize) -> String {
        self.equation_label(row)
    }

    fn facts(&self, row: usize) -> EquationFacts {
        let entries = self.matrix().row(row);
        EquationFacts {
            rhs: self.rhs()[row],
            largest: entries.clone().fold(0.0, |size: f64, (_, v)| size.max(v.abs())),
            dofs: entries.len(),
            prescribed: entries.filter(|&(j, _)| is_prescribed(self, j)).count(),
        }
    }
}

/// Whether a DOF is prescribed.
fn is_prescribed(system: &ConstraintSystem, dof: usize) -> bool {
    system.prescribed().binary_search_by_key(&dof, |&(j, _)| j).is_ok()
}

/// The name of an equation: `row 14 "tie B/C, y"`, or `row 14` without a label.
pub fn equation(equations: &dyn EquationLookup, row: usize) -> String {
    let number = format!("row {}", row + 1);
    let text = equations.label(row);
    if text == number { number } else { format!("{number} \"{}\"", label(&text)) }
}

/// Largest width of a label, in columns.
const LABEL: usize = 60;

/// A label without control characters, shortened if it is very long.
pub fn label(text: &str) -> String {
    shorten(&printable::line(text), LABEL)
}

/// A change in words: `change 4:1 in line 17 *BOUNDARY from 0.5 to 0`. `name` makes a label fit its space.
pub fn change(change: &ChangeFinding, name: fn(&str) -> String) -> String {
    match change {
        ChangeFinding::Prescribed { label: dof, place, from, to, .. } => {
            let place = place.as_ref().map_or_else(String::new, |place| format!(" in {}", name(place)));
            format!("change {}{place} from {} to {}", name(dof), exact(*from), exact(*to))
        }
        ChangeFinding::Equation { row, label, from, to } => {
            let row = format!("row {row}");
            let equation = if *label == row { row } else { format!("{row} \"{}\"", name(label)) };
            format!(
                "change the right-hand side of {equation} from {} to {}, or leave the equation out",
                exact(*from),
                exact(*to)
            )
        }
        _ => String::new(),
    }
}

/// A number with its noun: `1 equation`, `2 equations`.
pub fn count(n: usize, what: &str) -> String {
    if n == 1 { format!("1 {what}") } else { format!("{n} {what}s") }
}

/// The shortest form that gives the same number again: a number to type into the input.
pub fn exact(x: f64) -> String {
    let text = format!("{:?}", x + 0.0);
    text.strip_suffix(".0").map_or_else(|| text.clone(), str::to_owned)
}

/// The shortest form with six significant digits.
pub fn number(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return if x == 0.0 { "0".to_owned() } else { x.to_string() };
    }
    let scientific = format!("{x:.5e}");
    let Some((mantissa, exponent)) = scientific.split_once('e') else { return scientific };
    match exponent.parse::<i32>() {
        Ok(exponent) if (-4..6).contains(&exponent) => trim(&format!("{x:.*}", (5 - exponent) as usize)).to_owned(),
        _ => format!("{}e{exponent}", trim(mantissa)),
    }
}

/// Two significant digits, for magnitudes.
pub fn rough(x: f64) -> String {
    if x == 0.0 {
        return "0".to_owned();
    }
    let rounded: f64 = format!("{x:.1e}").parse().unwrap_or(x);
    number(rounded)
}

fn trim(digits: &str) -> &str {
    if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { digits }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn six_digits_at_most() {
        let cases = [
            (1.0, "1"),
            (-2.5, "-2.5"),
            (1.0 / 3.0, "0.333333"),
            (0.999_999_999, "1"),
            (123_456.0, "123456"),
            (1_234_567.0, "1.23457e6"),
            (1e-7, "1e-7"),
            (-0.0, "0"),
            (f64::INFINITY, "inf"),
        ];
        for (x, text) in cases {
            assert_eq!(number(x), text);
        }
        assert_eq!((rough(0.123_456), rough(3.27e-17)), ("0.12".into(), "3.3e-17".into()));
    }
}
