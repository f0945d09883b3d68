//! Sorts changes by plausibility. The true error is unknown, but a mistyped number usually occurs rarely in the model and has many digits.

use std::collections::HashMap;

use super::changes::{Change, Number};
use crate::ConstraintSystem;

/// The number of occurrences of each number among right-hand sides and among prescribed values.
pub(super) struct Plausibility<'a> {
    system: &'a ConstraintSystem,
    sides: HashMap<u64, usize>,
    values: HashMap<u64, usize>,
    /// The largest prescribed value, and the largest right-hand side relative to the coefficients of its equation.
    largest: [f64; 2],
}

impl<'a> Plausibility<'a> {
    pub fn new(system: &'a ConstraintSystem) -> Self {
        let mut all = Self { system, sides: HashMap::new(), values: HashMap::new(), largest: [0.0; 2] };
        for row in 0..system.equations() {
            let side = all.side(row, system.rhs()[row]);
            *all.sides.entry(rounded(side)).or_default() += 1;
            all.largest[1] = all.largest[1].max(side.abs());
        }
        for &(_, value) in system.prescribed() {
            *all.values.entry(rounded(value)).or_default() += 1;
            all.largest[0] = all.largest[0].max(value.abs());
        }
        all
    }

    /// A right-hand side relative to the largest coefficient of its equation, so that a multiple of the equation counts as the same.
    fn side(&self, row: usize, b: f64) -> f64 {
        let largest = self.system.matrix().row(row).fold(0.0, |most: f64, (_, value)| most.max(value.abs()));
        if largest > 0.0 { b / largest } else { b }
    }

    /// Sort key of a way (a list of changes that cures conflicts); the smallest key comes first. It compares, in this order: how much more
    /// common the new values are than the old ones, the decades by which new values exceed all present ones, the digits of the new values,
    /// the number of zeros that change, and the places.
    pub fn key(&self, way: &[Change]) -> (isize, usize, usize, usize, Vec<Number>) {
        let common = way.iter().map(|change| self.surplus(change)).sum::<isize>();
        let decades = way.iter().map(|change| self.decades(change)).sum();
        let digits = way.iter().map(|change| digits(change.to)).sum();
        let zeros = way.iter().filter(|change| change.from == 0.0).count();
        (-common, decades, digits, zeros, way.iter().map(|change| change.number).collect())
    }

    /// The decades by which the new value is larger than all present numbers of its kind; 0 if all of these are zero.
    fn decades(&self, change: &Change) -> usize {
        let (to, largest) = match change.number {
            Number::RightHandSide(row) => (self.side(row, change.to), self.largest[1]),
            Number::Prescribed(_) => (change.to, self.largest[0]),
        };
        if largest > 0.0 { (to.abs() / largest).log10().ceil().max(0.0) as usize } else { 0 }
    }

    /// How many other numbers equal the new value, minus how many equal the old value.
    fn surplus(&self, change: &Change) -> isize {
        let count = |counts: &HashMap<u64, usize>, key: u64| counts.get(&key).copied().unwrap_or(0) as isize;
        match change.number {
            Number::RightHandSide(row) => {
                let [to, from] = [change.to, change.from].map(|b| count(&self.sides, rounded(self.side(row, b))));
                to - (from - 1)
            }
            Number::Prescribed(_) => {
                let [to, from] = [change.to, change.from].map(|value| count(&self.values, rounded(value)));
                to - (from - 1)
            }
        }
    }
}

/// The bits of `|x|`, rounded to nine digits.
fn rounded(x: f64) -> u64 {
    let rounded: f64 = format!("{:.8e}", x.abs()).parse().unwrap_or(x);
    rounded.to_bits()
}

/// Significant digits of the shortest decimal; 0 for zero.
fn digits(x: f64) -> usize {
    let text = format!("{x:e}");
    let mantissa = text.split('e').next().unwrap_or_default();
    if x == 0.0 { 0 } else { mantissa.chars().filter(char::is_ascii_digit).count() }
}
