//! Exchanges equations so that those that the user prefers are kept: a dependent one replaces a kept one of its certificate.
//!
//! From `row_k = sum c_l row_l` follows `row_i = (row_k - sum_{l != i} c_l row_l) / c_i` for any i with `c_i != 0`: then k is
//! kept and i depends on it. If all equations of a certificate are preferred, they exceed the rank, and the preference is unmet. The stages
//! then run again on the kept equations of the components with exchanges, so that the basis, T, G and g come from these equations alone.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use super::certificate::{CertificateTerm, History};
use super::classify::{Dependent, Mismatch, MismatchRule, Source};
use super::pass_result::PassResult;
use crate::input::components::Labels;
use crate::input::scale::{Scaling, ldexp};

/// A term of a certificate that cancels to this fraction of its parts is zero.
const NOISE: f64 = 1e-11;

/// Exchanges dependent equations until none of `wanted` is dependent, or no exchange is possible. Returns all dependent equations of the
/// components with exchanges.
pub(crate) fn exchanged(wanted: &[usize], pass: &PassResult, rule: &MismatchRule) -> BTreeMap<usize, Dependent> {
    let wanted: BTreeSet<usize> = wanted.iter().copied().collect();
    let asked: Vec<usize> = pass.dependent.iter().map(|d| d.row).filter(|row| wanted.contains(row)).collect();
    if asked.is_empty() {
        return BTreeMap::new();
    }
    let mut exchange = Exchange::default();
    for d in &pass.dependent {
        exchange.insert(Exchangeable { because: certificate(d, &pass.history), dependent: d.clone() });
    }
    let labels = Labels::of(rule.system);
    let mut is_changed = vec![false; labels.count];
    for k in asked {
        if let Some(i) = substitute_for(&exchange.all[&k].because, &wanted, rule.scaling) {
            exchange.keep(k, i, rule);
            is_changed[labels.of_row[k] as usize] = true;
        }
    }
    let changed = exchange.all.into_iter().filter(|(row, _)| is_changed[labels.of_row[*row] as usize]);
    changed.map(|(row, entry)| (row, entry.into_dependent())).collect()
}

/// Marks the components in which a run finds another number of dependent equations: there, those that were left out are needed.
pub(crate) fn has_another_rank(before: &PassResult, after: &PassResult, labels: &Labels) -> Vec<bool> {
    let [old, new] = [before, after].map(|pass| pass.counts_by_component(labels));
    old.iter().zip(&new).map(|(old, new)| old.0 != new.0).collect()
}

struct Exchangeable {
    because: BTreeMap<usize, f64>,
    dependent: Dependent,
}

impl Exchangeable {
    fn into_dependent(self) -> Dependent {
        let terms = self.because.into_iter().map(|(row, coefficient)| CertificateTerm { row, coefficient });
        Dependent { source: Source::Given(terms.collect()), ..self.dependent }
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
