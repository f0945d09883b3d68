//! `(K + C^T D C) u = f + C^T D b` (Eq. 11), `D_i = factor k_i / |C_i|^2`, `k_i = max_j |K_jj|` over the DOFs of row i.
//!
//! D is scaled from K, so that the factor has no units: it says how much stiffer a constraint is than what it holds. The error
//! of u falls as 1 / factor until rounding, which grows as factor, takes over.

use super::condensation::Condensation;
use super::matrix::{Factor, Matrix, entries, from_triplets};
use super::{EnforceError, Problem, Solution};

/// Steps of augmented Lagrange before it gives up.
const STEPS: usize = 200;

impl Problem<'_> {
    /// Independent equations as stiff springs; `lambda = D (C u - b)`.
    ///
    /// # Errors
    /// [`EnforceError::Factor`], and [`EnforceError::Singular`] if the constraints do not hold the model.
    pub fn penalty(&self, factor: f64) -> Result<Solution, EnforceError> {
        let springs = Springs::new(self, factor)?;
        let mut multipliers = vec![0.0; self.system.equations()];
        let u = springs.solve(&multipliers)?;
        springs.add(&u, &mut multipliers);
        Ok(self.finish(u, multipliers))
    }

    /// Penalty with multipliers that take over step by step: `lambda += D (C u - b)`, until every equation holds to
    /// `tolerance`, relative to the largest of its parts.
    ///
    /// # Errors
    /// [`EnforceError::NoConvergence`], and as [`Problem::penalty`].
    pub fn augmented(&self, factor: f64, tolerance: f64) -> Result<Solution, EnforceError> {
        let springs = Springs::new(self, factor)?;
        let mut multipliers = vec![0.0; self.system.equations()];
        let mut left = f64::INFINITY;
        for _ in 0..STEPS {
            let u = springs.solve(&multipliers)?;
            springs.add(&u, &mut multipliers);
            left = self.left(&u);
            if left <= tolerance {
                return Ok(self.finish(u, multipliers));
            }
        }
        Err(EnforceError::NoConvergence { steps: STEPS, left })
    }

    /// `max_i |C_i u - b_i| / max(|b_i|, max_j |C_ij u_j|, |C_i| max |u|)` over the equations that are enforced.
    fn left(&self, u: &[f64]) -> f64 {
        let most = u.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
        let of_row = |&row: &usize| {
            let (mut sum, mut size) = (-self.system.rhs()[row], self.system.rhs()[row].abs());
            for (j, v) in self.system.matrix().row(row) {
                sum += v * u[j];
                size = size.max(v.abs() * most);
            }
            if sum == 0.0 { 0.0 } else { sum.abs() / size }
        };
        self.kept.iter().map(of_row).fold(0.0, f64::max)
    }
}

/// The factorized stiffness with springs for the equations.
struct Springs<'a> {
    problem: &'a Problem<'a>,
    /// `(row, D_i)`.
    stiffness: Vec<(usize, f64)>,
    /// `K + C^T D C`, ...
    sum: Matrix,
    /// ... on the DOFs that are not prescribed.
    free: Condensation,
    factor: Factor,
}

impl<'a> Springs<'a> {
    fn new(problem: &'a Problem<'a>, factor: f64) -> Result<Self, EnforceError> {
        if !(factor > 0.0 && factor.is_finite()) {
            return Err(EnforceError::Factor(factor));
        }
        let stiffness = spring_stiffness(problem, factor);
        let springs = stiffness.iter().flat_map(|&(row, d)| {
            let row = problem.system.matrix().row(row);
            row.clone().flat_map(move |(i, a)| row.clone().map(move |(j, b)| (i, j, d * a * b)))
        });
        let n = problem.system.dofs();
        let sum = from_triplets(n, n, entries(problem.k).chain(springs))?;
        let free = Condensation::new(problem.system, &[], &sum)?;
        let factor = Factor::new(&free.matrix(&sum)?, "the stiffness with penalties")?;
        Ok(Self { problem, stiffness, sum, free, factor })
    }

    /// `(K + C^T D C) u = f + C^T (D b - lambda)`, prescribed DOFs moved to the right.
    fn solve(&self, multipliers: &[f64]) -> Result<Vec<f64>, EnforceError> {
        let system = self.problem.system;
        let mut load = self.problem.f.to_vec();
        for &(row, d) in &self.stiffness {
            let pull = d * system.rhs()[row] - multipliers[row];
            system.matrix().row(row).for_each(|(j, v)| load[j] += v * pull);
        }
        self.free.expand(&self.factor.solve(&self.free.load(&self.sum, &load)?)?)
    }

    /// `lambda += D (C u - b)`.
    fn add(&self, u: &[f64], multipliers: &mut [f64]) {
        let system = self.problem.system;
        for &(row, d) in &self.stiffness {
            let value: f64 = system.matrix().row(row).map(|(j, v)| v * u[j]).sum();
            multipliers[row] += d * (value - system.rhs()[row]);
        }
    }
}

/// `(row, D_i)`; where K has no stiffness on the DOFs of a row, its largest one counts.
fn spring_stiffness(problem: &Problem, factor: f64) -> Vec<(usize, f64)> {
    let mut diagonal = vec![0.0_f64; problem.system.dofs()];
    entries(problem.k).filter(|&(i, j, _)| i == j).for_each(|(i, _, v)| diagonal[i] += v);
    let largest = diagonal.iter().fold(0.0, |most: f64, d| most.max(d.abs()));
    let of_row = |&row: &usize| {
        let (mut near, mut square) = (0.0_f64, 0.0);
        for (j, v) in problem.system.matrix().row(row) {
            near = near.max(diagonal[j].abs());
            square += v * v;
        }
        let near = [near, largest, 1.0].into_iter().find(|&k| k > 0.0).unwrap_or(1.0);
        (row, factor * near / square)
    };
    problem.kept.iter().map(of_row).collect()
}
