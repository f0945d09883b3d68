//! New values of numbers that cure mismatches.
//!
//! ```text
//! m_o(x) = constant_o + sum_w a_ow x_w      mismatch o, over the values x of all numbers of its certificate
//! m_o(x) = 0                                solved for the numbers of a way by refinement; the other numbers keep their values
//! ```
//!
//! Each sum is computed in twice the precision. The present value plus a change in doubles would keep only the digits of the larger of the
//! two.

use std::collections::BTreeMap;

use super::changes::Number;
use crate::common::two_sum;

/// Number of refinements of the new values. Each gains about 15 digits, unless the coefficients have fewer correct digits.
const REFINEMENTS: usize = 3;

/// A new value is shortened if it leaves mismatches of at most this fraction of the tolerance. Then other certificates of the same
/// equations, which have other factors, agree within the tolerance too.
const FIT: f64 = 1e-2;

/// The mismatch of a conflict as a sum over all numbers that affect it.
#[derive(Clone, Debug, Default)]
pub(super) struct MismatchSum {
    /// For each number, its effect on the mismatch and its present value.
    pub terms: BTreeMap<Number, (f64, f64)>,
    /// The sum for the present values, and the rounding errors of its products and additions.
    present: (f64, f64),
    constant: f64,
    /// The magnitude of each term with its number, the largest first.
    sizes: Vec<(f64, Number)>,
}

impl MismatchSum {
    /// A mismatch with this constant and these terms (number, effect, present value).
    pub fn new(constant: f64, terms: impl IntoIterator<Item = (Number, f64, f64)>) -> Self {
        let (mut all, mut present) = (BTreeMap::new(), (constant, 0.0));
        for (number, effect, value) in terms {
            all.entry(number).or_insert((0.0, value)).0 += effect;
            present = plus(present, effect, value);
        }
        let mut sizes: Vec<(f64, Number)> = all.iter().map(|(of, (a, x))| ((a * x).abs(), *of)).collect();
        sizes.sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
        Self { terms: all, present, constant, sizes }
    }

    /// The mismatch and its largest term if the numbers in `way` have the values given there. The sum is computed in twice the precision.
    /// O(length of `way`).
    pub fn at(&self, way: &[(Number, f64)]) -> (f64, f64) {
        let is_kept = |of: &&(f64, Number)| way.iter().all(|(number, _)| *number != of.1);
        let (mut sum, kept) = (self.present, self.sizes.iter().find(is_kept));
        let mut size = kept.map_or(0.0, |of| of.0).max(self.constant.abs());
        for (number, x) in way {
            if let Some(&(effect, value)) = self.terms.get(number) {
                sum = plus(plus(sum, -effect, value), effect, *x);
                size = size.max((effect * x).abs());
            }
        }
        (sum.0 + sum.1, size)
    }

    fn effect(&self, number: Number) -> f64 {
        self.terms.get(&number).map_or(0.0, |term| term.0)
    }
}

/// Adds the product of `effect` and x to a sum, and the rounding errors of the product and of the addition to `lost`.
fn plus((sum, lost): (f64, f64), effect: f64, x: f64) -> (f64, f64) {
    let part = effect * x;
    let (next, error) = two_sum(sum, part);
    (next, lost + (effect.mul_add(x, -part) + error))
}

/// The new values of the numbers in `changes`, which says by how much each number changes. The values are refined, and then shortened to as
/// few digits as the tolerance allows.
pub(super) fn new_values(sums: &[MismatchSum], changes: &[(Number, f64)], tolerance: f64) -> Vec<(Number, f64)> {
    let value = |number: &Number| sums.iter().find_map(|sum| sum.terms.get(number)).map_or(0.0, |term| term.1);
    let mut way: Vec<(Number, f64)> =
        changes.iter().map(|(number, change)| (*number, value(number) + change)).collect();
    let touched: Vec<&MismatchSum> =
        sums.iter().filter(|sum| way.iter().any(|&(number, _)| sum.effect(number) != 0.0)).collect();
    for _ in 0..REFINEMENTS {
        let corrections = corrections(&touched, &way);
        way.iter_mut().zip(corrections).for_each(|(of, correction)| of.1 += correction);
    }
    for k in 0..way.len() {
        shorten(&touched, &mut way, k, FIT * tolerance);
    }
    way
}

/// Computes corrections dx of the values in `way` from `m + A dx = 0`, with the mismatches m and the effects A of the numbers, by Gauss
/// elimination with pivoting. Each mismatch is divided by its largest term, so that the pivots are the mismatches with the smallest
/// rounding. Mismatches beyond the number of values are consistent, so they are left out.
fn corrections(sums: &[&MismatchSum], way: &[(Number, f64)]) -> Vec<f64> {
    let row = |sum: &&MismatchSum| {
        let (mismatch, size) = sum.at(way);
        let effects = way.iter().map(|&(number, _)| sum.effect(number));
        effects.chain([-mismatch]).map(|entry| entry / size).collect::<Vec<f64>>()
    };
    let mut rows: Vec<Vec<f64>> =
        sums.iter().map(row).filter(|row| row.iter().all(|entry| entry.is_finite())).collect();
    let mut pivots = Vec::new();
    for column in 0..way.len() {
        let largest = (0..rows.len()).max_by(|&p, &q| rows[p][column].abs().total_cmp(&rows[q][column].abs()));
        let Some(largest) = largest.filter(|&p| rows[p][column] != 0.0) else { continue };
        let pivot = rows.swap_remove(largest);
        for row in &mut rows {
            let factor = row[column] / pivot[column];
            row.iter_mut().zip(&pivot).skip(column).for_each(|(entry, other)| *entry -= factor * other);
            row[column] = 0.0;
        }
        pivots.push((column, pivot));
    }
    let mut solution = vec![0.0; way.len()];
    for (column, pivot) in pivots.iter().rev() {
        let known: f64 = (column + 1..way.len()).map(|other| pivot[other] * solution[other]).sum();
        let x = (pivot[way.len()] - known) / pivot[*column];
        solution[*column] = if x.is_finite() { x } else { 0.0 };
    }
    solution
}

/// Replaces value k by zero or, if that does not fit, rounds it to 12 digits. A value fits if it leaves all mismatches within `least` times
/// their largest terms; otherwise it stays.
fn shorten(sums: &[&MismatchSum], way: &mut [(Number, f64)], k: usize, least: f64) {
    let exact = way[k].1;
    let rounded = format!("{exact:.11e}").parse().unwrap_or(exact);
    for shorter in [0.0, rounded] {
        way[k].1 = shorter;
        let fits = |(mismatch, size): (f64, f64)| mismatch.abs() <= least * size;
        if sums.iter().all(|sum| fits(sum.at(way))) {
            return;
        }
    }
    way[k].1 = exact;
}
