//! From loose constraints to a [`ConstraintSet`].

use qless::{Csr, Identity, SystemError};

use super::block::Blocks;
use super::effective::Plan;
use super::labels::Owner;
use super::linear::Rows;
use super::rounding::Size;
use super::{AddError, ConstraintId, ConstraintSet, Store, StoreError};
use crate::constraint::Constraint;

/// Collects constraints of any types in any order; each is checked when it is added.
pub struct SetBuilder {
    identity: Identity,
    dofs: usize,
    names: Vec<String>,
    linear: Rows,
    blocks: Blocks,
    /// The largest coordinate that each DOF adds to, rounded up.
    sizes: Vec<Size>,
}

impl std::fmt::Debug for SetBuilder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut text = f.debug_struct("SetBuilder");
        text.field("dofs", &self.dofs).field("constraints", &self.names.len()).finish_non_exhaustive()
    }
}

impl SetBuilder {
    pub(super) fn new(dofs: usize) -> Self {
        let (linear, blocks) = (Rows::default(), Blocks::default());
        Self { identity: Identity::new(), dofs, names: Vec::new(), linear, blocks, sizes: Vec::new() }
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
        let mut store = Store::new(self.dofs, 0.0);
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
            self.linear.push(Owner { constraint, part: equation.part }, &equation.terms, &equation.rhs);
        }
        store.pieces.into_iter().for_each(|piece| piece.commit(constraint, &mut self.blocks));
        store.coordinates.into_iter().for_each(|(dof, at)| self.coordinate(dof as usize, at));
        ConstraintId { set: self.identity, number: constraint as usize }
    }

    fn coordinate(&mut self, dof: usize, at: f64) {
        if at == 0.0 || dof >= self.dofs {
            return;
        }
        if self.sizes.len() <= dof {
            self.sizes.resize(dof + 1, Size::default());
        }
        self.sizes[dof] = self.sizes[dof].max(Size::above(at));
    }

    /// Makes the patterns of G and H from the lists of DOFs and pairs.
    ///
    /// # Errors
    /// [`SystemError::TooLarge`] for more DOFs than 32 bits can number.
    pub fn build(self) -> Result<ConstraintSet, SystemError> {
        if self.dofs >= u32::MAX as usize {
            return Err(SystemError::TooLarge { what: "the number of DOFs", found: self.dofs });
        }
        let mut pattern = Csr::empty(self.dofs);
        let (mut linear, mut blocks) = (self.linear, self.blocks.all);
        linear.write_pattern(&mut pattern)?;
        blocks.iter_mut().try_for_each(|block| block.write_pattern(&mut pattern))?;
        let plan = Plan::new(&blocks, self.dofs);
        let (identity, dofs, names, sizes) = (self.identity, self.dofs, self.names, self.sizes);
        Ok(ConstraintSet { identity, dofs, linear, blocks, names, pattern, plan, sizes, time: 0.0 })
    }
}
