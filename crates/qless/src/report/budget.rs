//! Chooses the explanations of a report, whose total number of members is limited.

use rayon::prelude::*;

use super::{Certificate, DependentEquation, GeneratedCondition, Omitted};
use crate::explanation::Explanation;
use crate::{Analysis, ConstraintSystem, Dependent, Kind};

/// Number of explanations that all threads compute together before the limit is checked again.
const TOGETHER: usize = 64;

/// Largest number of operations of all searches for short explanations in a report: a second or two. Beyond that, certificates serve as
/// explanations.
const SEARCH: usize = 1 << 30;

/// The numbers of members and of search operations that remain.
pub(super) struct Budget<'a> {
    system: &'a ConstraintSystem,
    analysis: &'a Analysis,
    remaining: usize,
    search: usize,
}

impl<'a> Budget<'a> {
    pub fn new(analysis: &'a Analysis, remaining: usize) -> Self {
        Self { system: analysis.system(), analysis, remaining, search: SEARCH }
    }

    /// Explains conflicts first, then generated boundary conditions with at most half of the remaining members, then redundant equations.
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
            let mut explained = Vec::new();
            if self.remaining > 0 {
                let (analysis, may_search) = (self.analysis, self.search > 0);
                let explain = |dependent: &&Dependent| analysis.explained(dependent, may_search);
                some.par_iter().map(explain).collect_into_vec(&mut explained);
            }
            self.search = explained.iter().fold(self.search, |left, (_, effort)| left.saturating_sub(*effort));
            let mut explained: Vec<_> = explained.into_iter().map(|(explanation, _)| Some(explanation)).collect();
            explained.resize(some.len(), None);
            equations.extend(some.iter().zip(explained).map(|(dependent, found)| self.equation(dependent, found)));
        }
        equations
    }

    fn equation(&mut self, dependent: &Dependent, found: Option<Explanation>) -> DependentEquation {
        let system = self.system;
        let &Dependent { row, kind, mismatch, .. } = dependent;
        let arithmetic =
            found.as_ref().filter(|_| kind == Kind::Conflicting).map(|found| found.arithmetic(system, row));
        let certificate = self.certificate(0, || found);
        let equation = DependentEquation::new(row + 1, system.equation_label(row), kind, mismatch, certificate);
        DependentEquation { arithmetic, ..equation }
    }

    fn condition(&mut self, dof: usize, value: f64) -> GeneratedCondition {
        let (system, analysis) = (self.system, self.analysis);
        // The work of an explanation, counted in members: a pass over all DOFs (eight DOFs count as one member) and a factorization of the
        // largest block (a thousand operations count as one member).
        let block = analysis.presolve.largest_block;
        let work = system.dofs() / 8 + block.saturating_pow(3) / 1000;
        let certificate = self.certificate(work, || analysis.explain_fixed(dof).ok().flatten());
        GeneratedCondition::new(dof + 1, system.dof_label(dof), value, certificate)
    }

    /// Computes an explanation if members remain, and subtracts its members and `work` from the remaining ones. An explanation with more
    /// members than remain is omitted.
    fn certificate(&mut self, work: usize, explain: impl FnOnce() -> Option<Explanation>) -> Certificate {
        if self.remaining == 0 {
            return Certificate::left_out(Omitted::NotComputed);
        }
        let before = self.remaining;
        self.remaining = self.remaining.saturating_sub(work);
        let Some(Explanation { members, error, is_irreducible, .. }) = explain() else {
            return Certificate::left_out(Omitted::NotComputed);
        };
        self.remaining = self.remaining.saturating_sub(members.len());
        if members.len() > before {
            return Certificate::left_out(Omitted::Terms(members.len()));
        }
        let error = (error > self.analysis.options.tolerance.value()).then_some(error);
        Certificate { error, is_irreducible, ..Certificate::of_members(self.system, &members) }
    }
}
