//! Identities and labels of constraints, and the constraint and label of each row.
//!
//! The label of an equation is "constraint, equation name"; empty parts are left out.

use std::collections::BTreeMap;
use std::ops::Range;

use qless::ArgumentError;
use qless::common::Identity;

use crate::equations::contents::ConstraintContents;
use crate::equations::nonlinear::NonlinearBatch;
use crate::equations::{EquationNames, EquationOwner};
use crate::set::ConstraintSet;
use crate::set::error::EditError;

/// Identifies a constraint of one set until it is removed. It is never reused, and other sets refuse it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ConstraintId {
    pub(super) set: Identity,
    pub(super) number: u32,
}

impl ConstraintId {
    /// Number of constraints that were added before this one.
    pub fn place(self) -> usize {
        self.number as usize
    }
}

/// Identifies the constraints of one call of [`crate::ConstraintSet::add_all`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ConstraintIds {
    pub(super) set: Identity,
    pub(super) first: u32,
    pub(super) count: u32,
}

impl ConstraintIds {
    /// The i-th constraint, from 0; `None` after the last.
    pub fn get(self, i: usize) -> Option<ConstraintId> {
        (i < self.count as usize).then(|| ConstraintId { set: self.set, number: self.first + i as u32 })
    }

    /// All constraints, in order.
    pub fn iter(self) -> impl ExactSizeIterator<Item = ConstraintId> + DoubleEndedIterator {
        // `ExactSizeIterator` needs a range of `usize`.
        (0..self.count as usize).map(move |i| ConstraintId { set: self.set, number: self.first + i as u32 })
    }
}

/// Labels of all constraints ever added, and the contents of inactive ones.
#[derive(Default)]
pub(super) struct ConstraintRegister {
    pub identity: Identity,
    pub equation_names: EquationNames,
    /// Labels of all constraints ever added; `None` for removed ones.
    labels: Vec<Option<Box<str>>>,
    /// Number of constraints that were not removed.
    pub alive: usize,
    /// Contents of inactive constraints.
    pub inactive: BTreeMap<u32, ConstraintContents>,
}

impl ConstraintRegister {
    pub fn new() -> Self {
        Self { identity: Identity::new(), ..Self::default() }
    }

    /// Number of constraints ever added.
    pub fn ever(&self) -> usize {
        self.labels.len()
    }

    pub fn add(&mut self, label: String) -> ConstraintId {
        let id = ConstraintId { set: self.identity, number: self.labels.len() as u32 };
        self.labels.push(Some(label.into()));
        self.alive += 1;
        id
    }

    /// Adds `count` constraints under numbered labels.
    pub fn add_all(&mut self, label: &str, count: u32) -> ConstraintIds {
        let ids = ConstraintIds { set: self.identity, first: self.labels.len() as u32, count };
        self.labels.extend((0..count as usize).map(|i| Some(numbered(label, i).into())));
        self.alive += count as usize;
        ids
    }

    /// The number of a constraint; an error if it was removed or belongs to another set.
    pub fn number(&self, id: ConstraintId) -> Result<u32, EditError> {
        if id.set != self.identity {
            return Err(EditError::Foreign);
        }
        let there = self.labels[id.number as usize].is_some();
        there.then_some(id.number).ok_or(EditError::Gone { place: id.place() })
    }

    pub fn remove(&mut self, number: u32) {
        self.labels[number as usize] = None;
        self.alive -= 1;
    }

    pub fn name(&self, number: u32) -> &str {
        self.labels[number as usize].as_deref().unwrap_or_default()
    }

    /// Joins the label of the constraint and its nonempty equation names by commas.
    pub fn label(&self, owner: EquationOwner, part: &str) -> String {
        let mut label = self.name(owner.constraint).to_owned();
        for part in [self.equation_names.name(owner.name).as_ref(), part].into_iter().filter(|part| !part.is_empty()) {
            if !label.is_empty() {
                label.push_str(", ");
            }
            label.push_str(part);
        }
        label
    }
}

/// The label of the i-th of several constraints.
pub(super) fn numbered(label: &str, i: usize) -> String {
    if label.is_empty() { String::new() } else { format!("{label} {i}") }
}

impl ConstraintSet {
    /// The owner of a row, and the name of the equation within its nonlinear type. This name is empty for a linear equation.
    fn owner(&self, row: usize) -> Result<(EquationOwner, &'static str), ArgumentError> {
        if row >= self.equations() {
            return Err(ArgumentError::OutOfRange { what: "equation", found: row, count: self.equations() });
        }
        let Some(own) = row.checked_sub(self.linear.rows()) else { return Ok((self.linear.owners[row], "")) };
        let of = |(first, batch): (usize, &dyn NonlinearBatch)| {
            let (own, names) = (own.checked_sub(first)?, batch.equation_names());
            (own < batch.rows()).then(|| (batch.owner(own / names.len()), names[own % names.len()]))
        };
        Ok(self.nonlinear.with_rows().find_map(of).expect("the row is below the number of rows"))
    }

    /// The constraint that an equation belongs to.
    ///
    /// # Errors
    /// [`ArgumentError::OutOfRange`].
    pub fn constraint_of(&self, row: usize) -> Result<ConstraintId, ArgumentError> {
        let number = self.owner(row)?.0.constraint;
        Ok(ConstraintId { set: self.register.identity, number })
    }

    /// The equations of a constraint, ascending; empty if it is inactive or was removed.
    ///
    /// # Errors
    /// [`ArgumentError::Foreign`] for a constraint of another set.
    pub fn rows_of(&self, constraint: ConstraintId) -> Result<Vec<usize>, ArgumentError> {
        self.own("the constraint", constraint.set)?;
        let mut rows: Vec<usize> = self.linear.rows_of(constraint.number).collect();
        for (first, batch) in self.nonlinear.with_rows() {
            let (items, count) = (batch.items_of(constraint.number), batch.equations_per_item());
            let first = self.linear.rows() + first;
            rows.extend(first + items.start * count..first + items.end * count);
        }
        Ok(rows)
    }

    /// The label of an equation: that of its constraint, and the name of the equation.
    ///
    /// # Errors
    /// [`ArgumentError::OutOfRange`].
    pub fn label(&self, row: usize) -> Result<String, ArgumentError> {
        let (owner, part) = self.owner(row)?;
        Ok(self.register.label(owner, part))
    }

    /// Whether the equation is linear, so that its row of G is constant.
    pub fn is_linear(&self, row: usize) -> bool {
        self.linear_rows().contains(&row)
    }

    /// The rows of linear equations.
    pub fn linear_rows(&self) -> Range<usize> {
        0..self.linear.rows()
    }
}
