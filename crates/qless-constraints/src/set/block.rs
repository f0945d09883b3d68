//! What a set asks of the nonlinear equations of one type.

use std::any::{Any, TypeId};
use std::collections::HashMap;
use std::ops::Range;

use qless::{Csr, SystemError};

use super::homogeneous::Homogeneous;
use super::labels::Owner;
use super::rounding::Known;
#[cfg(test)]
use super::tests::double_double::DoubleDouble;
use crate::constraint::Nonlinear;

/// Equations of one type.
pub(super) trait Block: Send + Sync {
    fn rows(&self) -> usize;
    fn items(&self) -> usize;
    fn owner(&self, row: usize) -> (&Owner, &'static str);
    /// Appends the rows of G, with zeros in them.
    fn write_pattern(&mut self, g: &mut Csr) -> Result<(), SystemError>;
    /// Constraints per task.
    fn chunk(&self) -> usize;
    /// Rows and entries of G of the task that starts with constraint `first`.
    fn task(&self, first: usize) -> (usize, usize);
    /// A DOF of constraint `i`.
    fn first_dof(&self, i: usize) -> u32;
    /// Writes c and G of that task.
    fn evaluate(&self, first: usize, u: &[f64], c: &mut [f64], g: &mut [f64]);
    /// Writes the bounds on the rounding of c and G of that task.
    fn rounding(&self, first: usize, known: &Known, c: &mut [f64], g: &mut [f64]);
    /// Calls `pair` with the global DOFs of each pair of constraint `i`, and which of its numbers it takes.
    fn pairs(&self, i: usize, pair: &mut dyn FnMut(u32, u32, usize));
    /// How many numbers the Hessian of constraint `i` has.
    fn numbers(&self, i: usize) -> usize;
    /// Writes the numbers of the Hessians of these constraints, one after the other.
    fn curvatures(&self, items: &[Range<u32>], u: &[f64], w: &[f64], out: &mut [f64]);
    /// Calls `found` with the DOFs of each constraint, and where rotation vectors are among them.
    fn rotation_vectors(&self, found: &mut dyn FnMut(&[u32], &[usize]));
    /// Takes the parameters of this time, where they are functions of it.
    fn set_time(&mut self, time: f64);
    fn as_any(&mut self) -> &mut dyn Any;
    /// c and G in twice the digits.
    #[cfg(test)]
    fn reference(&self, u: &[DoubleDouble]) -> [Vec<DoubleDouble>; 2];
    /// Compares every formula with dual numbers.
    #[cfg(test)]
    fn compare_with_duals(&self, u: &[f64]);
}

/// All blocks, in the order of first use.
#[derive(Default)]
pub(super) struct Blocks {
    pub all: Vec<Box<dyn Block>>,
    of_type: HashMap<TypeId, usize>,
}

impl Blocks {
    pub fn rows(&self) -> usize {
        self.all.iter().map(|block| block.rows()).sum()
    }

    pub fn push<Q: Nonlinear>(&mut self, owner: Owner, dofs: &[u32], parameters: Q) {
        let next = self.all.len();
        let place = *self.of_type.entry(TypeId::of::<Q>()).or_insert(next);
        if place == next {
            self.all.push(Box::new(Homogeneous::<Q>::default()));
        }
        if let Some(block) = self.all[place].as_any().downcast_mut::<Homogeneous<Q>>() {
            block.push(owner, dofs, parameters);
        }
    }
}
