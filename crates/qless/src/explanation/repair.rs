//! Few right-hand sides and prescribed values whose change cures all conflicts.
//!
//! ```text
//! m_k = b_k - sum_i c_ki b_i - sum_j d_kj value_j      mismatch of equation k over kept equations i and prescribed DOFs j
//! a_kw                                                 change of m_k for a unit change of number w, a right-hand side or prescribed value
//! changes x of these numbers cure the conflicts if m_k + sum_w a_kw x_w = 0 for conflicting equations, and
//!                                               sum_w a_kw x_w = 0       for redundant ones
//! ```
//!
//! A random sum represents the redundant equations: a number that its certificate does not contain is in none of their certificates, with
//! probability 1. Removing an equation has the same effect as another right-hand side of it. Conflicts without a common number are cured
//! separately.
//!
//! Certificates decide which changes are candidates. A candidate becomes a repair if the analysis of the changed system agrees.

use std::collections::{BTreeMap, BTreeSet, HashSet};

use super::change_order::Plausibility;
use super::changes::{Change, Number};
use super::new_values::{MismatchSum, new_values};
use super::observations::Observations;
use super::verification::Verification;
use super::{Explanation, Member};
use crate::common::SplitMix64;
use crate::factor::backend::BackendError;
use crate::input::scale::ldexp;
use crate::{Analysis, CertificateTerm, Dependent, Kind};

/// Largest number of conflicts that are examined one by one. Beyond it only random sums of all conflicts are examined. They reveal single
/// changes that cure all conflicts, but no sets of changes.
const MOST_CONFLICTS: usize = 64;
/// Number of random sums that replace many conflicts. A single change that does not cure all conflicts cures both sums with probability 0.
const SUMS: usize = 2;
/// Largest number of conflicts for which pairs of changes are searched completely.
const HANDFUL: usize = 8;
/// Largest number of ways (lists of changes that cure the conflicts) that a repair lists; other ways are only counted.
const MOST_WAYS: usize = 16;
/// As long as no way holds, at least this many ways are tried, even if the budget of the verification is used up.
const TRIED: usize = 4;
/// Largest number of rounds of changes. A round uncovers wrong numbers that are smaller than those of the round before by a factor of the
/// tolerance, 1e-10. Doubles have 16 digits, so few rounds are enough.
const ROUNDS: usize = 4;
/// A coefficient below this fraction of the largest one of a certificate or a random sum counts as zero. Either its terms cancel, or only a
/// change that is larger than all other numbers would cure the conflict.
const NOISE: f64 = 1e-9;

/// A function that finds ways; a way lists numbers and how much each changes.
type Search<'a> = &'a dyn Fn() -> Vec<Vec<(Number, f64)>>;

/// An equation or DOF that could be freed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Freed {
    /// A dependent equation, 0-based, that could become independent.
    Equation(usize),
    /// A fixed DOF, 0-based, that could become free.
    Dof(usize),
}

/// Ways to cure conflicts that have numbers in common.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Repair {
    /// The conflicting equations, ascending.
    pub conflicts: Vec<usize>,
    /// Ways to cure all these conflicts together, the most plausible way first; all ways have the same number of changes. At most 16. Each
    /// way was verified: in the analysis of the changed system, none of `conflicts` conflicts, and no other equation has become
    /// conflicting.
    ///
    /// Fewer if an analysis takes long. Empty if no way was found that holds, or if more than 64 conflicts have no single change that cures
    /// them.
    pub ways: Vec<Vec<Change>>,
    /// Number of ways to cure the conflicts with as few changes as each listed way has: the listed ways, and further ones that were not
    /// verified.
    pub count: usize,
}

impl Analysis {
    /// How to cure the conflicts: few right-hand sides and prescribed values, with their new values.
    ///
    /// Single changes and, for up to 8 conflicts with at most 300 numbers, pairs of changes are searched completely. If more changes are
    /// needed, they are chosen one by one, always the one that cures the largest number of conflicts. Each way is verified: the changed
    /// system is analysed, and the conflicts are gone, and no other equation has become conflicting. Among ways with equally many changes,
    /// those come first that replace a rare number by a common one, or by one with fewer digits.
    ///
    /// ```
    /// use qless::explanation::Number;
    /// use qless::{Options, SystemBuilder, analyse};
    /// // u1 - u0 = 0.01 in three ways; the second right-hand side is wrong, in two equations that follow from others.
    /// let mut builder = SystemBuilder::new(2);
    /// for b in [0.01, 0.1, 0.01, 0.01] {
    ///     builder.equation([(1, 1.0), (0, -1.0)], b);
    /// }
    /// let analysis = analyse(&builder.build()?, &Options::default())?;
    /// let repair = &analysis.repairs()?[0];
    /// let change = repair.ways[0][0];
    /// assert_eq!((change.number, change.from, change.to), (Number::RightHandSide(1), 0.1, 0.01));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`BackendError`] if a block cannot be factored again.
    pub fn repairs(&self) -> Result<Vec<Repair>, BackendError> {
        let conflicts: Vec<&Dependent> = self.dependent.iter().filter(|d| d.kind == Kind::Conflicting).collect();
        if conflicts.is_empty() {
            return Ok(Vec::new());
        }
        let in_redundant = self.numbers_of(|d| d.kind == Kind::Redundant)?;
        let (plausibility, verification) = (Plausibility::new(&self.system), Verification::new(self));
        if conflicts.len() > MOST_CONFLICTS {
            let mut observed = self.observe_sums(&conflicts)?;
            observed.effects.retain(|number, _| !in_redundant.contains(number));
            let rows = conflicts.iter().map(|d| d.row).collect();
            return Ok(vec![self.repair(rows, &observed, &plausibility, &verification)]);
        }
        let mut observed = self.observe(&conflicts);
        observed.effects.retain(|number, _| !in_redundant.contains(number));
        let groups = observed.groups();
        let of_group = |group: Vec<usize>| {
            let rows = group.iter().map(|&o| conflicts[o].row).collect();
            self.repair(rows, &observed.only(&group), &plausibility, &verification)
        };
        Ok(groups.into_iter().map(of_group).collect())
    }

    /// The mismatch of each conflict with all numbers that affect it.
    fn observe(&self, conflicts: &[&Dependent]) -> Observations {
        let mut observed = Observations::default();
        for dependent in conflicts {
            let mut members = self.explained(dependent, false).0.members;
            members.push(Member::Equation { row: dependent.row, coefficient: -1.0 });
            let major = self.major(&members);
            observed.add(MismatchSum::new(0.0, self.terms(&members)), |number| major.contains(number));
        }
        observed
    }

    /// The numbers that may be changed: right-hand sides of the equations whose coefficients are more than noise beside the largest, and
    /// the prescribed DOFs in these equations.
    fn major(&self, members: &[Member]) -> HashSet<Number> {
        let equations = || {
            members.iter().filter_map(|member| match *member {
                Member::Equation { row, coefficient } => Some((row, ldexp(coefficient.abs(), -self.scaling.row[row]))),
                Member::Prescribed { .. } => None,
            })
        };
        let least = NOISE * equations().map(|(_, size)| size).fold(0.0, f64::max);
        let major = equations().filter(|&(_, size)| size >= least).map(|(row, _)| row);
        let numbers = |row: usize| {
            let dofs = self.system.matrix().row(row).map(|(dof, _)| Number::Prescribed(dof));
            dofs.chain([Number::RightHandSide(row)])
        };
        major.flat_map(numbers).collect()
    }

    /// The terms of `-sum c_i b_i - sum d_j value_j`, as (number, effect, present value). The effect is minus the coefficient of the
    /// member.
    fn terms(&self, members: &[Member]) -> impl Iterator<Item = (Number, f64, f64)> {
        members.iter().map(|&member| {
            let number = Number::from(member);
            (number, -member.coefficient(), self.value(number))
        })
    }

    /// The mismatches of random sums of the conflicts, with the numbers that affect them.
    fn observe_sums(&self, conflicts: &[&Dependent]) -> Result<Observations, BackendError> {
        let mut observed = Observations::default();
        for sum in 0..SUMS {
            let (explanation, b) = self.random_sum(conflicts, sum as u64)?;
            observed.add(MismatchSum::new(b, self.terms(&explanation.members)), |_| true);
        }
        Ok(observed)
    }

    /// The numbers that explain the selected dependent equations, except their own right-hand sides.
    fn numbers_of(&self, wanted: impl Fn(&Dependent) -> bool) -> Result<BTreeSet<Number>, BackendError> {
        let some: Vec<&Dependent> = self.dependent.iter().filter(|d| wanted(d)).collect();
        if some.is_empty() {
            return Ok(BTreeSet::new());
        }
        let (explanation, _) = self.random_sum(&some, SUMS as u64)?;
        Ok(explanation.members.iter().map(|&member| member.into()).collect())
    }

    /// Numbers whose removal alone makes a dependent equation independent, or frees a fixed DOF: the members of its certificate that no
    /// other dependent equation can replace. These are kept equations and prescribed values, never redundant equations.
    ///
    /// ```
    /// use qless::explanation::{Freed, Number};
    /// use qless::{Options, SystemBuilder, analyse};
    /// let mut builder = SystemBuilder::new(3);
    /// for (a, b) in [(0, 1), (1, 2), (0, 2), (0, 1)] {
    ///     builder.equation([(a, 1.0), (b, -1.0)], 0.0);
    /// }
    /// let analysis = analyse(&builder.build()?, &Options::default())?;
    /// // Row 2 follows from rows 0 and 1, but row 3 stands for row 0.
    /// let rows: Vec<usize> = analysis.dependent().iter().map(|found| found.row).collect();
    /// for row in rows {
    ///     assert!(analysis.what_frees(Freed::Equation(row))?.len() <= 1);
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`BackendError`] if a block cannot be factored again.
    pub fn what_frees(&self, freed: Freed) -> Result<Vec<Number>, BackendError> {
        let (explanation, row) = match freed {
            Freed::Equation(row) => (self.dependent_of(row).map(|found| self.explained(found, false).0), Some(row)),
            Freed::Dof(dof) => match self.generated.binary_search_by_key(&dof, |&(j, _)| j) {
                Ok(place) => {
                    let vector = [(self.fixed[place], 1.0)];
                    let terms = self.significant(&vector, self.expressed(vector)?);
                    (Some(self.with_values(&vector, terms, Some(0.0))), None)
                }
                Err(_) => (None, None),
            },
        };
        let Some(explanation) = explanation else { return Ok(Vec::new()) };
        let others = self.numbers_of(|d| Some(d.row) != row)?;
        Ok(explanation.members.into_iter().map(Number::from).filter(|number| !others.contains(number)).collect())
    }

    /// A random sum of dependent equations over kept ones and prescribed values, and its right-hand side.
    fn random_sum(&self, dependent: &[&Dependent], seed: u64) -> Result<(Explanation, f64), BackendError> {
        let system = self.local();
        let mut random = SplitMix64::new(seed);
        let mut sum: BTreeMap<u32, f64> = BTreeMap::new();
        let mut b = 0.0;
        for d in dependent {
            // The weight is between 1 and 2 in the units of scaled equations, so that no equation hides another.
            let weight = 1.0 + (random.next() >> 11) as f64 / (1_u64 << 53) as f64;
            let weight = ldexp(weight, self.scaling.row[d.row]);
            system.row(d.row).for_each(|(j, value)| *sum.entry(j as u32).or_default() += weight * value);
            b += weight * self.system.rhs()[d.row];
        }
        let vector: Vec<(u32, f64)> = sum.into_iter().collect();
        let free = vector.iter().copied().filter(|&(j, _)| system.free()[j as usize]);
        let terms = self.significant(&vector, self.expressed(free)?);
        Ok((self.with_values(&vector, terms, Some(0.0)), b))
    }

    /// The terms of a certificate of `vector` without those that count as zero. If units differ, a small coefficient may be needed: without
    /// it, more than the tolerance remains at some DOF. Then only smaller ones are left out.
    fn significant(&self, vector: &[(u32, f64)], terms: Vec<CertificateTerm>) -> Vec<CertificateTerm> {
        let error = |terms: &[CertificateTerm]| self.error_in(&self.sums(vector.iter().copied(), terms));
        let limit = error(&terms).max(self.options.tolerance.value());
        let mut pruned = [1.0, 1e-2, 1e-4].iter().map(|part| self.pruned(&terms, NOISE * part));
        pruned.find(|pruned| error(pruned) <= limit).unwrap_or(terms)
    }

    /// The repair of some conflicts: among the ways that hold, those with the fewest changes.
    fn repair(
        &self,
        conflicts: Vec<usize>,
        observed: &Observations,
        plausibility: &Plausibility,
        verification: &Verification,
    ) -> Repair {
        let is_handful = conflicts.len() <= HANDFUL;
        let is_each = observed.mismatches.len() == conflicts.len();
        let searches: [Search; 3] =
            [&|| observed.singles(), &|| if is_handful { observed.pairs() } else { Vec::new() }, &|| {
                if is_each { vec![observed.greedy()] } else { Vec::new() }
            }];
        for search in searches {
            let mut found: Vec<Vec<Change>> = search().iter().map(|way| self.changes(observed, way)).collect();
            found.sort_by_cached_key(|way| plausibility.key(way));
            let (mut ways, mut tried) = (Vec::new(), 0);
            let is_over = |tried: usize, none: bool| verification.is_over() && !(none && tried < TRIED);
            while tried < found.len() && ways.len() < MOST_WAYS && !is_over(tried, ways.is_empty()) {
                if verification.holds(&conflicts, &found[tried]) {
                    ways.push(found[tried].clone());
                }
                tried += 1;
            }
            if !ways.is_empty() {
                let count = ways.len() + found.len() - tried;
                return Repair { conflicts, ways, count };
            }
        }
        let ways: Vec<Vec<Change>> =
            if is_each { self.repeated(&conflicts, observed, verification).into_iter().collect() } else { Vec::new() };
        Repair { conflicts, count: ways.len(), ways }
    }

    /// Cures conflicts in rounds. A large wrong number hides smaller ones, whose conflicts appear only after the large number is changed.
    fn repeated(
        &self,
        conflicts: &[usize],
        observed: &Observations,
        verification: &Verification,
    ) -> Option<Vec<Change>> {
        let mut way = self.changes(observed, &observed.greedy());
        for _ in 0..ROUNDS {
            if verification.is_over() {
                return None;
            }
            let changed = verification.changed(conflicts, &way)?;
            if changed.wrong.is_empty() {
                return Some(way);
            }
            let more = changed.analysis.greedy_changes(&changed.wrong).ok()?;
            let is_changed_again = |old: &Change| more.iter().any(|new| new.number == old.number);
            way.retain(|old| !is_changed_again(old));
            way.extend(more.into_iter().map(|new| Change { from: self.value(new.number), ..new }));
            way.retain(|change| change.to != change.from);
            way.sort_unstable_by_key(|change| change.number);
        }
        None
    }

    /// Changes that cure some conflicts, chosen one by one.
    fn greedy_changes(&self, rows: &[usize]) -> Result<Vec<Change>, BackendError> {
        let conflicts: Vec<&Dependent> = rows.iter().filter_map(|&row| self.dependent_of(row)).collect();
        let in_redundant = self.numbers_of(|d| d.kind == Kind::Redundant)?;
        let mut observed = self.observe(&conflicts);
        observed.effects.retain(|number, _| !in_redundant.contains(number));
        Ok(self.changes(&observed, &observed.greedy()))
    }

    fn changes(&self, observed: &Observations, way: &[(Number, f64)]) -> Vec<Change> {
        let values = new_values(&observed.sums, way, self.options.tolerance.value());
        values.into_iter().map(|(number, to)| Change { number, from: self.value(number), to }).collect()
    }

    /// The present value of a number.
    fn value(&self, number: Number) -> f64 {
        match number {
            Number::RightHandSide(row) => self.system.rhs()[row],
            Number::Prescribed(dof) => self.system.prescribed_value(dof).unwrap_or_default(),
        }
    }
}
