//! Inequalities `c(u) >= 0` by an active set: `c >= 0`, `p >= 0`, `p c = 0`, where `p = -lambda` is the pressure.
//!
//! An inequality is a constraint of one equation. Inactive, it has no force; active, it holds c = 0. A step activates inactive inequalities
//! with c < 0, and deactivates active ones that pull (p < 0). If an active set recurs, each later step changes only the first violated
//! inequality. Such steps end for every positive definite problem (Murty 1974). If an active set recurs even then, the step fails, so no
//! cycle of active sets goes on for ever.

use std::collections::HashSet;

use qless::ArgumentError;

use crate::constraint::{Constraint, EquationError};
use crate::set::ConstraintSet;
use crate::set::error::{AddError, EditError};
use crate::set::evaluation::Evaluation;
use crate::set::per_constraint::PerConstraint;
use crate::set::register::ConstraintId;

/// Inequalities of a set.
///
/// ```
/// use qless_constraints::{ConstraintSet, Inequalities, types::LinearEquation};
/// // A weight f on a spring of stiffness 2, above a floor at -1: u >= -1.
/// let mut set = ConstraintSet::builder(1).build()?;
/// let mut floor = Inequalities::default();
/// let gap = floor.add(&mut set, "floor", LinearEquation { terms: vec![(0, 1.0)], rhs: -1.0 })?;
/// for (f, expected) in [(-1.0, -0.5), (-3.0, -1.0), (-1.0, -0.5)] {
///     let (u, multipliers) = floor.solve(&mut set, |set| {
///         // The floor holds u, or there is only the spring.
///         let u = if set.equations() == 1 { -1.0 } else { f / 2.0 };
///         let lambda = vec![f - 2.0 * u; set.equations()];
///         Ok::<_, Box<dyn std::error::Error>>((vec![u], set.by_constraint(&lambda)?))
///     })?;
///     assert_eq!(u, [expected]);
///     assert_eq!(multipliers.of(gap).first(), (f == -3.0).then_some(&-1.0));
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct Inequalities {
    ids: Vec<ConstraintId>,
    /// The active sets that occurred since the last solution.
    met: HashSet<Vec<bool>>,
    one_by_one: bool,
}

/// Why an active set could not be found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InequalityError {
    /// A constraint belongs to another set or was removed, or one of its functions of time is not finite.
    #[error(transparent)]
    Edit(#[from] EditError),
    /// The evaluation or the multipliers are out of date, or of another set.
    #[error(transparent)]
    Argument(#[from] ArgumentError),
    /// An active set recurs although only one inequality changes at a time.
    #[error(
        "the active set returns: neither open nor closed {} is a solution; the problem is not positive definite, or its equilibria are not \
         accurate enough", .labels.join(", ")
    )]
    Cycle {
        /// Labels of the inequalities that are violated.
        labels: Vec<String>,
    },
}

impl Inequalities {
    /// Adds `c >= 0` to the set as an inactive constraint. The constraint must have one equation; its force on the model is `p dc/du` with
    /// the pressure p.
    ///
    /// # Errors
    /// [`AddError`]; nothing is added then.
    pub fn add<C: Constraint>(
        &mut self,
        set: &mut ConstraintSet,
        label: impl Into<String>,
        constraint: C,
    ) -> Result<ConstraintId, AddError<C::Error>> {
        let label = label.into();
        let id = set.add(label.clone(), constraint)?;
        let found = set.rows_of(id).map_or(0, |rows| rows.len());
        let sound = "the constraint was just added";
        if found != 1 {
            set.remove(id).expect(sound);
            let source = EquationError::NotOne { found };
            return Err(AddError::Equation { name: C::NAME, label, source });
        }
        set.deactivate(id).expect(sound);
        self.ids.push(id);
        Ok(id)
    }

    /// The inequalities, in the order in which they were added.
    pub fn ids(&self) -> &[ConstraintId] {
        &self.ids
    }

    /// Checks all inequalities at an equilibrium. Returns true if none is violated: then the equilibrium is the solution. Otherwise
    /// activates the violated inactive inequalities, and deactivates the violated active ones. Once an active set has recurred, each step
    /// changes only the first violated inequality, until the solution is found.
    ///
    /// `evaluation` is the evaluation of the set at the equilibrium, and `multipliers` are the lambda of `f_int + G^T lambda = f_ext`. An
    /// inactive inequality is violated if c is negative by more than its rounding error, and an active one if its lambda is positive, so
    /// that it pulls.
    ///
    /// # Errors
    /// [`InequalityError`].
    pub fn step(
        &mut self,
        set: &mut ConstraintSet,
        evaluation: &Evaluation,
        multipliers: &PerConstraint,
    ) -> Result<bool, InequalityError> {
        set.current(evaluation)?;
        let mut violated = Vec::new();
        for &id in &self.ids {
            let wrong = match (set.resting_values(id, evaluation)?, multipliers.of(id)) {
                (Some(values), _) => values.iter().any(|value| value.real < -value.error),
                (None, [lambda]) => *lambda > 0.0,
                _ => return Err(ArgumentError::Outdated { what: "the list of multipliers" }.into()),
            };
            violated.extend(wrong.then_some(id));
        }
        if violated.is_empty() {
            (self.met, self.one_by_one) = (HashSet::new(), false);
            return Ok(true);
        }
        self.exclude_cycles(set, &violated)?;
        let count = if self.one_by_one { 1 } else { violated.len() };
        for &id in &violated[..count] {
            if set.is_active(id)? { set.deactivate(id)? } else { set.activate(id)? }
        }
        Ok(false)
    }

    /// Records the current active set. If this set occurred before, each step changes only one inequality from now on. If a set recurs even
    /// then, the step fails.
    fn exclude_cycles(&mut self, set: &ConstraintSet, violated: &[ConstraintId]) -> Result<(), InequalityError> {
        let active = self.ids.iter().map(|&id| set.is_active(id)).collect::<Result<Vec<bool>, _>>()?;
        if self.met.insert(active.clone()) {
            return Ok(());
        }
        if self.one_by_one {
            (self.met, self.one_by_one) = (HashSet::new(), false);
            let labels = violated.iter().map(|id| set.register.name(id.number).to_owned()).collect();
            return Err(InequalityError::Cycle { labels });
        }
        self.one_by_one = true;
        self.met = HashSet::from([active]);
        Ok(())
    }

    /// Repeats `equilibrium` and [`Inequalities::step`] until all inequalities hold. `equilibrium` returns u and the multipliers of the
    /// active constraints; it is called again after every change of the active set.
    ///
    /// # Errors
    /// [`InequalityError`], or that of `equilibrium`.
    pub fn solve<E: From<InequalityError>>(
        &mut self,
        set: &mut ConstraintSet,
        mut equilibrium: impl FnMut(&mut ConstraintSet) -> Result<(Vec<f64>, PerConstraint), E>,
    ) -> Result<(Vec<f64>, PerConstraint), E> {
        let mut evaluation = set.allocate();
        loop {
            let (u, multipliers) = equilibrium(set)?;
            set.evaluate(&u, &mut evaluation).map_err(InequalityError::from)?;
            if self.step(set, &evaluation, &multipliers)? {
                return Ok((u, multipliers));
            }
        }
    }
}
