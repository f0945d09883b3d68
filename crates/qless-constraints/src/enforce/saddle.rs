//! `[K_q, C_q^T; C_q, 0] [q; lambda] = [f_q; b_q]`: elimination and multipliers in one matrix.
//!
//! With no rows in C it is the transformation (Eq. 7-9), with nothing eliminated it is Lagrange's method (Eq. 10).

use qless::ArgumentError;

use super::condensation::Condensation;
use super::matrix::{Factor, Matrix, entries, from_triplets};
use super::{EnforceError, Problem};

/// u and the multipliers of `rows`, where the slaves of others are eliminated.
pub fn solve(problem: &Problem, some: &Condensation, rows: &[usize]) -> Result<(Vec<f64>, Vec<f64>), EnforceError> {
    let k = problem.stiffness()?;
    let all: Vec<usize> = [rows, &some.left].concat();
    let (border, offsets) = over_unknowns(problem, some, &all)?;
    let stiffness = some.matrix(&k)?;
    let mut rhs = some.load(&k, problem.f)?;
    rhs.extend(offsets);
    let what = if rows.is_empty() { "the reduced stiffness" } else { "the matrix with multipliers" };
    let matrix = if all.is_empty() { stiffness } else { bordered(&stiffness, &border)? };
    let x = Factor::new(&matrix, what)?.solve(&rhs)?;
    let (q, lambda) = x.split_at(some.condensed.unknowns());
    Ok((some.expand(q)?, lambda[..rows.len()].to_vec()))
}

/// Some rows of C and b, over the unknowns.
fn over_unknowns(problem: &Problem, some: &Condensation, rows: &[usize]) -> Result<(Matrix, Vec<f64>), EnforceError> {
    let (mut triplets, mut offsets) = (Vec::new(), Vec::new());
    for (i, &row) in rows.iter().enumerate() {
        let equation = problem.system.matrix().row(row);
        let (terms, b) = some.condensed.equation(&some.map, equation, problem.system.rhs()[row])?;
        triplets.extend(terms.into_iter().map(|(j, v)| (i, j, v)));
        offsets.push(b);
    }
    Ok((from_triplets(rows.len(), some.condensed.unknowns(), triplets)?, offsets))
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
        let k = self.stiffness()?;
        let free = Condensation::new(self.system, &[], &k)?;
        bordered(&free.matrix(&k)?, &over_unknowns(self, &free, rows)?.0)
    }
}
