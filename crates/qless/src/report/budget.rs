//! Chooses the certificates of a report, whose total number of terms is limited.

use rayon::prelude::*;

use super::{Certificate, DependentEquation, GeneratedCondition, Omitted};
use crate::{Analysis, CertificateTerm, ConstraintSystem, Dependent, Kind};

/// Certificates that are computed at a time, by all threads.
const TOGETHER: usize = 64;

/// A certificate and its error.
type CheckedTerms = (Vec<CertificateTerm>, f64);

/// The number of terms that remain.
pub(super) struct Budget<'a> {
    system: &'a ConstraintSystem,
    analysis: &'a Analysis,
    remaining: usize,
}

impl<'a> Budget<'a> {
    pub fn new(analysis: &'a Analysis, remaining: usize) -> Self {
        Self { system: analysis.system(), analysis, remaining }
    }

    /// Conflicts first, then generated boundary conditions with at most half of the remaining terms, then redundant equations.
    pub fn spend(&mut self) -> (Vec<DependentEquation>, Vec<GeneratedCondition>) {
        let mut dependent = self.equations(Kind::Conflicting);
        let reserved = self.remaining / 2;
        self.remaining -= reserved;
        let generated = self.analysis.generated.iter().map(|&(dof, value)| self.condition(dof, value)).collect();
        self.remaining += reserved;
        dependent.extend(self.equations(Kind::Redundant));
        dependent.sort_unstable_by_key(|equation| equation.row);
        (dependent, generated)
    }

    fn equations(&mut self, kind: Kind) -> Vec<DependentEquation> {
        let of_kind: Vec<_> = self.analysis.dependent.iter().filter(|dependent| dependent.kind == kind).collect();
        let mut equations = Vec::with_capacity(of_kind.len());
        for some in of_kind.chunks(TOGETHER) {
            let mut checked = Vec::new();
            if self.remaining > 0 {
                some.par_iter().map(|dependent| Some(self.analysis.checked(dependent))).collect_into_vec(&mut checked);
            }
            checked.resize(some.len(), None);
            equations.extend(some.iter().zip(checked).map(|(dependent, checked)| self.equation(dependent, checked)));
        }
        equations
    }

    fn equation(&mut self, dependent: &Dependent, checked: Option<CheckedTerms>) -> DependentEquation {
        let analysis = self.analysis;
        let &Dependent { row, kind, mismatch, .. } = dependent;
        let error = checked.as_ref().map_or(0.0, |checked| checked.1);
        let mut certificate = self.certificate(0, || checked.map(|checked| checked.0));
        let is_shown = certificate.omitted == Omitted::Nothing;
        certificate.error = (is_shown && error > analysis.options.tolerance.value()).then_some(error);
        DependentEquation::new(row + 1, self.system.equation_label(row), kind, mismatch, certificate)
    }

    fn condition(&mut self, dof: usize, value: f64) -> GeneratedCondition {
        let (system, analysis) = (self.system, self.analysis);
        // The cost of a pass over all DOFs and of a factorization of a block; a thousand operations count as one term.
        let block = analysis.presolve.largest_block;
        let work = system.dofs() / 8 + block.saturating_pow(3) / 1000;
        let certificate = self.certificate(work, || analysis.because_fixed(dof).ok());
        GeneratedCondition::new(dof + 1, system.dof_label(dof), value, certificate)
    }

    /// Computes a certificate if terms remain, and omits it if it has more terms than remain.
    fn certificate(&mut self, work: usize, compute: impl FnOnce() -> Option<Vec<CertificateTerm>>) -> Certificate {
        if self.remaining == 0 {
            return Certificate::left_out(Omitted::NotComputed);
        }
        let before = self.remaining;
        self.remaining = self.remaining.saturating_sub(work);
        let Some(terms) = compute() else { return Certificate::left_out(Omitted::NotComputed) };
        self.remaining = self.remaining.saturating_sub(terms.len());
        if terms.len() > before {
            return Certificate::left_out(Omitted::Terms(terms.len()));
        }
        Certificate::labelled(self.system, &terms)
    }
}
