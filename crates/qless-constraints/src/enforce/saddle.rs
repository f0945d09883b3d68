//! `[T^T K T, (C T)^T; C T, 0] [q; lambda] = [T^T (f - K u_0); b - C u_0]`: elimination and multipliers in one matrix.
//!
//! With no rows in C it is the transformation (Eq. 7-9), with T only picking free DOFs it is Lagrange's method (Eq. 10).

use qless::ArgumentError;

use super::expansion::Expansion;
use super::matrix::{Factor, Matrix, entries, from_triplets, product, times, transposed};
use super::{EnforceError, Problem};

/// u and the multipliers of `rows`.
pub fn solve(problem: &Problem, expansion: &Expansion, rows: &[usize]) -> Result<(Vec<f64>, Vec<f64>), EnforceError> {
    let back = transposed(&expansion.t)?;
    let constraints = chosen(problem, rows)?;
    let stiffness = product(&back, &product(problem.k, &expansion.t)?)?;
    let matrix = bordered(&stiffness, &product(&constraints, &expansion.t)?)?;
    let stressed = times(problem.k, &expansion.constant);
    let load: Vec<f64> = problem.f.iter().zip(stressed).map(|(f, k)| f - k).collect();
    let mut rhs = times(&back, &load);
    let offset = times(&constraints, &expansion.constant);
    rhs.extend(rows.iter().zip(offset).map(|(&row, c)| problem.system.rhs()[row] - c));
    let what = if rows.is_empty() { "the reduced stiffness" } else { "the matrix with multipliers" };
    let x = Factor::new(&matrix, what)?.solve(&rhs)?;
    let (q, lambda) = x.split_at(stiffness.nrows());
    let u = times(&expansion.t, q).iter().zip(&expansion.constant).map(|(u, c)| u + c).collect();
    Ok((u, lambda.to_vec()))
}

/// Some rows of C.
fn chosen(problem: &Problem, rows: &[usize]) -> Result<Matrix, EnforceError> {
    let row = |(i, &row): (usize, &usize)| problem.system.matrix().row(row).map(move |(j, v)| (i, j, v));
    from_triplets(rows.len(), problem.system.dofs(), rows.iter().enumerate().flat_map(row))
}

/// `[A B^T; B 0]`.
pub fn bordered(a: &Matrix, b: &Matrix) -> Result<Matrix, EnforceError> {
    let (n, size) = (a.nrows(), a.nrows() + b.nrows());
    let border = entries(b).flat_map(|(i, j, v)| [(n + i, j, v), (j, n + i, v)]);
    from_triplets(size, size, entries(a).chain(border))
}

impl Problem<'_> {
    /// Lagrange's matrix `[K C^T; C 0]` on the DOFs that are not prescribed, for the equations `rows` (Eq. 10).
    ///
    /// With a redundant equation among them it is singular, whatever K is.
    ///
    /// # Errors
    /// [`EnforceError::Argument`] for a row that is not there, another [`EnforceError`] if the matrix does not fit into memory.
    pub fn lagrange_matrix(&self, rows: &[usize]) -> Result<Matrix, EnforceError> {
        let count = self.system.equations();
        if let Some(&found) = rows.iter().find(|&&row| row >= count) {
            return Err(ArgumentError::OutOfRange { what: "equation", found, count }.into());
        }
        let free = Expansion::new(self.system, &[])?.t;
        let stiffness = product(&transposed(&free)?, &product(self.k, &free)?)?;
        bordered(&stiffness, &product(&chosen(self, rows)?, &free)?)
    }
}
