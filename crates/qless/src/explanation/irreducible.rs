//! Leaves out members of a combination without which the others still explain the vector.
//!
//! ```text
//! row_k = 1000 row_1 + 1000 row_2                                        irreducible
//! row_k = 1000 row_1 + 1000 row_2 + 2e-6 row_3 - 2e-6 row_4 + ...        an elimination through a coefficient of 1e-10 finds this
//!
//! v_j = sum_i c_i a_ij                          the vector
//! s_j = |v_j| + sum_i |c_i a_ij|                sizes of the sums
//! M_ji = c_i a_ij / s_j,   M = Q R              the terms of the members, without units
//! d_i = 1 / |row i of R^-1|                     distance of member i from the span of the others
//! ```
//!
//! Without member i, the smallest remainder is d_i. If it is within the tolerance, the others may explain v. Members are independent, so
//! their coefficients are unique, and the coefficient of such a member should be zero.

use std::collections::HashSet;

use super::{Explanation, Member, NOISE, SAME, neighbourhood};
use crate::{Analysis, CertificateTerm, Kind};

/// Largest number of members that are examined, as many as a neighbourhood has. The QR factorization of the matrix M of their terms then
/// takes some milliseconds.
const MOST: usize = neighbourhood::MOST;

/// Largest number of multiplications of all factorizations for one explanation: about a tenth of a second. Beyond it no other member is
/// tried.
const MOST_EFFORT: usize = 1 << 28;

/// Each projection is subtracted twice, and each solution is computed and then refined once. That leaves no more than rounding.
const PASSES: usize = 2;

/// The members of an explanation, and the factorization `M = Q R` of the matrix M of their terms: a row for each DOF, a column for each
/// member.
struct Members<'a> {
    analysis: &'a Analysis,
    vector: &'a [(u32, f64)],
    terms: Vec<CertificateTerm>,
    /// For each row of M, its free DOF and the sum of the magnitudes of the terms at this DOF; ascending by DOF.
    sizes: Vec<(u32, f64)>,
    /// The columns of the orthonormal factor Q of M.
    q: Vec<Vec<f64>>,
    /// The columns of the triangular factor R of M; column i has `i + 1` numbers.
    r: Vec<Vec<f64>>,
    /// For each member, its coefficient divided by the one for which its column of M was computed.
    factors: Vec<f64>,
}

/// The search for members that can be left out.
struct LeavingOut<'a> {
    /// The explanation by some equations, if it is as good as the one by all.
    explain: &'a dyn Fn(&[CertificateTerm]) -> Option<Explanation>,
    /// Number of multiplications until now.
    effort: usize,
}

impl Analysis {
    /// Leaves out members of `whole`, the explanation of a vector by `terms`, if the others still explain the vector. Also returns the
    /// number of operations.
    ///
    /// A smaller set is good if its error is within the tolerance or no larger than that of `whole`, and if it `agrees` with the verdict or
    /// `whole` does not. Coefficients that should be zero are at most `rounding`, relative to the sums at their DOFs. Without `search`,
    /// members are not tried one by one.
    pub(super) fn irreducible(
        &self,
        vector: &[(u32, f64)],
        terms: &[CertificateTerm],
        (rounding, search): (f64, bool),
        whole: Explanation,
        agrees: &dyn Fn(&Explanation) -> bool,
    ) -> (Explanation, usize) {
        if self.are_above(vector, terms, rounding * terms.len() as f64) {
            // Each equation of a circle has a DOF of its own, so they are independent.
            let is_circle = rounding == 0.0;
            return if is_circle { (whole, 0) } else { self.judged(vector, whole, 0) };
        }
        let says = |terms: &[CertificateTerm]| self.says_something(vector, &self.sums(vector.iter().copied(), terms));
        let limit = whole.error.max(self.options.tolerance.value());
        let (must_agree, must_say) = (agrees(&whole), says(terms));
        let is_good = |found: &Explanation| found.error <= limit && (agrees(found) || !must_agree);
        let explain = |terms: &[CertificateTerm]| {
            let terms: Vec<_> = terms.iter().copied().filter(|term| term.coefficient != 0.0).collect();
            let says = says(&terms) || !must_say;
            Some(self.with_values(vector, terms, None)).filter(|found| says && is_good(found))
        };
        if terms.len() > MOST || !search {
            let found = explain(&self.pruned(terms, NOISE)).unwrap_or(whole);
            return (Explanation { is_irreducible: false, ..found }, 0);
        }
        let members = Members::new(self, vector, terms.to_vec()).refined();
        LeavingOut { explain: &explain, effort: members.effort() }.run(members, whole)
    }

    /// Whether the sum of an explanation is the vector, but for rounding and the tolerance.
    fn holds(&self, found: &Explanation) -> bool {
        found.error <= self.options.tolerance.value().max(SAME)
    }

    /// Withdraws the claim that `found` is irreducible if its sum is not the vector, or if its members may be dependent. Also returns the
    /// number of operations, added to `effort`.
    fn judged(&self, vector: &[(u32, f64)], found: Explanation, effort: usize) -> (Explanation, usize) {
        let equations = found.members.iter().filter_map(|member| match *member {
            Member::Equation { row, coefficient } => Some(CertificateTerm { row, coefficient }),
            Member::Prescribed { .. } => None,
        });
        let terms: Vec<CertificateTerm> = equations.collect();
        let (holds, are_kept) =
            (self.holds(&found), terms.iter().all(|term| self.kinds[term.row] == Kind::Independent));
        if !holds || are_kept || terms.len() > MOST {
            return (Explanation { is_irreducible: holds && found.is_irreducible, ..found }, effort);
        }
        let is_member = |j: u32| {
            let dof = self.numbering.dofs[j as usize] as usize;
            found.members.iter().any(|member| matches!(*member, Member::Prescribed { dof: other, .. } if other == dof))
        };
        let sums = self.sums(vector.iter().copied(), &terms).into_iter();
        let sizes = sums.filter(|&(j, _)| !is_member(j)).map(|(j, (_, size))| (j, size)).collect();
        let members = Members::over(self, vector, terms, sizes);
        let is_irreducible = found.is_irreducible && members.distance() > NOISE;
        (Explanation { is_irreducible, ..found }, effort + members.effort())
    }

    /// Returns true if each term exceeds the fraction `least` of the sum at each of its free DOFs, and if each prescribed value that is
    /// more than rounding exceeds this fraction of its sum.
    fn are_above(&self, vector: &[(u32, f64)], terms: &[CertificateTerm], least: f64) -> bool {
        let (sums, free) = (self.sums(vector.iter().copied(), terms), self.numbering.free.as_slice());
        let is_large = |part: f64, j: usize| {
            let place = sums.binary_search_by_key(&(j as u32), |sum| sum.0);
            place.is_ok_and(|place| part.abs() > least * sums[place].1.1)
        };
        let is_above = |term: &CertificateTerm| {
            let mut entries = self.local().row(term.row).filter(|&(j, _)| free[j]);
            entries.all(|(j, value)| is_large(term.coefficient * value, j))
        };
        let is_clear = |&(j, (left, size)): &(u32, (f64, f64))| {
            free[j as usize] || left.abs() <= NOISE * size || left.abs() > least * size
        };
        terms.iter().all(is_above) && sums.iter().all(is_clear)
    }
}

impl LeavingOut<'_> {
    /// Leaves out members until all are needed; returns the explanation and the number of operations.
    fn run(mut self, mut members: Members, whole: Explanation) -> (Explanation, usize) {
        let mut best = (self.explain)(&members.terms).unwrap_or(whole);
        let mut needed = HashSet::new();
        while members.analysis.holds(&best)
            && let Some(row) = self.weakest(&members, &needed)
        {
            match self.without(&members, row) {
                Some(fewer) => (best, members) = fewer,
                // A member that a set needs is needed by each smaller set.
                None => _ = needed.insert(row),
            }
        }
        best.is_irreducible = self.effort < MOST_EFFORT;
        members.analysis.judged(members.vector, best, self.effort)
    }

    /// The explanation without a member, and without others if several have to be left out together.
    fn without<'a>(&mut self, members: &Members<'a>, row: usize) -> Option<(Explanation, Members<'a>)> {
        let mut fewer = members.without(row);
        loop {
            self.effort += fewer.effort();
            if let Some(found) = (self.explain)(&fewer.terms) {
                return Some((found, fewer));
            }
            fewer = fewer.without(self.weakest(&fewer, &HashSet::new())?);
        }
    }

    /// [`Members::weakest`], as long as the effort is bounded.
    fn weakest(&self, members: &Members, needed: &HashSet<usize>) -> Option<usize> {
        members.weakest(needed).filter(|_| self.effort < MOST_EFFORT)
    }
}

impl<'a> Members<'a> {
    fn new(analysis: &'a Analysis, vector: &'a [(u32, f64)], mut terms: Vec<CertificateTerm>) -> Self {
        terms.retain(|term| term.coefficient != 0.0);
        let sums = analysis.parts(vector.iter().copied(), &terms).into_iter();
        Self::over(analysis, vector, terms, sums.map(|(j, (_, size))| (j, size)).collect())
    }

    /// Factors the terms at the DOFs of `sizes`.
    fn over(
        analysis: &'a Analysis,
        vector: &'a [(u32, f64)],
        terms: Vec<CertificateTerm>,
        sizes: Vec<(u32, f64)>,
    ) -> Self {
        let factors = vec![1.0; terms.len()];
        let mut members = Self { analysis, vector, terms, sizes, q: Vec::new(), r: Vec::new(), factors };
        for i in 0..members.terms.len() {
            let (mut column, mut factors) = (members.column(members.terms[i]), vec![0.0; i]);
            for _ in 0..PASSES {
                members.project(&mut column, &mut factors);
            }
            let length = dot(&column, &column).sqrt();
            column.iter_mut().filter(|_| length > 0.0).for_each(|value| *value /= length);
            factors.push(length.max(f64::MIN_POSITIVE));
            members.q.push(column);
            members.r.push(factors);
        }
        members
    }

    /// The other members, with the coefficients that leave the smallest remainder.
    fn without(&self, row: usize) -> Self {
        let rest = self.terms.iter().copied().filter(|term| term.row != row).collect();
        Self::new(self.analysis, self.vector, rest).refined()
    }

    /// Replaces the coefficients by those that leave the smallest remainder.
    fn refined(mut self) -> Self {
        let before = self.terms.clone();
        for _ in 0..PASSES {
            let sums = self.sums().zip(&self.sizes);
            let mut left: Vec<f64> = sums.map(|((_, (left, _)), (_, size))| left / size).collect();
            let mut change = vec![0.0; before.len()];
            self.project(&mut left, &mut change);
            self.back_substitute(&mut change);
            for (k, change) in change.into_iter().enumerate() {
                self.factors[k] += change;
                let is_zero = self.factors[k].abs() <= NOISE;
                self.terms[k].coefficient = if is_zero { 0.0 } else { before[k].coefficient * self.factors[k] };
            }
        }
        self
    }

    /// Number of multiplications of the factorization.
    fn effort(&self) -> usize {
        PASSES * self.terms.len() * self.terms.len() * self.sizes.len() + 1
    }

    /// For each free DOF, what remains of the vector after the members are subtracted, and the sum of the magnitudes of the terms.
    fn sums(&self) -> impl Iterator<Item = (u32, (f64, f64))> + use<> {
        self.analysis.parts(self.vector.iter().copied(), &self.terms).into_iter()
    }

    /// The column of M of a member: its term at each free DOF, divided by the sum of the magnitudes of all terms there.
    fn column(&self, term: CertificateTerm) -> Vec<f64> {
        let (system, mut column) = (self.analysis.local(), vec![0.0; self.sizes.len()]);
        for (j, value) in system.row(term.row) {
            if let Ok(k) = self.sizes.binary_search_by_key(&(j as u32), |size| size.0) {
                column[k] = term.coefficient * value / self.sizes[k].1;
            }
        }
        column
    }

    /// Subtracts from a vector its projections on the columns of Q, and adds the factor of each projection to `factors`.
    fn project(&self, vector: &mut [f64], factors: &mut [f64]) {
        for (q, sum) in self.q.iter().zip(factors) {
            let factor = dot(q, vector);
            vector.iter_mut().zip(q).for_each(|(value, q)| *value -= factor * q);
            *sum += factor;
        }
    }

    /// Solves `R x = b` in place. b may be the first numbers of a longer vector whose other numbers are zero.
    fn back_substitute(&self, b: &mut [f64]) {
        for i in (0..b.len()).rev() {
            b[i] /= self.r[i][i];
            let (x, r) = (b[i], &self.r[i]);
            b[..i].iter_mut().zip(r).for_each(|(value, r)| *value -= x * r);
        }
    }

    /// A lower bound, within a factor of the root of the number of members, for the smallest singular value of M with columns of length 1:
    /// `1 / |D R^-1|`, where D has the lengths of the columns. Members that are dependent but for rounding leave rounding.
    fn distance(&self) -> f64 {
        let lengths = self.r.iter().map(|column| dot(column, column));
        1.0 / self.inverse_rows().into_iter().zip(lengths).map(|(row, length)| row * length).sum::<f64>().sqrt()
    }

    /// The squares of the lengths of the rows of `R^-1`.
    fn inverse_rows(&self) -> Vec<f64> {
        let mut squares = vec![0.0; self.terms.len()];
        for k in 0..squares.len() {
            let mut column = vec![0.0; k + 1];
            column[k] = 1.0;
            self.back_substitute(&mut column);
            squares.iter_mut().zip(column).for_each(|(sum, x)| *sum += x * x);
        }
        squares
    }

    /// Among the equations that may not be needed, the one whose absence leaves the smallest remainder. None if the absence of each one
    /// leaves more than the tolerance.
    fn weakest(&self, needed: &HashSet<usize>) -> Option<usize> {
        let squares = self.inverse_rows();
        let limit = self.analysis.options.tolerance.value() * (self.sizes.len() as f64).sqrt();
        let remainder = |k: usize| (self.factors[k].abs() / squares[k].sqrt(), self.terms[k].row);
        let remainders = (0..squares.len()).map(remainder);
        let weak = remainders.filter(|&(remainder, row)| remainder <= limit && !needed.contains(&row));
        weak.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, row)| row)
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
