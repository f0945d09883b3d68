//! From loose constraints to a [`ConstraintSet`].

use qless::Csr;

use super::block::Blocks;
use super::effective::Plan;
use super::labels::Owner;
use super::linear::Rows;
use super::{AddError, ConstraintId, ConstraintSet, Store, StoreError};
use crate::constraint::Constraint;

/// Collects constraints of any types in any order; each is checked when it is added.
#[derive(Default)]
pub struct SetBuilder {
    dofs: usize,
    names: Vec<String>,
    linear: Rows,
    blocks: Blocks,
}

impl SetBuilder {
    pub(super) fn new(dofs: usize) -> Self {
        Self { dofs, ..Self::default() }
    }

    /// Adds a constraint under a label that reports will use.
    ///
    /// # Errors
    /// [`AddError`]: what its type finds wrong with it, or a DOF or number that no type can have. Nothing is added then.
    pub fn add<C: Constraint>(
        &mut self,
        label: impl Into<String>,
        constraint: C,
    ) -> Result<ConstraintId, AddError<C::Error>> {
        let label = label.into();
        let mut store = Store::new(self.dofs);
        if let Err(source) = constraint.process(&mut store) {
            return Err(AddError::Input { name: C::NAME, label, source });
        }
        let fault = store.fault.take().or_else(|| self.too_large(&store));
        if let Some(source) = fault {
            return Err(AddError::Store { name: C::NAME, label, source });
        }
        Ok(self.commit(label, store))
    }

    /// The library marks "none" with `u32::MAX`.
    fn too_large(&self, store: &Store) -> Option<StoreError> {
        let rows = self.linear.rows() + self.blocks.rows() + store.equations.len() + store.pieces.len();
        [("DOFs", self.dofs), ("equations", rows), ("constraints", self.names.len() + 1)]
            .into_iter()
            .find(|&(_, found)| found >= u32::MAX as usize)
            .map(|(what, found)| StoreError::TooLarge { what, found })
    }

    fn commit(&mut self, label: String, store: Store) -> ConstraintId {
        let constraint = self.names.len() as u32;
        self.names.push(label);
        for equation in store.equations {
            self.linear.push(Owner { constraint, part: equation.part }, &equation.terms, equation.rhs);
        }
        store.pieces.into_iter().for_each(|piece| piece.commit(constraint, &mut self.blocks));
        ConstraintId(constraint as usize)
    }

    /// Makes the patterns of G and H from the lists of DOFs and pairs.
    pub fn build(self) -> ConstraintSet {
        let mut pattern = Csr::empty(self.dofs);
        let mut linear = self.linear;
        linear.write_pattern(&mut pattern);
        let mut blocks = self.blocks.all;
        blocks.iter_mut().for_each(|block| block.write_pattern(&mut pattern));
        let plan = Plan::new(&blocks, self.dofs);
        ConstraintSet { dofs: self.dofs, linear, blocks, names: self.names, pattern, plan }
    }
}
