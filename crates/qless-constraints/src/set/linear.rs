//! All linear equations, `c = G u - b`, in the order of their constraints; their rows of G do not depend on u.

use std::collections::BTreeMap;
use std::ops::Range;

use super::batch::{Batch, ROWS};
use super::labels::{Owner, Parts};
use super::lists::Recent;
use super::offsets::Offsets;
use super::store::Equation;
use super::time::{Function, Rhs};

/// Linear equations, whatever types they come from.
#[derive(Default)]
pub(super) struct Rows {
    pub batches: Vec<Batch>,
    offsets: Offsets,
    recent: Recent,
    /// Right-hand sides that are functions of time, by constraint and place among its linear equations.
    driven: BTreeMap<(u32, u32), Function>,
}

impl Rows {
    pub fn rows(&self) -> usize {
        self.offsets.rows()
    }

    pub fn nnz(&self) -> usize {
        self.batches.iter().map(Batch::nnz).sum()
    }

    pub fn owner(&self, row: usize) -> Owner {
        let (batch, own) = self.offsets.find(row);
        self.batches[batch].owners[own]
    }

    /// The equations of a constraint.
    pub fn of(&self, constraint: u32) -> Range<usize> {
        self.first_from(constraint)..self.first_from(constraint + 1)
    }

    /// The first equation of this constraint or of one that was added later.
    fn first_from(&self, constraint: u32) -> usize {
        let ends_before = |batch: &Batch| batch.owners.last().is_none_or(|owner| owner.constraint < constraint);
        let batch = self.batches.partition_point(ends_before);
        let inside = self.batches.get(batch);
        let own = inside.map_or(0, |batch| batch.owners.partition_point(|owner| owner.constraint < constraint));
        self.offsets.first(batch) + own
    }

    /// Puts equations of one constraint behind those that it has.
    pub fn put(&mut self, constraint: u32, equations: &mut Vec<Equation>, parts: &mut Parts, time: f64) {
        if equations.is_empty() {
            return;
        }
        let last = self.batches.last().and_then(|batch| batch.owners.last());
        let behind = last.is_none_or(|last| last.constraint < constraint);
        let of = if behind { self.rows()..self.rows() } else { self.of(constraint) };
        for (row, equation) in (of.end..).zip(equations.drain(..)) {
            let owner = Owner { constraint, part: parts.place(equation.part) };
            self.insert(row, owner, &equation.terms, equation.rhs.at(time));
            if let Rhs::Function(function) = equation.rhs {
                self.driven.insert((constraint, (row - of.start) as u32), function);
            }
        }
    }

    fn insert(&mut self, row: usize, owner: Owner, terms: &[(u32, f64)], rhs: f64) {
        let (batch, own) = self.room_at(row);
        self.batches[batch].insert(own, owner, terms, rhs, &mut self.recent);
        self.offsets.grow(batch, 1);
    }

    /// The batch in which a row can be put, and its place there.
    fn room_at(&mut self, row: usize) -> (usize, usize) {
        if row == self.rows() {
            if self.batches.last().is_none_or(|batch| batch.rows() == ROWS) {
                self.offsets.insert(self.batches.len());
                let mut batch = Batch::empty();
                if !self.batches.is_empty() {
                    batch.owners.reserve_exact(ROWS);
                    batch.rhs.reserve_exact(ROWS);
                }
                self.batches.push(batch);
            }
            let last = self.batches.len() - 1;
            return (last, row - self.offsets.first(last));
        }
        let (batch, own) = self.offsets.find(row);
        if self.batches[batch].rows() < ROWS {
            return (batch, own);
        }
        let second = self.batches[batch].split_off(ROWS / 2);
        self.offsets.split(batch, ROWS / 2);
        self.batches.insert(batch + 1, second);
        self.offsets.find(row)
    }

    /// Takes the equations of a constraint out.
    pub fn take(&mut self, constraint: u32, parts: &Parts) -> Vec<Equation> {
        let of = self.of(constraint);
        (0..of.len() as u32).map(|k| self.take_row(of.start, (constraint, k), parts)).collect()
    }

    fn take_row(&mut self, row: usize, key: (u32, u32), parts: &Parts) -> Equation {
        let (batch, own) = self.offsets.find(row);
        let (owner, terms, rhs) = self.batches[batch].remove(own);
        self.offsets.grow(batch, -1);
        if self.batches[batch].rows() == 0 {
            self.batches.remove(batch);
            self.offsets.remove(batch);
        }
        let rhs = self.driven.remove(&key).map_or(Rhs::Value(rhs), Rhs::Function);
        Equation { part: parts.name(owner.part), terms, rhs }
    }

    /// Gives the equations of a constraint, as many as it has, others: what does not change stays.
    pub fn overwrite(&mut self, constraint: u32, equations: Vec<Equation>, parts: &mut Parts, time: f64) {
        let of = self.of(constraint);
        for ((k, row), equation) in (0..).zip(of).zip(equations) {
            let (batch, own) = self.offsets.find(row);
            let (batch, owner) = (&mut self.batches[batch], Owner { constraint, part: parts.place(equation.part) });
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
            if let Rhs::Function(function) = equation.rhs {
                self.driven.insert((constraint, k), function);
            }
        }
    }

    /// Rows with their right-hand sides in time.
    pub fn driven(&self) -> impl Iterator<Item = (usize, &Function)> {
        self.driven.iter().map(|(&(constraint, k), function)| (self.first_from(constraint) + k as usize, function))
    }

    /// Gives a constraint right-hand sides that are no functions of time any more.
    pub fn set_values(&mut self, constraint: u32, rhs: &[f64]) {
        for ((k, row), &rhs) in (0..).zip(self.of(constraint)).zip(rhs) {
            self.driven.remove(&(constraint, k));
            self.set_rhs(row, rhs);
        }
    }

    pub fn set_rhs(&mut self, row: usize, rhs: f64) {
        let (batch, own) = self.offsets.find(row);
        self.batches[batch].rhs[own] = rhs;
    }
}
