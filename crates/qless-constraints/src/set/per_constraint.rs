//! Numbers that are stored by constraint, so that they stay with their constraints when rows are renumbered.
//!
//! Rows are numbered anew when constraints are added, removed, activated or deactivated. A multiplier that is stored by row would then
//! belong to another constraint.

use qless::ArgumentError;
use qless::common::Identity;

use crate::scalar::Bounded;
use crate::set::ConstraintSet;
use crate::set::error::{EditError, TimeError};
use crate::set::evaluation::Evaluation;
use crate::set::register::ConstraintId;

/// One number for each equation of a set, such as multipliers, stored by constraint.
///
/// ```
/// use qless_constraints::{ConstraintSet, types::Prescribed};
/// let mut builder = ConstraintSet::builder(2);
/// let [first, second] = [0, 1].map(|dof| builder.add("support", Prescribed::fixed([dof])).expect("valid"));
/// let mut set = builder.build()?;
/// let multipliers = set.by_constraint(&[3.0, 4.0])?;
/// set.deactivate(first)?;
/// // Row 0 belongs to the second constraint now, and so does its multiplier.
/// assert_eq!((multipliers.of(second), multipliers.in_rows(&set)?), ([4.0].as_slice(), vec![4.0]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PerConstraint {
    set: Identity,
    /// The constraint of each value, ascending.
    constraints: Vec<u32>,
    values: Vec<f64>,
}

impl PerConstraint {
    /// The numbers of a constraint, in the order of its equations; empty if it had none, or belongs to another set.
    pub fn of(&self, constraint: ConstraintId) -> &[f64] {
        if constraint.set == self.set { self.of_number(constraint.number) } else { &[] }
    }

    fn of_number(&self, number: u32) -> &[f64] {
        let first = self.constraints.partition_point(|&other| other < number);
        let count = self.constraints[first..].partition_point(|&other| other == number);
        &self.values[first..first + count]
    }

    /// The numbers in the rows that the set has now. A constraint gets zeros if it has no numbers here, or if its number of equations has
    /// changed.
    ///
    /// # Errors
    /// [`ArgumentError::Foreign`] if the numbers are those of another set.
    pub fn in_rows(&self, set: &ConstraintSet) -> Result<Vec<f64>, ArgumentError> {
        let mut rows = vec![0.0; set.equations()];
        if self.values.is_empty() {
            return Ok(rows);
        }
        set.own("the list by constraint", self.set)?;
        let owned = set.owned_rows();
        for same in owned.chunk_by(|a, b| a.0 == b.0) {
            let own = self.of_number(same[0].0);
            if own.len() == same.len() {
                same.iter().zip(own).for_each(|(&(_, row), &value)| rows[row] = value);
            }
        }
        Ok(rows)
    }
}

impl ConstraintSet {
    /// Assigns one number for each row to the constraints of the rows.
    ///
    /// # Errors
    /// [`ArgumentError::WrongLength`] unless there is one number for each equation.
    pub fn by_constraint(&self, rows: &[f64]) -> Result<PerConstraint, ArgumentError> {
        super::long("the list of numbers", rows.len(), self.equations())?;
        let owned = self.owned_rows();
        let (constraints, values) = owned.into_iter().map(|(number, row)| (number, rows[row])).unzip();
        Ok(PerConstraint { set: self.register.identity, constraints, values })
    }

    /// `(constraint, row)` of all rows, sorted by constraint.
    fn owned_rows(&self) -> Vec<(u32, usize)> {
        let mut all: Vec<_> = self.keys().into_iter().zip(0..).map(|((number, ..), row)| (number, row)).collect();
        all.sort_by_key(|&(number, _)| number);
        all
    }

    /// `c(u)` of a constraint at the configuration of the evaluation, in the order of its equations. An inactive constraint has values too,
    /// such as the gap of an open contact.
    ///
    /// ```
    /// use qless_constraints::{ConstraintSet, types::LinearEquation};
    /// let mut builder = ConstraintSet::builder(1);
    /// let gap = builder.add("gap", LinearEquation { terms: vec![(0, 1.0)], rhs: -2.0 })?;
    /// let mut set = builder.build()?;
    /// set.deactivate(gap)?;
    /// let mut evaluation = set.allocate();
    /// set.evaluate(&[-0.5], &mut evaluation)?;
    /// assert_eq!((evaluation.c().len(), set.values_of(gap, &evaluation)?), (0, vec![1.5]));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`EditError`]: the constraint or the evaluation belongs to another set, or is out of date, or a function of time of an inactive
    /// constraint is not finite at the time of the set.
    pub fn values_of(&self, constraint: ConstraintId, evaluation: &Evaluation) -> Result<Vec<f64>, EditError> {
        self.current(evaluation)?;
        if let Some(resting) = self.resting_values(constraint, evaluation)? {
            return Ok(resting.into_iter().map(|value| value.real).collect());
        }
        Ok(self.rows_of(constraint)?.into_iter().map(|row| evaluation.c[row]).collect())
    }

    /// c of an inactive constraint with bounds on its rounding; `None` if it is active.
    pub(super) fn resting_values(
        &self,
        constraint: ConstraintId,
        evaluation: &Evaluation,
    ) -> Result<Option<Vec<Bounded>>, EditError> {
        let number = self.register.number(constraint)?;
        let Some(contents) = self.register.inactive.get(&number) else { return Ok(None) };
        if let Some(value) = contents.not_finite {
            let label = self.register.name(number).to_owned();
            return Err(TimeError::NotFinite { label, time: self.time, value }.into());
        }
        Ok(Some(contents.values(&evaluation.u, self.time)))
    }
}
