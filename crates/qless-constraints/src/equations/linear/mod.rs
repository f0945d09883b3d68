//! All linear equations of a set, `c = G u - b`, in the order of their constraints; their rows of G do not depend on u.

pub mod batch;
pub mod equal_length;

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ops::Range;

use crate::equations::linear::batch::{BATCH_ROWS, LinearBatch, LinearTerms};
use crate::equations::linear::equal_length::CoefficientCache;
use crate::equations::{EquationNames, EquationOwner, LinearRhs, RowOffsets, TimeFunction, renumber};

/// Linear equations of all types.
#[derive(Default)]
pub struct LinearEquations {
    pub batches: Vec<LinearBatch>,
    /// Reserve memory for full batches from the start.
    many: bool,
    offsets: RowOffsets,
    recent: CoefficientCache,
    /// Right-hand sides that are functions of time. Key: constraint, and index among its linear equations.
    driven: BTreeMap<(u32, u32), TimeFunction>,
}

impl LinearEquations {
    /// Empty, but expects many equations.
    pub fn for_many_items() -> Self {
        Self { many: true, ..Self::default() }
    }

    pub fn rows(&self) -> usize {
        self.offsets.rows()
    }

    pub fn nnz(&self) -> usize {
        self.batches.iter().map(|batch| batch.nnz).sum()
    }

    pub fn owner(&self, row: usize) -> EquationOwner {
        let (batch, own) = self.offsets.find(row);
        self.batches[batch].owners[own]
    }

    /// The rows of a constraint.
    pub fn rows_of(&self, constraint: u32) -> Range<usize> {
        self.first_from(constraint)..self.first_from(constraint + 1)
    }

    /// The first row of this constraint or of a later one.
    fn first_from(&self, constraint: u32) -> usize {
        let ends_before = |batch: &LinearBatch| batch.owners.last().is_none_or(|owner| owner.constraint < constraint);
        let batch = self.batches.partition_point(ends_before);
        let inside = self.batches.get(batch);
        let own = inside.map_or(0, |batch| batch.owners.partition_point(|owner| owner.constraint < constraint));
        self.offsets.first(batch) + own
    }

    /// Appends equations to those of a constraint, and empties the list.
    pub fn put(&mut self, constraint: u32, equations: &mut Vec<StagedEquation>, names: &mut EquationNames, time: f64) {
        if equations.is_empty() {
            return;
        }
        let last = self.batches.last().and_then(|batch| batch.owners.last());
        let behind = last.is_none_or(|last| last.constraint < constraint);
        let of = if behind { self.rows()..self.rows() } else { self.rows_of(constraint) };
        for (row, equation) in (of.end..).zip(equations.drain(..)) {
            let owner = EquationOwner { constraint, name: names.place(equation.name) };
            self.insert(row, owner, &equation.terms, equation.rhs.at(time));
            self.drive((constraint, (row - of.start) as u32), equation.rhs);
        }
    }

    fn drive(&mut self, key: (u32, u32), rhs: LinearRhs) {
        if let LinearRhs::TimeFunction(function) = rhs {
            self.driven.insert(key, function);
        }
    }

    /// Appends an equation after all others; it is the k-th of its constraint.
    pub fn append(&mut self, owner: EquationOwner, k: u32, (terms, rhs): (&[(u32, f64)], LinearRhs), time: f64) {
        self.insert(self.rows(), owner, terms, rhs.at(time));
        self.drive((owner.constraint, k), rhs);
    }

    /// Appends the equations of later constraints, whose names are renumbered by `names`.
    pub fn join(&mut self, others: Self, names: Option<&[u32]>) {
        for mut batch in others.batches {
            renumber(&mut batch.owners, names);
            self.offsets.push(batch.rows());
            self.batches.push(batch);
        }
        self.driven.extend(others.driven);
    }

    fn insert(&mut self, row: usize, owner: EquationOwner, terms: &[(u32, f64)], rhs: f64) {
        let (batch, own) = self.room_at(row);
        self.batches[batch].insert(own, owner, terms, rhs, &mut self.recent);
        self.offsets.grow(batch, 1);
    }

    /// The batch into which a row can be inserted, and the row's number there. A full batch is split first.
    fn room_at(&mut self, row: usize) -> (usize, usize) {
        if row == self.rows() {
            if self.batches.last().is_none_or(|batch| batch.rows() == BATCH_ROWS) {
                self.offsets.insert(self.batches.len());
                let mut batch = LinearBatch::empty();
                if self.many || !self.batches.is_empty() {
                    batch.owners.reserve_exact(BATCH_ROWS);
                    batch.rhs.reserve_exact(BATCH_ROWS);
                }
                self.batches.push(batch);
            }
            let last = self.batches.len() - 1;
            return (last, row - self.offsets.first(last));
        }
        let (batch, own) = self.offsets.find(row);
        if self.batches[batch].rows() < BATCH_ROWS {
            return (batch, own);
        }
        let second = self.batches[batch].split_off(BATCH_ROWS / 2);
        self.offsets.split(batch, BATCH_ROWS / 2);
        self.batches.insert(batch + 1, second);
        self.offsets.find(row)
    }

    /// Removes and returns the equations of a constraint.
    pub fn take(&mut self, constraint: u32, names: &EquationNames) -> Vec<StagedEquation> {
        let of = self.rows_of(constraint);
        (0..of.len() as u32).map(|k| self.take_row(of.start, (constraint, k), names)).collect()
    }

    fn take_row(&mut self, row: usize, key: (u32, u32), names: &EquationNames) -> StagedEquation {
        let (batch, own) = self.offsets.find(row);
        let (owner, terms, rhs) = self.batches[batch].remove(own);
        self.offsets.grow(batch, -1);
        if self.batches[batch].rows() == 0 {
            self.batches.remove(batch);
            self.offsets.remove(batch);
        }
        let rhs = self.driven.remove(&key).map_or(LinearRhs::Value(rhs), LinearRhs::TimeFunction);
        StagedEquation { name: names.name(owner.name), terms, rhs }
    }

    /// Replaces the equations of a constraint by as many others. Equations whose terms stay the same keep their place in memory.
    pub fn overwrite(&mut self, constraint: u32, equations: Vec<StagedEquation>, names: &mut EquationNames, time: f64) {
        let of = self.rows_of(constraint);
        for ((k, row), equation) in (0..).zip(of).zip(equations) {
            let (batch, own) = self.offsets.find(row);
            let (batch, owner) =
                (&mut self.batches[batch], EquationOwner { constraint, name: names.place(equation.name) });
            let rhs = equation.rhs.at(time);
            let same = |(a, b): (&(u32, f64), &(u32, f64))| a.0 == b.0 && a.1.to_bits() == b.1.to_bits();
            let old = batch.terms(own);
            if old.len() == equation.terms.len() && old.iter().zip(&equation.terms).all(same) {
                (batch.rhs[own], batch.owners[own]) = (rhs, owner);
            } else {
                batch.remove(own);
                batch.insert(own, owner, &equation.terms, rhs, &mut self.recent);
            }
            self.driven.remove(&(constraint, k));
            self.drive((constraint, k), equation.rhs);
        }
    }

    /// Rows whose right-hand sides are functions of time.
    pub fn driven(&self) -> impl Iterator<Item = (usize, &TimeFunction)> {
        self.driven.iter().map(|(&(constraint, k), function)| (self.first_from(constraint) + k as usize, function))
    }

    /// Sets constant right-hand sides; functions of time of this constraint are dropped.
    pub fn set_values(&mut self, constraint: u32, rhs: &[f64]) {
        for ((k, row), &rhs) in (0..).zip(self.rows_of(constraint)).zip(rhs) {
            self.driven.remove(&(constraint, k));
            self.set_rhs(row, rhs);
        }
    }

    pub fn set_rhs(&mut self, row: usize, rhs: f64) {
        let (batch, own) = self.offsets.find(row);
        self.batches[batch].rhs[own] = rhs;
    }
}

/// A linear equation that is not stored in a batch: `sum a_j u_j = rhs`, DOFs ascending.
pub struct StagedEquation {
    pub name: Cow<'static, str>,
    pub terms: LinearTerms,
    pub rhs: LinearRhs,
}
