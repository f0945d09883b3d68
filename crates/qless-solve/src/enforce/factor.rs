//! `A x = b` by `S A S = L L^T` where A may be definite, by LU with partial pivoting otherwise.
//!
//! S takes the units off ([`super::scale`]): without it, pivots of a saddle matrix in SI units are chosen by units. There is no
//! `L D L^T` here: faer's has no pivoting across the pattern, and a saddle matrix has zeros on its diagonal.

use qless::elimination::Storage;

use super::EnforceError;
use super::matrix::{Matrix, entries, from_triplets};
use super::solver::{Columns, Llt, Lu, Solver, SolverError};

/// A factorization that can be used again.
pub struct Factor {
    units: Vec<f64>,
    solver: Option<Box<dyn Solver>>,
}

/// A scaled matrix with the integers of the solvers.
struct Scaled {
    starts: Vec<u32>,
    rows: Vec<u32>,
    values: Vec<f64>,
}

impl Factor {
    /// With the units of the unknowns; `definite` is whether Cholesky is worth a try.
    pub fn new(a: &Matrix, units: Vec<f64>, definite: bool) -> Result<Self, EnforceError> {
        if a.nrows() == 0 {
            return Ok(Self { units, solver: None });
        }
        let scaled = Scaled::new(a, &units)?;
        let mut solver: Box<dyn Solver> = Box::new(Llt::default());
        if !definite || solver.factor(scaled.columns()).is_err() {
            solver = Box::new(Lu::default());
            solver.factor(scaled.columns())?;
        }
        Ok(Self { units, solver: Some(solver) })
    }

    /// `A^-1 b`; an error where a pivot was zero.
    pub fn solve(&mut self, b: &[f64]) -> Result<Vec<f64>, EnforceError> {
        let mut x: Vec<f64> = b.iter().zip(&self.units).map(|(b, s)| b * s).collect();
        let Some(solver) = &mut self.solver else { return Ok(x) };
        solver.solve(&mut x)?;
        x.iter_mut().zip(&self.units).for_each(|(x, s)| *x *= s);
        if x.iter().all(|x| x.is_finite()) { Ok(x) } else { Err(SolverError("a pivot is zero".into()).into()) }
    }
}

/// What is added to the diagonal of unknown j, in its unit, to make a singular matrix regular. No two are the same: where forces that A cannot
/// carry and motions that it does not feel have nothing in common, `A + s I` is as good as singular.
pub fn uneven(shift: f64, j: usize, unit: f64) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    shift * (1.0 + (j as f64 * GOLDEN).fract()) / (unit * unit)
}

/// A with a shift added to the first of its diagonal: regular where A is not.
pub fn shifted(a: &Matrix, units: &[f64], count: usize, shift: f64) -> Result<Matrix, EnforceError> {
    let diagonal = (0..count).map(|j| (j, j, uneven(shift, j, units[j])));
    from_triplets(a.nrows(), a.ncols(), entries(a).chain(diagonal))
}

impl Scaled {
    fn new(a: &Matrix, units: &[f64]) -> Result<Self, EnforceError> {
        let too_large = |_| EnforceError::TooLarge { rows: a.nrows(), cols: a.ncols() };
        let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        for j in 0..a.ncols() {
            for (i, v) in a.symbolic().row_idx_of_col(j).zip(a.val_of_col(j)) {
                rows.push(u32::try_from(i).map_err(too_large)?);
                values.push(units[i] * v * units[j]);
            }
            starts.push(u32::try_from(rows.len()).map_err(too_large)?);
        }
        Ok(Self { starts, rows, values })
    }

    fn columns(&self) -> Columns<'_> {
        Columns { starts: &self.starts, rows: &self.rows, values: &self.values, storage: Storage::Full }
    }
}
