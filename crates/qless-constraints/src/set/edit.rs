//! Changes of a set that is in use: constraints are added, removed, activated, deactivated and replaced.
//!
//! | operation | cost |
//! | --- | --- |
//! | [`ConstraintSet::add`] | stores the numbers of the constraint |
//! | [`ConstraintSet::remove`] | moves numbers of later constraints that have linear equations or the same nonlinear types |
//! | [`ConstraintSet::activate`], [`ConstraintSet::deactivate`] | moves the same numbers as `remove` |
//! | [`ConstraintSet::replace`] with the same DOFs, [`set_rhs`](ConstraintSet::set_rhs) | stores the new numbers |
//! | the next evaluation after a change of equations | makes the pattern of G anew, and that of H if nonlinear equations changed |
//!
//! Results have the same bits, in the same rows, as those of a new set of the active constraints alone, provided that the types first occur
//! in the same order in both sets.

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
        let (label, number, mut rotations) = (label.into(), self.register.ever() as u32, Vec::new());
        if let Err(fault) = self.add_unnamed(number, constraint, &mut rotations) {
            return Err(fault.labelled(C::NAME, label));
        }
        let id = self.register.add(label);
        self.keep_lengths(&rotations);
        Ok(id)
    }

    /// Checks and stores a new constraint that has no label yet. Appends the DOFs of its Euler parameters to `rotations`.
    pub(super) fn add_unnamed<C: Constraint>(
        &mut self,
        number: u32,
        constraint: C,
        rotations: &mut Vec<[u32; 4]>,
    ) -> Result<(), EmitFault<C::Error>> {
        let more = number as usize - self.register.ever() + 1;
        let mut contents = self.processed(constraint, more)?;
        let statements = std::mem::take(&mut contents.statements);
        let found = euler_parameters(&statements);
        self.state(number, statements).map_err(EmitFault::Equation)?;
        rotations.extend(found);
        self.put(number, contents);
        Ok(())
    }

    /// Removes the equations and statements of an active constraint.
    pub(super) fn forget(&mut self, number: u32) {
        self.take(number);
        self.dof_uses.take(number, true);
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

    /// Makes a constraint inactive: it has no equations until it is activated. [`ConstraintSet::values_of`] still evaluates its values. No
    /// effect on an inactive constraint.
    ///
    /// # Errors
    /// [`EditError::Foreign`], [`EditError::Gone`].
    pub fn deactivate(&mut self, constraint: ConstraintId) -> Result<(), EditError> {
        let number = self.register.number(constraint)?;
        if !self.register.inactive.contains_key(&number) {
            let contents = self.take(number);
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
    /// G keeps its pattern if DOFs, types and numbers of equations are the same. H keeps it too if the DOF pairs of nonlinear equations are
    /// the same.
    ///
    /// # Errors
    /// [`ReplaceError`]; the constraint is not changed then.
    pub fn replace<C: Constraint>(&mut self, constraint: ConstraintId, new: C) -> Result<(), ReplaceError<C::Error>> {
        let number = self.register.number(constraint)?;
        let label = self.register.name(number).to_string();
        let mut contents = match self.processed(new, 0) {
            Ok(contents) => contents,
            Err(fault) => return Err(fault.labelled(C::NAME, label).into()),
        };
        let rotations = match self.state_anew(number, std::mem::take(&mut contents.statements)) {
            Ok(rotations) => rotations,
            Err(source) => return Err(AddError::Equation { name: C::NAME, label, source }.into()),
        };
        if let Some(inactive) = self.register.inactive.get_mut(&number) {
            // Items are sorted by type, as in an active constraint; types that the set does not know yet come last.
            contents.pieces.sort_by_key(|piece| piece.kind(&self.nonlinear).unwrap_or(usize::MAX));
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
            Some(contents) => {
                contents.set_rhs(rhs);
                contents.not_finite = contents.at_time(self.time).err();
            }
            None => self.linear.set_values(number, rhs),
        }
        self.version.renew();
        Ok(())
    }

    /// Emits and checks the equations of a constraint. `more` is the number of constraints that the set does not count yet, including this
    /// one; 0 for a replacement.
    fn processed<C: Constraint>(
        &mut self,
        constraint: C,
        more: usize,
    ) -> Result<ConstraintContents, EmitFault<C::Error>> {
        let mut sink = EquationSink::new(self.dofs, self.time);
        constraint.emit(&mut sink).map_err(EmitFault::Input)?;
        match sink.fault.take().or_else(|| self.too_large(more, sink.rows())) {
            Some(fault) => Err(EmitFault::Equation(fault)),
            None => Ok(sink.contents),
        }
    }

    /// Stores the equations of a constraint in its position.
    pub(super) fn put(&mut self, number: u32, contents: ConstraintContents) {
        let Self { register, linear, nonlinear, hessian_plan, time, .. } = self;
        let ConstraintContents { equations, pieces, dofs, .. } = contents;
        linear.replace(number, equations, &mut register.equation_names, *time);
        if !pieces.is_empty() {
            hessian_plan.take();
        }
        pieces.into_iter().for_each(|piece| piece.commit(number, &dofs, &mut register.equation_names, nonlinear));
        self.pattern.renew();
        self.version.renew();
    }

    /// Removes and returns the equations of a constraint.
    pub(super) fn take(&mut self, number: u32) -> ConstraintContents {
        let names = &mut self.register.equation_names;
        let equations = self.linear.replace(number, Vec::new(), names, self.time);
        let (pieces, dofs) = self.nonlinear.take(number, names);
        if !pieces.is_empty() {
            self.hessian_plan.take();
        }
        self.pattern.renew();
        self.version.renew();
        ConstraintContents { equations, pieces, dofs, ..ConstraintContents::default() }
    }

    /// Replaces the equations of a constraint by `contents` if the nonlinear ones keep their pattern. Otherwise changes nothing, and
    /// returns `contents`.
    fn overwrite(&mut self, number: u32, mut contents: ConstraintContents) -> Result<(), ConstraintContents> {
        contents.pieces.sort_by_key(|piece| piece.kind(&self.nonlinear));
        let places = self.nonlinear.items_of(number);
        let Self { register, linear, nonlinear, time, .. } = self;
        let names = &mut register.equation_names;
        let mut pairs = contents.pieces.iter().zip(&places);
        let fits = contents.pieces.len() == places.len()
            && pairs.all(|(piece, &place)| piece.fits(&contents.dofs, place, nonlinear));
        if !fits {
            return Err(contents);
        }
        linear.replace(number, contents.equations, names, *time);
        let pairs = contents.pieces.into_iter().zip(places);
        pairs.for_each(|(piece, place)| piece.overwrite(number, names, place, nonlinear));
        // An evaluation copies the coefficients of linear equations only if the pattern has a new stamp. So the pattern gets a new stamp
        // here, even if it is the same.
        self.pattern.renew();
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
