//! The right-hand sides of an explanation in one line.

use super::{Explanation, Member};
use crate::ConstraintSystem;

/// Largest number of terms in the line; the others are only counted.
const SHOWN: usize = 6;
/// Number of digits, if they suffice.
const DIGITS: usize = 6;
/// Largest number of characters of a label.
const LABEL: usize = 30;

impl Explanation {
    /// The sum of the members and the right-hand side of equation `row`: `0.5 (line 17) - 0 (line 13) = 0.5, but 0 is asked (line 11)`.
    ///
    /// Equations whose right-hand side is zero are left out. Numbers have at most six digits, or as many as show that the two sides differ.
    ///
    /// ```
    /// use qless::{Options, SystemBuilder, analyse};
    /// let mut builder = SystemBuilder::new(2);
    /// builder.labelled_equation("tie A", [(0, 1.0), (1, -1.0)], 0.0);
    /// builder.prescribe_at("line 13", 0, 0.5);
    /// builder.prescribe_at("line 17", 1, 0.0);
    /// let system = builder.build()?;
    /// let analysis = analyse(&system, &Options::default())?;
    /// let explanation = analysis.explain(0)?.expect("it conflicts");
    /// assert_eq!(explanation.arithmetic(&system, 0), "0.5 (line 13) - 0 (line 17) = 0.5, but 0 is asked (tie A)");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn arithmetic(&self, system: &ConstraintSystem, row: usize) -> String {
        let mut parts: Vec<ArithmeticTerm> =
            self.members.iter().filter_map(|&member| ArithmeticTerm::new(system, member)).collect();
        // If there is no room for all terms, the nonzero ones are shown first.
        if parts.len() > SHOWN {
            parts.sort_by_key(|part| part.value == 0.0);
        }
        let more = parts.len().saturating_sub(SHOWN);
        let asked = system.rhs().get(row).copied().unwrap_or_default();
        let count = self.digits(&parts, asked);
        let digits = |x: f64| digits(x, count);
        let shown = parts.iter().take(SHOWN).enumerate().map(|(k, part)| part.words(k == 0, count));
        let rest = (more > 0).then(|| format!(" + {more} more"));
        let line: String = shown.chain(rest).collect();
        let (given, asked) = (digits(self.right_hand_side), digits(asked));
        let place = short(&system.equation_label(row));
        let result = match &parts[..] {
            [] => format!("The sum is {given}"),
            [one] if one.factor == 1.0 => line,
            _ => format!("{line} = {given}"),
        };
        format!("{result}, but {asked} is asked ({place})")
    }

    /// The number of digits in which six digits of the difference of both sides are visible.
    fn digits(&self, parts: &[ArithmeticTerm], asked: f64) -> usize {
        let values = parts.iter().flat_map(|part| [part.value, part.factor * part.value]);
        let largest = values.chain([asked, self.right_hand_side]).fold(0.0, |most: f64, value| most.max(value.abs()));
        let difference = (self.right_hand_side - asked).abs();
        let lost = if difference > 0.0 { (largest / difference).log10().max(0.0) } else { 0.0 };
        (DIGITS + lost as usize).min(17)
    }
}

/// A factor times a right-hand side or a prescribed value, and the place of the value in the input.
struct ArithmeticTerm {
    factor: f64,
    value: f64,
    place: String,
}

impl ArithmeticTerm {
    fn new(system: &ConstraintSystem, member: Member) -> Option<Self> {
        match member {
            Member::Equation { row, coefficient } => {
                let value = system.rhs()[row];
                let place = || short(&system.equation_label(row));
                (value != 0.0).then(|| Self { factor: coefficient, value, place: place() })
            }
            Member::Prescribed { dof, value, coefficient } => {
                let place = system.prescribed_place(dof).map_or_else(|| system.dof_label(dof), str::to_owned);
                Some(Self { factor: coefficient, value, place: short(&place) })
            }
        }
    }

    /// The term as text, such as ` - 2 * 0.5 (line 17)`.
    fn words(&self, is_first: bool, count: usize) -> String {
        let digits = |x: f64| digits(x, count);
        let Self { factor, value, place } = self;
        let sign = match (is_first, *factor < 0.0) {
            (true, true) if *value == 0.0 => "",
            (true, false) => "",
            (true, true) => "-",
            (false, false) => " + ",
            (false, true) => " - ",
        };
        let size = digits(factor.abs());
        let value = if *value < 0.0 { format!("({})", digits(*value)) } else { digits(*value) };
        if size == "1" { format!("{sign}{value} ({place})") } else { format!("{sign}{size} * {value} ({place})") }
    }
}

/// The place in a label: `line 41` of `line 41 *EQUATION 3:1`, and `part.inc:41` of `part.inc:41 *TIE 3:1`. Other labels are shortened.
pub(super) fn short(label: &str) -> String {
    let words: Vec<&str> = label.split_whitespace().take(2).collect();
    match words[..] {
        ["line", number] => format!("line {number}"),
        [place, card] if card.starts_with('*') => place.to_owned(),
        _ if label.chars().count() > LABEL => label.chars().take(LABEL - 3).chain("...".chars()).collect(),
        _ => label.to_owned(),
    }
}

/// The number with at most this many significant digits.
fn digits(x: f64, count: usize) -> String {
    let rounded: f64 = format!("{x:.*e}", count.saturating_sub(1)).parse().unwrap_or(x);
    let text = format!("{:?}", rounded + 0.0);
    text.strip_suffix(".0").map_or_else(|| text.clone(), str::to_owned)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_shortened_to_their_line() {
        for (label, expected) in [
            ("line 41 *EQUATION 3:1", "line 41"),
            ("part.inc:41 *TIE 3:1", "part.inc:41"),
            ("tie A", "tie A"),
            ("a very long label of a tie between two parts", "a very long label of a tie ..."),
        ] {
            assert_eq!(short(label), expected);
        }
        assert_eq!([0.1 + 0.2, -0.0, 2.0, 1e-9].map(|x| digits(x, DIGITS)), ["0.3", "0", "2", "1e-9"]);
    }
}
