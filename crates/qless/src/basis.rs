//! The kept equations in an order in which each gives its slave: peeled rows, eliminated rows, blocks.
//!
//! `u_s = T u_q + G u_p + g` without T: a vector of masters and prescribed values is completed by going through the
//! blocks first, then the eliminated rows backwards, then the peeled rows backwards. O(nnz).

use crate::ConstraintSystem;
use crate::block::Solved;
use crate::presolve::eliminate::Step;
use crate::scale::{Scaling, ldexp};

/// Everything needed to express slaves by masters, in the units of the user.
pub(crate) struct Basis {
    /// (row, slave): the equation is read from the system itself.
    pub peeled: Vec<(u32, u32)>,
    pub steps: Vec<Step>,
    pub blocks: Vec<Solved>,
}

/// A term of an equation that gives a slave.
pub(crate) type Term = (u32, f64);

impl Basis {
    /// Takes the results of the stages and undoes the scaling of columns.
    pub fn new(peeled: Vec<(u32, u32)>, mut steps: Vec<Step>, mut blocks: Vec<Solved>, scaling: &Scaling) -> Self {
        if !scaling.col.is_empty() {
            steps.iter_mut().for_each(|step| unscale_step(step, scaling));
            blocks.iter_mut().for_each(|block| unscale_block(block, scaling));
        }
        Self { peeled, steps, blocks }
    }

    /// Number of slaves, which is the rank.
    pub fn rank(&self) -> usize {
        self.peeled.len() + self.steps.len() + self.blocks.iter().map(|block| block.slaves.len()).sum::<usize>()
    }

    /// Visits every slave, its terms `(DOF, coefficient)` and its constant, such that `u_slave = sum + constant` and
    /// every slave among the terms was visited before.
    pub fn visit(&self, system: &ConstraintSystem, mut visitor: impl FnMut(u32, &[Term], f64)) {
        let mut terms: Vec<Term> = Vec::new();
        for block in &self.blocks {
            for (i, &slave) in block.slaves.iter().enumerate() {
                terms.clear();
                terms.extend(block.relation.row(i).map(|(j, v)| (block.others[j], v)));
                visitor(slave, &terms, block.constant[i]);
            }
        }
        for step in self.steps.iter().rev() {
            terms.clear();
            terms.extend(step.others.iter().map(|&(j, v)| (j, -v / step.pivot)));
            visitor(step.dof, &terms, step.rhs / step.pivot);
        }
        for &(row, slave) in self.peeled.iter().rev() {
            let entries = system.matrix().row(row as usize);
            let pivot = entries.clone().find(|&(j, _)| j == slave as usize).map_or(1.0, |(_, v)| v);
            terms.clear();
            terms.extend(entries.filter(|&(j, _)| j != slave as usize).map(|(j, v)| (j as u32, -v / pivot)));
            visitor(slave, &terms, system.rhs()[row as usize] / pivot);
        }
    }

    /// Completes u, in which masters and prescribed DOFs are set; `constants` scales b (0 gives the homogeneous part).
    pub fn complete(&self, system: &ConstraintSystem, u: &mut [f64], constants: f64) {
        self.visit(system, |slave, terms, constant| {
            u[slave as usize] = constants * constant + terms.iter().map(|&(j, v)| v * u[j as usize]).sum::<f64>();
        });
    }
}

/// `u_j = 2^c_j u'_j`: the coefficient of u_j is that of u'_j times `2^-c_j`.
fn unscale_step(step: &mut Step, scaling: &Scaling) {
    step.pivot = ldexp(step.pivot, -scaling.col(step.dof as usize));
    step.others.iter_mut().for_each(|(j, v)| *v = ldexp(*v, -scaling.col(*j as usize)));
}

fn unscale_block(block: &mut Solved, scaling: &Scaling) {
    for i in 0..block.slaves.len() {
        let own = scaling.col(block.slaves[i] as usize);
        block.constant[i] = ldexp(block.constant[i], own);
        for k in block.relation.start[i]..block.relation.start[i + 1] {
            let other = block.others[block.relation.col[k] as usize];
            block.relation.val[k] = ldexp(block.relation.val[k], own - scaling.col(other as usize));
        }
    }
}
