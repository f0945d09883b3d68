//! Collects constraints into a [`ConstraintSet`]: one by one, or many of one type.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use qless::SystemError;

use crate::constraint::{Constraint, EquationError};
use crate::equations::ChangeStamp;
use crate::equations::dof_uses::DofUses;
use crate::equations::linear::LinearEquations;
use crate::equations::nonlinear::NonlinearEquations;
use crate::set::ConstraintSet;
use crate::set::error::AddError;
use crate::set::register::{ConstraintId, ConstraintIds, ConstraintRegister, numbered};

/// Collects constraints of any types in any order. Each is checked when it is added.
pub struct SetBuilder(ConstraintSet);

impl std::fmt::Debug for SetBuilder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut text = f.debug_struct("SetBuilder");
        text.field("dofs", &self.0.dofs).field("constraints", &self.0.constraints()).finish_non_exhaustive()
    }
}

impl SetBuilder {
    pub(super) fn new(dofs: usize) -> Self {
        Self(ConstraintSet {
            register: ConstraintRegister::new(),
            dofs,
            linear: LinearEquations::default(),
            nonlinear: NonlinearEquations::default(),
            hessian_plan: OnceLock::new(),
            time: 0.0,
            dof_uses: DofUses::default(),
            norms: BTreeMap::new(),
            pattern: ChangeStamp::default(),
            version: ChangeStamp::default(),
        })
    }

    /// Adds a constraint under a label for reports, as [`ConstraintSet::add`] does.
    ///
    /// # Errors
    /// [`AddError`]: the type refuses the input, or a DOF or number is not valid. Nothing is added then.
    pub fn add<C: Constraint>(
        &mut self,
        label: impl Into<String>,
        constraint: C,
    ) -> Result<ConstraintId, AddError<C::Error>> {
        self.0.add(label, constraint)
    }

    /// Adds many constraints of one type, as [`ConstraintSet::add_all`] does: all or none.
    ///
    /// # Errors
    /// [`AddError`] of the first faulty constraint. Nothing is added then.
    pub fn add_all<C: Constraint>(
        &mut self,
        label: impl Into<String>,
        count: usize,
        constraint: impl Fn(usize) -> C,
    ) -> Result<ConstraintIds, AddError<C::Error>> {
        self.0.add_all(label, count, constraint)
    }

    /// The set of all constraints added. Patterns are made on request.
    ///
    /// # Errors
    /// [`SystemError::TooLarge`] for more DOFs than 32 bits can number.
    pub fn build(mut self) -> Result<ConstraintSet, SystemError> {
        if self.0.dofs >= u32::MAX as usize {
            return Err(SystemError::TooLarge { what: "the number of DOFs", found: self.0.dofs });
        }
        self.0.linear.shrink();
        Ok(self.0)
    }
}

impl ConstraintSet {
    /// Adds `count` constraints of one type, `constraint(0)` to `constraint(count - 1)`: all, or none if one is faulty.
    ///
    /// The set is the same as if they were added one by one under the labels `"label 0"`, `"label 1"` and so on, or under empty labels if
    /// `label` is empty; their identities are consecutive.
    ///
    /// ```
    /// use qless_constraints::ConstraintSet;
    /// use qless_constraints::types::{Distance, PlanarPoint};
    /// // A chain of four rods of length 1.
    /// let point = |i: usize| PlanarPoint::new([2 * i, 2 * i + 1], [i as f64, 0.0]);
    /// let mut builder = ConstraintSet::builder(10);
    /// let rods = builder.add_all("rod", 4, |i| Distance::new(point(i), point(i + 1)))?;
    /// let mut set = builder.build()?;
    /// assert_eq!((set.equations(), set.label(2)?.as_str()), (4, "rod 2"));
    /// set.remove(rods.get(2).expect("there are four"))?;
    /// assert_eq!(set.label(2)?, "rod 3");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`AddError`] of the first faulty constraint. Nothing is added then.
    pub fn add_all<C: Constraint>(
        &mut self,
        label: impl Into<String>,
        count: usize,
        constraint: impl Fn(usize) -> C,
    ) -> Result<ConstraintIds, AddError<C::Error>> {
        let (label, first, mut rotations) = (label.into(), self.register.ever(), Vec::new());
        let too_many = self.too_many(count);
        for i in 0..if too_many.is_some() { 0 } else { count } {
            if let Err(fault) = self.add_unnamed((first + i) as u32, constraint(i), &mut rotations) {
                (first..first + i).rev().for_each(|number| self.forget(number as u32));
                return Err(fault.labelled(C::NAME, numbered(&label, i)));
            }
        }
        if let Some((i, source)) = too_many {
            return Err(AddError::Equation { name: C::NAME, label: numbered(&label, i), source });
        }
        let ids = self.register.add_all(&label, count as u32);
        self.keep_lengths(&rotations);
        Ok(ids)
    }

    /// Checks the limits of the set before any of `count` constraints is made. Returns the index of the first constraint that exceeds a
    /// limit, and the fault.
    fn too_many(&self, count: usize) -> Option<(usize, EquationError)> {
        let last = count.checked_sub(1)?;
        let room = (u32::MAX as usize - 1).saturating_sub(self.register.ever());
        let i = if self.too_large(1, 0).is_some() { 0 } else { last.min(room) };
        self.too_large(i + 1, 0).map(|fault| (i, fault))
    }

    /// The limit that the set would exceed with this many more constraints and equations, if any. The index `u32::MAX` is reserved.
    pub(super) fn too_large(&self, constraints: usize, rows: usize) -> Option<EquationError> {
        let (rows, constraints) = (self.equations() + rows, self.register.ever() + constraints);
        [("DOFs", self.dofs), ("equations", rows), ("constraints", constraints)]
            .into_iter()
            .find(|&(_, found)| found >= u32::MAX as usize)
            .map(|(what, found)| EquationError::TooLarge { what, found })
    }
}
