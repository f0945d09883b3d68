//! What a set asks of the nonlinear equations of one type.
//! Nonlinear equations that are not among those of their type.

use std::any::Any;
use std::ops::Range;

use qless::common::Identity;

use crate::equations::coordinates::UncertainDofs;
use crate::equations::layout::ChunkRows;
use crate::equations::nonlinear::{ItemPlace, NonlinearEquations};
use crate::equations::{EquationNames, EquationOwner};
#[cfg(test)]
use crate::scalar::double_double::DoubleDouble;

/// Equations of one type that follow one another: as many as one task takes.
pub trait NonlinearBatch: Send + Sync {
    /// Another one after each change of its rows of G or of its pairs.
    fn stamp(&self) -> Identity;
    fn rows(&self) -> usize;
    fn items(&self) -> usize;
    /// Whether no more constraints go in.
    fn is_full(&self) -> bool;
    fn owner(&self, row: usize) -> (EquationOwner, &'static str);
    /// To which constraint the equations of item i belong.
    fn constraint(&self, i: usize) -> u32;
    /// Gives the names that its equations are the numbers that stand at theirs.
    fn renumber_names(&mut self, names: Option<&[u32]>);
    /// Equations of each item.
    fn equations_per_item(&self) -> usize;
    /// Entries of its rows of G.
    fn nnz(&self) -> usize;
    /// Writes the columns of its rows of G, and where these end; the first starts at `first`.
    fn write_pattern(&self, first: usize, end: &mut [usize], col: &mut [u32]);
    /// From its smallest DOF to behind its largest.
    fn reach(&self) -> Range<u32>;
    /// Nearly the last DOF that it reads.
    fn last_dof(&self) -> u32;
    /// Writes c and G.
    fn evaluate(&self, u: &[f64], c: &mut [f64], g: &mut [f64]);
    /// Writes the bounds on the rounding of c and G.
    fn rounding(&self, known: &UncertainDofs, c: &mut [f64], g: &mut [f64]);
    /// Counts the entries that some items have in each of the rows of H from `row` on.
    fn count(&self, items: &[Range<u32>], row: u32, counts: &mut [u32]);
    /// Calls `row` with the rows of H that item i has entries in.
    fn touched(&self, i: usize, row: &mut dyn FnMut(u32));
    /// Appends `(chunk, item)` for each of some items and the chunks of H that it has entries in.
    fn share_out(&self, items: &[Range<u32>], cut: &ChunkRows, out: &mut Vec<(u32, u32)>);
    /// Puts `(column, number)` of the entries that [`NonlinearBatch::count`] counts where `next` says for each row; numbers from `first` on.
    fn keys(&self, items: &[Range<u32>], row: u32, first: usize, next_and_keys: (&mut [u32], &mut [u64]));
    /// How many numbers the Hessian of item i has.
    fn numbers(&self, i: usize) -> usize;
    /// Writes the numbers of the Hessians of these items, one after the other.
    fn curvatures(&self, items: &[Range<u32>], u: &[f64], w: &[f64], out: &mut [f64]);
    /// Calls `found` with the DOFs of each item, and where rotation vectors are among them.
    fn rotation_vectors(&self, found: &mut dyn FnMut(&[u32], &[usize]));
    /// Takes the parameters of this time, where they are functions of it.
    ///
    /// As an error the first row with a number that is not finite, and that number.
    fn set_time(&mut self, time: f64) -> Result<(), (usize, f64)>;
    /// Calls `found` with each angle that is prescribed, and the first row that it is in.
    fn angles(&self, found: &mut dyn FnMut(usize, f64));
    /// The items from i on, in a batch of their own.
    fn split_off(&mut self, i: usize) -> Box<dyn NonlinearBatch>;
    /// Takes item i out, and appends its DOFs.
    fn take(&mut self, i: usize, names: &EquationNames, dofs: &mut Vec<u32>) -> Box<dyn StagedNonlinear>;
    fn as_any(&self) -> &dyn Any;
    fn as_any_mut(&mut self) -> &mut dyn Any;
    /// c and G in twice the digits.
    #[cfg(test)]
    fn reference(&self, u: &[DoubleDouble]) -> [Vec<DoubleDouble>; 2];
    /// Compares every formula with dual numbers.
    #[cfg(test)]
    fn compare_with_duals(&self, u: &[f64]);
}

/// Those of one constraint, of whatever type.
pub trait StagedNonlinear: Send + Sync {
    fn rows(&self) -> usize;
    /// Which type of the set it is of; none if the set has not met it.
    fn kind(&self, nonlinear: &NonlinearEquations) -> Option<u32>;
    /// Takes the parameters of this time; as an error the number of it that is not finite.
    fn at_time(&mut self, time: f64) -> Result<(), f64>;
    /// Puts it among those of its type; the DOFs of all pieces of its constraint and its names are given.
    fn commit(
        self: Box<Self>,
        constraint: u32,
        dofs: &[u32],
        names: &mut EquationNames,
        nonlinear: &mut NonlinearEquations,
    );
    /// Whether it has the DOFs and pairs of an equation of its type, so that it can take its place.
    fn fits(&self, dofs: &[u32], place: ItemPlace, nonlinear: &NonlinearEquations) -> bool;
    /// Takes that place.
    fn overwrite(
        self: Box<Self>,
        constraint: u32,
        names: &mut EquationNames,
        place: ItemPlace,
        nonlinear: &mut NonlinearEquations,
    );
}
