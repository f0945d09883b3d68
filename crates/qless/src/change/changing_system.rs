//! Constraints that come and go: contact, staged construction.
//!
//! ```text
//! add, remove, change, prescribe, release  ->  equations and DOFs touched
//! update  ->  blocks that hold them, split or joined anew  ->  analyse and reduce these  ->  kinds, u_s = T u_q + G u_p + g
//! ```
//!
//! Equations that share a free DOF form a block, and blocks know nothing of each other: what a change costs depends on the blocks that
//! it touches, not on the model. A block's system holds its equations in the order in which they were added and its DOFs in
//! ascending order, so that the results are those of a fresh run, to the last bit.

use rayon::prelude::*;

use super::network::Network;
use super::{ChangeError, EquationId, SolvedBlock};
use crate::common::argument::long;
use crate::{Kind, Options};

/// A set of equations that changes between steps.
///
/// ```
/// use qless::{ChangingSystem, Kind, Options};
/// let mut set = ChangingSystem::new(4, Options::default())?;
/// set.add([(0, 1.0), (1, -1.0)], 0.0)?;
/// set.add([(2, 1.0), (3, -1.0)], 0.0)?;
/// assert_eq!(set.update()?, 2);
/// // Contact closes the ring of the first two DOFs; the other block is not touched.
/// let closing = set.add([(0, 2.0), (1, -2.0)], 0.5)?;
/// assert_eq!(set.update()?, 1);
/// assert_eq!(set.kind(closing), Some(Kind::Conflicting));
/// set.set_rhs(closing, 0.0)?;
/// set.update()?;
/// assert_eq!((set.kind(closing), set.rank()), (Some(Kind::Redundant), 2));
/// # Ok::<(), qless::change::ChangeError>(())
/// ```
#[derive(Debug)]
pub struct ChangingSystem {
    network: Network,
    options: Options,
    blocks: Vec<Option<SolvedBlock>>,
    /// Places in `blocks` that are free.
    free: Vec<u32>,
    rank: usize,
}

impl ChangingSystem {
    /// No equations on DOFs 0 to `dofs - 1`. Preferences of the options are not used: they number whole systems.
    ///
    /// # Errors
    /// [`ChangeError::TooMany`] DOFs.
    pub fn new(dofs: usize, mut options: Options) -> Result<Self, ChangeError> {
        options.preferences = crate::Preferences::default();
        Ok(Self { network: Network::new(dofs)?, options, blocks: Vec::new(), free: Vec::new(), rank: 0 })
    }

    /// Adds `sum a_j u_j = rhs`; repeated DOFs are summed.
    ///
    /// # Errors
    /// [`ChangeError`] for a DOF out of range, a number that is not finite or one equation too many; then nothing changes.
    pub fn add(&mut self, terms: impl IntoIterator<Item = (usize, f64)>, rhs: f64) -> Result<EquationId, ChangeError> {
        self.network.add(terms.into_iter().collect(), rhs)
    }

    /// Takes an equation out.
    ///
    /// # Errors
    /// [`ChangeError::Gone`], [`ChangeError::Foreign`].
    pub fn remove(&mut self, equation: EquationId) -> Result<(), ChangeError> {
        self.network.remove(equation)
    }

    /// Gives an equation another right-hand side.
    ///
    /// # Errors
    /// [`ChangeError::Gone`], [`ChangeError::Foreign`], [`ChangeError::NotFinite`].
    pub fn set_rhs(&mut self, equation: EquationId, rhs: f64) -> Result<(), ChangeError> {
        self.network.set_rhs(equation, rhs)
    }

    /// Gives an equation other terms.
    ///
    /// # Errors
    /// [`ChangeError`]; then nothing changes.
    pub fn set_terms(
        &mut self,
        equation: EquationId,
        terms: impl IntoIterator<Item = (usize, f64)>,
    ) -> Result<(), ChangeError> {
        self.network.set_terms(equation, terms.into_iter().collect())
    }

    /// Gives a DOF a value, whether it had one or not.
    ///
    /// # Errors
    /// [`ChangeError::DofOutOfRange`], [`ChangeError::NotFinite`].
    pub fn prescribe(&mut self, dof: usize, value: f64) -> Result<(), ChangeError> {
        self.network.prescribe(dof, Some(value))
    }

    /// Makes a DOF free.
    ///
    /// # Errors
    /// [`ChangeError::DofOutOfRange`].
    pub fn release(&mut self, dof: usize) -> Result<(), ChangeError> {
        self.network.prescribe(dof, None)
    }

    /// Analyses and reduces what the changes since the last update touch; the number of blocks that were done.
    ///
    /// # Errors
    /// [`ChangeError::System`], [`ChangeError::Analysis`]; the changes stay to be done, the results are those before.
    pub fn update(&mut self) -> Result<usize, ChangeError> {
        let region = self.network.region(&|place| self.blocks[place as usize].as_ref().map(SolvedBlock::equations));
        let parts = self.network.parts(&region.equations);
        let solve = |part: &Vec<EquationId>| SolvedBlock::new(part, &self.network, &self.options);
        // A single block may have parallel work of its own; many share the threads between them.
        let solved: Result<Vec<SolvedBlock>, ChangeError> =
            if parts.len() < 2 { parts.iter().map(solve).collect() } else { parts.par_iter().map(solve).collect() };
        let solved = solved?;
        for &place in &region.blocks {
            if let Some(block) = self.blocks[place as usize].take() {
                self.rank -= block.rank();
                self.free.push(place);
            }
        }
        let done = solved.len();
        for block in solved {
            self.rank += block.rank();
            let place = self.free.pop().unwrap_or(self.blocks.len() as u32);
            self.network.place(block.equations(), place);
            if place as usize == self.blocks.len() {
                self.blocks.push(Some(block));
            } else {
                self.blocks[place as usize] = Some(block);
            }
        }
        self.network.settled();
        Ok(done)
    }

    /// What an equation is since the last update; none if it is not there, newer, or of another set.
    pub fn kind(&self, equation: EquationId) -> Option<Kind> {
        self.block_of(equation).and_then(|block| block.kind(equation))
    }

    /// Why an equation is dependent: `row_k = sum c_i row_i` over its free DOFs; empty for an independent one and for
    /// one that is newer than the last update.
    ///
    /// # Errors
    /// [`ChangeError::Gone`], [`ChangeError::Foreign`].
    pub fn because(&self, equation: EquationId) -> Result<Vec<(EquationId, f64)>, ChangeError> {
        self.network.number(equation)?;
        Ok(self.block_of(equation).map_or_else(Vec::new, |block| block.because(equation)))
    }

    /// The block of an equation since the last update.
    pub fn block_of(&self, equation: EquationId) -> Option<&SolvedBlock> {
        self.blocks.get(self.network.place_of(equation)? as usize)?.as_ref()
    }

    /// All blocks, in no particular order.
    pub fn blocks(&self) -> impl Iterator<Item = &SolvedBlock> {
        self.blocks.iter().flatten()
    }

    /// Rank of the free part of C: the number of slaves.
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// Number of equations.
    pub fn equations(&self) -> usize {
        self.network.equations()
    }

    /// Sets slaves and prescribed DOFs of all blocks in `u`, which holds the masters.
    ///
    /// # Errors
    /// [`ArgumentError`](crate::ArgumentError) if `u` does not have a number for each DOF, or one that is not finite; slaves may then have been set.
    pub fn expand(&self, u: &mut [f64]) -> Result<(), ChangeError> {
        long("u", u.len(), self.network.dofs())?;
        self.network.given().for_each(|(dof, value)| u[dof] = value);
        self.blocks().try_for_each(|block| block.expand(u))
    }
}
