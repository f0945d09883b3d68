//! Solves small square systems `A x = b` by Gauss elimination with complete pivoting; A may be singular.

use std::cmp::Ordering;
use std::collections::BTreeMap;

use super::body::{CouplingEquation, clean};
use crate::deck::{CardFault, Dof, Problem};

/// The factors of a square matrix A, `P A Q = L U` with permutations P and Q, and the rank of A.
pub struct DenseFactor {
    n: usize,
    rank: usize,
    lu: Vec<f64>,
    rows: Vec<usize>,
    columns: Vec<usize>,
}

/// A pivot counts as zero if it is at most this fraction of the largest entry of the matrix.
const SINGULAR: f64 = 1e-10;
/// `A x = b` has a solution if the equations without a pivot leave residuals of at most this fraction of the largest entry of b.
const CONSISTENT: f64 = 1e-9;

impl DenseFactor {
    /// Factors an n x n matrix, whose entries are given row by row.
    pub fn new(n: usize, a: Vec<f64>) -> Self {
        let mut factor = Self { n, rank: n, lu: a, rows: (0..n).collect(), columns: (0..n).collect() };
        let largest = factor.lu.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        factor.rank = (0..n).find(|&k| !factor.eliminate(k, SINGULAR * largest)).unwrap_or(n);
        factor
    }

    pub fn is_regular(&self) -> bool {
        self.rank == self.n
    }

    /// A solution of `A x = b`; `None` if there is no solution.
    pub fn solve(&self, b: &[f64]) -> Option<Vec<f64>> {
        let n = self.n;
        let mut y: Vec<f64> = self.rows.iter().map(|&row| b[row]).collect();
        for k in 0..self.rank {
            for i in k + 1..n {
                y[i] -= self.lu[i * n + k] * y[k];
            }
        }
        let size = b.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
        if y[self.rank..].iter().any(|residual| residual.abs() > CONSISTENT * size) {
            return None;
        }
        let mut x = vec![0.0; n];
        for k in (0..self.rank).rev() {
            let known: f64 = (k + 1..self.rank).map(|j| self.lu[k * n + j] * x[self.columns[j]]).sum();
            x[self.columns[k]] = (y[k] - known) / self.lu[k * n + k];
        }
        Some(x)
    }

    /// Eliminates with the k-th pivot. Returns false if no remaining entry exceeds `least`.
    fn eliminate(&mut self, k: usize, least: f64) -> bool {
        let n = self.n;
        let places = (k..n).flat_map(|i| (k..n).map(move |j| (i, j)));
        let size = |&(i, j): &(usize, usize)| self.lu[i * n + j].abs();
        let Some((row, column)) = places.max_by(|a, b| size(a).total_cmp(&size(b))) else { return false };
        // A comparison with NaN has no result, so this rejects NaN too.
        if size(&(row, column)).partial_cmp(&least) != Some(Ordering::Greater) {
            return false;
        }
        self.exchange(k, row, column);
        for i in k + 1..n {
            let factor = self.lu[i * n + k] / self.lu[k * n + k];
            self.lu[i * n + k] = factor;
            for j in k + 1..n {
                self.lu[i * n + j] -= factor * self.lu[k * n + j];
            }
        }
        true
    }

    fn exchange(&mut self, k: usize, row: usize, column: usize) {
        let n = self.n;
        (0..n).for_each(|j| self.lu.swap(k * n + j, row * n + j));
        (0..n).for_each(|i| self.lu.swap(i * n + k, i * n + column));
        self.rows.swap(k, row);
        self.columns.swap(k, column);
    }
}

/// Solves m equations for m dependent components. `size` is the length that converts rotations to lengths.
pub fn solved_for(
    equations: &[CouplingEquation],
    dependent: &[Dof],
    size: f64,
) -> Result<Vec<CouplingEquation>, Problem> {
    let m = equations.len();
    if dependent.len() != m {
        return Err(CardFault::UmCount { found: dependent.len(), expected: m }.into());
    }
    let columns = columns(equations, size);
    let mut matrix = vec![0.0; m * m];
    for (j, dof) in dependent.iter().enumerate() {
        let column = columns.get(dof).ok_or(CardFault::UmSingular)?;
        (0..m).for_each(|i| matrix[m * i + j] = column[i]);
    }
    let factor = DenseFactor::new(m, matrix);
    if !factor.is_regular() {
        return Err(CardFault::UmSingular.into());
    }
    let others = columns.iter().filter(|(dof, _)| !dependent.contains(dof));
    let solved: Vec<(Dof, Vec<f64>)> =
        others.map(|(&dof, column)| (dof, factor.solve(column).unwrap_or_default())).collect();
    Ok((0..m).map(|i| equation(i, dependent[i], &solved, size)).collect())
}

/// For each component, its coefficients in all equations, after rotations are converted to lengths.
fn columns(equations: &[CouplingEquation], size: f64) -> BTreeMap<Dof, Vec<f64>> {
    let mut columns = BTreeMap::new();
    for (i, equation) in equations.iter().enumerate() {
        for &(dof, value) in &equation.terms {
            let column = columns.entry(dof).or_insert_with(|| vec![0.0; equations.len()]);
            column[i] += value * unit(equation.terms[0].0, size) / unit(dof, size);
        }
    }
    columns
}

fn equation(i: usize, dependent: Dof, solved: &[(Dof, Vec<f64>)], size: f64) -> CouplingEquation {
    let largest = solved.iter().fold(1.0, |m: f64, (_, column)| m.max(column[i].abs()));
    let back = |dof| unit(dof, size) / unit(dependent, size);
    CouplingEquation::new(dependent, solved.iter().map(|(dof, column)| (*dof, -clean(column[i], largest) * back(*dof))))
}

fn unit(dof: Dof, size: f64) -> f64 {
    if dof.component > 3 { size } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regular_systems() {
        let factor = DenseFactor::new(3, vec![0.0, 2.0, 1.0, 1.0, 0.0, 3.0, 4.0, 1.0, 0.0]);
        assert!(factor.is_regular());
        let x = factor.solve(&[7.0, 10.0, 6.0]).expect("a solution");
        for (x, expected) in x.iter().zip([1.0, 2.0, 3.0]) {
            assert!((x - expected).abs() < 1e-14, "{x} for {expected}");
        }
    }

    #[test]
    fn consistent_singular_systems_are_solved() {
        let factor = DenseFactor::new(2, vec![1.0, 2.0, 2.0, 4.0]);
        assert!(!factor.is_regular());
        let x = factor.solve(&[3.0, 6.0]).expect("a solution");
        assert_eq!(x[0] + 2.0 * x[1], 3.0);
        assert!(factor.solve(&[3.0, 5.0]).is_none());
        assert!(!DenseFactor::new(2, vec![0.0; 4]).is_regular());
        assert!(!DenseFactor::new(1, vec![f64::NAN]).is_regular());
    }
}
