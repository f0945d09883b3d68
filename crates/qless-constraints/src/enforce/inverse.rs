//! `x = M^-1 r` for right-hand sides of all DOFs and all equations: elimination, multipliers and springs in one matrix.
//!
//! ```text
//! springs        K' = K + C_P^T D C_P                     equations with a penalty or augmented
//! elimination    u = L q + u_0, C_E u_0 = r_E             K_q = L^T K' L, f_q = L^T (r + C_P^T D r_P - K' u_0)
//! multipliers    [K_q C_q^T; C_q 0] [q; lambda_M] = [f_q; r_M - C_M u_0]
//! back           lambda_P = D (C_P u - r_P),  C_E^T lambda_E = r - K u - C_M^T lambda_M - C_P^T lambda_P
//! ```
//!
//! This is the inverse of [`super::model`] up to rounding, and up to `1 / D` for augmented equations.

use std::borrow::Cow;

use super::condensation::Condensation;
use super::factor::{Factor, shifted};
use super::matrix::{Matrix, bordered, entries, from_triplets, times};
use super::method::Method;
use super::problem::Problem;
use super::{EnforceError, scale};

/// The factored matrix of some methods.
pub struct Inverse<'a> {
    problem: &'a Problem<'a>,
    /// D of each equation; zero without a spring.
    springs: Vec<f64>,
    /// K with its springs.
    sum: Cow<'a, Matrix>,
    eliminated: Vec<usize>,
    condensation: Condensation,
    /// Equations with a multiplier in the matrix: those of the caller, and of parts of which T would fill.
    border: Vec<usize>,
    multipliers: usize,
    factor: Factor,
}

impl<'a> Inverse<'a> {
    /// With `shift` on the diagonal of the unknown DOFs in units of [`super::scale`], for a matrix that is singular.
    pub fn new(problem: &'a Problem, methods: &[Method], springs: Vec<f64>, shift: f64) -> Result<Self, EnforceError> {
        let of = |method: Method| problem.kept.iter().copied().filter(move |&row| methods[row] == method);
        let eliminated: Vec<usize> = of(Method::Elimination).collect();
        let mut border: Vec<usize> = of(Method::Multiplier).collect();
        let sum = with_springs(problem, &springs)?;
        let condensation = Condensation::new(problem.system, &eliminated, &sum)?;
        let multipliers = border.len();
        border.extend(&condensation.left);
        let k_q = condensation.matrix(&sum)?;
        let c_q = over_unknowns(problem, &condensation, &border)?;
        let (units, count) = (scale::units(&k_q, &c_q), k_q.nrows());
        let definite = problem.symmetric && border.is_empty();
        let matrix = if border.is_empty() { k_q } else { bordered(&k_q, &c_q)? };
        let matrix = if shift > 0.0 { shifted(&matrix, &units, count, shift)? } else { matrix };
        let factor = Factor::new(&matrix, units, definite)?;
        Ok(Self { problem, springs, sum, eliminated, condensation, border, multipliers, factor })
    }

    /// `M^-1 r`.
    pub fn solve(&mut self, r: &[f64]) -> Result<Vec<f64>, EnforceError> {
        let n = self.problem.system.dofs();
        let (forces, gaps) = r.split_at(n);
        let of_eliminated: Vec<f64> = self.eliminated.iter().map(|&row| gaps[row]).collect();
        self.condensation.set(&of_eliminated)?;
        let mut rhs = self.condensation.load(&self.sum, &self.loaded(forces, gaps))?;
        let constant = self.condensation.constant()?;
        rhs.extend(self.border.iter().map(|&row| gaps[row] - self.along(row, &constant)));
        let x = self.factor.solve(&rhs)?;
        let (q, of_border) = x.split_at(self.condensation.condensed.unknowns());
        let u = self.condensation.expand(q)?;
        let lambda = self.multipliers(forces, gaps, &u, of_border)?;
        Ok([u, lambda].concat())
    }

    /// `r + C_P^T D r_P`.
    fn loaded(&self, forces: &[f64], gaps: &[f64]) -> Vec<f64> {
        let mut load = forces.to_vec();
        for (row, d) in self.sprung() {
            self.problem.system.matrix().row(row).for_each(|(j, v)| load[j] += v * d * gaps[row]);
        }
        load
    }

    fn multipliers(
        &self,
        forces: &[f64],
        gaps: &[f64],
        u: &[f64],
        of_border: &[f64],
    ) -> Result<Vec<f64>, EnforceError> {
        let mut lambda = vec![0.0; gaps.len()];
        self.border[..self.multipliers].iter().zip(of_border).for_each(|(&row, &value)| lambda[row] = value);
        self.sprung().for_each(|(row, d)| lambda[row] = d * (self.along(row, u) - gaps[row]));
        if self.eliminated.is_empty() {
            return Ok(lambda);
        }
        let stressed = times(&self.problem.k, u);
        let mut rest: Vec<f64> = forces.iter().zip(stressed).map(|(force, stressed)| force - stressed).collect();
        for &row in self.problem.kept.iter().filter(|&&row| lambda[row] != 0.0) {
            self.problem.system.matrix().row(row).for_each(|(j, v)| rest[j] -= v * lambda[row]);
        }
        let carried = self.condensation.map.multipliers(&rest)?;
        self.eliminated.iter().zip(carried).for_each(|(&row, value)| lambda[row] = value);
        Ok(lambda)
    }

    fn sprung(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.springs.iter().copied().enumerate().filter(|&(_, d)| d > 0.0)
    }

    /// `C_i u`.
    fn along(&self, row: usize, u: &[f64]) -> f64 {
        self.problem.system.matrix().row(row).map(|(j, v)| v * u[j]).sum()
    }
}

/// `K + C_P^T D C_P`.
fn with_springs<'a>(problem: &'a Problem, springs: &[f64]) -> Result<Cow<'a, Matrix>, EnforceError> {
    if springs.iter().all(|d| *d == 0.0) {
        return Ok(Cow::Borrowed(&problem.k));
    }
    let n = problem.system.dofs();
    let of_row = |(row, &d): (usize, &f64)| {
        let row = problem.system.matrix().row(row);
        row.clone().flat_map(move |(i, a)| row.clone().map(move |(j, b)| (i, j, d * a * b)))
    };
    let springs = springs.iter().enumerate().filter(|(_, d)| **d > 0.0).flat_map(of_row);
    from_triplets(n, n, entries(&problem.k).chain(springs)).map(Cow::Owned)
}

/// Some rows of C over the unknowns.
pub fn over_unknowns(problem: &Problem, some: &Condensation, rows: &[usize]) -> Result<Matrix, EnforceError> {
    let mut triplets = Vec::new();
    for (i, &row) in rows.iter().enumerate() {
        let (terms, _) = some.condensed.equation(&some.map, problem.system.matrix().row(row), 0.0)?;
        triplets.extend(terms.into_iter().map(|(j, v)| (i, j, v)));
    }
    from_triplets(rows.len(), some.condensed.unknowns(), triplets)
}
