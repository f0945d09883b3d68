//! Interfaces to nonlinear equations of any type, stored in a batch or staged outside of one.

use std::any::Any;
use std::ops::Range;

use qless::common::Identity;

use crate::equations::dof_uses::UncertainDofs;
use crate::equations::layout::ChunkRows;
use crate::equations::nonlinear::{ItemPlace, NonlinearEquations};
use crate::equations::{EquationNames, EquationOwner};
use crate::scalar::Bounded;
#[cfg(test)]
use crate::scalar::double_double::DoubleDouble;

/// Consecutive items of one type, as many as one task evaluates.
pub trait NonlinearBatch: Send + Sync {
    /// Renewed after each change of the batch's rows of G or of its pairs.
    fn stamp(&self) -> Identity;
    fn rows(&self) -> usize;
    fn items(&self) -> usize;
    /// Whether the batch accepts no more items.
    fn is_full(&self) -> bool;
    fn owner(&self, row: usize) -> (EquationOwner, &'static str);
    /// The constraint that item i belongs to.
    fn constraint(&self, i: usize) -> u32;
    /// Renumbers the names of its equations, as [`crate::equations::renumber`] does.
    fn renumber_names(&mut self, names: Option<&[u32]>);
    fn equations_per_item(&self) -> usize;
    /// Entries in the rows of G.
    fn nnz(&self) -> usize;
    /// Writes the columns and the ends of its rows of G; the first row starts at `first`.
    fn write_pattern(&self, first: usize, end: &mut [usize], col: &mut [u32]);
    /// Range of DOFs from the smallest to the largest.
    fn reach(&self) -> Range<u32>;
    /// Approximately the last DOF that it reads.
    fn last_dof(&self) -> u32;
    /// Writes c and G.
    fn evaluate(&self, u: &[f64], c: &mut [f64], g: &mut [f64]);
    /// Writes bounds on the rounding errors of c and G.
    fn rounding(&self, known: &UncertainDofs, c: &mut [f64], g: &mut [f64]);
    /// Adds the contributions of some items to each row of H, from `row` on.
    fn count(&self, items: &[Range<u32>], row: u32, counts: &mut [u32]);
    /// Calls `row` with each row of H to which item i contributes.
    fn touched(&self, i: usize, row: &mut dyn FnMut(u32));
    /// Appends `(chunk, item)` for each of these items and each reported chunk of H to which it contributes.
    fn assign_to_chunks(&self, items: &[Range<u32>], cut: &ChunkRows, out: &mut Vec<(u32, u32)>);
    /// Writes the keys `(column, number)` of the contributions that [`NonlinearBatch::count`] counts, at the positions `next` of each row.
    ///
    /// Hessian numbers are counted from `first`.
    fn keys(&self, items: &[Range<u32>], row: u32, first: usize, next_and_keys: (&mut [u32], &mut [u64]));
    /// Length of the Hessian of item i, as a list of numbers.
    fn numbers(&self, i: usize) -> usize;
    /// Writes the Hessian numbers of these items, one item after the other.
    fn curvatures(&self, items: &[Range<u32>], u: &[f64], w: &[f64], out: &mut [f64]);
    /// Calls `found` with the DOFs of each item, and the positions among them at which rotation vectors start.
    fn rotation_vectors(&self, found: &mut dyn FnMut(&[u32], &[usize]));
    /// Evaluates parameters that are functions of time.
    ///
    /// The error is the first row whose value is not finite, and that value.
    fn set_time(&mut self, time: f64) -> Result<(), (usize, f64)>;
    /// Calls `found` with each prescribed angle, and the first row that it occurs in.
    fn angles(&self, found: &mut dyn FnMut(usize, f64));
    /// Moves the items from i on to a new batch.
    fn split_off(&mut self, i: usize) -> Box<dyn NonlinearBatch>;
    /// Removes item i, and appends its DOFs to `dofs`.
    fn take(&mut self, i: usize, names: &EquationNames, dofs: &mut Vec<u32>) -> Box<dyn StagedNonlinear>;
    fn as_any(&self) -> &dyn Any;
    fn as_any_mut(&mut self) -> &mut dyn Any;
    /// c and G in double-double arithmetic.
    #[cfg(test)]
    fn reference(&self, u: &[DoubleDouble]) -> [Vec<DoubleDouble>; 2];
    /// Compares every formula with dual numbers.
    #[cfg(test)]
    fn compare_with_duals(&self, u: &[f64]);
}

/// Nonlinear equations of one constraint, of any type, that are not stored in a batch.
pub trait StagedNonlinear: Send + Sync {
    fn rows(&self) -> usize;
    /// The number of their type in the set; `None` if the set does not know the type yet.
    fn kind(&self, nonlinear: &NonlinearEquations) -> Option<u32>;
    /// Evaluates parameters that are functions of time. The error is a value that is not finite.
    fn at_time(&mut self, time: f64) -> Result<(), f64>;
    /// c at u, with bounds on its rounding errors. `dofs` are those of all nonlinear pieces of the constraint.
    fn values(&self, dofs: &[u32], u: &[f64]) -> Vec<Bounded>;
    /// Stores the item in a batch of its type. `dofs` are those of all nonlinear pieces of the constraint.
    fn commit(
        self: Box<Self>,
        constraint: u32,
        dofs: &[u32],
        names: &mut EquationNames,
        nonlinear: &mut NonlinearEquations,
    );
    /// Whether the item at `place` has the same type, DOFs and pairs, so that this one can replace it.
    fn fits(&self, dofs: &[u32], place: ItemPlace, nonlinear: &NonlinearEquations) -> bool;
    /// Replaces the item at `place`.
    fn overwrite(
        self: Box<Self>,
        constraint: u32,
        names: &mut EquationNames,
        place: ItemPlace,
        nonlinear: &mut NonlinearEquations,
    );
}
