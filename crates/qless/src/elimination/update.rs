//! New right-hand sides and prescribed values: they change g, but not T and the slaves.

use std::sync::Arc;

use super::error::refuse_conflicts;
use super::{Elimination, EliminationError, EliminationSource};
use crate::ArgumentError;
use crate::change::Refresher;
use crate::common::argument::numbers;

impl Elimination {
    /// Sets new right-hand sides b (length m) and prescribed values (in the order of [`Elimination::prescribed`]). Slaves and T do not
    /// change.
    ///
    /// ```
    /// # use qless::{Elimination, Options, SystemBuilder};
    /// let mut builder = SystemBuilder::new(3);
    /// builder.equation([(0, 1.0), (1, -1.0), (2, -1.0)], 0.0);
    /// builder.prescribe(2, 0.0);
    /// let mut elimination = Elimination::new(&builder.build()?, &Options::default())?;
    /// for step in 1..=3 {
    ///     let t = f64::from(step);
    ///     elimination.update(&[0.5 * t], &[t * t])?;
    ///     let mut u = [0.0; 3];
    ///     elimination.expand_into(&[0.0], &mut u)?;
    ///     assert_eq!(u[0] - u[1], t * t + 0.5 * t);
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`EliminationError::NoEquations`], [`EliminationError::Backend`], [`EliminationError::Refresh`], and
    /// [`EliminationError::Conflicting`] if equations conflict now; then nothing changes.
    pub fn update(&mut self, rhs: &[f64], prescribed: &[f64]) -> Result<(), EliminationError> {
        let Self { reduction, equations, prescribed_values, .. } = self;
        let EliminationSource { analysis, rhs: old, refreshed: verdicts, refresher, .. } =
            equations.as_mut().ok_or(EliminationError::NoEquations)?;
        let g = reduction.g.clone();
        let refresher = if let Some(refresher) = refresher.get() {
            refresher
        } else {
            let new = Refresher::new(Arc::clone(analysis))?;
            refresher.get_or_init(|| new)
        };
        let refreshed = refresher.refresh(rhs, prescribed, reduction)?;
        if let Err(error) = refuse_conflicts(&refreshed.kinds, analysis.system()) {
            refresher.refresh(old, prescribed_values, reduction)?;
            reduction.g = g;
            return Err(error);
        }
        *verdicts = Some(refreshed);
        old.copy_from_slice(rhs);
        self.prescribe(prescribed);
        Ok(())
    }

    /// [`Elimination::update`] with functions that return the right-hand side of an equation and the value of a prescribed DOF.
    ///
    /// # Errors
    /// As [`Elimination::update`].
    pub fn update_with(
        &mut self,
        rhs: impl Fn(usize) -> f64,
        prescribed: impl Fn(usize) -> f64,
    ) -> Result<(), EliminationError> {
        let rhs: Vec<f64> = (0..self.rhs().len()).map(rhs).collect();
        let prescribed: Vec<f64> = self.prescribed().iter().map(|&dof| prescribed(dof)).collect();
        self.update(&rhs, &prescribed)
    }

    /// Sets a new g and new values of the prescribed DOFs; T and G do not change.
    ///
    /// # Errors
    /// [`ArgumentError`] for wrong lengths or numbers that are not finite; then nothing changes.
    pub fn set(&mut self, g: &[f64], prescribed: &[f64]) -> Result<(), ArgumentError> {
        numbers("g", g, self.reduction.g.len())?;
        numbers("the list of prescribed values", prescribed, self.prescribed_values.len())?;
        self.reduction.g.copy_from_slice(g);
        self.prescribe(prescribed);
        Ok(())
    }

    fn prescribe(&mut self, prescribed: &[f64]) {
        self.prescribed_values.copy_from_slice(prescribed);
        self.roles.refresh(&self.reduction, prescribed);
    }
}
