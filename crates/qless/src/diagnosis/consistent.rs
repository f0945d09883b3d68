//! Kept equations of which all consistent equations follow to the last digits.
//!
//! `u1 + u2 = 1e12 + 1e-3`, `u2 = 1e12` and `u1 = 1e-3` agree, but the first two give u1 with the digits that `1e12 + 1e-3` has lost.
//! A dropped equation does not hold if a solution of the kept ones leaves more than the tolerance of its own parts; where no more than the
//! rounding of its certificate is left, the equation with the largest part of the certificate is given up instead.

use std::collections::BTreeSet;

use super::Analysis;
use super::certificate::{CertificateTerm, History};
use super::classify::{Dependent, Kind, Mismatch, Source};
use crate::input::numbering::LocalSystem;
use crate::input::scale::{Scaling, ldexp};
use crate::presolve::basis::Basis;
use crate::presolve::rows::{MORE_THAN_ROUNDING, WorkingRow};

/// Times that equations are given up; each time all equations of a chain of losses that are known.
pub const ROUNDS: usize = 4;

/// Equations to give up for dropped ones that do not hold, if they are not wanted.
pub fn to_give_up(
    system: LocalSystem,
    (basis, history, dependent): (&Basis, &History, &[Dependent]),
    scaling: &Scaling,
    wanted: &[usize],
    tolerance: f64,
) -> BTreeSet<usize> {
    let is_zero = |values: &[f64]| values.iter().all(|&value| value == 0.0);
    let mut gone = BTreeSet::new();
    if dependent.is_empty() || (is_zero(system.rhs()) && system.prescribed().iter().all(|&(_, value)| value == 0.0)) {
        return gone;
    }
    let u = basis.particular(system, scaling);
    for d in dependent.iter().filter(|d| d.kind == Kind::Redundant) {
        let (left, size) = left_of(system, d.row, &u);
        if left > tolerance * size && left <= MORE_THAN_ROUNDING * d.rest.error {
            let part = |row: usize, c: f64| (c * of_row(system, row).size).abs();
            let terms = d.source.explain(history);
            let scaled = |term: &CertificateTerm| ldexp(term.coefficient.abs(), -scaling.row[term.row]);
            let most = terms.iter().map(scaled).fold(0.0, f64::max);
            // An exchange by a smaller coefficient would bring the kept equations nearer to dependence.
            let may_go = terms.iter().filter(|term| scaled(term) >= most / 2.0 && !wanted.contains(&term.row));
            let parts = may_go.map(|term| (term.row, part(term.row, term.coefficient)));
            let largest = parts.reduce(|a, b| if b.1 > a.1 { b } else { a });
            gone.extend(largest.filter(|&(_, part)| part > size).map(|(row, _)| row));
        }
    }
    gone
}

/// `|b - C u|` of an equation, and the largest of its parts.
fn left_of(system: LocalSystem, row: usize, u: &[f64]) -> (f64, f64) {
    let b = system.rhs()[row];
    let parts = system.row(row).map(|(j, v)| v * u[j]);
    let (sum, size) = parts.fold((b, b.abs()), |(sum, size), part| (sum - part, size.max(part.abs())));
    (sum.abs(), size)
}

/// `b - C_p u_p` of an equation.
fn of_row(system: LocalSystem, row: usize) -> Mismatch {
    let mut side = WorkingRow::new(system.rhs()[row]);
    for &(j, value) in system.prescribed() {
        system.row(row).filter(|&(k, _)| k == j).for_each(|(_, v)| side.prescribe(v * value));
    }
    Mismatch::of_row(&side)
}

impl Analysis {
    /// Classifies equations that were given up, as combinations of the kept ones.
    pub(super) fn with_given_up(mut self, gone: &BTreeSet<usize>) -> Self {
        for &row in gone {
            let local = self.numbering.view(&self.system, self.system.rhs());
            let free: Vec<_> = local.row(row).filter(|&(j, _)| local.free()[j]).map(|(j, v)| (j as u32, v)).collect();
            let because = self.expressed(free).unwrap_or_default();
            let mut rest = of_row(local, row);
            because.iter().for_each(|term| rest.subtract(term.coefficient, of_row(local, term.row)));
            // It agreed with the others when it was kept.
            rest.error = rest.error.max(rest.value.abs());
            let found = Dependent::new(row, rest, 0.0, Source::Given(because), self.options.tolerance.value());
            self.kinds[row] = found.kind;
            let place = self.dependent.partition_point(|d| d.row < row);
            self.dependent.insert(place, found);
        }
        self
    }
}
