//! The kept equations, each solved for its slave: first the peeled rows, then the eliminated rows, then the blocks.
//!
//! Each row is `u_s = sum_k value_k u_k + constant`, and no slave occurs in a later row. So substitution from the last row to the first
//! computes the slaves from masters and prescribed values without T, in O(nnz). DOFs have local numbers; values are in the user's units.
//!
//! Most rows are peeled: they are the user's equations, read in place and never copied.

mod blocks;
mod resting;
mod row;

use std::ops::Range;

use crate::input::numbering::LocalSystem;
use crate::input::scale::{Scaling, ldexp};
use crate::presolve::eliminated::Step;

pub(crate) use blocks::{BlockCertificate, BlockDependent, Diagnosed, LateTerms, NEAR, Nearness, Solved, Vectors};
pub(crate) use row::BasisRow;

/// The rows that express slaves by masters. A diagnosis has no rows for blocks; a reduction adds them.
#[derive(Clone, Default)]
pub(crate) struct Basis {
    slaves: Vec<u32>,
    constants: Vec<f64>,
    /// The user's equations of the peeled rows.
    pub peeled: Vec<u32>,
    /// Position of the slave in each peeled row.
    positions: Vec<u32>,
    /// For each row that is not peeled, the end of its terms in `dofs` and `values`.
    ends: Vec<usize>,
    dofs: Vec<u32>,
    values: Vec<f64>,
    /// Scaled pivots of the eliminated rows. These rows follow the peeled rows.
    pivots: Vec<f64>,
    /// For each eliminated row, [`Step::reach`]: the largest product of factors by which elimination added a user's equation to the row.
    reaches: Vec<f64>,
    /// The blocks; their rows come last.
    pub blocks: Vec<Kept>,
}

/// Data of a block other than its rows.
#[derive(Clone)]
pub(crate) struct Kept {
    /// The kept rows, numbered as in `Eliminated::rows`.
    pub rows: Vec<u32>,
    /// Indices of `rows` in a fill-reducing order.
    pub order: Vec<u32>,
    /// Distance of the kept rows from dependence.
    pub nearness: Nearness,
    /// The free DOFs of the block.
    pub dofs: Vec<u32>,
    /// Vectors over the free DOFs of the block.
    pub vectors: Vectors,
}

/// The stage that made a row.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum RowOrigin {
    Peeled,
    Eliminated,
    /// The block with this index.
    Block(usize),
}

impl Basis {
    /// A basis without rows, with capacity for this many equations.
    pub fn with_capacity(rows: usize) -> Self {
        Self {
            slaves: Vec::with_capacity(rows),
            constants: Vec::with_capacity(rows),
            peeled: Vec::with_capacity(rows),
            positions: Vec::with_capacity(rows),
            ..Self::default()
        }
    }

    /// Appends equation `row`, solved for `slave`, the term at `position`.
    #[inline]
    pub fn peel(&mut self, row: u32, slave: u32, position: usize, constant: f64) {
        self.slaves.push(slave);
        self.constants.push(constant);
        self.peeled.push(row);
        self.positions.push(position as u32);
    }

    /// Ends a row whose terms were pushed to `dofs` and `values`.
    pub fn close(&mut self, slave: u32, constant: f64) {
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

    /// Appends the eliminated rows, in the user's units, and the data of the blocks.
    pub fn extend(&mut self, steps: Vec<Step>, blocks: impl Iterator<Item = (Vec<u32>, Diagnosed)>, scaling: &Scaling) {
        steps.into_iter().for_each(|step| self.push_step(&step, scaling));
        let kept = |(dofs, block)| {
            let Diagnosed { kept: rows, order, nearness, vectors, .. } = block;
            Kept { rows, order, nearness, dofs, vectors }
        };
        self.blocks.extend(blocks.map(kept));
    }

    /// A copy with the rows of the blocks appended.
    pub fn with_blocks(&self, blocks: &[Solved], scaling: &Scaling) -> Self {
        let mut all = self.clone();
        blocks.iter().for_each(|block| all.push_block(block, scaling));
        all
    }

    /// A copy of the rows and blocks for which the functions return true.
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

    /// Number of eliminated rows.
    pub fn steps(&self) -> usize {
        self.pivots.len()
    }

    /// Number of rows.
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

    /// The scaled pivot of an eliminated row.
    pub fn pivot_of_step(&self, step: usize) -> f64 {
        self.pivots[step]
    }

    /// [`Step::reach`] of an eliminated row: the largest product of factors by which elimination added a user's equation to the row.
    pub fn reach_of_step(&self, step: usize) -> f64 {
        self.reaches[step]
    }

    /// The scaled pivot of row t, which is peeled or eliminated and has these terms.
    #[inline]
    pub fn pivot(&self, t: usize, terms: &BasisRow, scaling: &Scaling) -> f64 {
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

    /// Range of the terms of a row that is not peeled.
    fn stored(&self, t: usize) -> Range<usize> {
        let k = t - self.peeled.len();
        (if k == 0 { 0 } else { self.ends[k - 1] })..self.ends[k]
    }

    /// Row t; `system` is the system that was peeled.
    #[expect(clippy::inline_always, reason = "out of line it was a twentieth of the profile of an elimination")]
    #[inline(always)]
    pub fn row<'a>(&'a self, system: LocalSystem<'a>, t: usize) -> BasisRow<'a> {
        if let Some(&row) = self.peeled.get(t) {
            let (dofs, values) = system.parts(row as usize);
            return BasisRow::solved(dofs, values, self.positions[t] as usize);
        }
        let range = self.stored(t);
        BasisRow::new(&self.dofs[range.clone()], &self.values[range])
    }

    /// Bounds of the rows of T: for each row of the basis the largest coefficient, or infinity if the row contains another slave.
    pub fn bounds(&self, system: LocalSystem) -> Vec<f64> {
        let mut is_slave = vec![false; system.dofs()];
        self.slaves.iter().for_each(|&slave| is_slave[slave as usize] = true);
        let size = |(j, v): (u32, f64)| if is_slave[j as usize] { f64::INFINITY } else { v.abs() };
        (0..self.rows()).map(|t| self.row(system, t).entries().map(size).fold(0.0, f64::max)).collect()
    }

    /// The origin of row t, if each block counts as one row.
    pub fn origin(&self, t: usize) -> RowOrigin {
        if t < self.peeled.len() {
            RowOrigin::Peeled
        } else if t < self.peeled.len() + self.steps() {
            RowOrigin::Eliminated
        } else {
            RowOrigin::Block(t - self.peeled.len() - self.steps())
        }
    }

    /// The solution with all masters zero, by DOF; slaves of blocks have the values of the blocks' particular solutions.
    pub fn particular(&self, system: LocalSystem, scaling: &Scaling) -> Vec<f64> {
        let mut u = vec![0.0; system.dofs()];
        system.prescribed().iter().for_each(|&(j, value)| u[j] = value);
        for block in &self.blocks {
            let particular = block.dofs.iter().zip(&block.vectors.particular);
            particular.for_each(|(&j, &x)| u[j as usize] = ldexp(x, scaling.col(j as usize)));
        }
        self.complete(system, &mut u);
        u
    }

    /// Computes the slaves in u, which holds masters and prescribed DOFs.
    pub fn complete(&self, system: LocalSystem, u: &mut [f64]) {
        self.complete_with(system, &self.constants, u);
    }

    /// [`Basis::complete`] with other constants.
    pub fn complete_with(&self, system: LocalSystem, constants: &[f64], u: &mut [f64]) {
        for t in (0..self.rows()).rev() {
            let sum: f64 = self.row(system, t).entries().map(|(j, v)| v * u[j as usize]).sum();
            u[self.slaves[t] as usize] = constants[t] + sum;
        }
    }
}
