//! From loose constraints to a [`ConstraintSet`].

use qless::SystemError;

use super::blocks::Blocks;
use super::labels::Register;
use super::lazy::Planned;
use super::linear::Rows;
use super::stamp::Stamp;
use super::stated::Stated;
use super::{AddError, ConstraintId, ConstraintIds, ConstraintSet};
use crate::constraint::Constraint;

/// Collects constraints of any types in any order; each is checked when it is added.
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
            register: Register::new(),
            dofs,
            linear: Rows::default(),
            blocks: Blocks::default(),
            planned: Planned::default(),
            time: 0.0,
            stated: Stated::default(),
            version: Stamp::default(),
            spare: None,
        })
    }

    /// Adds a constraint under a label that reports will use, as [`ConstraintSet::add`] does.
    ///
    /// # Errors
    /// [`AddError`]: what its type finds wrong with it, or a DOF or number that no type can have. Nothing is added then.
    pub fn add<C: Constraint>(
        &mut self,
        label: impl Into<String>,
        constraint: C,
    ) -> Result<ConstraintId, AddError<C::Error>> {
        self.0.add(label, constraint)
    }

    /// Adds many constraints of one type at once, as [`ConstraintSet::add_all`] does: by all threads, all of them or none.
    ///
    /// # Errors
    /// [`AddError`] of the first faulty one. Nothing is added then.
    pub fn add_all<C: Constraint>(
        &mut self,
        label: impl Into<String>,
        count: usize,
        constraint: impl Fn(usize) -> C + Sync,
    ) -> Result<ConstraintIds, AddError<C::Error>> {
        self.0.add_all(label, count, constraint)
    }

    /// The set of all that was added. Patterns are made when they are asked for.
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
