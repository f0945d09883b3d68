//! `K u + C^T lambda = f` on the free DOFs, `C u - lambda / D = b` on the equations that are kept: what every method solves.
//!
//! Unknowns are one list, u of all DOFs and lambda of all equations; prescribed DOFs and redundant equations stay zero in it and
//! are on the right-hand side. `1 / D` is zero but where a penalty is asked for. Cost: three copies of K and C.

use super::EnforceError;
use super::equations::Equations;
use super::matrix::{Matrix, add, add_sizes, add_sizes_transposed, add_transposed, among, entries, from_triplets};
use super::method::Method;
use super::problem::Problem;
use super::scale;

/// The equations of all methods, and their terms.
pub struct Model {
    /// K on the free DOFs.
    k: Matrix,
    /// C on the free DOFs, rows that are kept.
    c: Matrix,
    /// 1 / D of each equation.
    compliance: Vec<f64>,
    units: Vec<f64>,
    parts: Vec<usize>,
    /// b and the sizes of its terms.
    pub rhs: (Vec<f64>, Vec<f64>),
}

impl Model {
    pub fn new(problem: &Problem, methods: &[Method], springs: &[f64]) -> Result<Self, EnforceError> {
        let (n, m) = (problem.system.dofs(), problem.system.equations());
        let mut free = vec![true; n];
        problem.system.prescribed().iter().for_each(|&(j, _)| free[j] = false);
        let k = among(&problem.k, &free);
        let rows = problem.kept.iter().flat_map(|&i| problem.system.matrix().row(i).map(move |(j, v)| (i, j, v)));
        let c = from_triplets(m, n, rows.filter(|&(_, j, _)| free[j]))?;
        let penalty = |(method, d): (&Method, &f64)| {
            if matches!(method, Method::Penalty { .. }) && *d > 0.0 { d.recip() } else { 0.0 }
        };
        let compliance = methods.iter().zip(springs).map(penalty).collect();
        let pairs = entries(&k).map(|(i, j, _)| (i, j)).chain(entries(&c).map(|(i, j, _)| (n + i, j)));
        let (units, parts) = (scale::units(&k, &c), scale::parts(n + m, pairs));
        Ok(Self { k, c, compliance, units, parts, rhs: right_hand_side(problem, &free) })
    }

    /// `A x` without compliance: the equations that penalties stand for.
    pub fn exactly(&self, x: &[f64]) -> Vec<f64> {
        let mut y = self.apply(x);
        let n = self.dofs();
        (0..self.compliance.len()).for_each(|i| y[n + i] += self.compliance[i] * x[n + i]);
        y
    }

    /// The connected parts, by name, that have stiffness.
    pub fn stiff_parts(&self) -> Vec<bool> {
        let mut stiff = vec![false; self.parts.len()];
        entries(&self.k).filter(|&(_, _, v)| v != 0.0).for_each(|(i, _, _)| stiff[self.parts[i]] = true);
        stiff
    }

    /// How many unknowns are DOFs.
    pub fn dofs(&self) -> usize {
        self.k.nrows()
    }
}

/// `f - K u_p` and `b - C u_p`, and the sizes of their terms.
fn right_hand_side(problem: &Problem, free: &[bool]) -> (Vec<f64>, Vec<f64>) {
    let (n, m) = (problem.system.dofs(), problem.system.equations());
    let mut given = vec![0.0; n];
    problem.system.prescribed().iter().for_each(|&(j, value)| given[j] = value);
    let mut sums = [problem.f, &vec![0.0; m]].concat();
    problem.kept.iter().for_each(|&row| sums[n + row] = problem.system.rhs()[row]);
    let mut sizes: Vec<f64> = sums.iter().map(|b| b.abs()).collect();
    let mut term = |i: usize, v: f64| {
        sums[i] -= v;
        sizes[i] += v.abs();
    };
    entries(&problem.k).filter(|&(_, j, _)| !free[j]).for_each(|(i, j, v)| term(i, v * given[j]));
    for &row in &problem.kept {
        let prescribed = problem.system.matrix().row(row).filter(|&(j, _)| !free[j]);
        prescribed.for_each(|(j, v)| term(n + row, v * given[j]));
    }
    for j in (0..n).filter(|&j| !free[j]) {
        (sums[j], sizes[j]) = (0.0, 0.0);
    }
    (sums, sizes)
}

impl Equations for Model {
    fn apply(&self, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; x.len()];
        let (u, lambda) = x.split_at(self.dofs());
        let (forces, gaps) = y.split_at_mut(self.dofs());
        add(&self.k, u, forces);
        add_transposed(&self.c, lambda, forces);
        add(&self.c, u, gaps);
        (0..gaps.len()).for_each(|i| gaps[i] -= self.compliance[i] * lambda[i]);
        y
    }

    fn size(&self, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; x.len()];
        let (u, lambda) = x.split_at(self.dofs());
        let (forces, gaps) = y.split_at_mut(self.dofs());
        add_sizes(&self.k, u, forces);
        add_sizes_transposed(&self.c, lambda, forces);
        add_sizes(&self.c, u, gaps);
        (0..gaps.len()).for_each(|i| gaps[i] += (self.compliance[i] * lambda[i]).abs());
        y
    }

    fn units(&self) -> &[f64] {
        &self.units
    }

    fn parts(&self) -> &[usize] {
        &self.parts
    }
}
