//! Equations that the user wants kept: a dependent one changes places with a kept one of its certificate.
//!
//! From `row_k = sum c_l row_l` follows `row_i = (row_k - sum_{l != i} c_l row_l) / c_i` for any i with `c_i != 0`: then k is
//! kept and i depends on it. Where all of a certificate is to be kept, so is more than the rank allows: that wish is unmet.

use std::collections::{BTreeMap, BTreeSet};

use super::certificate::{CertificateTerm, History};
use super::classify::{Dependent, Kind, Mismatch, MismatchRule, Source};
use crate::input::scale::{Scaling, ldexp};

/// A part of a certificate that cancels to within this, relative to its parts, is zero.
const NOISE: f64 = 1e-11;

/// What came of the wishes.
#[derive(Default)]
pub(crate) struct PreferenceOutcome {
    /// Wanted equations that are dependent all the same, ascending.
    pub unmet: Vec<usize>,
    /// Equations given up for wanted ones that they conflict with, and what their right-hand sides would have to be
    /// lowered by to agree.
    pub overruled: Vec<(usize, f64)>,
}

/// Exchanges dependent equations until none of `wanted` is, or no exchange is left.
pub(crate) fn keep_preferred(
    wanted: &[usize],
    dependent: &mut Vec<Dependent>,
    history: &History,
    rule: &MismatchRule,
) -> PreferenceOutcome {
    let wanted: BTreeSet<usize> = wanted.iter().copied().collect();
    let mut out = PreferenceOutcome::default();
    if !dependent.iter().any(|d| wanted.contains(&d.row)) {
        return out;
    }
    let mut all: BTreeMap<usize, Exchangeable> = dependent
        .drain(..)
        .map(|d| (d.row, Exchangeable { because: certificate(&d, history), dependent: d }))
        .collect();
    let asked: Vec<usize> = all.keys().copied().filter(|row| wanted.contains(row)).collect();
    for k in asked {
        match substitute_for(&all[&k].because, &wanted, rule.scaling) {
            Some(i) => exchange(&mut all, k, i, rule),
            None => out.unmet.push(k),
        }
    }
    out.overruled = all.values().filter(|e| e.changed() && e.is_conflicting()).map(Exchangeable::correction).collect();
    dependent.extend(all.into_values().map(Exchangeable::into_dependent));
    out
}

struct Exchangeable {
    because: BTreeMap<usize, f64>,
    dependent: Dependent,
}

impl Exchangeable {
    /// Whether an exchange made this equation dependent.
    fn changed(&self) -> bool {
        matches!(self.dependent.source, Source::Given(_))
    }

    fn is_conflicting(&self) -> bool {
        self.dependent.kind == Kind::Conflicting
    }

    fn correction(&self) -> (usize, f64) {
        (self.dependent.row, self.dependent.mismatch)
    }

    fn into_dependent(mut self) -> Dependent {
        if self.changed() {
            let terms = self.because.into_iter().map(|(row, coefficient)| CertificateTerm { row, coefficient });
            self.dependent.source = Source::Given(terms.collect());
        }
        self.dependent
    }
}

fn certificate(dependent: &Dependent, history: &History) -> BTreeMap<usize, f64> {
    dependent.source.explain(history).into_iter().map(|term| (term.row, term.coefficient)).collect()
}

/// The equation of a certificate with the largest part, of those that may go.
fn substitute_for(because: &BTreeMap<usize, f64>, wanted: &BTreeSet<usize>, scaling: &Scaling) -> Option<usize> {
    let part = |(&row, c): (&usize, &f64)| (row, ldexp(c.abs(), -scaling.row[row]));
    let may_go = because.iter().filter(|(row, _)| !wanted.contains(row)).map(part);
    may_go.reduce(|a, b| if b.1 > a.1 { b } else { a }).map(|(row, _)| row)
}

/// Equation k is kept, i depends on it.
fn exchange(all: &mut BTreeMap<usize, Exchangeable>, k: usize, i: usize, rule: &MismatchRule) {
    let Some(Exchangeable { mut because, dependent }) = all.remove(&k) else { return };
    let pivot = because.remove(&i).unwrap_or(1.0);
    because.values_mut().for_each(|c| *c = -*c / pivot);
    because.insert(k, 1.0 / pivot);
    let Mismatch { value, size, error } = dependent.rest;
    let rest = Mismatch { value: -value / pivot, size: size / pivot.abs(), error: error / pivot.abs() };
    for entry in all.values_mut() {
        if let Some(c) = entry.because.remove(&i) {
            because.iter().for_each(|(&row, &v)| add(&mut entry.because, row, c * v));
            let old = entry.dependent.rest;
            let part = (c * rest.value, c.abs() * rest.size, c.abs() * rest.error);
            let sum = Mismatch { value: old.value + part.0, size: old.size.max(part.1), error: old.error + part.2 };
            entry.dependent = Dependent::new(entry.dependent.row, sum, entry.dependent.dropped, GIVEN, rule);
        }
    }
    all.insert(i, Exchangeable { because, dependent: Dependent::new(i, rest, dependent.dropped, GIVEN, rule) });
}

/// Filled in at the end.
const GIVEN: Source = Source::Given(Vec::new());

/// Adds a part to a sum over equations; what cancels is no term.
pub(crate) fn add(because: &mut BTreeMap<usize, f64>, row: usize, part: f64) {
    let old = because.get(&row).copied().unwrap_or(0.0);
    if (old + part).abs() <= NOISE * old.abs().max(part.abs()) {
        because.remove(&row);
    } else {
        because.insert(row, old + part);
    }
}
