//! Condensation of K by some of the equations: `K_q = L^T K L`, `f_q = L^T (f - K u_0)`, with their slaves eliminated.
//!
//! If T of a connected component would fill, nothing is eliminated there: its slaves stay unknowns, and its equations need multipliers. The
//! solution is the same; `L^T K L` of a dense T grows with the square of the number of masters.
//!
//! Entries of T that are rounding are recognised by their size in an equilibrated T ([`TransformNoise`]):
//!
//! ```text
//! R T S, the largest number of each row and column being 1 (Ruiz 2001)        real: above 2^-40
//! ```
//!
//! A factorization leaves entries of relative size `eps` where T has zeros. A master that only such entries connect to K has no stiffness.
//! In sizes of terms, such an entry therefore counts as the number whose rounding it is. R and S are needed because the entries of a row
//! may have different units. Cost: one pass over T, and a dozen if some entries are small.

use faer::sparse::SymbolicSparseColMat;
use qless::elimination::{CondensedPattern, PrescribedDofs, View};
use qless::{ConstraintSystem, Csr, Elimination, Form, Options, SystemBuilder, analyse};

use super::EnforceError;
use super::singularity::WRONG;
use crate::common::SparseMatrix;

/// Condensation by some independent equations. Prescribed DOFs are zero; right-hand sides are passed to [`Condensation::set`].
pub struct Condensation {
    pub elimination: Elimination,
    pub condensed: CondensedPattern,
    /// The equations that are not eliminated.
    pub remaining: Vec<usize>,
}

impl Condensation {
    /// Eliminates the slaves of `rows` where T stays sparse. Without rows, only prescribed DOFs are removed.
    pub fn new(system: &ConstraintSystem, rows: &[usize], k: &SparseMatrix) -> Result<Self, EnforceError> {
        let elimination = elimination_of(system, rows)?;
        let condensed = elimination
            .condensed(View::columns(k.symbolic().col_ptr(), k.symbolic().row_idx()), PrescribedDofs::Eliminated)?;
        let remaining = condensed.remaining_equations(&elimination).into_iter().map(|i| rows[i]).collect();
        Ok(Self { elimination, condensed, remaining })
    }

    /// Sets the right-hand sides of the equations.
    pub fn set(&mut self, rhs: &[f64]) -> Result<(), EnforceError> {
        if rhs.is_empty() {
            return Ok(());
        }
        let at_rest = vec![0.0; self.elimination.prescribed().len()];
        Ok(self.elimination.update(rhs, &at_rest)?)
    }

    /// `u_0` of the DOFs that are not unknowns; zero for the others.
    pub fn constant(&self) -> Result<Vec<f64>, EnforceError> {
        let mut u = vec![0.0; self.elimination.dofs()];
        self.elimination.expand_into(&vec![0.0; self.elimination.masters().len()], &mut u)?;
        self.condensed.dofs().iter().for_each(|&dof| u[dof] = 0.0);
        Ok(u)
    }

    /// K_q.
    pub fn matrix(&self, k: &SparseMatrix) -> Result<SparseMatrix, EnforceError> {
        let mut values = vec![0.0; self.condensed.nnz()];
        self.condensed.condense_matrix_into(&self.elimination, k.val(), &mut values)?;
        let n = self.condensed.unknowns();
        let wide = |numbers: &[u32]| numbers.iter().map(|&k| k as usize).collect();
        let (starts, index) = (wide(self.condensed.starts()), wide(self.condensed.index()));
        Ok(SparseMatrix::new(SymbolicSparseColMat::new_checked(n, n, starts, None, index), values))
    }

    /// `f_q`.
    pub fn load(&self, k: &SparseMatrix, f: &[f64]) -> Result<Vec<f64>, EnforceError> {
        let mut load = vec![0.0; self.condensed.unknowns()];
        self.condensed.load_into(&self.elimination, k.val(), f, &mut load)?;
        Ok(load)
    }

    /// All DOFs from the unknowns.
    pub fn expand(&self, x: &[f64]) -> Result<Vec<f64>, EnforceError> {
        let place = |dof: &usize| self.condensed.dofs().binary_search(dof).unwrap_or_default();
        let masters: Vec<f64> = self.elimination.masters().iter().map(|dof| x[place(dof)]).collect();
        let mut u = vec![0.0; self.elimination.dofs()];
        self.elimination.expand_into(&masters, &mut u)?;
        Ok(u)
    }
}

/// The elimination of some equations, with zero right-hand sides; components whose T would fill are kept as factors.
pub fn elimination_of(system: &ConstraintSystem, rows: &[usize]) -> Result<Elimination, EnforceError> {
    let mut builder = SystemBuilder::new(system.dofs());
    rows.iter().for_each(|&row| {
        builder.equation(system.matrix().row(row), 0.0);
    });
    system.prescribed().iter().for_each(|&(dof, _)| builder.prescribe(dof, 0.0));
    Ok(Elimination::from_analysis(analyse(&builder.build()?, &Options::default())?, Form::Auto)?)
}

/// Equilibrated entries up to this size are rounding.
const NOISE: f64 = 1.0 / (1_u64 << 40) as f64;
/// Passes of equilibration; each takes square roots of the largest entries.
const SWEEPS: usize = 12;

/// Row and column scales of T; none if no entry is small in its row.
#[derive(Debug)]
pub struct TransformNoise {
    scales: Option<(Vec<f64>, Vec<f64>)>,
}

impl TransformNoise {
    pub fn new(t: &Csr) -> Self {
        let is_small = |i: usize| {
            let sizes = t.row(i).map(|(_, v)| v.abs()).filter(|v| *v > 0.0);
            let (least, most) = sizes.fold((f64::INFINITY, 0.0_f64), |(a, b), v| (a.min(v), b.max(v)));
            least < NOISE * most
        };
        Self { scales: (0..t.rows()).any(is_small).then(|| equilibrated(t)) }
    }

    /// Size of the terms of an entry: its own, or that of the number whose rounding it is.
    pub fn size(&self, row: usize, col: usize, value: f64) -> f64 {
        let Some((of_row, of_col)) = &self.scales else { return value.abs() };
        let unit = 1.0 / (of_row[row] * of_col[col]);
        if value.abs() > NOISE * unit { value.abs() } else { unit.min(value.abs() / WRONG) }
    }
}

fn equilibrated(t: &Csr) -> (Vec<f64>, Vec<f64>) {
    let (mut of_row, mut of_col) = (vec![1.0; t.rows()], vec![1.0; t.cols()]);
    for _ in 0..SWEEPS {
        let (mut rows, mut cols) = (vec![0.0_f64; t.rows()], vec![0.0_f64; t.cols()]);
        for i in 0..t.rows() {
            for (j, v) in t.row(i) {
                let v = of_row[i] * v.abs() * of_col[j];
                rows[i] = rows[i].max(v);
                cols[j] = cols[j].max(v);
            }
        }
        let halve = |scales: &mut [f64], most: &[f64]| {
            scales
                .iter_mut()
                .zip(most)
                .filter(|(_, most)| **most > 0.0)
                .for_each(|(scale, most)| *scale /= most.sqrt());
        };
        halve(&mut of_row, &rows);
        halve(&mut of_col, &cols);
    }
    (of_row, of_col)
}
