//! Equations that are added and removed between steps: contact, staged construction.
//!
//! ```text
//! add, remove, change, prescribe, release  ->  equations and DOFs touched
//! update  ->  blocks that contain them, split or joined  ->  analyse and reduce these  ->  kinds, u_s = T u_q + G u_p + g
//! ```
//!
//! Equations that share a free DOF are in the same block, and blocks are independent. So the cost of a change depends on the blocks that it
//! touches, not on the model. A block has its equations in the order of their addition and its DOFs in ascending order, so that the
//! results equal those of a new analysis, to the last bit.

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
/// // Contact adds a second equation on the first two DOFs; the other block is not touched.
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
    /// Indices of unused entries of `blocks`.
    free: Vec<u32>,
    rank: usize,
}

impl ChangingSystem {
    /// A set without equations on DOFs 0 to `dofs - 1`. The preferences of the options are ignored, because their equation numbers refer
    /// to a fixed system.
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
    /// [`ChangeError`] for a DOF out of range, a number that is not finite or too many equations; then nothing changes.
    pub fn add(&mut self, terms: impl IntoIterator<Item = (usize, f64)>, rhs: f64) -> Result<EquationId, ChangeError> {
        self.network.add(terms.into_iter().collect(), rhs)
    }

    /// Removes an equation.
    ///
    /// # Errors
    /// [`ChangeError::Gone`], [`ChangeError::Foreign`].
    pub fn remove(&mut self, equation: EquationId) -> Result<(), ChangeError> {
        self.network.remove(equation)
    }

    /// Changes the right-hand side of an equation.
    ///
    /// # Errors
    /// [`ChangeError::Gone`], [`ChangeError::Foreign`], [`ChangeError::NotFinite`].
    pub fn set_rhs(&mut self, equation: EquationId, rhs: f64) -> Result<(), ChangeError> {
        self.network.set_rhs(equation, rhs)
    }

    /// Replaces the terms of an equation.
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

    /// Prescribes the value of a DOF, free or prescribed.
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

    /// Analyses and reduces the blocks that changed since the last update; returns their number.
    ///
    /// # Errors
    /// [`ChangeError::System`], [`ChangeError::Analysis`], [`ChangeError::Reduction`]. Then the results are unchanged, and the next update
    /// tries again.
    pub fn update(&mut self) -> Result<usize, ChangeError> {
        let region = self.network.region(&|place| self.blocks[place as usize].as_ref().map(SolvedBlock::equations));
        let parts = self.network.parts(&region.equations);
        let solve = |part: &Vec<EquationId>| SolvedBlock::new(part, &self.network, &self.options);
        // The analysis of a single block uses all threads; many blocks run in parallel.
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
        self.network.clear_changes();
        Ok(done)
    }

    /// The kind of an equation as of the last update; None if it was removed, added later, or belongs to another set.
    pub fn kind(&self, equation: EquationId) -> Option<Kind> {
        self.block_of(equation).and_then(|block| block.kind(equation))
    }

    /// The certificate of a dependent equation: `row_k = sum c_i row_i` on the free DOFs. Empty for an independent equation and for one
    /// that was added after the last update.
    ///
    /// # Errors
    /// [`ChangeError::Gone`], [`ChangeError::Foreign`].
    pub fn because(&self, equation: EquationId) -> Result<Vec<(EquationId, f64)>, ChangeError> {
        self.network.number(equation)?;
        Ok(self.block_of(equation).map_or_else(Vec::new, |block| block.because(equation)))
    }

    /// The block of an equation as of the last update.
    pub fn block_of(&self, equation: EquationId) -> Option<&SolvedBlock> {
        self.blocks.get(self.network.place_of(equation)? as usize)?.as_ref()
    }

    /// All blocks, in no particular order.
    pub fn blocks(&self) -> impl Iterator<Item = &SolvedBlock> {
        self.blocks.iter().flatten()
    }

    /// Rank of C in the columns of the free DOFs, which is also the number of slaves.
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// Number of equations.
    pub fn equations(&self) -> usize {
        self.network.equations()
    }

    /// Sets all prescribed DOFs and the slaves of all blocks in `u`, which holds the values of the masters.
    ///
    /// # Errors
    /// [`ArgumentError`](crate::ArgumentError) if `u` has a wrong length or a number that is not finite. Some entries of `u` may then be
    /// set already.
    pub fn expand(&self, u: &mut [f64]) -> Result<(), ChangeError> {
        long("u", u.len(), self.network.dofs())?;
        self.network.prescribed_dofs().for_each(|(dof, value)| u[dof] = value);
        self.blocks().try_for_each(|block| block.expand(u))
    }
}
