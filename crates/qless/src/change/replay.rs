//! Repeats the elimination on new right-hand sides, step by step: `b_k <- b_k - factor b_p`, where p is the pivot row of the step.

use crate::Analysis;
use crate::factor::backend::BackendError;
use crate::factor::block::Block;
use crate::factor::lu::{self, LuError};
use crate::factor::solver::SlaveSolver;
use crate::input::numbering::LocalSystem;
use crate::input::scale::{Scaling, ldexp};
use crate::presolve::basis::Kept;
use crate::presolve::eliminated::Mismatch;
use crate::presolve::rows::WorkingRow;
use crate::reduction::block::may_be_slaves;

/// The right-hand side of a row.
#[derive(Clone, Copy, Default)]
pub struct RowRhs {
    /// The right-hand side b.
    pub rhs: f64,
    /// `b - C_p u_p`: b minus the terms of the prescribed DOFs.
    pub effective: Mismatch,
}

impl RowRhs {
    fn subtract(&mut self, factor: f64, other: Self) {
        self.rhs -= factor * other.rhs;
        self.effective.subtract(factor, other.effective);
        // `factor` is rounded; adds the error of the product that this causes.
        self.effective.error += f64::EPSILON * (factor * other.effective.value).abs();
    }
}

/// The right-hand sides of all rows for one b and u_p.
pub struct Replay<'a> {
    analysis: &'a Analysis,
    local: LocalSystem<'a>,
    /// The user's right-hand sides b.
    pub rhs: &'a [f64],
    /// For each DOF by its local number, its prescribed value, or 0 if it is free. Empty if u_p is zero.
    values: Vec<f64>,
    /// Stated errors of the right-hand sides, in scaled rows; None if there are none.
    noise: Option<&'a [f64]>,
    /// The right-hand side of the pivot row of each step.
    pub steps: Vec<RowRhs>,
}

impl<'a> Replay<'a> {
    /// Repeats the elimination for the right-hand sides `rhs` without errors and these prescribed values. If `prescribed` is empty, u_p is
    /// zero.
    pub fn new(analysis: &'a Analysis, rhs: &'a [f64], prescribed: &[f64]) -> Self {
        Self::with_noise(analysis, rhs, prescribed, None)
    }

    /// [`Replay::new`] for right-hand sides with these errors, in scaled rows.
    pub fn with_noise(analysis: &'a Analysis, rhs: &'a [f64], prescribed: &[f64], noise: Option<&'a [f64]>) -> Self {
        let local = analysis.numbering.view(&analysis.system, rhs);
        let mut values = vec![0.0; if prescribed.is_empty() { 0 } else { local.dofs() }];
        if !values.is_empty() {
            local.prescribed_places().for_each(|(l, place)| values[l] = prescribed[place]);
        }
        let steps = Vec::with_capacity(analysis.history.steps.len());
        let mut replay = Self { analysis, local, rhs, values, noise, steps };
        for &row in &analysis.history.steps {
            let side = replay.row(row);
            replay.steps.push(side);
        }
        replay
    }

    /// The scaled right-hand sides of row `i` after all steps; i counts the rows that went through elimination.
    pub fn row(&self, i: u32) -> RowRhs {
        let history = &self.analysis.history;
        let user = history.rows[i as usize] as usize;
        let mut side = self.side(user, true);
        history.factors[i as usize].iter().for_each(|&(step, factor)| side.subtract(factor, self.steps[step as usize]));
        side
    }

    /// `b - C_p u_p` of a user's equation (b minus the terms of its prescribed DOFs), unscaled.
    pub fn of_user(&self, row: usize) -> Mismatch {
        self.side(row, false).effective
    }

    fn side(&self, row: usize, scaled: bool) -> RowRhs {
        let exponent = if scaled { self.analysis.scaling.row[row] } else { 0 };
        let mut sum = WorkingRow::new(ldexp(self.rhs[row], exponent));
        let noise = self.noise.map_or(0.0, |noise| noise[row]);
        sum.effective_error += ldexp(noise, exponent - self.analysis.scaling.row[row]);
        if !self.values.is_empty() {
            let fixed = self.local.row(row).filter(|&(j, _)| !self.local.free()[j]);
            fixed.for_each(|(j, v)| sum.prescribe(ldexp(v, exponent) * self.values[j]));
        }
        RowRhs { rhs: sum.rhs, effective: Mismatch::of_row(&sum) }
    }
}

/// Solves the kept rows of a block for their slaves.
pub struct BlockSolver {
    /// For each kept row, the exponent by which the block scales it.
    exponents: Vec<i32>,
    solver: SlaveSolver,
    /// For each entry of a solution, its local DOF and the exponent of the scaling of this DOF.
    slaves: Vec<(u32, i32)>,
}

impl BlockSolver {
    pub fn new(block: &Block, kept: &Kept, scaling: &Scaling, memory: usize) -> Result<Self, BackendError> {
        let rows: Vec<usize> = kept.rows.iter().filter_map(|row| block.rows.binary_search(row).ok()).collect();
        let matrix = block.select(&rows);
        let order: Vec<usize> = kept.order.iter().map(|&i| i as usize).collect();
        let may = may_be_slaves(block, kept, memory)?;
        // Any solution of the rows gives g. If LU finds the columns of the reduction's slaves dependent, it chooses among all DOFs.
        let lu = match lu::factor(&matrix, &order, |j| may[j], memory) {
            Err(LuError::Dependent) => lu::factor(&matrix, &order, |_| true, memory),
            lu => lu,
        };
        let lu = lu.map_err(|error| error.of_block("refresher", &matrix, memory))?;
        let slave = |&j: &u32| (block.dofs[j as usize], scaling.col(block.dofs[j as usize] as usize));
        let slaves = lu.slaves.iter().map(slave).collect();
        let exponents = rows.iter().map(|&i| block.exponents[i]).collect();
        Ok(Self { exponents, solver: SlaveSolver::new(&matrix, lu), slaves })
    }

    /// Sets the slaves in u (local numbers) for the right-hand sides b of the kept rows, as if the other DOFs of the block were zero.
    pub fn solve(&self, mut b: Vec<f64>, u: &mut [f64]) {
        b.iter_mut().zip(&self.exponents).for_each(|(b, &shift)| *b = ldexp(*b, shift));
        let x = self.solver.solve_dense(&b);
        self.slaves.iter().zip(x).for_each(|(&(j, exponent), x)| u[j as usize] = ldexp(x, exponent));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::common::SplitMix64;

    /// `b_2 - (a / p) b_1` of whole numbers, compared in integers with the rounded quotient, product and difference.
    #[test]
    fn bounds_of_rounding_hold() {
        let mut random = SplitMix64::new(1);
        for _ in 0..10_000 {
            let mut next = |least: u64| (least + random.next() % least) as i32;
            let [a, p, first, second] = [next(1 << 20), next(1 << 9), next(1 << 20), next(1 << 29)];
            let side = |value: i32| {
                let value = f64::from(value);
                RowRhs { rhs: value, effective: Mismatch { value, size: value, error: 0.0 } }
            };
            let mut found = side(second);
            found.subtract(f64::from(a) / f64::from(p), side(first));
            let Mismatch { value, error, .. } = found.effective;
            // Products of factors above 1024 have no digit below 2^-52.
            let digits = 2_f64.powi(52);
            let truth = i128::from(second) * i128::from(p) - i128::from(a) * i128::from(first);
            let off = (value * digits) as i128 * i128::from(p) - truth * (1 << 52);
            assert!(
                off.abs() as f64 <= error * f64::from(p) * digits,
                "{second} - {a} / {p} {first}: {value}, {error:e}"
            );
        }
    }
}
