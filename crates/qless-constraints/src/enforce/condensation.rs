//! `K_q = L^T K L`, `f_q = L^T (f - K u_0)` for some of the equations: what is left when their slaves are eliminated.
//!
//! Where T would fill, nothing is eliminated: the slaves of such a part stay unknowns, and its equations are left for multipliers.
//! The solution is the same; `L^T K L` of a dense T is as large as the square of the masters.

use faer::sparse::SymbolicSparseColMat;
use qless::{Condensed, ConstraintSystem, Form, Given, Map, Options, SystemBuilder, View, analyse};

use super::matrix::{Matrix, compressed};
use super::{EnforceError, Problem};

/// Some independent equations on K; prescribed DOFs are in `u_0`.
pub struct Condensation {
    pub map: Map,
    pub condensed: Condensed,
    /// The equations that unknowns have to meet.
    pub left: Vec<usize>,
}

impl Condensation {
    /// Eliminates the slaves of `rows` where T stays sparse; with no rows, prescribed DOFs alone.
    pub fn new(system: &ConstraintSystem, rows: &[usize], k: &Matrix) -> Result<Self, EnforceError> {
        let map = map_of(system, rows)?;
        let condensed =
            map.condensed(View::columns(k.symbolic().col_ptr(), k.symbolic().row_idx()), Given::Eliminated)?;
        let left = condensed.left(&map).into_iter().map(|i| rows[i]).collect();
        Ok(Self { map, condensed, left })
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

/// The map of some equations of a system; parts whose T would fill stay factors.
pub fn map_of(system: &ConstraintSystem, rows: &[usize]) -> Result<Map, EnforceError> {
    let mut builder = SystemBuilder::new(system.dofs());
    rows.iter().for_each(|&row| {
        builder.equation(system.matrix().row(row), system.rhs()[row]);
    });
    system.prescribed().iter().for_each(|&(dof, value)| builder.prescribe(dof, value));
    Ok(Map::of(analyse(&builder.build()?, &Options::default())?, Form::Auto)?)
}

impl Problem<'_> {
    /// K in compressed columns.
    pub(super) fn stiffness(&self) -> Result<std::borrow::Cow<'_, Matrix>, EnforceError> {
        compressed(self.k)
    }
}
