//! Which equations are whose.

use std::ops::Range;

use qless::ArgumentError;

use super::block::Block;
use super::labels::Owner;
use super::{ConstraintId, ConstraintSet};

impl ConstraintSet {
    /// Which block of equations a row belongs to, and its row there; nothing for linear equations.
    fn place(&self, row: usize) -> Option<(&dyn Block, usize)> {
        let (block, own) = self.blocks.offsets.find(row.checked_sub(self.linear.rows())?);
        Some((self.blocks.all[block].as_ref(), own))
    }

    /// The constraint of a row and the name of the part that it is.
    fn owner(&self, row: usize) -> Result<(Owner, &'static str), ArgumentError> {
        if row >= self.equations() {
            return Err(ArgumentError::OutOfRange { what: "equation", found: row, count: self.equations() });
        }
        Ok(self.place(row).map_or_else(|| (self.linear.owner(row), ""), |(block, own)| block.owner(own)))
    }

    /// Which constraint an equation belongs to.
    ///
    /// # Errors
    /// [`ArgumentError::OutOfRange`].
    pub fn constraint_of(&self, row: usize) -> Result<ConstraintId, ArgumentError> {
        let number = self.owner(row)?.0.constraint;
        Ok(ConstraintId { set: self.register.identity, number })
    }

    /// The equations of a constraint, ascending; none if it is not active or was removed.
    ///
    /// # Errors
    /// [`ArgumentError::Foreign`] for a constraint of another set.
    pub fn rows_of(&self, constraint: ConstraintId) -> Result<Vec<usize>, ArgumentError> {
        self.own("the constraint", constraint.set)?;
        let mut rows: Vec<usize> = self.linear.of(constraint.number).collect();
        for (_, (block, item)) in self.blocks.of(constraint.number) {
            let parts = self.blocks.all[block].parts();
            let first = self.linear.rows() + self.blocks.offsets.first(block) + item * parts;
            rows.extend(first..first + parts);
        }
        Ok(rows)
    }

    /// The label of an equation: that of its constraint, and which part of it.
    ///
    /// # Errors
    /// [`ArgumentError::OutOfRange`].
    pub fn label(&self, row: usize) -> Result<String, ArgumentError> {
        let (owner, part) = self.owner(row)?;
        Ok(self.register.label(owner, part))
    }

    /// Whether the equation is linear: its row of G never changes.
    pub fn is_linear(&self, row: usize) -> bool {
        self.linear_rows().contains(&row)
    }

    /// The linear equations.
    pub fn linear_rows(&self) -> Range<usize> {
        0..self.linear.rows()
    }
}
