//! Chooses kept equations from which all consistent equations follow to the last digits.
//!
//! `u1 + u2 = 1e12 + 1e-3`, `u2 = 1e12` and `u1 = 1e-3` agree, but u1 from the first two lacks the digits that `1e12 + 1e-3` has lost. A
//! dropped equation k is examined if it may not hold to the tolerance of its terms. Two numbers are compared with this tolerance: the
//! residual that a solution of the kept equations leaves in k, and one rounding of the largest term of the certificate of k. If the
//! residual is within the rounding of the certificate, a kept equation i of the certificate is given up so that k can be kept. The
//! coefficient of i must be at least half of the largest one, so that the kept equations come nearer to dependence by a factor of two at
//! most. Among the equations with such a coefficient, i has the largest right-hand side term, and this term must exceed the terms of k. The
//! exchange is undone in components where an equation that was given up is then not redundant, where the number of dependent equations
//! changes, or where that of conflicting ones falls.

use std::collections::BTreeSet;

use super::AnalysisError;
use super::certificate::CertificateTerm;
use super::classify::{Dependent, Kind, MismatchRule, Source};
use super::confidence::CLEAR_MISMATCH;
use super::generated::{Explainer, times};
use super::pass_result::PassResult;
use crate::factor::backend::Backend;
use crate::input::components::Labels;
use crate::input::numbering::LocalSystem;
use crate::input::scale::ldexp;
use crate::presolve::rows::MORE_THAN_ROUNDING;

/// Kept equations to give up, so that dropped equations that may not hold are kept instead. Equations of `wanted` are never given up.
pub(crate) fn to_give_up(pass: &PassResult, rule: &MismatchRule, wanted: &[usize]) -> BTreeSet<usize> {
    let (system, PassResult { basis, history, dependent, .. }) = (rule.system, pass);
    let is_zero = |values: &[f64]| values.iter().all(|&value| value == 0.0);
    let mut gone = BTreeSet::new();
    if dependent.is_empty() || (is_zero(system.rhs()) && system.prescribed().iter().all(|&(_, value)| value == 0.0)) {
        return gone;
    }
    let u = basis.particular(system, rule.scaling);
    for d in dependent.iter().filter(|d| d.kind == Kind::Redundant) {
        let (left, size) = left_of(system, d.row, &u);
        // An equation whose terms are only rounding is not examined.
        let has_parts = rule.side(d.row).size > 0.0 || size > MORE_THAN_ROUNDING * d.rest.error;
        // `left` is the residual of one solution of the kept equations, and may be small by chance. Another solution may leave an error as
        // large as the rounding of the largest term of the certificate, so the larger of the two counts.
        let most_left = left.max(f64::EPSILON * d.rest.size);
        if has_parts && most_left > rule.tolerance * size && left <= MORE_THAN_ROUNDING * d.rest.error {
            let part = |term: &CertificateTerm| (term.coefficient * rule.side(term.row).size).abs();
            let scaled = |term: &CertificateTerm| ldexp(term.coefficient.abs(), -rule.scaling.row[term.row]);
            let terms = d.source.explain(history);
            let most = terms.iter().map(scaled).fold(0.0, f64::max);
            let may_go = terms.iter().filter(|term| !wanted.contains(&term.row) && scaled(term) >= most / 2.0);
            let parts = may_go.map(|term| (term.row, part(term)));
            let largest = parts.reduce(|a, b| if b.1 > a.1 { b } else { a });
            gone.extend(largest.filter(|&(_, part)| part > size).map(|(row, _)| row));
        }
    }
    gone
}

/// Whether the equations in `gone` are needed: marks the components in which one of them is not redundant, the number of dependent equations
/// changes, that of conflicting ones falls, or a new conflict is not clear. A clear new conflict is accepted, because a large right-hand
/// side may have hidden it.
pub(crate) fn is_worse(before: &PassResult, after: &PassResult, labels: &Labels, gone: &BTreeSet<usize>) -> Vec<bool> {
    let [old, new] = [before, after].map(|pass| pass.counts_by_component(labels));
    let mut is_worse: Vec<bool> = old.iter().zip(&new).map(|(old, new)| old.0 != new.0 || new.1 < old.1).collect();
    let is_conflicting = |d: &&Dependent| d.kind == Kind::Conflicting;
    let known: BTreeSet<usize> = before.dependent.iter().filter(is_conflicting).map(|d| d.row).collect();
    let is_bad =
        |d: &&Dependent| gone.contains(&d.row) || (!known.contains(&d.row) && d.relative_mismatch < CLEAR_MISMATCH);
    let bad = after.dependent.iter().filter(is_conflicting).filter(is_bad);
    bad.for_each(|d| is_worse[labels.of_row[d.row] as usize] = true);
    is_worse
}

/// The equations in `gone` as combinations of those that a run without them kept.
///
/// # Errors
/// [`AnalysisError::Backend`] if a block cannot be factored again.
pub(crate) fn as_combinations(
    gone: &BTreeSet<usize>,
    pass: &PassResult,
    rule: &MismatchRule,
    backend: &dyn Backend,
) -> Result<Vec<Dependent>, AnalysisError> {
    let (system, scaling, PassResult { basis, blocks, history, .. }) = (rule.system, rule.scaling, pass);
    let time = &times(basis, system.dofs());
    let explainer = Explainer { system, basis, blocks, history, scaling, backend, time };
    let dependent = |&row: &usize| {
        let free = system.row(row).filter(|&(j, _)| system.free()[j]).map(|(j, v)| (j as u32, v));
        let because = explainer.because(free)?;
        let mut rest = rule.side(row);
        because.iter().for_each(|term| rest.subtract(term.coefficient, rule.side(term.row)));
        Ok(Dependent::new(row, rest, 0.0, Source::Given(because), rule))
    };
    gone.iter().map(dependent).collect()
}

/// The residual `|b - C u|` of an equation, and its largest term.
fn left_of(system: LocalSystem, row: usize, u: &[f64]) -> (f64, f64) {
    let b = system.rhs()[row];
    let parts = system.row(row).map(|(j, v)| v * u[j]);
    let (sum, size) = parts.fold((b, b.abs()), |(sum, size), part| (sum - part, size.max(part.abs())));
    (sum.abs(), size)
}
