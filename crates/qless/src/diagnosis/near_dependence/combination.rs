//! `d = row_k - sum_i y_i row_i`: a row as a combination of kept ones, and the difference.

use std::collections::BTreeMap;

use super::NearDependent;
use super::equations::ScaledEquations;
use crate::Csr;
use crate::diagnosis::certificate::CertificateTerm;
use crate::factor::backend::{Factor, norm};
use crate::input::scale::ldexp;

/// Terms of a combination are dropped if their size is below this many times the difference between the row and the combination: they only
/// fit rounding errors.
const FITTED: f64 = 3.0;
/// A term `y_i row_i` is uncertain if `|y_i| |row_i|` is below this many times `sqrt(distance) |row_k|`: it may belong to the combination
/// that nearly equals row k, or not.
const UNTOLD: f64 = 0.3;
/// The combination without the uncertain terms is used if its distance is at most this many times that of the combination with them.
const LOSS: f64 = 3.0;
/// A row must agree with its combination to at least this many decimal digits to be nearly dependent.
const LEAST_DIGITS: u32 = 2;
/// A row can be exchanged for the row of a term whose size is at least this fraction of the row.
const NEUTRAL: f64 = 0.9;
/// Largest number of digits of a double.
const DIGITS: f64 = 16.0;

/// A row as a combination of kept ones; row numbers are those within their part.
pub(super) struct NearCombination {
    pub row: usize,
    /// The coefficients `y_i`, by row i.
    terms: BTreeMap<usize, f64>,
    /// About the smallest relative change of one coefficient that makes the row a combination ([`NearDependent::distance`]).
    pub distance: f64,
}

impl NearCombination {
    /// Fits the row by the kept rows C in the least-squares sense, with the triangular factor R of C but without Q. It takes two steps
    /// `y <- y + R^-1 R^-T C d` from y = 0, where `d = row - C^T y`.
    pub fn fit(part: &ScaledEquations, factor: &Factor, columns: &Csr, kept: &[usize], row: usize) -> Self {
        let mut rest = dense(part, row);
        let mut y = vec![0.0; kept.len()];
        for _ in 0..2 {
            let step = factor.solved(&factor.solve_transposed(&columns.product(&rest)));
            y.iter_mut().zip(&step).for_each(|(y, s)| *y += s);
            rest = dense(part, row);
            for (k, &y) in y.iter().enumerate().filter(|(_, y)| **y != 0.0) {
                columns.row(k).for_each(|(j, v)| rest[j] -= y * v);
            }
        }
        let least = FITTED * norm(&rest);
        let size = |k: usize| y[k].abs() * length(part, kept[k]);
        let terms = (0..y.len()).filter(|&k| size(k) > least).map(|k| (kept[k], y[k])).collect();
        let mut found = Self { row, terms, distance: 0.0 };
        found.measure(part);
        found.shorten(part);
        found
    }

    /// Drops small terms if the other ones fit nearly as well.
    fn shorten(&mut self, part: &ScaledEquations) {
        let least = UNTOLD * self.distance.sqrt() * length(part, self.row);
        let large = |(&i, &y): (&usize, &f64)| (y.abs() * length(part, i) > least).then_some((i, y));
        let mut short = Self { row: self.row, terms: self.terms.iter().filter_map(large).collect(), distance: 0.0 };
        short.measure(part);
        if short.distance <= LOSS * self.distance {
            *self = short;
        }
    }

    /// Returns true if the combination may be intended: the row is near it, also in each coefficient.
    pub fn is_near(&self, part: &ScaledEquations, limit: f64) -> bool {
        self.distance <= limit && self.digits(part) >= LEAST_DIGITS
    }

    /// For each DOF, the difference d between the row and its combination, and the largest term of d. If only one equation contains the
    /// DOF, also its coefficient relative to the largest coefficient of that equation.
    fn rest(&self, part: &ScaledEquations) -> BTreeMap<usize, (f64, f64, Option<f64>)> {
        let mut rest: BTreeMap<usize, (f64, f64, Option<f64>)> = BTreeMap::new();
        let mut add = |row: usize, y: f64| {
            let size = part.matrix.row(row).fold(0.0, |a: f64, (_, v)| a.max(v.abs()));
            for (j, v) in part.matrix.row(row) {
                let (sum, most, alone) = rest.entry(j).or_default();
                *alone = (*most == 0.0).then(|| v.abs() / size);
                *sum += y * v;
                *most = most.max((y * v).abs());
            }
        };
        add(self.row, 1.0);
        self.terms.iter().for_each(|(&i, &y)| add(i, -y));
        rest
    }

    fn measure(&mut self, part: &ScaledEquations) {
        let rest: Vec<f64> = self.rest(part).into_values().map(|(sum, ..)| sum).collect();
        let largest = rest.iter().fold(0.0, |a: f64, v| a.max(v.abs()));
        self.distance = if largest > 0.0 { norm(&rest).powi(2) / largest } else { 0.0 };
    }

    /// Number of decimals to which the row and its combination agree.
    fn digits(&self, part: &ScaledEquations) -> u32 {
        let rest = self.rest(part);
        let relative = |&(sum, most, alone): &(f64, f64, Option<f64>)| alone.unwrap_or_else(|| sum.abs() / most);
        let largest = rest.values().map(relative).fold(0.0, f64::max);
        (-largest.log10()).clamp(0.0, DIGITS).floor() as u32
    }

    /// The last term whose row comes after `self.row` and has a large enough share in the combination to be dropped instead.
    fn later(&self, part: &ScaledEquations) -> Option<usize> {
        let own = NEUTRAL * length(part, self.row);
        let mut later = self.terms.range(self.row + 1..).rev();
        later.find(|&(&i, y)| y.abs() * length(part, i) >= own).map(|(&i, _)| i)
    }

    /// Solves the combination for the row of a term, which then becomes `self.row`.
    fn exchange(&mut self, term: usize) {
        let Some(pivot) = self.terms.remove(&term) else { return };
        self.terms.values_mut().for_each(|y| *y /= -pivot);
        self.terms.insert(self.row, 1.0 / pivot);
        self.row = term;
    }

    /// Replaces a term by the combination `by` of other rows that nearly equals the row of the term.
    fn replace(&mut self, by: &BTreeMap<usize, f64>, term: usize, least: f64) {
        let Some(factor) = self.terms.remove(&term) else { return };
        for (&i, y) in by {
            *self.terms.entry(i).or_default() += factor * y;
        }
        self.terms.retain(|_, y| y.abs() > least);
    }
}

/// Exchanges rows so that, among nearly equivalent rows, the earlier ones are kept.
pub(super) fn in_order(part: &ScaledEquations, found: &mut [NearCombination]) {
    let mut holders: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (k, c) in found.iter().enumerate() {
        c.terms.keys().for_each(|&i| holders.entry(i).or_default().push(k));
    }
    // Each exchange replaces a dropped row by a later one, so the exchanges end; the budget limits their number.
    let mut budget = 4 * found.len() + 16;
    for k in 0..found.len() {
        while let Some(term) = found[k].later(part).filter(|_| budget > 0) {
            budget -= 1;
            found[k].exchange(term);
            let by = found[k].terms.clone();
            let others = holders.remove(&term).unwrap_or_default();
            for &other in others.iter().filter(|&&other| other != k) {
                let least = FITTED * found[other].distance;
                found[other].replace(&by, term, least);
                found[other].measure(part);
                by.keys().for_each(|&i| holders.entry(i).or_default().push(other));
            }
            by.keys().for_each(|&i| holders.entry(i).or_default().push(k));
            found[k].measure(part);
        }
    }
}

/// The combination in the user's rows and units.
pub(super) fn explain(part: &ScaledEquations, found: &NearCombination) -> NearDependent {
    let k = found.row;
    let term = |(&i, &y): (&usize, &f64)| CertificateTerm {
        row: part.rows[i] as usize,
        coefficient: ldexp(y, part.exponents[i] - part.exponents[k]),
    };
    let because = found.terms.iter().map(term).collect();
    NearDependent { row: part.rows[k] as usize, digits: found.digits(part), distance: found.distance, because }
}

fn dense(part: &ScaledEquations, row: usize) -> Vec<f64> {
    let mut dense = vec![0.0; part.matrix.cols];
    part.matrix.row(row).for_each(|(j, v)| dense[j] = v);
    dense
}

fn length(part: &ScaledEquations, row: usize) -> f64 {
    part.matrix.row(row).map(|(_, v)| v * v).sum::<f64>().sqrt()
}
