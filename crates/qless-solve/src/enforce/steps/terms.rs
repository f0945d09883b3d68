//! `L^T K L x` and the sizes of its terms, computed from K, since K_q does not show the terms that it was summed from.

use qless::Elimination;
use qless::elimination::{Index, Storage, View};

use super::super::condensation::TransformNoise;
use super::super::refinement::MeasuredEquations;
use super::super::units;

/// Positions of the entries of K.
#[derive(Debug)]
pub struct StiffnessPattern {
    /// `(row, column)` in the order of the values.
    entries: Vec<(u32, u32)>,
    storage: Storage,
}

impl StiffnessPattern {
    /// From a validated view; its indices are below the number of DOFs, which fits u32.
    pub fn new<P: Index, I: Index>(k: &View<P, I>) -> Self {
        Self { entries: k.entries().map(|(i, j)| (i as u32, j as u32)).collect(), storage: k.storage() }
    }

    /// Whether a matrix declared as full has entries on one side of the diagonal only: true for the lower, false for the upper half.
    pub fn triangle(&self) -> Option<bool> {
        let off = |below: bool| self.entries.iter().any(|&(i, j)| i != j && (i > j) == below);
        let (lower, upper) = (off(true), off(false));
        (self.storage == Storage::Full && lower != upper).then_some(lower)
    }

    /// Calls `term(i, j, v)` for all entries of K, including the half that is not stored.
    pub fn each(&self, k: &[f64], mut term: impl FnMut(usize, usize, f64)) {
        let half = self.storage != Storage::Full;
        for (&(i, j), &v) in self.entries.iter().zip(k) {
            term(i as usize, j as usize, v);
            if half && i != j {
                term(j as usize, i as usize, v);
            }
        }
    }
}

/// The equations of one step.
pub struct StepEquations<'a> {
    elimination: &'a Elimination,
    pattern: &'a StiffnessPattern,
    k: &'a [f64],
    units: Vec<f64>,
    parts: &'a [usize],
    noise: &'a TransformNoise,
}

impl<'a> StepEquations<'a> {
    pub fn new(
        elimination: &'a Elimination,
        pattern: &'a StiffnessPattern,
        k: &'a [f64],
        (parts, noise): (&'a [usize], &'a TransformNoise),
    ) -> Self {
        let mut terms = Self { elimination, pattern, k, units: Vec::new(), parts, noise };
        let mut stiffness = vec![0.0_f64; elimination.dofs()];
        pattern.each(k, |i, j, v| {
            if i == j {
                stiffness[i] += v.abs();
            }
        });
        let mut of_unknowns = vec![0.0; elimination.masters().len()];
        terms.spread_back(&stiffness, &mut of_unknowns, |_, _, t| t * t);
        terms.units = units::units_of_diagonal(&of_unknowns);
        terms
    }

    /// `|L|^T (|f| + |K| |u_0|)`.
    pub fn size_of_load(&self, f: &[f64], constant: &[f64]) -> Vec<f64> {
        let mut sizes: Vec<f64> = f.iter().map(|f| f.abs()).collect();
        self.pattern.each(self.k, |i, j, v| sizes[i] += (v * constant[j]).abs());
        let mut of_unknowns = vec![0.0; self.elimination.masters().len()];
        self.spread_back(&sizes, &mut of_unknowns, self.sizes_of_t());
        of_unknowns
    }

    /// `y += w(L)^T x`.
    fn spread_back(&self, x: &[f64], y: &mut [f64], w: impl Fn(usize, usize, f64) -> f64) {
        self.elimination.masters().iter().enumerate().for_each(|(q, &dof)| y[q] += x[dof]);
        for (i, &dof) in self.elimination.slaves().iter().enumerate() {
            self.elimination.reduction().t().row(i).for_each(|(q, t)| y[q] += w(i, q, t) * x[dof]);
        }
    }

    /// The sizes of the entries of T.
    fn sizes_of_t(&self) -> impl Fn(usize, usize, f64) -> f64 + '_ {
        |i, q, t| self.noise.size(i, q, t)
    }

    /// A unit for each DOF, from the unknowns that it depends on.
    pub fn spread_units(&self) -> Vec<f64> {
        self.spread(&self.units, |_, _, t| t.abs()).into_iter().map(|s| if s > 0.0 { s } else { 1.0 }).collect()
    }

    /// `L x`.
    pub fn moved(&self, x: &[f64]) -> Vec<f64> {
        self.spread(x, |_, _, t| t)
    }

    /// `w(L) x`.
    fn spread(&self, x: &[f64], w: impl Fn(usize, usize, f64) -> f64) -> Vec<f64> {
        spread(self.elimination, x, w)
    }
}

fn spread(elimination: &Elimination, x: &[f64], w: impl Fn(usize, usize, f64) -> f64) -> Vec<f64> {
    let mut u = vec![0.0; elimination.dofs()];
    elimination.masters().iter().enumerate().for_each(|(q, &dof)| u[dof] = x[q]);
    for (i, &dof) in elimination.slaves().iter().enumerate() {
        u[dof] = elimination.reduction().t().row(i).map(|(q, t)| w(i, q, t) * x[q]).sum();
    }
    u
}

fn absolute(x: &[f64]) -> Vec<f64> {
    x.iter().map(|x| x.abs()).collect()
}

/// `|L| |x| + |G| |u_p| + |g|`: the sizes of the terms of u.
pub fn sizes_of_dofs(elimination: &Elimination, x: &[f64]) -> Vec<f64> {
    let mut sizes = spread(elimination, &absolute(x), |_, _, t| t.abs());
    let (reduction, values) = (elimination.reduction(), elimination.prescribed_values());
    elimination.prescribed().iter().zip(values).for_each(|(&dof, value)| sizes[dof] = value.abs());
    for (i, &dof) in elimination.slaves().iter().enumerate() {
        let of_prescribed = reduction.g_matrix().row(i).map(|(p, v)| (v * values[p]).abs());
        sizes[dof] += of_prescribed.sum::<f64>() + reduction.g()[i].abs();
    }
    sizes
}

impl MeasuredEquations for StepEquations<'_> {
    fn apply(&self, x: &[f64]) -> Vec<f64> {
        let (u, mut forces) = (self.moved(x), vec![0.0; self.elimination.dofs()]);
        self.pattern.each(self.k, |i, j, v| forces[i] += v * u[j]);
        let mut y = vec![0.0; x.len()];
        self.spread_back(&forces, &mut y, |_, _, t| t);
        y
    }

    fn size(&self, x: &[f64]) -> Vec<f64> {
        let (u, mut forces) = (self.spread(&absolute(x), self.sizes_of_t()), vec![0.0; self.elimination.dofs()]);
        self.pattern.each(self.k, |i, j, v| forces[i] += v.abs() * u[j]);
        let mut y = vec![0.0; x.len()];
        self.spread_back(&forces, &mut y, self.sizes_of_t());
        y
    }

    fn units(&self) -> &[f64] {
        &self.units
    }

    fn parts(&self) -> &[usize] {
        self.parts
    }
}
