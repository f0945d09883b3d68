//! Keeps the equations that the user prefers: a dependent one is exchanged for a kept one of its certificate.
//!
//! From `row_k = sum c_l row_l` follows `row_i = (row_k - sum_{l != i} c_l row_l) / c_i` for any i with `c_i != 0`: then k is
//! kept and i depends on it. If all equations of a certificate are preferred, they exceed the rank, and the preference is unmet.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::certificate::{CertificateTerm, History};
use super::classify::{Dependent, Kind, Mismatch, MismatchRule, Source};
use crate::input::scale::{Scaling, ldexp};

/// A term of a certificate that cancels to this fraction of its parts is zero.
const NOISE: f64 = 1e-11;

/// Which preferences could not be met, and which equations were given up for others.
#[derive(Default)]
pub(crate) struct PreferenceOutcome {
    /// Preferred equations that are dependent nevertheless, ascending.
    pub unmet: Vec<usize>,
    /// Equations given up for preferred ones that contradict them, and the amount by which their right-hand sides have to be
    /// lowered to agree.
    pub overruled: Vec<(usize, f64)>,
}

/// Exchanges dependent equations until none of `wanted` is dependent, or no exchange is possible.
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
    let mut exchange = Exchange::default();
    for d in dependent.drain(..) {
        exchange.insert(Exchangeable { because: certificate(&d, history), dependent: d });
    }
    let asked: Vec<usize> = exchange.all.keys().copied().filter(|row| wanted.contains(row)).collect();
    for k in asked {
        match substitute_for(&exchange.all[&k].because, &wanted, rule.scaling) {
            Some(i) => exchange.keep(k, i, rule),
            None => out.unmet.push(k),
        }
    }
    let all = exchange.all;
    out.overruled = all.values().filter(|e| e.changed() && e.is_conflicting()).map(Exchangeable::correction).collect();
    dependent.extend(all.into_values().map(Exchangeable::into_dependent));
    out
}

struct Exchangeable {
    because: BTreeMap<usize, f64>,
    dependent: Dependent,
}

impl Exchangeable {
    /// Returns true if an exchange made this equation dependent.
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

/// The equation that a preferred one replaces: the one with the largest term among the equations of the certificate that are not preferred.
fn substitute_for(because: &BTreeMap<usize, f64>, wanted: &BTreeSet<usize>, scaling: &Scaling) -> Option<usize> {
    let part = |(&row, c): (&usize, &f64)| (row, ldexp(c.abs(), -scaling.row[row]));
    let may_go = because.iter().filter(|(row, _)| !wanted.contains(row)).map(part);
    may_go.reduce(|a, b| if b.1 > a.1 { b } else { a }).map(|(row, _)| row)
}

/// The dependent equations while some are exchanged.
#[derive(Default)]
struct Exchange {
    all: BTreeMap<usize, Exchangeable>,
    /// For each kept equation, dependent ones whose certificates name it or named it before.
    users: HashMap<usize, Vec<usize>>,
}

impl Exchange {
    fn insert(&mut self, entry: Exchangeable) {
        let row = entry.dependent.row;
        entry.because.keys().for_each(|&kept| self.users.entry(kept).or_default().push(row));
        self.all.insert(row, entry);
    }

    /// Keeps equation k instead of equation i; i then depends on k.
    fn keep(&mut self, k: usize, i: usize, rule: &MismatchRule) {
        let Some(Exchangeable { mut because, dependent }) = self.all.remove(&k) else { return };
        let pivot = because.remove(&i).unwrap_or(1.0);
        because.values_mut().for_each(|c| *c = -*c / pivot);
        because.insert(k, 1.0 / pivot);
        let Mismatch { value, size, error } = dependent.rest;
        let rest = Mismatch { value: -value / pivot, size: size / pivot.abs(), error: error / pivot.abs() };
        for user in self.users.remove(&i).unwrap_or_default() {
            let Some(entry) = self.all.get_mut(&user) else { continue };
            let Some(c) = entry.because.remove(&i) else { continue };
            because.iter().for_each(|(&row, &v)| add(&mut entry.because, row, c * v));
            because.keys().for_each(|&row| self.users.entry(row).or_default().push(user));
            let old = entry.dependent.rest;
            let part = (c * rest.value, c.abs() * rest.size, c.abs() * rest.error);
            let sum = Mismatch { value: old.value + part.0, size: old.size.max(part.1), error: old.error + part.2 };
            entry.dependent = Dependent::new(entry.dependent.row, sum, entry.dependent.dropped, GIVEN, rule);
        }
        self.insert(Exchangeable { because, dependent: Dependent::new(i, rest, dependent.dropped, GIVEN, rule) });
    }
}

/// A placeholder: the certificate replaces it at the end.
const GIVEN: Source = Source::Given(Vec::new());

/// Adds a term to a sum over equations; removes a term that cancels.
pub(crate) fn add(because: &mut BTreeMap<usize, f64>, row: usize, part: f64) {
    let old = because.get(&row).copied().unwrap_or(0.0);
    if (old + part).abs() <= NOISE * old.abs().max(part.abs()) {
        because.remove(&row);
    } else {
        because.insert(row, old + part);
    }
}
