//! Explains why an equation is dependent or a DOF fixed, by few equations and prescribed values.
//!
//! ```text
//! row_k = sum_i c_i row_i + sum_j d_j e_j      over all DOFs; e_j: the prescribed value of DOF j, as an equation `u_j = value`
//! b_k  ?= sum_i c_i b_i   + sum_j d_j value_j  equal: redundant; not equal: conflicting
//! ```
//!
//! Certificates ([`Analysis::because`]) use kept equations only; they are unique, and can be long. Explanations may use all equations that
//! agree with the kept ones, also redundant ones, and are short if that is cheap:
//!
//! ```text
//! circle         equations with one or two DOFs: the shortest cycle of their graph, by breadth-first search
//! neighbourhood  elimination among nearby equations
//! certificate    if neither finds an irreducible explanation that agrees with the verdict, or if the certificate has fewer members
//! ```
//!
//! Every explanation is *irreducible*, unless it says that this is not known ([`Explanation::is_irreducible`]): its members are independent
//! and no factor is zero or rounding, so no smaller set of its members explains the equation.

mod arithmetic;
mod candidates;
mod change_order;
mod changes;
mod irreducible;
mod neighbourhood;
mod new_values;
mod observations;
mod repair;
mod tie_path;
mod verification;

use std::collections::HashMap;

use crate::common::argument::{ArgumentError, within};
use crate::diagnosis::classify::Dependent;
use crate::factor::backend::BackendError;
use crate::input::incidence::Incidence;
use crate::input::scale::ldexp;
use crate::{Analysis, CertificateTerm, Kind};
use candidates::Candidates;

pub use changes::{Change, Number};
pub use repair::{Freed, Repair};

/// Largest number of equations that are visited in the search for a circle (a cycle of equations with one or two DOFs). Such a search takes
/// a millisecond.
const MOST_VISITED: usize = 1 << 14;

/// A sum that cancels to this fraction of its terms is zero.
const NOISE: f64 = 1e-11;

/// A combination of equations counts as equal to a sum of DOFs if the remainder is at most this fraction of its terms. Rounding leaves
/// less.
const SAME: f64 = 1e-9;

/// An explanation with more members is compared with the certificate, which may be shorter.
const SHORT: usize = 8;

/// A member of an explanation, with its factor.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Member {
    /// `coefficient` times an equation.
    Equation {
        /// The equation, 0-based.
        row: usize,
        /// The factor of the equation.
        coefficient: f64,
    },
    /// `coefficient` times `u_dof = value`.
    Prescribed {
        /// The prescribed DOF, 0-based.
        dof: usize,
        /// The value of the DOF.
        value: f64,
        /// The factor of the equation `u_dof = value`.
        coefficient: f64,
    },
}

impl Member {
    /// The factor of the member.
    pub fn coefficient(self) -> f64 {
        match self {
            Self::Equation { coefficient, .. } | Self::Prescribed { coefficient, .. } => coefficient,
        }
    }
}

/// Equations and prescribed values whose sum is another equation, or the value of a fixed DOF.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Explanation {
    /// Equations, ascending, then prescribed values, ascending. Empty for the equation `0 = b`.
    pub members: Vec<Member>,
    /// The right-hand side of the sum of the members: `sum_i c_i b_i + sum_j d_j value_j`. The explained equation would be redundant with
    /// this right-hand side; a fixed DOF has this value.
    pub right_hand_side: f64,
    /// Largest relative remainder: `max_j |row_kj - sum c_i row_ij| / (|row_kj| + sum |c_i row_ij|)` over the free DOFs.
    pub error: f64,
    /// False if it may be possible to leave out a member: because the explanation was not examined completely, as one with more than 128
    /// equations of which some have small coefficients; because rounding does not tell whether its members are independent; or because
    /// its error is more than rounding and the tolerance.
    pub is_irreducible: bool,
}

impl Explanation {
    /// An irreducible explanation with these members, right-hand side and error.
    pub fn new(members: Vec<Member>, right_hand_side: f64, error: f64) -> Self {
        Self { members, right_hand_side, error, is_irreducible: true }
    }
}

impl Analysis {
    /// Why an equation is dependent, in few members; `None` for an independent one.
    ///
    /// `row_k = sum_i c_i row_i + sum_j d_j e_j` over all DOFs, where `e_j` are prescribed values. The members are irreducible: without any
    /// one of them, the others do not explain the equation. The search is bounded (16,384 visited or 128 eliminated equations); beyond that
    /// the certificate is the explanation, and a long one is not always examined: [`Explanation::is_irreducible`].
    ///
    /// ```
    /// use qless::explanation::Member;
    /// use qless::{Options, SystemBuilder, analyse};
    /// // u0 = u1 = u2, and the ends are prescribed.
    /// let mut builder = SystemBuilder::new(3);
    /// builder.equation([(0, 1.0), (1, -1.0)], 0.0);
    /// builder.equation([(1, 1.0), (2, -1.0)], 0.0);
    /// builder.prescribe(0, 0.5);
    /// builder.prescribe(2, 0.0);
    /// let analysis = analyse(&builder.build()?, &Options::default())?;
    /// let conflict = &analysis.dependent()[0];
    /// let explanation = analysis.explain(conflict.row)?.expect("it is dependent");
    /// assert_eq!(explanation.members.len(), 3);
    /// assert!(explanation.members.contains(&Member::Prescribed { dof: 2, value: 0.0, coefficient: -1.0 }));
    /// assert_eq!(explanation.right_hand_side, 0.5);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`ArgumentError::OutOfRange`].
    pub fn explain(&self, row: usize) -> Result<Option<Explanation>, ArgumentError> {
        within("equation", row, self.kinds.len())?;
        Ok(self.dependent_of(row).map(|dependent| self.explained(dependent, true).0))
    }

    /// Why a DOF s of [`Analysis::generated`] is fixed: its unit vector `e_s = sum_i c_i row_i + sum_j d_j e_j`, where `e_j` are prescribed
    /// values; `None` for any other DOF.
    ///
    /// # Errors
    /// [`BackendError`] if the block of the DOF cannot be factored again.
    pub fn explain_fixed(&self, dof: usize) -> Result<Option<Explanation>, BackendError> {
        let Ok(place) = self.generated.binary_search_by_key(&dof, |&(j, _)| j) else { return Ok(None) };
        self.combination(&[(self.fixed[place], 1.0)], Some(self.generated[place].1)).map(Some)
    }

    /// Why the equations fix a sum `sum a_j u_j` to a value, which is [`Explanation::right_hand_side`]; `None` if they do not.
    ///
    /// ```
    /// use qless::{Options, SystemBuilder, analyse};
    /// // u0 = u1 + 1 and u1 = u2 + 2 give u0 - u2 = 3.
    /// let mut builder = SystemBuilder::new(4);
    /// builder.equation([(0, 1.0), (1, -1.0)], 1.0);
    /// builder.equation([(1, 1.0), (2, -1.0)], 2.0);
    /// let analysis = analyse(&builder.build()?, &Options::default())?;
    /// assert_eq!(analysis.explain_sum(&[(0, 1.0), (2, -1.0)])?.expect("it follows").right_hand_side, 3.0);
    /// assert!(analysis.explain_sum(&[(0, 1.0)])?.is_none() && analysis.explain_sum(&[(3, 1.0)])?.is_none());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`BackendError`] if a block cannot be factored again.
    pub fn explain_sum(&self, sum: &[(usize, f64)]) -> Result<Option<Explanation>, BackendError> {
        let local: HashMap<u32, u32> = self.numbering.dofs.iter().copied().zip(0..).collect();
        let Some(vector) = sum.iter().map(|&(j, a)| Some((*local.get(&u32::try_from(j).ok()?)?, a))).collect() else {
            return Ok(None);
        };
        let vector: Vec<(u32, f64)> = vector;
        let found = self.combination(&vector, None)?;
        Ok((found.error <= SAME).then_some(found))
    }

    /// Expresses a vector by few equations if they are found and agree with its `value`, else by kept equations.
    fn combination(&self, vector: &[(u32, f64)], value: Option<f64>) -> Result<Explanation, BackendError> {
        let agrees =
            |found: &Explanation, value: f64| (found.right_hand_side - value).abs() <= self.side_error(found, value);
        let explain = |terms: Vec<CertificateTerm>, rounding: f64| {
            let whole = self.with_values(vector, terms.clone(), None);
            let value = value.unwrap_or(whole.right_hand_side);
            self.irreducible(vector, &terms, (rounding, true), whole, &|found| agrees(found, value)).0
        };
        let short = self.short(None, vector).0.map(|(terms, rounding)| explain(terms, rounding));
        let is_good = |found: &Explanation| found.is_irreducible && value.is_none_or(|value| agrees(found, value));
        if let Some(short) = short.filter(is_good) {
            return Ok(short);
        }
        let is_free = self.numbering.free.as_slice();
        let free = vector.iter().copied().filter(|&(j, _)| is_free[j as usize]);
        let terms = self.expressed(free)?;
        let rounding = self.rounding(&terms);
        Ok(explain(terms, rounding))
    }

    /// The explanation of a dependent equation and its cost in operations. Without `search`, the explanation is the certificate.
    pub(crate) fn explained(&self, dependent: &Dependent, search: bool) -> (Explanation, usize) {
        let vector: Vec<(u32, f64)> = self.local().row(dependent.row).map(|(j, value)| (j as u32, value)).collect();
        let (short, mut effort) = if search { self.short(Some(dependent.row), &vector) } else { (None, 0) };
        let agrees = |found: &Explanation| self.is_of(dependent, found);
        let mut explain = |terms: Vec<CertificateTerm>, rounding: f64, error: Option<f64>| {
            let whole = self.with_values(&vector, terms.clone(), error);
            let (found, more) = self.irreducible(&vector, &terms, (rounding, search), whole, &agrees);
            effort += more;
            found
        };
        let short = short.map(|(terms, rounding)| explain(terms, rounding, None)).filter(agrees);
        let is_short = |short: &Explanation| short.is_irreducible && short.members.len() <= SHORT;
        let certificate = (!short.as_ref().is_some_and(is_short)).then(|| {
            let (terms, error) = self.checked(dependent);
            let rounding = self.rounding(&terms);
            explain(terms, rounding, Some(error))
        });
        let order = |found: &Explanation| (!found.is_irreducible, found.members.len());
        let shortest = short.into_iter().chain(certificate).min_by_key(order);
        (shortest.expect("one of both"), effort)
    }

    /// Searches for few equations whose combination is the vector. Returns the terms, if they are found within the bounds, with a bound for
    /// coefficients that should be zero. Also returns the number of operations.
    fn short(&self, row: Option<usize>, vector: &[(u32, f64)]) -> (Option<(Vec<CertificateTerm>, f64)>, usize) {
        let system = self.local();
        let incidence = self.incidence.get_or_init(|| Incidence::new(system));
        let candidates = Candidates { system, incidence, kinds: &self.kinds, scaling: &self.scaling, row };
        let tolerance = self.options.tolerance.value();
        let is_good = |terms: &Vec<CertificateTerm>| {
            let sums = self.sums(vector.iter().copied(), terms);
            self.error_in(&sums) <= tolerance && self.says_something(vector, &sums)
        };
        let ends: Vec<u32> = vector.iter().map(|&(j, _)| j).collect();
        let (circle, visited) = tie_path::shortest_circle(&candidates, &ends, MOST_VISITED);
        let circle = circle.map(|circle| terms(tie_path::factors(&candidates, vector, &circle)));
        if let Some(circle) = circle.filter(is_good) {
            // Each equation of a path eliminates one DOF with a nonzero factor, so no coefficient should be zero.
            return (Some((circle, 0.0)), visited);
        }
        let free: Vec<(u32, f64)> = vector.iter().copied().filter(|&(j, _)| system.free()[j as usize]).collect();
        let (near, effort) = neighbourhood::near(&candidates, &free, tolerance);
        // Pivots are above the tolerance of their sums, so they enlarge rounding by a factor below `1 / tolerance`.
        let rounding = f64::EPSILON / tolerance;
        // Terms that exceed the vector by a factor of `1 / tolerance` can match any vector to within the tolerance, so they explain
        // nothing.
        let largest =
            free.iter().map(|&(j, value)| ldexp(value.abs(), self.scaling.col(j as usize))).fold(0.0, f64::max);
        let size = |term: &CertificateTerm| ldexp(term.coefficient.abs(), -self.scaling.row[term.row]);
        let is_bounded = |terms: &Vec<CertificateTerm>| terms.iter().all(|term| tolerance * size(term) < largest);
        let near = near.map(terms).filter(is_good).filter(is_bounded);
        (near.map(|near| (near, rounding)), visited + effort)
    }

    /// Returns false if the remainder is more than half as large as the vector, in scaled columns: sums that are far larger hide it.
    fn says_something(&self, vector: &[(u32, f64)], sums: &[(u32, (f64, f64))]) -> bool {
        let size = |(j, value): (u32, f64)| {
            if self.numbering.free[j as usize] { ldexp(value.abs(), self.scaling.col(j as usize)) } else { 0.0 }
        };
        let largest = vector.iter().map(|&term| size(term)).fold(0.0, f64::max);
        sums.iter().all(|&(j, (left, _))| size((j, left)) <= largest / 2.0)
    }

    /// Bound below which a coefficient may stand for zero: the tolerance divided by the distance of the component from dependence. If an
    /// equation with a larger coefficient is left out, more than the tolerance remains. The distance is an estimate within a factor of the
    /// number of equations.
    fn rounding(&self, terms: &[CertificateTerm]) -> f64 {
        self.options.tolerance.value() / terms.first().map_or(1.0, |term| self.distance_near(term.row))
    }

    /// Returns true if the right-hand side of an explanation agrees with the verdict of the certificate. Differences come from equations
    /// that agree only to the tolerance.
    fn is_of(&self, dependent: &Dependent, explanation: &Explanation) -> bool {
        let b = self.system.rhs()[dependent.row];
        let mismatch = b - explanation.right_hand_side;
        let agrees = (mismatch - dependent.mismatch).abs() <= self.side_error(explanation, b);
        match dependent.kind {
            Kind::Redundant => agrees || mismatch.abs() <= dependent.mismatch.abs(),
            _ => agrees && mismatch.abs() >= dependent.mismatch.abs() / 2.0,
        }
    }

    /// The right-hand side of an explanation may differ from the true one, b, by this much, because equations agree only to the tolerance.
    fn side_error(&self, explanation: &Explanation, b: f64) -> f64 {
        let size = explanation.members.iter().map(|&member| self.part(member).abs()).fold(b.abs(), f64::max);
        10.0 * self.options.tolerance.value() * size
    }

    /// The contribution of a member to the right-hand side.
    fn part(&self, member: Member) -> f64 {
        match member {
            Member::Equation { row, coefficient } => coefficient * self.system.rhs()[row],
            Member::Prescribed { value, coefficient, .. } => coefficient * value,
        }
    }

    /// The explanation by these equations and by the prescribed values in their remainder. The error is computed unless it is given.
    fn with_values(&self, vector: &[(u32, f64)], terms: Vec<CertificateTerm>, error: Option<f64>) -> Explanation {
        let sums = self.sums(vector.iter().copied(), &terms);
        let is_value =
            |&(j, (left, size)): &(u32, (f64, f64))| !self.numbering.free[j as usize] && left.abs() > NOISE * size;
        let value = |(j, (left, _)): (u32, (f64, f64))| (self.numbering.dofs[j as usize] as usize, left);
        let error = error.unwrap_or_else(|| self.error_in(&sums));
        let mut values: Vec<(usize, f64)> = sums.into_iter().filter(is_value).map(value).collect();
        values.sort_unstable_by_key(|&(dof, _)| dof);
        let equation = |term: CertificateTerm| Member::Equation { row: term.row, coefficient: term.coefficient };
        let value = |(dof, coefficient)| Member::Prescribed {
            dof,
            value: self.system.prescribed_value(dof).unwrap_or_default(),
            coefficient,
        };
        let members: Vec<Member> = terms.into_iter().map(equation).chain(values.into_iter().map(value)).collect();
        let right_hand_side = members.iter().map(|&member| self.part(member)).sum();
        Explanation::new(members, right_hand_side, error)
    }
}

/// Certificate terms, ascending by row, without zeros.
fn terms(factors: Vec<(u32, f64)>) -> Vec<CertificateTerm> {
    let term = |(row, coefficient)| CertificateTerm { row: row as usize, coefficient };
    let mut terms: Vec<CertificateTerm> = factors.into_iter().filter(|&(_, factor)| factor != 0.0).map(term).collect();
    terms.sort_unstable_by_key(|term| term.row);
    terms
}
