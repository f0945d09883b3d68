//! Certificates in the user's equations, checked and refined.
//!
//! ```text
//! row_k = sum_i c_i row_i             of a dependent equation k
//! e_s   = sum_i c_i row_i             of a DOF s that the equations fix
//!
//! error = max_j |row_kj - sum c_i row_ij| / (|row_kj| + sum |c_i row_ij|)
//! refinement: the remainder row_k - sum c_i row_i is expressed by the kept equations, and its coefficients are added to c;
//!             skipped if a block is large
//! ```

use std::collections::BTreeMap;

use rustc_hash::FxHashMap;

use super::Analysis;
use super::certificate::CertificateTerm;
use super::classify::Dependent;
use super::generated::{self, Explainer};
use super::preferred_equations::add;
use crate::common::argument::{ArgumentError, within};
use crate::common::two_sum;
use crate::factor::backend::{Backend, BackendError};
use crate::input::scale::ldexp;

/// No refinement if a block has more entries than this (2 MiB): refinement factors the block again, which costs too much for a report.
const SMALL: usize = 1 << 18;

/// Largest number of refinements; each gains as many digits as the condition of the kept equations allows.
const REFINEMENTS: usize = 3;

impl Analysis {
    /// Why an equation is dependent: the terms of `row_k = sum c_i row_i` over the free DOFs, ascending by row; empty for an independent
    /// equation.
    ///
    /// The coefficients are checked and, if their error is above the tolerance and no block is large, refined:
    /// [`Analysis::because_error`] is the remaining error.
    /// For every free DOF j, in its own unit, `|row_kj - sum c_i row_ij|` is at most `1e-11 / d` of the largest term `|c_i row_il|` of the
    /// certificate, whatever the sizes of equations; d is [`Confidence::distance`](crate::Confidence::distance).
    ///
    /// # Errors
    /// [`ArgumentError::OutOfRange`].
    pub fn because(&self, row: usize) -> Result<Vec<CertificateTerm>, ArgumentError> {
        within("equation", row, self.kinds.len())?;
        Ok(self.dependent_of(row).map_or_else(Vec::new, |dependent| self.checked(dependent).0))
    }

    /// Error of [`Analysis::because`]: `max_j |row_kj - sum c_i row_ij| / (|row_kj| + sum |c_i row_ij|)` over the free DOFs; 0 if it is at
    /// most the tolerance, and with [`Effort::Quick`](crate::Effort::Quick), which does not check it.
    /// Costs as much as the certificate.
    ///
    /// ```
    /// use qless::{Options, SystemBuilder, analyse};
    /// let mut builder = SystemBuilder::new(2);
    /// builder.equation([(0, 1.0), (1, -1.0)], 0.0);
    /// builder.equation([(0, 2.0), (1, -2.0)], 0.0);
    /// let analysis = analyse(&builder.build()?, &Options::default())?;
    /// assert_eq!((analysis.because(1)?[0].coefficient, analysis.because_error(1)?), (2.0, 0.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ArgumentError::OutOfRange`].
    pub fn because_error(&self, row: usize) -> Result<f64, ArgumentError> {
        within("equation", row, self.kinds.len())?;
        let error = self.dependent_of(row).map_or(0.0, |dependent| self.checked(dependent).1);
        Ok(if error > self.options.tolerance.value() { error } else { 0.0 })
    }

    /// Why a DOF s of [`Analysis::generated`] is fixed: its unit vector `e_s = sum c_i row_i` over the free DOFs; empty for any other DOF.
    ///
    /// # Errors
    /// [`BackendError`] if the block of the DOF cannot be factored again.
    pub fn because_fixed(&self, dof: usize) -> Result<Vec<CertificateTerm>, BackendError> {
        let Ok(place) = self.generated.binary_search_by_key(&dof, |&(j, _)| j) else { return Ok(Vec::new()) };
        self.expressed([(self.fixed[place], 1.0)])
    }

    /// The certificate with its error, refined as long as that reduces an error above the tolerance.
    pub(crate) fn checked(&self, dependent: &Dependent) -> (Vec<CertificateTerm>, f64) {
        self.refined(dependent, self.options.tolerance.value())
    }

    /// The certificate with its error, refined as long as that reduces an error above `limit`.
    pub(super) fn refined(&self, dependent: &Dependent, limit: f64) -> (Vec<CertificateTerm>, f64) {
        let terms = dependent.source.explain(&self.history);
        if !self.options.effort.checks() {
            return (terms, 0.0);
        }
        let mut best = self.best_of(dependent.row, terms, limit);
        let mut last = best.0.clone();
        let is_small = || self.blocks.iter().all(|block| block.rows.len() * block.dofs.len() <= SMALL);
        for _ in 0..REFINEMENTS {
            if best.1 <= limit || !is_small() {
                break;
            }
            let left = self.parts(self.entries(dependent.row), &last).into_iter().map(|(j, (left, _))| (j, left));
            let Ok(correction) = self.expressed(left) else { break };
            let mut sum = last.iter().map(|term| (term.row, term.coefficient)).collect();
            correction.iter().for_each(|term| add(&mut sum, term.row, term.coefficient));
            // Terms of a correction may be needed although they do not reduce the error yet: each correction has only those terms that are
            // above rounding of its largest one.
            last = terms_of(sum);
            let better = self.best_of(dependent.row, last.clone(), limit);
            if better.1 < best.1 {
                last.clone_from(&better.0);
                best = better;
            }
        }
        best
    }

    /// The certificate with or without terms that may be rounding, whichever has the smaller error. Such a term alone gives an error of 1
    /// at a DOF that no other term contains.
    fn best_of(&self, row: usize, terms: Vec<CertificateTerm>, limit: f64) -> (Vec<CertificateTerm>, f64) {
        let parts = [f64::EPSILON * terms.len() as f64, 1e-13, 1e-11];
        let mut best = self.with_error(row, terms);
        for part in parts {
            if best.1 <= limit {
                break;
            }
            let pruned = self.with_error(row, self.pruned(&best.0, part));
            best = if pruned.1 <= best.1 { pruned } else { best };
        }
        best
    }

    /// The terms above the fraction `part` of the largest one, in scaled units.
    pub(crate) fn pruned(&self, terms: &[CertificateTerm], part: f64) -> Vec<CertificateTerm> {
        let scaled = |term: &CertificateTerm| ldexp(term.coefficient.abs(), -self.scaling.row[term.row]);
        let largest = terms.iter().map(scaled).fold(0.0, f64::max);
        terms.iter().copied().filter(|term| scaled(term) > part * largest).collect()
    }

    /// For each free local DOF, ascending: what remains of a vector after its certificate is subtracted, and the sum of the magnitudes of
    /// all terms.
    pub(crate) fn parts(
        &self,
        vector: impl IntoIterator<Item = (u32, f64)>,
        terms: &[CertificateTerm],
    ) -> Vec<(u32, (f64, f64))> {
        let mut sums = self.sums(vector, terms);
        sums.retain(|&(j, _)| self.numbering.free[j as usize]);
        sums
    }

    /// As [`Self::parts`], for all local DOFs, prescribed ones too. The remainder is summed in twice the precision, so that a refinement
    /// uses its true value. Thousands of certificates are checked one by one, so time and memory depend on the terms only, not on the size
    /// of the system.
    pub(crate) fn sums(
        &self,
        vector: impl IntoIterator<Item = (u32, f64)>,
        terms: &[CertificateTerm],
    ) -> Vec<(u32, (f64, f64))> {
        let (mut sums, mut place) = (Vec::<(u32, [f64; 3])>::new(), FxHashMap::default());
        let mut add = |j: u32, coefficient: f64, v: f64| {
            let k = *place.entry(j).or_insert_with(|| {
                sums.push((j, [0.0; 3]));
                sums.len() - 1
            });
            let [left, lost, size] = &mut sums[k].1;
            let part = coefficient * v;
            let (sum, error) = two_sum(*left, part);
            *lost += coefficient.mul_add(v, -part) + error;
            *left = sum;
            *size += part.abs();
        };
        for term in terms {
            self.entries(term.row).for_each(|(j, v)| add(j, -term.coefficient, v));
        }
        vector.into_iter().for_each(|(j, v)| add(j, 1.0, v));
        sums.sort_unstable_by_key(|&(j, _)| j);
        sums.into_iter().map(|(j, [left, lost, size])| (j, (left + lost, size))).collect()
    }

    pub(super) fn entries(&self, row: usize) -> impl Iterator<Item = (u32, f64)> {
        self.local().row(row).map(|(j, v)| (j as u32, v))
    }

    fn with_error(&self, row: usize, terms: Vec<CertificateTerm>) -> (Vec<CertificateTerm>, f64) {
        let error = self.error_of(self.entries(row), &terms);
        (terms, error)
    }

    /// The error of a combination that should equal a vector: the largest relative remainder at a free DOF.
    pub(crate) fn error_of(&self, vector: impl IntoIterator<Item = (u32, f64)>, terms: &[CertificateTerm]) -> f64 {
        self.error_in(&self.sums(vector, terms))
    }

    /// The largest relative remainder at a free DOF. For each DOF, `sums` has the remainder and the sum of the magnitudes of its terms.
    pub(crate) fn error_in(&self, sums: &[(u32, (f64, f64))]) -> f64 {
        let error = |(left, size): (f64, f64)| if left == 0.0 { 0.0 } else { left.abs() / size };
        let free = sums.iter().filter(|sum| self.numbering.free[sum.0 as usize]);
        free.map(|&(_, sum)| error(sum)).fold(0.0, |most, e| if e.is_nan() { f64::INFINITY } else { most.max(e) })
    }

    /// Expresses a vector of free DOFs, by local number, as a combination of the kept equations.
    pub(crate) fn expressed(
        &self,
        vector: impl IntoIterator<Item = (u32, f64)>,
    ) -> Result<Vec<CertificateTerm>, BackendError> {
        let backend: Box<dyn Backend> = self.options.backend.get(self.options.memory)?;
        let explainer = Explainer {
            system: self.local(),
            basis: &self.basis,
            blocks: &self.blocks,
            history: &self.history,
            scaling: &self.scaling,
            backend: backend.as_ref(),
            time: self.times.get_or_init(|| generated::times(&self.basis, self.numbering.dofs.len())),
        };
        explainer.because(vector)
    }
}

fn terms_of(sum: BTreeMap<usize, f64>) -> Vec<CertificateTerm> {
    sum.into_iter().map(|(row, coefficient)| CertificateTerm { row, coefficient }).collect()
}
