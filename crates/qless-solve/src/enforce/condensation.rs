//! `K_q = L^T K L`, `f_q = L^T (f - K u_0)` for some of the equations: what is left when their slaves are eliminated.
//!
//! Where T would fill, nothing is eliminated: the slaves of such a part stay unknowns, and its equations are left for multipliers.
//! The solution is the same; `L^T K L` of a dense T is as large as the square of the masters.

use faer::sparse::SymbolicSparseColMat;
use qless::elimination::{CondensedPattern, PrescribedDofs, View};
use qless::{ConstraintSystem, Elimination, Form, Options, SystemBuilder, analyse};

use super::EnforceError;
use super::matrix::Matrix;

/// Some independent equations on K, with prescribed DOFs at rest and right-hand sides that are [`Condensation::set`].
pub struct Condensation {
    pub map: Elimination,
    pub condensed: CondensedPattern,
    /// The equations that unknowns have to meet.
    pub left: Vec<usize>,
}

impl Condensation {
    /// Eliminates the slaves of `rows` where T stays sparse; with no rows, prescribed DOFs alone.
    pub fn new(system: &ConstraintSystem, rows: &[usize], k: &Matrix) -> Result<Self, EnforceError> {
        let map = map_of(system, rows)?;
        let condensed =
            map.condensed(View::columns(k.symbolic().col_ptr(), k.symbolic().row_idx()), PrescribedDofs::Eliminated)?;
        let left = condensed.left(&map).into_iter().map(|i| rows[i]).collect();
        Ok(Self { map, condensed, left })
    }

    /// New right-hand sides of the equations.
    pub fn set(&mut self, rhs: &[f64]) -> Result<(), EnforceError> {
        if rhs.is_empty() {
            return Ok(());
        }
        let at_rest = vec![0.0; self.map.prescribed().len()];
        Ok(self.map.update(rhs, &at_rest)?)
    }

    /// `u_0` of all DOFs that are no unknowns.
    pub fn constant(&self) -> Result<Vec<f64>, EnforceError> {
        let mut u = vec![0.0; self.map.dofs()];
        self.map.expand_into(&vec![0.0; self.map.masters().len()], &mut u)?;
        self.condensed.dofs().iter().for_each(|&dof| u[dof] = 0.0);
        Ok(u)
    }

    /// K_q.
    pub fn matrix(&self, k: &Matrix) -> Result<Matrix, EnforceError> {
        let mut values = vec![0.0; self.condensed.nnz()];
        self.condensed.condense_matrix_into(&self.map, k.val(), &mut values)?;
        let n = self.condensed.unknowns();
        let wide = |numbers: &[u32]| numbers.iter().map(|&k| k as usize).collect();
        let (starts, index) = (wide(self.condensed.starts()), wide(self.condensed.index()));
        Ok(Matrix::new(SymbolicSparseColMat::new_checked(n, n, starts, None, index), values))
    }

    /// `f_q`.
    pub fn load(&self, k: &Matrix, f: &[f64]) -> Result<Vec<f64>, EnforceError> {
        let mut load = vec![0.0; self.condensed.unknowns()];
        self.condensed.load_into(&self.map, k.val(), f, &mut load)?;
        Ok(load)
    }

    /// All DOFs from the unknowns.
    pub fn expand(&self, x: &[f64]) -> Result<Vec<f64>, EnforceError> {
        let place = |dof: &usize| self.condensed.dofs().binary_search(dof).unwrap_or_default();
        let masters: Vec<f64> = self.map.masters().iter().map(|dof| x[place(dof)]).collect();
        let mut u = vec![0.0; self.map.dofs()];
        self.map.expand_into(&masters, &mut u)?;
        Ok(u)
    }
}

/// The map of some equations of a system, all right-hand sides zero; parts whose T would fill stay factors.
pub fn map_of(system: &ConstraintSystem, rows: &[usize]) -> Result<Elimination, EnforceError> {
    let mut builder = SystemBuilder::new(system.dofs());
    rows.iter().for_each(|&row| {
        builder.equation(system.matrix().row(row), 0.0);
    });
    system.prescribed().iter().for_each(|&(dof, _)| builder.prescribe(dof, 0.0));
    Ok(Elimination::from_analysis(analyse(&builder.build()?, &Options::default())?, Form::Auto)?)
}
