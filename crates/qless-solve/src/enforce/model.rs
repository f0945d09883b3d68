//! `K u + C^T lambda = f`, `C u - lambda / D = b` of one part: what every method solves.
//!
//! Unknowns are one list, u and then lambda. `1 / D` is zero but where a penalty is asked for.

use super::EnforceError;
use super::equations::{Equations, levelled};
use super::kinds::Kinds;
use super::matrix::{Matrix, add, add_sizes, add_sizes_transposed, add_transposed, entries, from_triplets};
use super::method::Method;
use super::part::Part;
use super::scale;

/// The equations of all methods, and their terms.
pub struct Model<'a> {
    k: &'a Matrix,
    c: Matrix,
    /// 1 / D of each equation.
    compliance: Vec<f64>,
    units: Vec<f64>,
    kinds: Kinds,
    /// All of one part.
    parts: Vec<usize>,
}

impl<'a> Model<'a> {
    pub fn new(part: &'a Part<'_>) -> Result<Self, EnforceError> {
        let (n, m) = (part.dofs.len(), part.rows.len());
        let rows = (0..m).flat_map(|i| part.system.matrix().row(i).map(move |(j, v)| (i, j, v)));
        let (k, c) = (&part.k, from_triplets(m, n, rows)?);
        let units = scale::units(k, &c);
        let kinds = Kinds::new(k, &c);
        Ok(Self { k, c, compliance: vec![0.0; m], units, kinds, parts: vec![0; n + m] })
    }

    /// The same with penalties of these springs instead of equations.
    pub fn yielding(mut self, methods: &[Method], springs: &[f64]) -> Self {
        let penalty = |(method, d): (&Method, &f64)| {
            if matches!(method, Method::Penalty { .. }) && *d > 0.0 { d.recip() } else { 0.0 }
        };
        self.compliance = methods.iter().zip(springs).map(penalty).collect();
        self
    }

    /// `A x` without compliance: the equations that penalties stand for.
    pub fn exactly(&self, x: &[f64]) -> Vec<f64> {
        self.apply(x).iter().zip(self.yields(x)).map(|(a, b)| a + b).collect()
    }

    /// `Z x`: zero for DOFs, what springs yield for equations.
    pub fn yields(&self, x: &[f64]) -> Vec<f64> {
        let of_springs = self.compliance.iter().zip(&x[self.dofs()..]).map(|(z, lambda)| z * lambda);
        vec![0.0; self.dofs()].into_iter().chain(of_springs).collect()
    }

    /// All entries of `[K C^T; C 0]`.
    pub fn entries(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        let n = self.dofs();
        entries(self.k).chain(entries(&self.c).flat_map(move |(i, j, v)| [(n + i, j, v), (j, n + i, v)]))
    }

    /// Which DOFs can be compared.
    pub fn kinds(&self) -> &Kinds {
        &self.kinds
    }

    /// Which unknowns can be compared: a multiplier as all DOFs of its equation.
    fn known(&self) -> Vec<bool> {
        let n = self.dofs();
        let mut known: Vec<bool> = (0..n + self.c.nrows()).map(|j| j >= n || self.kinds.is_known(j)).collect();
        entries(&self.c).filter(|&(_, j, _)| !self.kinds.is_known(j)).for_each(|(i, ..)| known[n + i] = false);
        known
    }

    /// Whether there is any stiffness.
    pub fn is_stiff(&self) -> bool {
        self.k.val().iter().any(|v| *v != 0.0)
    }

    /// How many unknowns are DOFs.
    pub fn dofs(&self) -> usize {
        self.k.nrows()
    }
}

impl Equations for Model<'_> {
    fn apply(&self, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; x.len()];
        let (u, lambda) = x.split_at(self.dofs());
        let (forces, gaps) = y.split_at_mut(self.dofs());
        add(self.k, u, forces);
        add_transposed(&self.c, lambda, forces);
        add(&self.c, u, gaps);
        (0..gaps.len()).for_each(|i| gaps[i] -= self.compliance[i] * lambda[i]);
        y
    }

    fn size(&self, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; x.len()];
        let (u, lambda) = x.split_at(self.dofs());
        let (forces, gaps) = y.split_at_mut(self.dofs());
        add_sizes(self.k, u, forces);
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

    fn levels(&self, x: &[f64], size: &[f64]) -> Vec<f64> {
        if !self.kinds.are_many() {
            return levelled(self, x);
        }
        let known = self.known();
        let of_known: Vec<f64> = x.iter().zip(&known).map(|(x, known)| if *known { *x } else { 0.0 }).collect();
        let (mut levels, mut most) = (levelled(self, &of_known), vec![0.0_f64; x.len()]);
        for (i, j, v) in self.entries().filter(|&(_, j, v)| v != 0.0 && !known[j]) {
            most[j] = most[j].max(size[i] / v.abs());
        }
        let alone = (0..x.len()).filter(|&j| !known[j]);
        alone.for_each(|j| levels[j] = most[j]);
        levels
    }
}
