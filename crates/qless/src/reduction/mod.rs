//! `u_s = T u_q + G u_p + g` (Eq. 23-26): slaves by masters, prescribed DOFs and a constant.

mod growth;
mod rows;

use crate::basis::Basis;
use crate::generated::random;
use crate::scale::{Scaling, ldexp};
use crate::{ConstraintSystem, Csr};

/// The reduced form of a constraint system.
///
/// `C u = b` holds for every `u_q`, and for every `u_p` for which the redundant equations are consistent.
/// DOFs are 0-based; `masters` are all free DOFs that are not slaves, those outside all equations included.
#[derive(Clone, Debug)]
pub struct Reduction {
    /// u_s, ascending.
    pub slaves: Vec<usize>,
    /// u_q, ascending.
    pub masters: Vec<usize>,
    /// u_p, ascending.
    pub prescribed: Vec<usize>,
    /// T, slaves x masters.
    pub t: Csr,
    /// G, slaves x prescribed DOFs.
    pub g_matrix: Csr,
    /// g, one number per slave.
    pub g: Vec<f64>,
    /// `max |T_ij|`.
    pub growth: f64,
    /// How many times a slave and a master changed places to keep the growth down.
    pub exchanges: usize,
    /// `max_i |C_i u - b_i| / (|C_i D| 1 max_j(s_j / d_j) + |b_i|)` over independent equations, for random u_q and u_p: s_j
    /// is the sum of the sizes of the parts that make u_j, D the scaling of columns (1 unless units mix).
    pub residual: f64,
}

/// Builds T, G and g and exchanges slaves and masters until `max |T_ij| <= bound`; rows of `fixed` slaves are zero in T.
pub(crate) fn build(
    system: &ConstraintSystem,
    basis: &Basis,
    independent: &[bool],
    fixed: &[usize],
    bound: f64,
    scaling: &Scaling,
) -> Reduction {
    let mut relation = rows::assemble(system, basis, fixed);
    let exchanges = growth::bound(&mut relation, bound);
    let mut reduction = finish(system, &relation);
    reduction.exchanges = exchanges;
    reduction.growth = reduction.t.val.iter().fold(0.0, |a: f64, v| a.max(v.abs()));
    reduction.residual = residual(system, &reduction, independent, scaling);
    reduction
}

fn finish(system: &ConstraintSystem, relation: &rows::Relation) -> Reduction {
    let is_slave = |j: usize| relation.row_of[j] != u32::MAX;
    let slaves: Vec<usize> = (0..system.dofs()).filter(|&j| is_slave(j)).collect();
    let prescribed: Vec<usize> = system.prescribed().iter().map(|&(j, _)| j).collect();
    let is_master = |&j: &usize| !is_slave(j) && !relation.is_prescribed[j];
    let masters: Vec<usize> = (0..system.dofs()).filter(is_master).collect();
    let mut column = vec![0; system.dofs()];
    for side in [&masters, &prescribed] {
        side.iter().enumerate().for_each(|(k, &j)| column[j] = k);
    }
    let mut t = Csr::empty(masters.len());
    let mut g_matrix = Csr::empty(prescribed.len());
    let mut g = Vec::with_capacity(slaves.len());
    for &s in &slaves {
        let row = relation.row_of[s] as usize;
        for (matrix, fixed) in [(&mut t, false), (&mut g_matrix, true)] {
            let part = relation.row(row).iter().filter(|(j, _)| relation.is_prescribed[*j as usize] == fixed);
            matrix.push_row(part.map(|&(j, v)| (column[j as usize], v)));
        }
        g.push(relation.constant[row]);
    }
    Reduction { slaves, masters, prescribed, t, g_matrix, g, growth: 0.0, exchanges: 0, residual: 0.0 }
}

impl Reduction {
    /// As [`Reduction::expand`], with the sizes of all parts: what the rounding of u is relative to.
    fn sizes(&self, masters: &[f64], prescribed: &[f64]) -> Vec<f64> {
        let size = |matrix: &Csr, i: usize, x: &[f64]| matrix.row(i).map(|(j, v)| (v * x[j]).abs()).sum::<f64>();
        let mut u = vec![0.0; self.slaves.len() + self.masters.len() + self.prescribed.len()];
        self.masters.iter().zip(masters).for_each(|(&j, &v)| u[j] = v.abs());
        self.prescribed.iter().zip(prescribed).for_each(|(&j, &v)| u[j] = v.abs());
        for (i, &j) in self.slaves.iter().enumerate() {
            u[j] = size(&self.t, i, masters) + size(&self.g_matrix, i, prescribed) + self.g[i].abs();
        }
        u
    }

    /// All DOFs from masters (length of `masters`) and prescribed values (length of `prescribed`).
    ///
    /// ```
    /// use qless::{Options, SystemBuilder, analyse};
    /// let mut builder = SystemBuilder::new(2);
    /// builder.equation([(0, 1.0), (1, -2.0)], 3.0);
    /// let system = builder.build()?;
    /// let reduction = analyse(&system, &Options::default())?.reduction(&system);
    /// let u = reduction.expand(&[0.5], &[]);
    /// assert!((u[0] - 2.0 * u[1] - 3.0).abs() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn expand(&self, masters: &[f64], prescribed: &[f64]) -> Vec<f64> {
        let mut u = vec![0.0; self.slaves.len() + self.masters.len() + self.prescribed.len()];
        self.masters.iter().zip(masters).for_each(|(&j, &v)| u[j] = v);
        self.prescribed.iter().zip(prescribed).for_each(|(&j, &v)| u[j] = v);
        let (t, g) = (self.t.times(masters), self.g_matrix.times(prescribed));
        self.slaves.iter().enumerate().for_each(|(i, &j)| u[j] = t[i] + g[i] + self.g[i]);
        u
    }
}

/// For random u_q and u_p: `max_i |C_i u - b_i| / (|C_i D| 1 max_j(s_j / d_j) + |b_i|)`, where s_j is the sum of the
/// sizes of the parts that make u_j and D the scaling of the columns.
fn residual(system: &ConstraintSystem, reduction: &Reduction, independent: &[bool], scaling: &Scaling) -> f64 {
    let masters: Vec<f64> = (0..reduction.masters.len() as u64).map(|j| random(1, j)).collect();
    let prescribed: Vec<f64> = (0..reduction.prescribed.len() as u64).map(|j| random(2, j)).collect();
    let u = reduction.expand(&masters, &prescribed);
    let sizes = reduction.sizes(&masters, &prescribed);
    let largest = sizes.iter().enumerate().map(|(j, &s)| ldexp(s, -scaling.col(j))).fold(0.0, f64::max);
    let mut worst = 0.0_f64;
    for i in (0..system.equations()).filter(|&i| independent[i]) {
        let b = system.rhs()[i];
        let (mut sum, mut size) = (-b, b.abs());
        for (j, v) in system.matrix().row(i) {
            sum += v * u[j];
            size += ldexp(v.abs(), scaling.col(j)) * largest;
        }
        if sum != 0.0 {
            worst = worst.max(sum.abs() / size);
        }
    }
    worst
}
