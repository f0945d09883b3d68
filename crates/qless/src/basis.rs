//! The kept equations, each solved for its slave, in an order in which that can be done: peeled rows, eliminated rows, blocks.
//!
//! `u_s = sum_k value_k u_k + constant`, where no slave occurs in a later row. Going from the last row to the first, a vector
//! of masters and prescribed values is completed without T, in O(nnz). All in local numbers and the user's units.

use std::ops::Range;

use crate::block::Solved;
use crate::presolve::eliminate::Step;
use crate::scale::{Scaling, ldexp};

/// Terms for which there is room at once while rows are peeled.
const ROOM: usize = 1 << 12;

/// Everything needed to express slaves by masters.
#[derive(Default)]
pub(crate) struct Basis {
    slaves: Vec<u32>,
    /// Where each row ends in `dofs` and `values`.
    ends: Vec<usize>,
    dofs: Vec<u32>,
    values: Vec<f64>,
    /// How much of `dofs` and `values` is in use while rows are peeled; the rest is zeros.
    used: usize,
    constants: Vec<f64>,
    /// Scaled coefficients by which peeled and eliminated rows were divided.
    pivots: Vec<f64>,
    /// The equations of the first rows, which are the user's own.
    pub peeled: Vec<u32>,
    /// Number of eliminated rows, which follow.
    pub steps: usize,
    /// The blocks, the rows of which come last.
    pub blocks: Vec<Kept>,
}

/// What remains of a block beside its rows.
pub(crate) struct Kept {
    /// Indices of the kept rows among those that went through elimination.
    pub rows: Vec<u32>,
    /// Its rows of the basis.
    pub slaves: Range<usize>,
    /// Estimate of the smallest singular value of the kept rows.
    pub sigma: f64,
}

/// Rows, in order.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Part {
    Peeled,
    Eliminated,
    /// Row of this block.
    Block(usize),
}

impl Basis {
    /// No rows; room for this many equations, with all their entries.
    pub fn with_capacity(rows: usize, entries: usize) -> Self {
        Self {
            slaves: Vec::with_capacity(rows),
            ends: Vec::with_capacity(rows),
            dofs: Vec::with_capacity(entries + ROOM),
            values: Vec::with_capacity(entries + ROOM),
            constants: Vec::with_capacity(rows),
            pivots: Vec::with_capacity(rows),
            peeled: Vec::with_capacity(rows),
            ..Self::default()
        }
    }

    /// The terms of the row that [`Basis::peel`] closes: all but the slave's own, divided by its coefficient.
    #[inline]
    pub fn terms(&mut self, dofs: &[u32], values: &[f64], position: usize) {
        let pivot = -values[position];
        // A power of two, which most pivots are, has an exact reciprocal, and a product takes less time than a quotient.
        let factor = if pivot.to_bits() << 12 == 0 { 1.0 / pivot } else { f64::NAN };
        let (end, length) = (self.used, dofs.len());
        if end + length > self.dofs.len() {
            self.make_room(end + length);
        }
        let (of_dofs, of_values) = (&mut self.dofs[end..end + length], &mut self.values[end..end + length]);
        let mut at = 0;
        for (k, (&j, &v)) in dofs.iter().zip(values).enumerate() {
            (of_dofs[at], of_values[at]) = (j, if factor.is_nan() { v / pivot } else { v * factor });
            // Without a branch, which nobody could predict.
            at += usize::from(k != position);
        }
        self.used += at;
    }

    /// Zeros for the next terms: not far ahead, so that they are in a cache when the terms are written.
    #[cold]
    fn make_room(&mut self, length: usize) {
        self.dofs.resize(length + ROOM, 0);
        self.values.resize(length + ROOM, 0.0);
    }

    /// Closes equation `row`, solved for `slave`; `scaled` is the slave's coefficient after scaling.
    #[inline]
    pub fn peel(&mut self, row: u32, slave: u32, constant: f64, scaled: f64) {
        self.slaves.push(slave);
        self.ends.push(self.used);
        self.constants.push(constant);
        self.pivots.push(scaled);
        self.peeled.push(row);
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
    }

    fn push_block(&mut self, block: Solved, scaling: &Scaling) {
        let first = self.rank();
        for (i, &slave) in block.slaves.iter().enumerate() {
            let own = scaling.col(slave as usize);
            for (k, v) in block.relation.row(i) {
                let other = block.others[k];
                self.dofs.push(other);
                self.values.push(ldexp(v, own - scaling.col(other as usize)));
            }
            self.close(slave, ldexp(block.constant[i], own));
        }
        self.blocks.push(Kept { rows: block.kept, slaves: first..self.rank(), sigma: block.sigma });
    }

    /// Appends what elimination and blocks found to the peeled rows, in the user's units.
    pub fn extend(&mut self, steps: Vec<Step>, blocks: Vec<Solved>, scaling: &Scaling) {
        self.dofs.truncate(self.used);
        self.values.truncate(self.used);
        self.steps = steps.len();
        steps.into_iter().for_each(|step| self.push_step(&step, scaling));
        blocks.into_iter().for_each(|block| self.push_block(block, scaling));
    }

    /// Number of slaves, which is the rank.
    pub fn rank(&self) -> usize {
        self.slaves.len()
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

    /// The scaled coefficient of the slave in a peeled or eliminated row.
    #[inline]
    pub fn pivot(&self, t: usize) -> f64 {
        self.pivots[t]
    }

    /// DOFs and coefficients of row t.
    #[inline]
    pub fn row(&self, t: usize) -> (&[u32], &[f64]) {
        let range = (if t == 0 { 0 } else { self.ends[t - 1] })..self.ends[t];
        (&self.dofs[range.clone()], &self.values[range])
    }

    /// The rows of a block.
    pub fn rows_of(&self, block: usize) -> Range<usize> {
        self.blocks[block].slaves.clone()
    }

    /// Where row t comes from.
    pub fn part(&self, t: usize) -> Part {
        if t < self.peeled.len() {
            Part::Peeled
        } else if t < self.pivots.len() {
            Part::Eliminated
        } else {
            Part::Block(self.blocks.partition_point(|kept| kept.slaves.end <= t))
        }
    }

    /// Completes u, in which masters and prescribed DOFs are set.
    pub fn complete(&self, u: &mut [f64]) {
        self.complete_with(&self.constants, u);
    }

    /// The same with other constants.
    pub fn complete_with(&self, constants: &[f64], u: &mut [f64]) {
        for t in (0..self.rank()).rev() {
            let (dofs, values) = self.row(t);
            let sum: f64 = dofs.iter().zip(values).map(|(&j, v)| v * u[j as usize]).sum();
            u[self.slaves[t] as usize] = constants[t] + sum;
        }
    }
}
