//! Proofs of a verdict, with rounding counted: the kept equations are independent, and every other one is a combination of them.
//!
//! ```text
//! kept      triangular   equations with one DOF, or with a DOF that no other equation has, are removed until only cores are left. The
//!                        coefficients of removed equations do not matter, so this comes first and needs no arithmetic
//!           bounded      A holds the equations of a core in scaled rows and columns, s is a small part of the diagonal of A A^T:
//!                        fl(A A^T) - diag(s) = L L^T   runs to its end, and for every i
//!                        s_i > (gamma |L| |L|^T e + gamma |A| |A|^T e + 2 u diag(A A^T))_i       gamma_n = n u / (1 - n u)
//!                        so  x^T A A^T x > 0  for every x, and A^T (A A^T)^-1 is a right inverse
//!           modular      the rank of A modulo a prime, which is never above the rank
//! dropped   exact        sum_i c_i row_i = row_k  with rational c_i, modulo primes whose product is above every numerator;
//!                        or all minors of size r + 1 of row_k and the r rows of its certificate are zero, in the same way
//!           enclosed     |row_kj - sum_i c_i row_ij| <= 2^-46 (|row_kj| + sum_i |c_i row_ij|),  if numbers have more than 12 digits
//! ```
//!
//! Right-hand sides, with prescribed DOFs moved into them, are one more column. It agrees for a redundant equation and differs for a
//! conflicting one. [`crate::Options::numbers`] decides how numbers are read. The bound holds for both readings: a decimal differs from its
//! double by a rounding, which gamma counts. Numbers of more than 12 digits were computed. Their sums are seldom exactly zero, so
//! such combinations are enclosed if they are not exact. 2^-46 is the size below which a number may be rounding of others
//! ([`crate::Noise`]).
//!
//! Cost: a sparse Cholesky factorization of each core, and O(nnz) of each certificate for each prime. The proof does not cover which DOFs
//! the equations fix.

mod exactly;
mod gram;
mod number_size;
mod rational;
mod rounded_sides;

use rayon::prelude::*;

use super::classify::{Dependent, Kind};
use super::confidence::Doubt;
use super::core::{Core, cores};
use super::exact::eliminate::eliminate;
use super::exact::field::Field;
use super::exact::prime;
use super::{Analysis, certificate::CertificateTerm};
use crate::Options;
use crate::input::numbering::LocalSystem;
use crate::input::reading::Number;
use exactly::{Explanation, Found};
use rounded_sides::{has_computed_sides, is_computed, sides_agree};

/// How the verdict on every equation was proved; [`crate::Effort::Proved`] and [`crate::Effort::Exact`].
///
/// ```
/// use qless::{Effort, Options, SystemBuilder, analyse};
/// let mut builder = SystemBuilder::new(3);
/// builder.equation([(0, 0.1), (1, 0.2)], 0.0);
/// builder.equation([(1, 0.3), (2, 1.0)], 0.0);
/// builder.equation([(0, 0.1), (1, 0.5), (2, 1.0)], 0.0);
/// let options = Options { effort: Effort::Proved, ..Options::default() };
/// let analysis = analyse(&builder.build()?, &options)?;
/// let proof = analysis.proof().expect("asked for");
/// assert_eq!((proof.triangular, proof.exact, proof.unproved.len()), (2, 1, 0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Proof {
    /// Kept equations in triangular parts, which are independent whatever their numbers are.
    pub triangular: usize,
    /// Kept equations that a bound with rounding counted proves to be independent.
    pub bounded: usize,
    /// Kept equations that have full rank modulo a prime, and therefore are independent.
    pub modular: usize,
    /// Dependent equations that are exactly the combination of their certificate, and whose right-hand side exactly agrees or differs.
    pub exact: usize,
    /// Dependent equations with computed numbers that equal the combination of their certificate to rounding.
    pub enclosed: usize,
    /// Equations without a proof, 0-based and ascending.
    pub unproved: Vec<usize>,
}

impl Analysis {
    /// Proves the verdicts of the analysis; a verdict without a proof is in doubt.
    pub(super) fn prove(&mut self) {
        let proof = Proof::of(self);
        if !proof.unproved.is_empty() {
            self.confidence = self.confidence.or(Doubt::Unproved);
        }
        self.proof = Some(proof);
    }

    /// Compares right-hand sides in exact arithmetic ([`are_sides_contradicted`]). A contradicted verdict is in doubt.
    pub(super) fn check_sides(&mut self) {
        let local = self.local();
        if !self.confidence.ambiguous && are_sides_contradicted(self, &self.dependent, local) {
            self.confidence = self.confidence.or(Doubt::Mismatch);
        }
    }
}

/// Returns true if exact arithmetic contradicts the verdict on one of the dependent equations of an analysis; `local` has the right-hand
/// sides. Only equations are verified whose certificate is known without a solve, and whose mismatch is above rounding or is accepted only
/// because its error bound is large: elimination loses digits of right-hand sides if it substitutes large values or nearly parallel
/// equations. Right-hand sides with stated errors need not agree exactly, so they contradict nothing.
pub(crate) fn are_sides_contradicted(analysis: &Analysis, dependent: &[Dependent], local: LocalSystem) -> bool {
    let Options { tolerance, noise, numbers, .. } = &analysis.options;
    if tolerance.is_absolute() || noise.has_errors_of_sides() {
        return false;
    }
    let explanation = Explanation::new(local, *numbers);
    let is_open = |d: &&Dependent| {
        let is_beside_rounding = d.kind == Kind::Conflicting || d.relative_mismatch > 0.0;
        (is_beside_rounding || d.is_excused(tolerance.value())) && d.source.is_known()
    };
    dependent.par_iter().filter(is_open).any(|d| is_contradicted(analysis, &explanation, d, local))
}

/// Returns true if the right-hand sides as typed contradict the verdict.
fn is_contradicted(analysis: &Analysis, explanation: &Explanation, dependent: &Dependent, local: LocalSystem) -> bool {
    let terms = dependent.source.explain(&analysis.history);
    let (row, is_redundant) = (dependent.row, dependent.kind == Kind::Redundant);
    if terms.iter().any(|term| analysis.kinds[term.row] != Kind::Independent) {
        return false;
    }
    let agrees = exact_sides(explanation, row, &terms).is_none_or(|agree| agree == is_redundant);
    // Computed numbers cannot be expected to agree better than to rounding.
    let is_rounded = || has_computed_sides(local, row, &terms) || is_computed(local, row, &terms);
    !(agrees || is_redundant && is_rounded())
}

/// Returns true if the right-hand side of the equation is exactly the combination of those of its certificate. None unless it is proved
/// that the coefficients of the equation are exactly this combination.
fn exact_sides(explanation: &Explanation, row: usize, terms: &[CertificateTerm]) -> Option<bool> {
    let is_exact = |found: &Found| found.is_combination;
    let found = explanation.identity(row, terms).filter(is_exact);
    found.or_else(|| explanation.minors(row, terms).filter(is_exact)).map(|found| found.sides_agree)
}

impl Proof {
    /// Collects the proofs of an analysis.
    pub(super) fn of(analysis: &Analysis) -> Self {
        let mut proof = Self::default();
        proof.add_kept(analysis);
        let explainer = Explanation::new(analysis.local(), analysis.options.numbers);
        let found: Vec<_> = analysis.dependent.par_iter().map(|d| dropped(analysis, &explainer, d)).collect();
        for (found, dependent) in found.into_iter().zip(&analysis.dependent) {
            match found {
                Some(true) => proof.exact += 1,
                Some(false) => proof.enclosed += 1,
                None => proof.unproved.push(dependent.row),
            }
        }
        proof.unproved.sort_unstable();
        proof
    }

    fn add_kept(&mut self, analysis: &Analysis) {
        let local = analysis.local();
        let is_kept = |i: &usize| analysis.kinds[*i] == Kind::Independent;
        let kept: Vec<u32> = (0..analysis.kinds.len()).filter(is_kept).map(|i| i as u32).collect();
        let cores = cores(local, &kept);
        self.triangular = kept.len() - cores.iter().map(|core| core.rows.len()).sum::<usize>();
        let memory = analysis.options.memory;
        let is_bounded: Vec<bool> = cores.par_iter().map(|core| gram::is_independent(core, memory)).collect();
        for (core, is_bounded) in cores.iter().zip(is_bounded) {
            if is_bounded {
                self.bounded += core.rows.len();
            } else if has_full_rank(core, analysis) {
                self.modular += core.rows.len();
            } else {
                self.unproved.extend(core.rows.iter().map(|&row| row as usize));
            }
        }
    }
}

/// Bytes of a coefficient during modular elimination.
const BYTES: usize = 24;

/// Returns true if a core has full row rank modulo a prime; false also if elimination would need too much memory.
fn has_full_rank(core: &Core, analysis: &Analysis) -> bool {
    let field = Field::new(prime::first(1)[0]);
    let mut dofs: Vec<u32> = core.entries.iter().flatten().map(|&(j, _)| j).collect();
    dofs.sort_unstable();
    dofs.dedup();
    let place = |j: u32| dofs.partition_point(|&other| other < j) as u32;
    let residue = |value| field.residue(Number::read(value, analysis.options.numbers));
    let row = |entries: &Vec<(u32, f64)>| {
        let mut row: Vec<_> = entries.iter().map(|&(j, v)| (place(j), residue(v))).collect();
        row.sort_unstable();
        row
    };
    let (rows, count) = (core.entries.iter().map(row).collect(), core.rows.len());
    let done = eliminate(field, rows, vec![0; count], dofs.len(), analysis.options.memory / BYTES);
    done.is_ok_and(|done| done.pivots.len() == count)
}

/// Proves the verdict on a dependent equation exactly (`true`) or to rounding (`false`); None without a proof.
fn dropped(analysis: &Analysis, explanation: &Explanation, dependent: &Dependent) -> Option<bool> {
    let terms = analysis.checked(dependent).0;
    if terms.iter().any(|term| analysis.kinds[term.row] != Kind::Independent) {
        return None;
    }
    let row = dependent.row;
    match exact_sides(explanation, row, &terms) {
        Some(agree) if agree == (dependent.kind == Kind::Redundant) => Some(true),
        // A computed right-hand side cannot be expected to agree better than to rounding.
        Some(_) if dependent.kind == Kind::Redundant && has_computed_sides(analysis.local(), row, &terms) => {
            is_enclosed(analysis, dependent, &terms).then_some(false)
        }
        None if is_computed(analysis.local(), row, &terms) => is_enclosed(analysis, dependent, &terms).then_some(false),
        _ => None,
    }
}

/// Returns true if the verdict holds to rounding by the given certificate, or by a refined one.
fn is_enclosed(analysis: &Analysis, dependent: &Dependent, terms: &[CertificateTerm]) -> bool {
    let (row, is_redundant) = (dependent.row, dependent.kind == Kind::Redundant);
    let holds = |terms: &[CertificateTerm]| {
        is_combination(analysis, row, terms) && sides_agree(analysis.local(), row, terms) == Some(is_redundant)
    };
    holds(terms) || {
        let refined = analysis.refined(dependent, ROUNDING / 4.0).0;
        refined.iter().all(|term| analysis.kinds[term.row] == Kind::Independent) && holds(&refined)
    }
}

/// A sum below this fraction of its terms may be their rounding.
const ROUNDING: f64 = f64::EPSILON * 64.0;

/// [`ROUNDING`] less the errors of a computed sum: a sum of n terms, computed with twice the digits, is wrong by at most a unit in its last
/// place plus `(n u)^2` times the sum of the magnitudes of its terms, where u is the rounding unit (Ogita, Rump, Oishi 2005). A hundredth
/// of [`ROUNDING`] is above that for up to 10^8 terms.
const COMPUTED: f64 = 0.99 * ROUNDING;

/// Returns true if the combination of a certificate equals its equation to rounding, with the errors of the sums counted.
fn is_combination(analysis: &Analysis, row: usize, terms: &[CertificateTerm]) -> bool {
    // Products below 1e-290 may lose digits.
    let is_rounding =
        |&(left, size): &(f64, f64)| size == 0.0 || size > 1e-290 && size.is_finite() && left.abs() <= COMPUTED * size;
    analysis.parts(analysis.entries(row), terms).iter().all(|(_, parts)| is_rounding(parts))
}
