//! The equations of a reduction, held against their terms: K_q alone does not show what it was made of.

use super::super::equations::{Equations, Goal, settle};
use super::super::factor::{Factor, shifted};
use super::super::matrix::{Matrix, add_sizes, add_sizes_transposed, add_transposed, times};
use super::super::support::{SHIFTS, Verdict, judged, loose};
use super::super::{EnforceError, Motion, scale};

/// Solutions and refinements at most.
const REFINEMENTS: usize = 6;

/// `T^T K T q + B^T lambda = f_q`, `B q = 0`, term by term.
pub struct Transformed<'a> {
    pub k: &'a Matrix,
    pub t: Matrix,
    /// What its entries are up to.
    pub t_sizes: Matrix,
    pub constraints: Matrix,
    pub units: Vec<f64>,
    pub parts: Vec<usize>,
}

impl Transformed<'_> {
    /// In balance, or refused.
    pub fn solved(&self, matrix: &Matrix, rhs: (&[f64], &[f64])) -> Result<Vec<f64>, EnforceError> {
        let singular = EnforceError::Singular { what: "the reduced stiffness" };
        let Ok(mut factor) = Factor::new(matrix, self.units.clone(), false) else {
            return Err(self.free_motion(matrix).unwrap_or(singular));
        };
        let mut solve = |r: &[f64]| factor.solve(r);
        match judged(self, &mut solve) {
            Ok(Verdict::Held(_)) => {}
            Ok(Verdict::Loose(motion, held)) => return Err(self.unsupported(&motion, held)),
            Err(_) => return Err(self.free_motion(matrix).unwrap_or(singular)),
        }
        let settled = settle(self, &mut solve, rhs, &Goal::balance(REFINEMENTS))?;
        if settled.share > 1.0 {
            let row = format!("the forces on unknown {}", settled.row);
            return Err(EnforceError::OutOfBalance { row, imbalance: settled.imbalance });
        }
        Ok(settled.x)
    }

    fn free_motion(&self, matrix: &Matrix) -> Option<EnforceError> {
        let motion = |shift: f64| {
            let matrix = shifted(matrix, &self.units, self.t.ncols(), shift).ok()?;
            let mut factor = Factor::new(&matrix, self.units.clone(), false).ok()?;
            let (motion, held) = loose(self, &mut |r: &[f64]| factor.solve(r))?;
            Some(self.unsupported(&motion, held))
        };
        SHIFTS.into_iter().find_map(motion)
    }

    fn unsupported(&self, motion: &[f64], held: f64) -> EnforceError {
        let (u, units) = (times(&self.t, &motion[..self.t.ncols()]), scale::units_of(self.k));
        EnforceError::Unsupported(Motion::new(&u, &units, held))
    }
}

impl Equations for Transformed<'_> {
    fn apply(&self, x: &[f64]) -> Vec<f64> {
        let (q, lambda) = x.split_at(self.t.ncols());
        let mut y = vec![0.0; q.len()];
        add_transposed(&self.t, &times(self.k, &times(&self.t, q)), &mut y);
        add_transposed(&self.constraints, lambda, &mut y);
        y.extend(times(&self.constraints, q));
        y
    }

    fn size(&self, x: &[f64]) -> Vec<f64> {
        let (q, lambda) = x.split_at(self.t.ncols());
        let (mut u, mut forces, mut y) = (vec![0.0; self.k.nrows()], vec![0.0; self.k.nrows()], vec![0.0; q.len()]);
        add_sizes(&self.t_sizes, q, &mut u);
        add_sizes(self.k, &u, &mut forces);
        add_sizes_transposed(&self.t_sizes, &forces, &mut y);
        add_sizes_transposed(&self.constraints, lambda, &mut y);
        let mut gaps = vec![0.0; lambda.len()];
        add_sizes(&self.constraints, q, &mut gaps);
        [y, gaps].concat()
    }

    fn units(&self) -> &[f64] {
        &self.units
    }

    fn parts(&self) -> &[usize] {
        &self.parts
    }
}
