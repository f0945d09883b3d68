//! The nonlinear equations of all types: one batch for each type, in the order of first use, the items of a type sorted by constraint.

#[cfg(test)]
mod compare;
pub mod typed;

use std::any::{Any, TypeId};
use std::collections::HashMap;
use std::ops::Range;

use crate::equations::dof_uses::UncertainDofs;
use crate::equations::nonlinear::typed::TypedBatch;
use crate::equations::{EquationNames, EquationOwner};
use crate::nonlinear::Nonlinear;
use crate::scalar::Bounded;
#[cfg(test)]
use crate::scalar::double_double::DoubleDouble;

/// A batch: all items of one type. An item holds the parameters and the DOFs of one call of [`crate::EquationSink::nonlinear`].
pub trait NonlinearBatch: Send + Sync {
    fn items(&self) -> usize;
    /// Names of the equations of each item.
    fn equation_names(&self) -> &'static [&'static str];
    fn owner(&self, i: usize) -> EquationOwner;
    /// Sum of the numbers of DOFs of some items. Multiplied by the number of equations per item, it gives the number of entries of these
    /// items in G.
    fn width(&self, items: Range<usize>) -> usize;
    /// Appends the pattern of the batch's rows of G. For each row, `col` gets the columns in ascending order, and `start` gets the length
    /// that `col` then has, which is where the next row starts.
    fn write_pattern(&self, start: &mut Vec<usize>, col: &mut Vec<u32>);
    /// Writes c and G of some items.
    fn evaluate(&self, items: Range<usize>, u: &[f64], c: &mut [f64], g: &mut [f64]);
    /// Writes bounds on the rounding errors of c and G of some items.
    fn rounding(&self, items: Range<usize>, known: &UncertainDofs, c: &mut [f64], g: &mut [f64]);
    /// How many numbers [`Nonlinear::hessian`] computes for some items.
    fn numbers(&self, items: Range<usize>) -> usize;
    /// Calls `entry(row, column, number)` for each contribution to H. `number` is the index of its value in the list of all Hessian
    /// numbers, in which those of this batch start at `first`.
    fn entries(&self, first: usize, entry: &mut dyn FnMut(u32, u32, u32));
    /// Writes the numbers of [`Nonlinear::hessian`] for some items, one item after the other; `w` are the weights of their equations.
    fn curvatures(&self, items: Range<usize>, u: &[f64], w: &[f64], out: &mut [f64]);
    /// The DOFs of an item.
    fn dofs_of(&self, i: usize) -> &[u32];
    /// Evaluates parameters that are functions of time. If a value is not finite, the error is `(row, value)`, where `row` is the first row
    /// of the item in this batch.
    fn set_time(&mut self, time: f64) -> Result<(), (usize, f64)>;
    /// Calls `found(row, angle)` for each prescribed angle; `row` is the first row of its item in this batch.
    fn angles(&self, found: &mut dyn FnMut(usize, f64));
    /// Removes item i, and appends its DOFs to `dofs`.
    fn take(&mut self, i: usize, names: &EquationNames, dofs: &mut Vec<u32>) -> Box<dyn StagedNonlinear>;
    fn as_any_mut(&mut self) -> &mut dyn Any;
    /// c and G in double-double arithmetic.
    #[cfg(test)]
    fn reference(&self, u: &[DoubleDouble]) -> [Vec<DoubleDouble>; 2];
    /// Compares every formula with dual numbers.
    #[cfg(test)]
    fn compare_with_duals(&self, u: &[f64]);
}

impl dyn NonlinearBatch + '_ {
    pub fn equations_per_item(&self) -> usize {
        self.equation_names().len()
    }

    pub fn rows(&self) -> usize {
        self.items() * self.equations_per_item()
    }

    /// The items of a constraint.
    pub fn items_of(&self, constraint: u32) -> Range<usize> {
        let first_from = |constraint: u32| {
            let (mut low, mut high) = (0, self.items());
            while low < high {
                let middle = low.midpoint(high);
                (low, high) =
                    if self.owner(middle).constraint < constraint { (middle + 1, high) } else { (low, middle) };
            }
            low
        };
        first_from(constraint)..first_from(constraint + 1)
    }
}

/// An item of any type that is not stored in a batch. The argument `dofs` holds the DOFs of all items of its constraint.
pub trait StagedNonlinear: Send + Sync {
    fn rows(&self) -> usize;
    /// Index of the batch of the item's type; `None` if the set has no such batch yet.
    fn kind(&self, nonlinear: &NonlinearEquations) -> Option<usize>;
    /// Evaluates parameters that are functions of time. The error is a value that is not finite.
    fn at_time(&mut self, time: f64) -> Result<(), f64>;
    /// The values `c(u)` of the item's equations, with bounds on their rounding errors.
    fn values(&self, dofs: &[u32], u: &[f64]) -> Vec<Bounded>;
    /// Stores the item in the batch of its type.
    fn commit(
        self: Box<Self>,
        constraint: u32,
        dofs: &[u32],
        names: &mut EquationNames,
        nonlinear: &mut NonlinearEquations,
    );
    /// Whether the item at `place`, `(batch, item)`, has the same type, DOFs and DOF pairs, so that this one can replace it.
    fn fits(&self, dofs: &[u32], place: (usize, usize), nonlinear: &mut NonlinearEquations) -> bool;
    /// Replaces the item at `place` by this one.
    fn overwrite(
        self: Box<Self>,
        constraint: u32,
        names: &mut EquationNames,
        place: (usize, usize),
        nonlinear: &mut NonlinearEquations,
    );
}

/// All batches of a set.
#[derive(Default)]
pub struct NonlinearEquations {
    pub batches: Vec<Box<dyn NonlinearBatch>>,
    of_type: HashMap<TypeId, usize>,
}

impl NonlinearEquations {
    pub fn rows(&self) -> usize {
        self.batches.iter().map(|batch| batch.rows()).sum()
    }

    /// Each batch with its first row.
    pub fn with_rows(&self) -> impl Iterator<Item = (usize, &dyn NonlinearBatch)> {
        let first = |row: &mut usize, batch: &dyn NonlinearBatch| std::mem::replace(row, *row + batch.rows());
        self.batches.iter().scan(0, move |row, batch| Some((first(row, batch.as_ref()), batch.as_ref())))
    }

    /// Evaluates parameters that are functions of time. If a value is not finite, the error is `(row, value)`, where `row` is the first row
    /// of the item, counted from the first nonlinear row.
    pub fn set_time(&mut self, time: f64) -> Result<(), (usize, f64)> {
        let mut first = 0;
        self.batches.iter_mut().try_for_each(|batch| {
            batch.set_time(time).map_err(|(row, value)| (first + row, value))?;
            first += batch.rows();
            Ok(())
        })
    }

    pub fn kind<Q: Nonlinear>(&self) -> Option<usize> {
        self.of_type.get(&TypeId::of::<Q>()).copied()
    }

    /// The batch with this number; `None` if there is none, or if its items have another type.
    pub fn typed_mut<Q: Nonlinear>(&mut self, batch: usize) -> Option<&mut TypedBatch<Q>> {
        self.batches.get_mut(batch)?.as_any_mut().downcast_mut()
    }

    /// Inserts an item of the constraint `owner.constraint`. Items are sorted by their constraints; the new one comes last among those of
    /// its constraint.
    pub fn insert<Q: Nonlinear>(&mut self, owner: EquationOwner, dofs: &[u32], parameters: Q) {
        let next = self.batches.len();
        let kind = *self.of_type.entry(TypeId::of::<Q>()).or_insert(next);
        if kind == next {
            self.batches.push(Box::new(TypedBatch::<Q>::default()));
        }
        if let Some(batch) = self.typed_mut::<Q>(kind) {
            batch.insert(owner, dofs, parameters);
        }
    }

    /// `(batch, item)` of the items of a constraint, type by type.
    pub fn items_of(&self, constraint: u32) -> Vec<(usize, usize)> {
        let each = self.batches.iter().enumerate();
        each.flat_map(|(b, batch)| batch.items_of(constraint).map(move |item| (b, item))).collect()
    }

    /// Removes and returns the items of a constraint, and their DOFs.
    pub fn take(&mut self, constraint: u32, names: &EquationNames) -> (Vec<Box<dyn StagedNonlinear>>, Vec<u32>) {
        let mut dofs = Vec::new();
        // The last item goes first, so that the indices of the remaining ones stay valid.
        let places = self.items_of(constraint).into_iter().rev();
        let mut pieces: Vec<_> = places.map(|(b, item)| self.batches[b].take(item, names, &mut dofs)).collect();
        pieces.reverse();
        (pieces, dofs)
    }
}
