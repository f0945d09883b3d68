//! What each DOF is, and the columns of T and G.

use crate::{Csr, Reduction};

/// A place in the list of masters, of slaves or of prescribed DOFs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    Master(u32),
    Slave(u32),
    Prescribed(u32),
}

/// By DOF, and by column.
pub(super) struct Roles {
    pub of: Vec<Role>,
    /// `G u_p + g`, by slave.
    pub constants: Vec<f64>,
    /// `T^T`: for each master the slaves that follow it.
    pub of_masters: Csr,
    /// Slaves of factored parts.
    held: Vec<bool>,
}

impl Roles {
    pub fn new(reduction: &Reduction, given: &[f64]) -> Self {
        let mut of = vec![Role::Master(0); reduction.dofs()];
        reduction.masters.iter().zip(0..).for_each(|(&j, q)| of[j] = Role::Master(q));
        reduction.slaves.iter().zip(0..).for_each(|(&j, i)| of[j] = Role::Slave(i));
        reduction.prescribed.iter().zip(0..).for_each(|(&j, p)| of[j] = Role::Prescribed(p));
        let mut held = vec![false; if reduction.is_explicit() { 0 } else { reduction.slaves.len() }];
        for &j in reduction.factored.iter().flat_map(|block| &block.slaves) {
            if let Role::Slave(i) = of[j] {
                held[i as usize] = true;
            }
        }
        let mut roles = Self { of, constants: Vec::new(), of_masters: reduction.t.transposed(), held };
        roles.refresh(reduction, given);
        roles
    }

    /// The constants, for a new g and new prescribed values.
    pub fn refresh(&mut self, reduction: &Reduction, given: &[f64]) {
        self.constants = reduction.g_matrix.product(given);
        self.constants.iter_mut().zip(&reduction.g).for_each(|(sum, g)| *sum += g);
    }

    /// Whether the row of slave i is not at hand.
    pub fn is_held(&self, i: usize) -> bool {
        self.held.get(i).is_some_and(|&held| held)
    }
}
