//! Changes of a set that is in use: constraints are added, removed, activated, deactivated and replaced.
//!
//! | operation | cost |
//! | --- | --- |
//! | [`ConstraintSet::add`], [`remove`](ConstraintSet::remove), [`activate`](ConstraintSet::activate), [`deactivate`](ConstraintSet::deactivate) | the batches of the constraint's equations, at most some thousand numbers each |
//! | [`ConstraintSet::replace`] with the same DOFs, [`set_rhs`](ConstraintSet::set_rhs) | the numbers that are replaced |
//! | the next evaluation | new patterns for the chunks of H that changed; rows of G and H after the first change move once |
//!
//! Results have the same bits, in the same rows, as those of a new set of the active constraints that meets their types in the same order.

use crate::constraint::{Constraint, EquationError, EquationSink};
use crate::equations::contents::ConstraintContents;
use crate::set::ConstraintSet;
use crate::set::error::{AddError, EditError, ReplaceError, TimeError};
use crate::set::register::ConstraintId;
use crate::set::statements::euler_parameters;

impl ConstraintSet {
    /// Adds an active constraint under a label for reports.
    ///
    /// ```
    /// use qless_constraints::ConstraintSet;
    /// use qless_constraints::types::{Equal, Prescribed};
    /// let mut builder = ConstraintSet::builder(3);
    /// let tie = builder.add("tie", Equal::new([0, 1]))?;
    /// let mut set = builder.build()?;
    /// let mut evaluation = set.allocate();
    /// let push = set.add("push", Prescribed { values: vec![(2, 0.5)] })?;
    /// set.deactivate(tie)?;
    /// set.evaluate(&[0.0, 1.0, 2.0], &mut evaluation)?;
    /// assert_eq!((evaluation.c(), set.label(0)?.as_str()), ([1.5].as_slice(), "push"));
    /// set.set_rhs(push, &[2.0])?;
    /// set.activate(tie)?;
    /// set.evaluate(&[0.0, 1.0, 2.0], &mut evaluation)?;
    /// assert_eq!((evaluation.c(), set.rows_of(push)?), ([1.0, 0.0].as_slice(), vec![1]));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`AddError`]: the type refuses the input, or a DOF or number is not valid. Nothing is added then.
    pub fn add<C: Constraint>(
        &mut self,
        label: impl Into<String>,
        constraint: C,
    ) -> Result<ConstraintId, AddError<C::Error>> {
        let label = label.into();
        let mut contents = match self.processed(constraint, (0, 0)) {
            Ok(contents) => contents,
            Err(fault) => return Err(fault.labelled(C::NAME, label)),
        };
        let rotations = match self.state(vec![std::mem::take(&mut contents.statements)]) {
            Ok(rotations) => rotations,
            Err((_, source)) => return Err(AddError::Equation { name: C::NAME, label, source }),
        };
        let id = self.register.add(label);
        self.put(id.number, contents);
        self.keep_lengths(&rotations);
        Ok(id)
    }

    /// Removes a constraint for good, active or not.
    ///
    /// # Errors
    /// [`EditError::Foreign`], [`EditError::Gone`].
    pub fn remove(&mut self, constraint: ConstraintId) -> Result<(), EditError> {
        let number = self.register.number(constraint)?;
        let active = self.register.inactive.remove(&number).is_none();
        if active {
            self.take(number);
        }
        let statements = self.dof_uses.take(number, active);
        self.register.remove(number);
        self.keep_lengths(&euler_parameters(&statements));
        Ok(())
    }

    /// Makes a constraint inactive: it has no equations until it is activated. No effect on an inactive constraint.
    ///
    /// # Errors
    /// [`EditError::Foreign`], [`EditError::Gone`].
    pub fn deactivate(&mut self, constraint: ConstraintId) -> Result<(), EditError> {
        let number = self.register.number(constraint)?;
        if !self.register.inactive.contains_key(&number) {
            let contents = Box::new(self.take(number));
            self.dof_uses.activate(number, false);
            self.register.inactive.insert(number, contents);
        }
        Ok(())
    }

    /// Reactivates an inactive constraint in its old position, evaluated at the time of the set. No effect on an active constraint.
    ///
    /// # Errors
    /// [`EditError::Foreign`], [`EditError::Gone`], [`EditError::Time`] if a function of time is not finite at the time of the set.
    pub fn activate(&mut self, constraint: ConstraintId) -> Result<(), EditError> {
        let number = self.register.number(constraint)?;
        let Some(contents) = self.register.inactive.get_mut(&number) else { return Ok(()) };
        if let Err(value) = contents.at_time(self.time) {
            let label = self.register.name(number).to_string();
            return Err(TimeError::NotFinite { label, time: self.time, value }.into());
        }
        if let Some(contents) = self.register.inactive.remove(&number) {
            self.dof_uses.activate(number, true);
            self.put(number, contents);
        }
        Ok(())
    }

    /// Whether a constraint is active, so that its equations are part of the set.
    ///
    /// # Errors
    /// [`EditError::Foreign`], [`EditError::Gone`].
    pub fn is_active(&self, constraint: ConstraintId) -> Result<bool, EditError> {
        self.register.number(constraint).map(|number| !self.register.inactive.contains_key(&number))
    }

    /// Replaces the parameters or the type of a constraint. Its label and position stay, and it remains active or inactive.
    ///
    /// All patterns stay if DOFs, types and numbers of equations are the same.
    ///
    /// # Errors
    /// [`ReplaceError`]; the constraint is not changed then.
    pub fn replace<C: Constraint>(&mut self, constraint: ConstraintId, new: C) -> Result<(), ReplaceError<C::Error>> {
        let number = self.register.number(constraint)?;
        let label = self.register.name(number).to_string();
        let mut contents = match self.processed(new, (0, 0)) {
            Ok(contents) => contents,
            Err(fault) => return Err(fault.labelled(C::NAME, label).into()),
        };
        let rotations = match self.state_anew(number, std::mem::take(&mut contents.statements)) {
            Ok(rotations) => rotations,
            Err(source) => return Err(AddError::Equation { name: C::NAME, label, source }.into()),
        };
        if let Some(inactive) = self.register.inactive.get_mut(&number) {
            *inactive = contents;
        } else if let Err(contents) = self.overwrite(number, contents) {
            self.take(number);
            self.put(number, contents);
        }
        self.keep_lengths(&rotations);
        Ok(())
    }

    /// Sets constant right-hand sides for the linear equations of a constraint, in order. They replace functions of time.
    ///
    /// # Errors
    /// [`EditError::Foreign`], [`EditError::Gone`], [`EditError::Count`], [`EditError::NotFinite`]; nothing changes then.
    pub fn set_rhs(&mut self, constraint: ConstraintId, rhs: &[f64]) -> Result<(), EditError> {
        let number = self.register.number(constraint)?;
        let inactive = self.register.inactive.get(&number).map(|contents| contents.equations.len());
        let expected = inactive.unwrap_or_else(|| self.linear.rows_of(number).len());
        if rhs.len() != expected {
            let label = self.register.name(number).to_string();
            return Err(EditError::Count { label, found: rhs.len(), expected });
        }
        if let Some(&value) = rhs.iter().find(|rhs| !rhs.is_finite()) {
            return Err(EditError::NotFinite { label: self.register.name(number).to_string(), value });
        }
        match self.register.inactive.get_mut(&number) {
            Some(contents) => contents.set_rhs(rhs),
            None => self.linear.set_values(number, rhs),
        }
        self.version.renew();
        Ok(())
    }

    /// The checked equations of a new constraint, which follows `others` new ones with `rows` equations.
    pub(super) fn processed<C: Constraint>(
        &mut self,
        constraint: C,
        (others, rows): (usize, usize),
    ) -> Result<Box<ConstraintContents>, EmitFault<C::Error>> {
        let mut sink = EquationSink::new(self.dofs, self.time, self.spare.take().unwrap_or_default());
        constraint.emit(&mut sink).map_err(EmitFault::Input)?;
        match sink.fault.take().or_else(|| self.too_large(others, rows + sink.rows())) {
            Some(fault) => Err(EmitFault::Equation(fault)),
            None => Ok(sink.contents),
        }
    }

    /// Stores the equations of a constraint in its position.
    pub(super) fn put(&mut self, number: u32, mut contents: Box<ConstraintContents>) {
        let Self { register, linear, nonlinear, hessian_plan, time, .. } = self;
        linear.put(number, &mut contents.equations, &mut register.equation_names, *time);
        if !contents.pieces.is_empty() {
            hessian_plan.outdate();
            let ConstraintContents { pieces, dofs, .. } = &mut *contents;
            pieces.drain(..).for_each(|piece| piece.commit(number, dofs, &mut register.equation_names, nonlinear));
            if hessian_plan.is_wanted() {
                nonlinear
                    .items_of(number)
                    .into_iter()
                    .for_each(|(_, (b, i))| hessian_plan.touch(nonlinear.batches[b].as_ref(), i));
            }
        }
        self.version.renew();
        self.spare = contents.emptied();
    }

    /// Removes and returns the equations of a constraint.
    pub(super) fn take(&mut self, number: u32) -> ConstraintContents {
        let Self { register, linear, nonlinear, hessian_plan, .. } = self;
        let places = nonlinear.items_of(number);
        if !places.is_empty() {
            hessian_plan.outdate();
            places.iter().for_each(|&(_, (batch, item))| hessian_plan.touch(nonlinear.batches[batch].as_ref(), item));
        }
        self.version.renew();
        let equations = linear.take(number, &register.equation_names);
        let (pieces, dofs) = nonlinear.take(number, &register.equation_names);
        ConstraintContents { equations, pieces, dofs, ..ConstraintContents::default() }
    }

    /// Replaces the numbers of a constraint if all patterns stay; otherwise returns the contents.
    fn overwrite(&mut self, number: u32, mut contents: Box<ConstraintContents>) -> Result<(), Box<ConstraintContents>> {
        contents.pieces.sort_by_key(|piece| piece.kind(&self.nonlinear));
        let places = self.nonlinear.items_of(number);
        let same =
            contents.equations.len() == self.linear.rows_of(number).len() && contents.pieces.len() == places.len();
        let mut pairs = contents.pieces.iter().zip(&places);
        if !same || !pairs.all(|(piece, &(_, place))| piece.fits(&contents.dofs, place, &self.nonlinear)) {
            return Err(contents);
        }
        let Self { register, linear, nonlinear, time, .. } = self;
        let ConstraintContents { equations, pieces, .. } = *contents;
        linear.overwrite(number, equations, &mut register.equation_names, *time);
        for (piece, (_, place)) in pieces.into_iter().zip(places) {
            piece.overwrite(number, &mut register.equation_names, place, nonlinear);
        }
        self.version.renew();
        Ok(())
    }
}

/// A fault of a constraint, before it is labelled.
pub(super) enum EmitFault<E> {
    Input(E),
    Equation(EquationError),
}

impl<E: std::error::Error + 'static> EmitFault<E> {
    pub(super) fn labelled(self, name: &'static str, label: String) -> AddError<E> {
        match self {
            Self::Input(source) => AddError::Input { name, label, source },
            Self::Equation(source) => AddError::Equation { name, label, source },
        }
    }
}
