//! The role of each DOF, and T by columns.

use crate::{Csr, Reduction};

/// The index of a DOF among the masters, the slaves or the prescribed DOFs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    Master(u32),
    Slave(u32),
    Prescribed(u32),
}

/// The roles of the DOFs, with data derived from T, G and g.
pub(super) struct Roles {
    /// Role of each DOF.
    pub of: Vec<Role>,
    /// `G u_p + g` of each slave.
    pub constants: Vec<f64>,
    /// `T^T`: for each master the DOFs of the slaves whose rows contain it.
    pub of_masters: Csr,
    /// For each slave, true if it belongs to a factored part; empty if T is explicit.
    factored: Vec<bool>,
}

impl Roles {
    pub fn new(reduction: &Reduction, prescribed: &[f64]) -> Self {
        let mut of = vec![Role::Master(0); reduction.dofs()];
        reduction.masters.iter().zip(0..).for_each(|(&j, q)| of[j] = Role::Master(q));
        reduction.slaves.iter().zip(0..).for_each(|(&j, i)| of[j] = Role::Slave(i));
        reduction.prescribed.iter().zip(0..).for_each(|(&j, p)| of[j] = Role::Prescribed(p));
        let mut factored = vec![false; if reduction.is_explicit() { 0 } else { reduction.slaves.len() }];
        for &j in reduction.factored.iter().flat_map(|block| &block.slaves) {
            if let Role::Slave(i) = of[j] {
                factored[i as usize] = true;
            }
        }
        let mut of_masters = reduction.t.transposed();
        of_masters.cols = reduction.dofs();
        of_masters.col.iter_mut().for_each(|i| *i = reduction.slaves[*i as usize] as u32);
        let mut roles = Self { of, constants: Vec::new(), of_masters, factored };
        roles.refresh(reduction, prescribed);
        roles
    }

    /// Updates the constants for a new g and new prescribed values.
    pub fn refresh(&mut self, reduction: &Reduction, prescribed: &[f64]) {
        self.constants = reduction.g_matrix.product(prescribed);
        self.constants.iter_mut().zip(&reduction.g).for_each(|(sum, g)| *sum += g);
    }

    /// Returns true if slave i belongs to a factored part.
    pub fn is_factored(&self, i: usize) -> bool {
        self.factored.get(i).is_some_and(|&factored| factored)
    }
}

/// `sum_k a_ik x_k` for row i, in four independent sums, so that additions overlap.
#[inline]
pub(super) fn product(a: &Csr, i: usize, x: &[f64]) -> f64 {
    let range = a.start[i]..a.start[i + 1];
    let (places, values) = (&a.col[range.clone()], &a.val[range]);
    let mut sums = [0.0; 4];
    let (fours, rest) = (places.chunks_exact(4), values.chunks_exact(4));
    let (last, of_last) = (fours.remainder(), rest.remainder());
    for (places, values) in fours.zip(rest) {
        (0..4).for_each(|k| sums[k] += values[k] * x[places[k] as usize]);
    }
    let last: f64 = last.iter().zip(of_last).map(|(&j, v)| v * x[j as usize]).sum();
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + last
}
