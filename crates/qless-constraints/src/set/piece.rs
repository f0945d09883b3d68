//! Nonlinear equations that are not among those of their type.

use std::borrow::Cow;
use std::ops::Range;

use super::blocks::{Blocks, Place};
use super::labels::{Owner, Parts};
use crate::constraint::Nonlinear;

/// Those of one constraint, of whatever type.
pub(super) trait Piece: Send + Sync {
    fn rows(&self) -> usize;
    /// Which type of the set it is of; none if the set has not met it.
    fn kind(&self, blocks: &Blocks) -> Option<u32>;
    /// Takes the parameters of this time; as an error the number of it that is not finite.
    fn at_time(&mut self, time: f64) -> Result<(), f64>;
    /// Puts it among those of its type; the DOFs of all pieces of its constraint and its parts are given.
    fn commit(self: Box<Self>, constraint: u32, dofs: &[u32], parts: &mut Parts, blocks: &mut Blocks);
    /// Whether it has the DOFs and pairs of an equation of its type, so that it can take its place.
    fn fits(&self, dofs: &[u32], place: Place, blocks: &Blocks) -> bool;
    /// Takes that place.
    fn overwrite(self: Box<Self>, constraint: u32, parts: &mut Parts, place: Place, blocks: &mut Blocks);
}

pub(super) struct Staged<Q> {
    pub part: Cow<'static, str>,
    /// Places among the DOFs of all pieces.
    pub dofs: Range<usize>,
    pub parameters: Q,
}

impl<Q: Nonlinear> Piece for Staged<Q> {
    fn rows(&self) -> usize {
        Q::PARTS.len()
    }

    fn kind(&self, blocks: &Blocks) -> Option<u32> {
        blocks.kind::<Q>()
    }

    fn at_time(&mut self, time: f64) -> Result<(), f64> {
        if Q::DRIVEN { self.parameters.at_time(time) } else { Ok(()) }
    }

    fn commit(self: Box<Self>, constraint: u32, dofs: &[u32], parts: &mut Parts, blocks: &mut Blocks) {
        let Self { part, dofs: own, parameters } = *self;
        blocks.insert(Owner { constraint, part: parts.place(part) }, &dofs[own], parameters);
    }

    fn fits(&self, dofs: &[u32], (block, item): Place, blocks: &Blocks) -> bool {
        let dofs = &dofs[self.dofs.clone()];
        blocks.of_type::<Q>(block).is_some_and(|block| block.alike(item, dofs, &self.parameters))
    }

    fn overwrite(self: Box<Self>, constraint: u32, parts: &mut Parts, (block, item): Place, blocks: &mut Blocks) {
        let owner = Owner { constraint, part: parts.place(self.part) };
        if let Some(block) = blocks.of_type_mut::<Q>(block) {
            block.overwrite(item, owner, self.parameters);
        }
    }
}
