//! The kept equations, each solved for its slave, in an order in which that can be done: peeled rows, eliminated rows, blocks.
//!
//! `u_s = sum_k value_k u_k + constant`, where no slave occurs in a later row. Going from the last row to the first, a vector
//! of masters and prescribed values is completed without T, in O(nnz). All in local numbers and the user's units.
//!
//! Peeled rows, which are most, are the user's equations as they are: they are read where they stand and never copied.

mod blocks;
mod row;

use std::ops::Range;

use crate::input::numbering::LocalSystem;
use crate::input::scale::{Scaling, ldexp};
use crate::presolve::eliminated::Step;

pub(crate) use blocks::{BlockDependent, Diagnosed, NEAR, Nearness, Solved, Vectors};
pub(crate) use row::Row;

/// Everything needed to express slaves by masters. A diagnosis has no rows of blocks: those are added when a reduction is wanted.
#[derive(Clone, Default)]
pub(crate) struct Basis {
    slaves: Vec<u32>,
    constants: Vec<f64>,
    /// The equations of the first rows, which are the user's own and stay where they are, ...
    pub peeled: Vec<u32>,
    /// ... and where the slave of each stands in its equation.
    positions: Vec<u32>,
    /// Where each of the other rows ends in `dofs` and `values`.
    ends: Vec<usize>,
    dofs: Vec<u32>,
    values: Vec<f64>,
    /// Scaled coefficients by which eliminated rows, which follow the peeled ones, were divided.
    pivots: Vec<f64>,
    /// As [`Step::reach`].
    reaches: Vec<f64>,
    /// The blocks, the rows of which come last.
    pub blocks: Vec<Kept>,
}

/// What remains of a block beside its rows.
#[derive(Clone)]
pub(crate) struct Kept {
    /// Indices of the kept rows among those that went through elimination.
    pub rows: Vec<u32>,
    /// Indices of `rows` in an order in which they fill little.
    pub order: Vec<u32>,
    /// How near to dependence the kept rows are.
    pub nearness: Nearness,
    /// Its free DOFs, ...
    pub dofs: Vec<u32>,
    /// ... and vectors over them.
    pub vectors: Vectors,
}

/// Rows, in order.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Part {
    Peeled,
    Eliminated,
    /// This block.
    Block(usize),
}

impl Basis {
    /// No rows; room for this many equations.
    pub fn with_capacity(rows: usize) -> Self {
        Self {
            slaves: Vec::with_capacity(rows),
            constants: Vec::with_capacity(rows),
            peeled: Vec::with_capacity(rows),
            positions: Vec::with_capacity(rows),
            ..Self::default()
        }
    }

    /// Takes equation `row` in, solved for `slave`, which stands at a position in it.
    #[inline]
    pub fn peel(&mut self, row: u32, slave: u32, position: usize, constant: f64) {
        self.slaves.push(slave);
        self.constants.push(constant);
        self.peeled.push(row);
        self.positions.push(position as u32);
    }

    fn close(&mut self, slave: u32, constant: f64) {
        self.slaves.push(slave);
        self.ends.push(self.dofs.len());
        self.constants.push(constant);
    }

    fn push_step(&mut self, step: &Step, scaling: &Scaling) {
        let own = scaling.col(step.dof as usize);
        for &(j, v) in &step.others {
            self.dofs.push(j);
            self.values.push(ldexp(-v / step.pivot, own - scaling.col(j as usize)));
        }
        self.close(step.dof, ldexp(step.rhs / step.pivot, own));
        self.pivots.push(step.pivot);
        self.reaches.push(step.reach);
    }

    fn push_block(&mut self, block: &Solved, scaling: &Scaling) {
        for (i, &slave) in block.slaves.iter().enumerate() {
            let own = scaling.col(slave as usize);
            for (k, v) in block.relation.row(i) {
                let other = block.others[k];
                self.dofs.push(other);
                self.values.push(ldexp(v, own - scaling.col(other as usize)));
            }
            self.close(slave, ldexp(block.constant[i], own));
        }
    }

    /// Appends what elimination found to the peeled rows, in the user's units, and takes note of the blocks.
    pub fn extend(&mut self, steps: Vec<Step>, blocks: impl Iterator<Item = (Vec<u32>, Diagnosed)>, scaling: &Scaling) {
        steps.into_iter().for_each(|step| self.push_step(&step, scaling));
        let kept = |(dofs, block)| {
            let Diagnosed { kept: rows, order, nearness, vectors, .. } = block;
            Kept { rows, order, nearness, dofs, vectors }
        };
        self.blocks.extend(blocks.map(kept));
    }

    /// The same with the rows of the blocks.
    pub fn with_blocks(&self, blocks: &[Solved], scaling: &Scaling) -> Self {
        let mut all = self.clone();
        blocks.iter().for_each(|block| all.push_block(block, scaling));
        all
    }

    /// Only the rows and blocks for which these hold.
    pub fn only(&self, row: impl Fn(usize) -> bool, block: impl Fn(usize) -> bool) -> Self {
        let mut some = Self::default();
        let first = self.peeled.len();
        for t in (0..first).filter(|&t| row(t)) {
            some.peel(self.peeled[t], self.slaves[t], self.positions[t] as usize, self.constants[t]);
        }
        for t in (first..self.rows()).filter(|&t| row(t)) {
            let range = self.stored(t);
            some.dofs.extend_from_slice(&self.dofs[range.clone()]);
            some.values.extend_from_slice(&self.values[range]);
            some.close(self.slaves[t], self.constants[t]);
            some.pivots.push(self.pivots[t - first]);
            some.reaches.push(self.reaches[t - first]);
        }
        some.blocks = (0..self.blocks.len()).filter(|&k| block(k)).map(|k| self.blocks[k].clone()).collect();
        some
    }

    /// Takes a slave in whose row is empty: it is given elsewhere.
    pub fn place(&mut self, slave: u32, constant: f64) {
        self.close(slave, constant);
    }

    /// Number of eliminated rows.
    pub fn steps(&self) -> usize {
        self.pivots.len()
    }

    /// Number of rows that are there.
    pub fn rows(&self) -> usize {
        self.slaves.len()
    }

    /// Number of kept equations.
    pub fn rank(&self) -> usize {
        self.peeled.len() + self.steps() + self.blocks.iter().map(|block| block.rows.len()).sum::<usize>()
    }

    #[inline]
    pub fn slave(&self, t: usize) -> u32 {
        self.slaves[t]
    }

    pub fn slaves(&self) -> &[u32] {
        &self.slaves
    }

    pub fn constants(&self) -> &[f64] {
        &self.constants
    }

    /// The scaled coefficient by which the row of a step was divided.
    pub fn pivot_of_step(&self, step: usize) -> f64 {
        self.pivots[step]
    }

    /// As [`Step::reach`].
    pub fn reach_of_step(&self, step: usize) -> f64 {
        self.reaches[step]
    }

    /// The scaled coefficient of row t, peeled or eliminated, the terms of which are given.
    #[inline]
    pub fn pivot(&self, t: usize, terms: &Row, scaling: &Scaling) -> f64 {
        match self.peeled.get(t) {
            Some(&row) => scaling.entry(row as usize, self.slaves[t] as usize, terms.pivot()),
            None => self.pivots[t - self.peeled.len()],
        }
    }

    /// Number of terms of row t.
    #[inline]
    pub fn length(&self, system: LocalSystem, t: usize) -> usize {
        match self.peeled.get(t) {
            Some(&row) => system.length(row as usize) - 1,
            None => self.stored(t).len(),
        }
    }

    /// Where the terms of a row are that is not the user's.
    fn stored(&self, t: usize) -> Range<usize> {
        let k = t - self.peeled.len();
        (if k == 0 { 0 } else { self.ends[k - 1] })..self.ends[k]
    }

    /// Row t; of the system that was peeled.
    #[expect(clippy::inline_always, reason = "out of line it was a twentieth of the profile of an elimination")]
    #[inline(always)]
    pub fn row<'a>(&'a self, system: LocalSystem<'a>, t: usize) -> Row<'a> {
        if let Some(&row) = self.peeled.get(t) {
            let (dofs, values) = system.parts(row as usize);
            return Row::solved(dofs, values, self.positions[t] as usize);
        }
        let range = self.stored(t);
        Row::new(&self.dofs[range.clone()], &self.values[range])
    }

    /// Bounds of the rows of T: their own largest coefficients, infinite where they name other slaves.
    pub fn bounds(&self, system: LocalSystem) -> Vec<f64> {
        let mut is_slave = vec![false; system.dofs()];
        self.slaves.iter().for_each(|&slave| is_slave[slave as usize] = true);
        let size = |(j, v): (u32, f64)| if is_slave[j as usize] { f64::INFINITY } else { v.abs() };
        (0..self.rows()).map(|t| self.row(system, t).entries().map(size).fold(0.0, f64::max)).collect()
    }

    /// Where row t comes from, blocks counted as one each.
    pub fn part(&self, t: usize) -> Part {
        if t < self.peeled.len() {
            Part::Peeled
        } else if t < self.peeled.len() + self.steps() {
            Part::Eliminated
        } else {
            Part::Block(t - self.peeled.len() - self.steps())
        }
    }

    /// Completes u, in which masters and prescribed DOFs are set.
    pub fn complete(&self, system: LocalSystem, u: &mut [f64]) {
        self.complete_with(system, &self.constants, u);
    }

    /// The same with other constants.
    pub fn complete_with(&self, system: LocalSystem, constants: &[f64], u: &mut [f64]) {
        for t in (0..self.rows()).rev() {
            let sum: f64 = self.row(system, t).entries().map(|(j, v)| v * u[j as usize]).sum();
            u[self.slaves[t] as usize] = constants[t] + sum;
        }
    }
}
