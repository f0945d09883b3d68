//! Generated boundary conditions: free DOFs that the equations fix to a value (section 2.2, Figure 6).
//!
//! DOF s is fixed iff its row of T vanishes, that is iff it does not move with the masters. Two random vectors of masters
//! tell this without T: `u_s = T u_q` is then zero to rounding, and for any other s with probability zero only.

use std::collections::BTreeMap;

use crate::ConstraintSystem;
use crate::basis::Basis;
use crate::block::Block;
use crate::block::dependent::NO_PIVOT;
use crate::certificate::{Because, History};
use crate::qr::{Backend, BackendError};
use crate::scale::{Scaling, ldexp};

/// A sum of parts that cancels to within this, relative to the parts, is zero.
const NOISE: f64 = 1e-11;

/// Slaves that do not move with any master, ascending, and their values `G u_p + g`.
pub(crate) fn find(system: &ConstraintSystem, basis: &Basis, scaling: &Scaling) -> Vec<(usize, f64)> {
    let mut fixed = vec![false; system.dofs()];
    basis.visit(system, |slave, _, _| fixed[slave as usize] = true);
    for seed in [0x9e37_79b9_u64, 0x85eb_ca6b] {
        let moved = move_masters(system, basis, scaling, seed);
        fixed.iter_mut().zip(moved).for_each(|(fixed, u)| *fixed &= u == 0.0);
    }
    let mut u = vec![0.0; system.dofs()];
    system.prescribed().iter().for_each(|&(j, value)| u[j] = value);
    basis.complete(system, &mut u, 1.0);
    (0..system.dofs()).filter(|&j| fixed[j]).map(|j| (j, u[j])).collect()
}

/// All DOFs for random masters, each in its unit, and zero prescribed values; what cancels is exactly zero.
fn move_masters(system: &ConstraintSystem, basis: &Basis, scaling: &Scaling, seed: u64) -> Vec<f64> {
    let mut u: Vec<f64> = (0..system.dofs()).map(|j| ldexp(random(seed, j as u64), scaling.col(j))).collect();
    system.prescribed().iter().for_each(|&(j, _)| u[j] = 0.0);
    basis.visit(system, |slave, terms, _| {
        let (mut sum, mut size) = (0.0, 0.0_f64);
        for &(j, v) in terms {
            let part = v * u[j as usize];
            sum += part;
            size = size.max(part.abs());
        }
        u[slave as usize] = if sum.abs() <= NOISE * size { 0.0 } else { sum };
    });
    u
}

/// A number in `[0.5, 1.5)` that depends on the seed and the index only (splitmix64).
pub(crate) fn random(seed: u64, index: u64) -> f64 {
    let mut x = seed.wrapping_add(index.wrapping_mul(0x9e37_79b9_7f4a_7c15));
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    0.5 + ((x ^ (x >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}

/// What is left of `e_s` while equations are taken from it, by the time at which each DOF became a slave.
struct Rest {
    parts: BTreeMap<(u32, u32), f64>,
}

impl Rest {
    fn add(&mut self, time: u32, dof: u32, value: f64) {
        *self.parts.entry((time, dof)).or_default() += value;
    }
}

/// Explains fixed DOFs: `e_s = sum_i c_i row_i` over the free DOFs.
pub(crate) struct Explainer<'a> {
    pub system: &'a ConstraintSystem,
    pub basis: &'a Basis,
    pub blocks: &'a [Block],
    pub history: &'a History,
    pub scaling: &'a Scaling,
    pub backend: &'a dyn Backend,
    /// When each DOF became a slave: peeled rows, then steps, then blocks; `u32::MAX` for masters and prescribed.
    time: Vec<u32>,
}

impl<'a> Explainer<'a> {
    pub fn new(
        system: &'a ConstraintSystem,
        basis: &'a Basis,
        blocks: &'a [Block],
        history: &'a History,
        scaling: &'a Scaling,
        backend: &'a dyn Backend,
    ) -> Self {
        let mut time = vec![u32::MAX; system.dofs()];
        basis.peeled.iter().zip(0..).for_each(|(&(_, dof), t)| time[dof as usize] = t);
        let peeled = basis.peeled.len() as u32;
        basis.steps.iter().zip(peeled..).for_each(|(step, t)| time[step.dof as usize] = t);
        let eliminated = peeled + basis.steps.len() as u32;
        for (block, t) in basis.blocks.iter().zip(eliminated..) {
            block.slaves.iter().for_each(|&dof| time[dof as usize] = t);
        }
        Self { system, basis, blocks, history, scaling, backend, time }
    }

    /// The equations that fix DOF s.
    pub fn because(&self, s: usize) -> Result<Vec<Because>, BackendError> {
        let (peeled, steps) = (self.basis.peeled.len() as u32, self.basis.steps.len() as u32);
        let mut rest = Rest { parts: BTreeMap::from([((self.time[s], s as u32), 1.0)]) };
        let (mut own, mut of_steps, mut of_blocks) = (Vec::new(), Vec::new(), Vec::new());
        while let Some((&(time, dof), &value)) = rest.parts.first_key_value() {
            if time == u32::MAX {
                break;
            }
            if time < peeled {
                rest.parts.pop_first();
                let row = self.basis.peeled[time as usize].0 as usize;
                own.push(Because { row, coefficient: self.take_peeled(&mut rest, row, dof, value) });
            } else if time < peeled + steps {
                rest.parts.pop_first();
                of_steps.push((time - peeled, self.take_step(&mut rest, time - peeled, value)));
            } else {
                of_blocks.extend(self.take_block(&mut rest, time)?);
            }
        }
        own.extend(self.history.combination(&of_steps, &of_blocks, 0));
        own.retain(|term| term.coefficient != 0.0);
        own.sort_unstable_by_key(|term| term.row);
        Ok(own)
    }

    fn take_peeled(&self, rest: &mut Rest, row: usize, dof: u32, value: f64) -> f64 {
        let entries = self.system.matrix().row(row);
        let pivot = entries.clone().find(|&(j, _)| j == dof as usize).map_or(1.0, |(_, v)| v);
        let weight = value / pivot;
        for (j, v) in entries.filter(|&(j, _)| j != dof as usize) {
            rest.add(self.time[j], j as u32, -weight * v);
        }
        weight
    }

    fn take_step(&self, rest: &mut Rest, step: u32, value: f64) -> f64 {
        let step = &self.basis.steps[step as usize];
        let weight = value / step.pivot;
        step.others.iter().for_each(|&(j, v)| rest.add(self.time[j as usize], j, -weight * v));
        weight
    }

    /// All that is left in one block at once: `C_kept^T y = rest`.
    fn take_block(&self, rest: &mut Rest, time: u32) -> Result<Vec<(u32, f64)>, BackendError> {
        let k = (time as usize) - self.basis.peeled.len() - self.basis.steps.len();
        let (block, solved) = (&self.blocks[k], &self.basis.blocks[k]);
        let mut right = vec![0.0; block.dofs.len()];
        for (position, &dof) in block.dofs.iter().enumerate() {
            if let Some(value) = rest.parts.remove(&(self.time[dof as usize], dof)) {
                right[position] = ldexp(value, self.scaling.col(dof as usize));
            }
        }
        let mut columns = crate::Csr::empty(block.dofs.len());
        let kept: Vec<usize> = solved.kept.iter().filter_map(|row| block.rows.binary_search(row).ok()).collect();
        kept.iter().for_each(|&i| columns.push_row(block.matrix.row(i)));
        let factor = self.backend.factor(&columns, &right, NO_PIVOT)?;
        let y = factor.solve(&factor.rhs);
        let largest = y.iter().fold(0.0, |a: f64, v| a.max(v.abs()));
        let terms = y.iter().zip(&factor.order).filter(|(v, _)| v.abs() > NOISE * largest);
        Ok(terms.map(|(v, &i)| (block.rows[kept[i]], ldexp(*v, block.exponents[kept[i]]))).collect())
    }
}
