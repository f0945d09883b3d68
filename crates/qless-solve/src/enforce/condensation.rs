//! `K_q = L^T K L`, `f_q = L^T (f - K u_0)` for some of the equations: what is left when their slaves are eliminated.
//!
//! Where T would fill, nothing is eliminated: the slaves of such a part stay unknowns, and its equations are left for multipliers.
//! The solution is the same; `L^T K L` of a dense T is as large as the square of the masters.
//! @@ enforce/noise.rs
//! Entries of T that are rounding.
//!
//! ```text
//! R T S, the largest number of each row and column being 1 (Ruiz 2001)        real: above 2^-40
//! ```
//!
//! T comes out of a factorization, which leaves some `eps` of its numbers where it has zeros. A stiffness that a master feels through such entries
//! alone is none: in sizes of terms they count as what they are the rounding of. Where the numbers of a row are in other units, R and S show it.
//! Cost: a pass over T, and a dozen where entries are small.

use faer::sparse::SymbolicSparseColMat;
use qless::elimination::{CondensedPattern, PrescribedDofs, View};
use qless::{ConstraintSystem, Csr, Elimination, Form, Options, SystemBuilder, analyse};

use super::EnforceError;
use super::singularity::WRONG;
use crate::common::SparseMatrix;

/// Some independent equations on K, with prescribed DOFs at rest and right-hand sides that are [`Condensation::set`].
pub struct Condensation {
    pub elimination: Elimination,
    pub condensed: CondensedPattern,
    /// The equations that unknowns have to meet.
    pub left: Vec<usize>,
}

impl Condensation {
    /// Eliminates the slaves of `rows` where T stays sparse; with no rows, prescribed DOFs alone.
    pub fn new(system: &ConstraintSystem, rows: &[usize], k: &SparseMatrix) -> Result<Self, EnforceError> {
        let elimination = elimination_of(system, rows)?;
        let condensed = elimination
            .condensed(View::columns(k.symbolic().col_ptr(), k.symbolic().row_idx()), PrescribedDofs::Eliminated)?;
        let left = condensed.left(&elimination).into_iter().map(|i| rows[i]).collect();
        Ok(Self { elimination, condensed, left })
    }

    /// New right-hand sides of the equations.
    pub fn set(&mut self, rhs: &[f64]) -> Result<(), EnforceError> {
        if rhs.is_empty() {
            return Ok(());
        }
        let at_rest = vec![0.0; self.elimination.prescribed().len()];
        Ok(self.elimination.update(rhs, &at_rest)?)
    }

    /// `u_0` of all DOFs that are no unknowns.
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

/// The map of some equations of a system, all right-hand sides zero; parts whose T would fill stay factors.
pub fn elimination_of(system: &ConstraintSystem, rows: &[usize]) -> Result<Elimination, EnforceError> {
    let mut builder = SystemBuilder::new(system.dofs());
    rows.iter().for_each(|&row| {
        builder.equation(system.matrix().row(row), 0.0);
    });
    system.prescribed().iter().for_each(|&(dof, _)| builder.prescribe(dof, 0.0));
    Ok(Elimination::from_analysis(analyse(&builder.build()?, &Options::default())?, Form::Auto)?)
}

/// What is smaller in every unit is rounding.
const NOISE: f64 = 1.0 / (1_u64 << 40) as f64;
/// Passes; each takes the root of what is missing.
const SWEEPS: usize = 12;

/// The units of rows and columns, where any entry is small in its row.
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

    /// The size of the terms that an entry was made of: its own, or that of which it is the rounding.
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
