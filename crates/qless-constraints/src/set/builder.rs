//! Collects constraints into a [`ConstraintSet`]: one by one, or many of one type in parallel.

use std::collections::BTreeMap;
use std::ops::Range;

use qless::SystemError;
use rayon::prelude::*;

use crate::constraint::{Constraint, EquationError, EquationSink};
use crate::equations::ChangeStamp;
use crate::equations::contents::{BulkEquations, ConstraintContents};
use crate::equations::dof_uses::{DofStatement, DofUses};
use crate::equations::hessian::LazyPlan;
use crate::equations::linear::LinearEquations;
use crate::equations::linear::batch::BATCH_ROWS;
use crate::equations::nonlinear::NonlinearEquations;
use crate::set::ConstraintSet;
use crate::set::edit::EmitFault;
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
            hessian_plan: LazyPlan::default(),
            time: 0.0,
            dof_uses: DofUses::default(),
            norms: BTreeMap::new(),
            version: ChangeStamp::default(),
            spare: None,
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

    /// Adds many constraints of one type in parallel, as [`ConstraintSet::add_all`] does: all or none.
    ///
    /// # Errors
    /// [`AddError`] of the first faulty constraint. Nothing is added then.
    pub fn add_all<C: Constraint>(
        &mut self,
        label: impl Into<String>,
        count: usize,
        constraint: impl Fn(usize) -> C + Sync,
    ) -> Result<ConstraintIds, AddError<C::Error>> {
        self.0.add_all(label, count, constraint)
    }

    /// The set of all constraints added. Patterns are made on request.
    ///
    /// # Errors
    /// [`SystemError::TooLarge`] for more DOFs than 32 bits can number.
    pub fn build(self) -> Result<ConstraintSet, SystemError> {
        if self.0.dofs >= u32::MAX as usize {
            return Err(SystemError::TooLarge { what: "the number of DOFs", found: self.0.dofs });
        }
        Ok(self.0)
    }
}

/// Constraints per task: if each has one equation, they fill whole batches.
const PORTION: usize = BATCH_ROWS;

/// Index of a faulty constraint, and its fault.
type IndexedFault<C> = (usize, EmitFault<<C as Constraint>::Error>);

impl ConstraintSet {
    /// Adds `count` constraints of one type, `constraint(0)` to `constraint(count - 1)`: all, or none if one is faulty.
    ///
    /// The set is the same as if they were added one by one under the labels `"label 0"`, `"label 1"` and so on, or under empty labels if
    /// `label` is empty. All threads call `constraint`; it may read from a list: `|i| list[i]`.
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
        constraint: impl Fn(usize) -> C + Sync,
    ) -> Result<ConstraintIds, AddError<C::Error>> {
        let label = label.into();
        let added = match self.too_many(count) {
            Some(faulty) => Err(faulty),
            None if count < PORTION => self.one_by_one(count, constraint),
            None => self.side_by_side(count, constraint),
        };
        let stated = |mut added: AddedConstraints| {
            let rotations = self.state(added.stated()).map_err(|(i, fault)| (i, EmitFault::Equation(fault)))?;
            Ok((added, rotations))
        };
        match added.and_then(stated) {
            Ok((added, rotations)) => {
                let ids = self.join(label, count, added);
                self.keep_lengths(&rotations);
                Ok(ids)
            }
            Err((i, fault)) => Err(fault.labelled(C::NAME, numbered(&label, i))),
        }
    }

    /// Too few to fill a batch: their equations go into the existing batches.
    fn one_by_one<C: Constraint>(
        &mut self,
        count: usize,
        constraint: impl Fn(usize) -> C,
    ) -> Result<AddedConstraints, IndexedFault<C>> {
        let mut rows = 0;
        let checked = |i| {
            let contents = self.processed(constraint(i), (i, rows)).map_err(|fault| (i, fault))?;
            rows += contents.rows();
            Ok(*contents)
        };
        (0..count).map(checked).collect::<Result<_, _>>().map(AddedConstraints::Few)
    }

    fn side_by_side<C: Constraint>(
        &self,
        count: usize,
        constraint: impl Fn(usize) -> C + Sync,
    ) -> Result<AddedConstraints, IndexedFault<C>> {
        let portion = |k: usize| self.portion(k * PORTION..count.min((k + 1) * PORTION), &constraint);
        let portions: Vec<_> = (0..count.div_ceil(PORTION)).into_par_iter().map(portion).collect();
        let (mut rows, mut all) = (0, Vec::with_capacity(portions.len()));
        for (k, portion) in portions.into_iter().enumerate() {
            let portion = portion?;
            rows += portion.rows();
            let last = count.min((k + 1) * PORTION) - 1;
            self.too_large(last, rows).map_or(Ok(()), |fault| Err((last, EmitFault::Equation(fault))))?;
            all.push(portion);
        }
        Ok(AddedConstraints::Many(all))
    }

    /// Checks a range of constraints, and stores their equations.
    fn portion<C: Constraint>(
        &self,
        which: Range<usize>,
        constraint: &(impl Fn(usize) -> C + Sync),
    ) -> Result<BulkEquations, IndexedFault<C>> {
        let first = self.register.ever() + which.start;
        let mut sink = EquationSink::for_many(self.dofs, BulkEquations::new(first as u32, self.time));
        for i in which {
            constraint(i).emit(&mut sink).map_err(|error| (i, EmitFault::Input(error)))?;
            sink.fault.take().map_or(Ok(()), |fault| Err((i, EmitFault::Equation(fault))))?;
            sink.next();
        }
        Ok(sink.into_portion())
    }

    /// The first constraint that exceeds the limits of the set, before any constraint is made.
    fn too_many<E>(&self, count: usize) -> Option<(usize, EmitFault<E>)> {
        let last = count.checked_sub(1)?;
        let room = (u32::MAX as usize - 1).saturating_sub(self.register.ever());
        let i = if self.too_large(0, 0).is_some() { 0 } else { last.min(room) };
        self.too_large(i, 0).map(|fault| (i, EmitFault::Equation(fault)))
    }

    /// The limit that i + 1 more constraints with this many equations exceed, if any. The index `u32::MAX` is reserved.
    pub(super) fn too_large(&self, i: usize, rows: usize) -> Option<EquationError> {
        let (rows, constraints) = (self.equations() + rows, self.register.ever() + i + 1);
        [("DOFs", self.dofs), ("equations", rows), ("constraints", constraints)]
            .into_iter()
            .find(|&(_, found)| found >= u32::MAX as usize)
            .map(|(what, found)| EquationError::TooLarge { what, found })
    }

    fn join(&mut self, label: String, count: usize, added: AddedConstraints) -> ConstraintIds {
        let ids = self.register.add_all(label, count as u32);
        match added {
            AddedConstraints::Few(all) => {
                std::iter::zip(ids.first.., all).for_each(|(number, contents)| self.put(number, Box::new(contents)));
            }
            AddedConstraints::Many(all) => self.append(all),
        }
        ids
    }

    /// Takes over the equations of new constraints.
    fn append(&mut self, portions: Vec<BulkEquations>) {
        let Self { register, linear, nonlinear, hessian_plan, .. } = self;
        for BulkEquations { linear: rows, nonlinear: others, names, .. } in portions {
            let places = register.equation_names.places_of(&names);
            linear.join(rows, places.as_deref());
            if others.rows() > 0 {
                hessian_plan.outdate();
                others.batches.iter().for_each(|batch| hessian_plan.touch_all(batch.as_ref()));
                nonlinear.join(others, places.as_deref());
            }
        }
        self.version.renew();
    }
}

/// Constraints that passed the checks.
enum AddedConstraints {
    Few(Vec<ConstraintContents>),
    Many(Vec<BulkEquations>),
}

impl AddedConstraints {
    /// The statements of each constraint, which are taken out.
    fn stated(&mut self) -> Vec<Vec<DofStatement>> {
        match self {
            Self::Few(all) => all.iter_mut().map(|contents| std::mem::take(&mut contents.statements)).collect(),
            Self::Many(all) => all.iter_mut().flat_map(|portion| std::mem::take(&mut portion.stated)).collect(),
        }
    }
}
