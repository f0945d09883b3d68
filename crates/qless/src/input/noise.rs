//! Numbers that may be rounding errors of a computation whose exact result is zero.
//!
//! A relative tolerance takes every coefficient as exact, but a 4.4e-16 that stands for 0 has a relative error of 100 %. No rule can tell
//! such a number from data with certainty. Such numbers are therefore only *suspect*, and if they decide, both readings are reported.

use std::collections::HashSet;

use crate::input::components::Labels;
use crate::input::numbering::{Exponents, LocalSystem};
use crate::input::scale::{balanced_powers, balanced_rows, exponent, free, ldexp};
use crate::{ConstraintSystem, OptionError};

/// `2^-46` = 1.4e-14: the rounding error of a sum of a hundred terms. A coefficient is suspect if it is below this fraction of the largest
/// one of its equation.
pub(crate) const SUSPECT: i32 = -46;
/// Numbers with at most this many decimal digits are not the result of rounding.
const NOT_LEFT_OVER: usize = 8;
/// Sums of numbers between `2^-8` and 1, and their rounding errors, are multiples of `2^-60`, because the last bit of `2^-8` is `2^-60`.
const QUANTUM: i32 = -60;

/// If units do not mix, data are above `2^-20` of the largest coefficient of their equation: inputs span a factor of a million, and that is
/// far above [`SUSPECT`].
const DATA: i32 = -20;

/// Coefficients of an equation that consists of rounding are at most sixteen times the suspect coefficients of its component.
const ALIKE: f64 = 16.0;

/// Decides which numbers may be rounding errors that stand for zero.
///
/// A coefficient is *suspect* if one of these holds:
///
/// - In balanced units, it is below `2^-46` (1.4e-14) of the largest coefficient of its equation.
/// - The same holds in the user's units, and every coefficient of its component is either above `2^-20` of the largest of its equation or
///   between `2^-60` and `2^-46` of it, or between the squares or the cubes of these fractions: products of rounding errors, as of axes that
///   were turned several times.
/// - Every coefficient of its equation is small: below `2^-46` of M, and at most sixteen times the largest coefficient of the component
///   that is suspect by the first two rules. M is the largest coefficient of the equation's DOFs in all equations. If every coefficient
///   is also a multiple of the rounding unit of M (`2^-60` times the largest power of two up to M), and its right-hand side is zero or as
///   small as a suspect mismatch, the whole equation is suspect.
///
/// A mismatch of right-hand sides is suspect if it is below `2^-46` of the largest right-hand side and prescribed term of its component,
/// in balanced units. Numbers of up to 8 decimal digits were typed and are never suspect.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Noise {
    /// Suspect equations and mismatches count as zero; single suspect coefficients keep their value. If another reading gives another rank
    /// or verdict, the result is ambiguous, and [`crate::Analysis::other_reading`] returns that reading.
    #[default]
    Auto,
    /// No number is suspect.
    None,
    /// Three kinds of numbers count as zero, all in the user's units: coefficients below this fraction of the largest of their equation,
    /// equations below this fraction of the largest coefficients of their DOFs, and mismatches below this fraction of the largest
    /// right-hand side and prescribed term.
    Relative(f64),
    /// The absolute error of each equation's coefficients and right-hand side is known. Coefficients within it are zero. A
    /// dependent equation that differs from its combination by no more than these errors causes no doubt.
    Floors {
        /// For each equation, the size up to which coefficients count as zero.
        coefficients: Vec<f64>,
        /// For each equation, the error of its right-hand side.
        rhs: Vec<f64>,
    },
}

impl Noise {
    /// Returns true if the option states errors of right-hand sides.
    pub(crate) fn has_errors_of_sides(&self) -> bool {
        match self {
            Self::Auto | Self::None => false,
            Self::Relative(part) => *part > 0.0,
            Self::Floors { rhs, .. } => rhs.iter().any(|&floor| floor > 0.0),
        }
    }

    /// Checks the range of every number and the length of every list.
    pub(crate) fn validate(&self, system: &ConstraintSystem) -> Result<(), OptionError> {
        let is_size = |x: f64| x >= 0.0 && x.is_finite();
        match self {
            &Self::Relative(value) if !(value > 0.0 && value < 1.0) => Err(OptionError::Noise(value)),
            Self::Auto | Self::None | Self::Relative(_) => Ok(()),
            Self::Floors { coefficients, rhs } => {
                let expected = system.equations();
                if let Some(found) = [coefficients.len(), rhs.len()].into_iter().find(|&found| found != expected) {
                    return Err(OptionError::Floors { found, expected });
                }
                let bad = coefficients.iter().chain(rhs).copied().find(|&x| !is_size(x));
                bad.map_or(Ok(()), |value| Err(OptionError::Noise(value)))
            }
        }
    }
}

/// A coefficient that counts as zero, or would count as zero in another reading.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct NoiseTerm {
    /// The equation, 0-based.
    pub row: usize,
    /// The DOF, 0-based.
    pub dof: usize,
    /// The coefficient.
    pub coefficient: f64,
}

/// Coefficients that may be rounding. `rows` count as zero: with [`Noise::Auto`] all coefficients of suspect equations, with
/// [`Noise::Relative`] and [`Noise::Floors`] all coefficients below the limit. `single` are the other suspect coefficients, ascending by
/// row and DOF; they keep their value.
#[derive(Default)]
pub(crate) struct Suspects {
    pub rows: Vec<NoiseTerm>,
    pub single: Vec<NoiseTerm>,
}

impl Suspects {
    /// Finds the coefficients that the option sets to zero at once, and those that it only suspects.
    pub fn find(system: LocalSystem, exponents: &[Exponents], noise: &Noise) -> Self {
        match noise {
            Noise::None => Self::default(),
            Noise::Auto => {
                let mut single = suspect(system, exponents);
                if single.is_empty() {
                    return Self::default();
                }
                // Rounding errors seldom occur alone, so the component of an equation of rounding errors has other suspect coefficients of
                // similar size. The component of an equation that only has small units has none. So coefficients are compared with the
                // largest suspect one.
                let labels = Labels::of(system);
                let label = |row: usize| labels.of_row[row] as usize;
                let mut largest = vec![0.0_f64; labels.count];
                single.iter().for_each(|t| largest[label(t.row)] = largest[label(t.row)].max(t.coefficient.abs()));
                let is_alike = |i: usize, v: f64| v.abs() <= ALIKE * largest[label(i)] && !is_typed(v);
                let part = ldexp(1.0, SUSPECT);
                let mut rows = rows_below(system, exponents, part, |i, v, most| is_alike(i, v) && is_left_of(v, most));
                without_sides(system, &mut rows);
                let gone: HashSet<usize> = rows.iter().map(|term| term.row).collect();
                single.extend(rows_below(system, exponents, part, |i, v, _| is_alike(i, v)));
                single.retain(|term| !gone.contains(&term.row));
                Self { rows, single: ascending(single) }
            }
            &Noise::Relative(part) => {
                let mut rows = rows_below(system, exponents, part, |_, _, _| true);
                rows.extend((0..system.equations()).flat_map(|i| below(system, i, part)));
                Self { rows: ascending(rows), single: Vec::new() }
            }
            Noise::Floors { coefficients, .. } => {
                let all = (0..system.equations()).flat_map(|i| terms(system, i));
                Self { rows: all.filter(|t| t.coefficient.abs() <= coefficients[t.row]).collect(), single: Vec::new() }
            }
        }
    }

    /// The terms of `rows` and of `single` in one list, ascending by row and DOF.
    pub fn all(&self) -> Vec<NoiseTerm> {
        ascending([self.rows.as_slice(), &self.single].concat())
    }
}

/// Sorts by row and DOF, and removes repeats.
fn ascending(mut terms: Vec<NoiseTerm>) -> Vec<NoiseTerm> {
    terms.sort_unstable_by_key(|term| (term.row, term.dof));
    terms.dedup();
    terms
}

/// Number of digits of the shortest decimal that reads back as this double.
pub(crate) fn digits(value: f64) -> usize {
    let text = format!("{value:e}");
    let mantissa = text.split('e').next().unwrap_or_default();
    mantissa.bytes().filter(u8::is_ascii_digit).count()
}

pub(crate) fn is_typed(value: f64) -> bool {
    digits(value) <= NOT_LEFT_OVER
}

/// Numbers of digits at which typing rounds coefficients. An equation with fewer digits is exact, and one with more was computed.
pub(crate) const TYPED: std::ops::RangeInclusive<usize> = 4..=12;

/// The relative size of the last digit of a number with this many digits.
pub(crate) fn last_digit(digits: usize) -> f64 {
    10_f64.powi(1 - digits as i32)
}

/// The relative size of the last digit of the equation that was typed with the fewest digits; 0 if all equations are exact or computed.
/// An equation is given by its coefficients.
pub(crate) fn typed_precision<T: Iterator<Item = f64>>(equations: impl Iterator<Item = T>) -> f64 {
    let longest = |equation: T| equation.map(digits).max().unwrap_or_default();
    equations.map(longest).filter(|digits| TYPED.contains(digits)).min().map_or(0.0, last_digit)
}

fn terms(system: LocalSystem<'_>, row: usize) -> impl Iterator<Item = NoiseTerm> + '_ {
    free(system, row).map(move |(j, coefficient)| {
        let dof = system.numbering.dofs[j] as usize;
        NoiseTerm { row, dof, coefficient }
    })
}

/// Coefficients up to the fraction `part` of the largest of their equation, in the user's units.
fn below(system: LocalSystem<'_>, i: usize, part: f64) -> impl Iterator<Item = NoiseTerm> + '_ {
    let most = free(system, i).fold(0.0, |most: f64, (_, v)| most.max(v.abs()));
    terms(system, i).filter(move |term| term.coefficient.abs() <= part * most)
}

/// Computed coefficients that are small beside the largest of their equation, in balanced units or [`as_given`]. The second test is needed
/// because balancing gives a small unit to a DOF that has only rounding errors.
fn suspect(system: LocalSystem, exponents: &[Exponents]) -> Vec<NoiseTerm> {
    let power = f64::from(SUSPECT);
    // Exponents are rounded down, so their difference can be one too large.
    let spans = |i: usize| {
        let Exponents { least, most } = exponents[i];
        least < most && f64::from(least) - f64::from(most) <= power + 1.0
    };
    let spanning: Vec<usize> = (0..system.equations()).filter(|&i| spans(i)).collect();
    if spanning.is_empty() {
        return Vec::new();
    }
    let mut found = as_given(system, &spanning);
    balanced_powers(system, spans, |row, powers| {
        let most = powers.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let of_row = terms(system, row).zip(powers).filter(|&(_, power_of)| power_of - most <= power);
        found.extend(of_row.map(|(term, _)| term));
    });
    found.retain(|term| !is_typed(term.coefficient));
    found
}

/// Coefficients as small as rounding errors of the largest of their equation, or as products of these, in the user's units. They count only
/// in components in which every coefficient is either as small as this or far larger: if units mix, coefficients of other sizes occur too.
fn as_given(system: LocalSystem, spanning: &[usize]) -> Vec<NoiseTerm> {
    let labels = Labels::of(system);
    let mut may_be = vec![false; labels.count];
    spanning.iter().for_each(|&i| may_be[labels.of_row[i] as usize] = true);
    let largest = |i: usize| free(system, i).fold(0.0, |most: f64, (_, v)| most.max(v.abs()));
    for (i, &label) in labels.of_row.iter().enumerate() {
        if may_be[label as usize] {
            let largest = largest(i);
            let is_far = |v: f64| v.abs() >= ldexp(largest, DATA) || is_rounding(v, largest);
            may_be[label as usize] = free(system, i).all(|(_, v)| is_far(v));
        }
    }
    let of = |&i: &usize| {
        let largest = largest(i);
        terms(system, i).filter(move |term| is_rounding(term.coefficient, largest))
    };
    spanning.iter().filter(|&&i| may_be[labels.of_row[i] as usize]).flat_map(of).collect()
}

/// Whether a number may be a rounding error beside the largest coefficient of its equation, or the product of two or three: axes that were
/// turned by three angles hold products of three.
fn is_rounding(v: f64, largest: f64) -> bool {
    (1..=3).any(|k| v.abs() <= ldexp(largest, k * SUSPECT) && v.abs() >= ldexp(largest, k * QUANTUM))
}

/// The terms of certain equations: every coefficient is at most the fraction `part` of the largest coefficient of the equation's DOFs, and
/// satisfies `may_be(row, value, largest)`.
fn rows_below(
    system: LocalSystem,
    exponents: &[Exponents],
    part: f64,
    may_be: impl Fn(usize, f64, f64) -> bool,
) -> Vec<NoiseTerm> {
    let largest = exponents.iter().map(|e| i32::from(e.most)).fold(0, i32::max);
    // Exponents are rounded down, so the limit is one higher.
    let below = largest + 1 + exponent(part);
    let is_small = |&i: &usize| exponents[i].most > 0 && i32::from(exponents[i].most) <= below;
    let rows: Vec<usize> = (0..system.equations()).filter(is_small).collect();
    if rows.is_empty() {
        return Vec::new();
    }
    let mut of_dof = vec![0.0_f64; system.dofs()];
    for i in 0..system.equations() {
        free(system, i).for_each(|(j, v)| of_dof[j] = of_dof[j].max(v.abs()));
    }
    let is_rounding = |&i: &usize| {
        let most = free(system, i).map(|(j, _)| of_dof[j]).fold(0.0, f64::max);
        free(system, i).all(|(_, v)| v.abs() <= part * most && may_be(i, v, most))
    };
    rows.into_iter().filter(is_rounding).flat_map(|i| terms(system, i)).collect()
}

/// Leaves out equations whose right-hand side is no rounding error beside those of their component: that of an equation of rounding is.
fn without_sides(system: LocalSystem, rows: &mut Vec<NoiseTerm>) {
    if rows.iter().any(|term| system.rhs()[term.row] != 0.0) {
        let rounding = rounding_of_sides(system);
        rows.retain(|term| system.rhs()[term.row] == 0.0 || system.rhs()[term.row].abs().log2() <= rounding[term.row]);
    }
}

/// Returns true if a number can be the rounding error of a sum of numbers up to `most`: it was not typed, and it is a multiple of the
/// rounding unit, `2^-60` times the largest power of two up to `most`.
fn is_left_of(value: f64, most: f64) -> bool {
    let multiple = ldexp(value, -(exponent(most) + QUANTUM));
    multiple.fract() == 0.0 && !is_typed(value)
}

/// For each equation, the error of its coefficients relative to the largest one; None if the option states no errors.
pub(crate) fn relative_floors(system: LocalSystem, noise: &Noise) -> Option<Vec<f64>> {
    let largest = |i: usize| free(system, i).fold(0.0, |most: f64, (_, v)| most.max(v.abs()));
    match noise {
        Noise::Auto | Noise::None => None,
        Noise::Relative(part) => Some(vec![*part; system.equations()]),
        Noise::Floors { coefficients, .. } => {
            Some(coefficients.iter().enumerate().map(|(i, floor)| floor / largest(i)).collect())
        }
    }
}

/// For each equation, the error of its right-hand side in scaled rows (row i times `2^of_row[i]`); None if the option states no errors.
pub(crate) fn of_right_hand_sides(system: LocalSystem, of_row: &[i32], noise: &Noise) -> Option<Vec<f64>> {
    match noise {
        Noise::Auto | Noise::None => None,
        stated if !stated.has_errors_of_sides() => None,
        Noise::Relative(part) => Some(vec![part * largest_side(system, of_row); system.equations()]),
        Noise::Floors { rhs, .. } => Some(rhs.iter().zip(of_row).map(|(floor, &power)| ldexp(*floor, power)).collect()),
    }
}

/// The largest right-hand side or prescribed term of all equations, in scaled rows.
fn largest_side(system: LocalSystem, of_row: &[i32]) -> f64 {
    let sides = system.rhs().iter().zip(of_row).map(|(b, &power)| ldexp(b.abs(), power));
    let mut most = sides.fold(0.0, f64::max);
    if !system.prescribed().is_empty() {
        let mut values = vec![0.0; system.dofs()];
        system.prescribed().iter().for_each(|&(j, value)| values[j] = value);
        for (i, &power) in of_row.iter().enumerate() {
            let terms = system.row(i).map(|(j, v)| ldexp((v * values[j]).abs(), power));
            most = terms.fold(most, f64::max);
        }
    }
    most
}

/// For each equation, `log2` of the largest mismatch that may be rounding: `2^-46` of the largest right-hand side or prescribed term of its
/// component. These are compared in balanced units; the result is in the user's units. NaN for an equation without free DOFs.
pub(crate) fn rounding_of_sides(system: LocalSystem) -> Vec<f64> {
    let units = balanced_rows(system, |_| true);
    let labels = Labels::of(system);
    let mut values = vec![0.0; system.dofs()];
    system.prescribed().iter().for_each(|&(j, value)| values[j] = value);
    let mut largest = vec![f64::NEG_INFINITY; labels.count];
    for (i, &unit) in units.iter().enumerate().filter(|(_, unit)| !unit.is_nan()) {
        let terms = system.row(i).map(|(j, v)| (v * values[j]).abs());
        let side = terms.fold(system.rhs()[i].abs(), f64::max);
        let most = &mut largest[labels.of_row[i] as usize];
        *most = most.max(side.log2() + unit);
    }
    let of = |(unit, &label): (&f64, &u32)| largest[label as usize] - unit + f64::from(SUSPECT);
    units.iter().zip(&labels.of_row).map(of).collect()
}
