//! The result of elimination: pivots, dependent rows, and the core for the backend.

use super::rows::WorkingRow;
use crate::input::components::components;
use crate::input::scale::ldexp;

/// One pivot, with its row at the time of the elimination.
#[derive(Clone, Debug)]
pub(crate) struct Step {
    /// Index of the pivot row among the rows that were passed to the elimination.
    pub row: u32,
    /// The DOF of the pivot, which becomes a slave.
    pub dof: u32,
    /// The coefficient of the slave.
    pub pivot: f64,
    /// The other entries of the row, as `(DOF, coefficient)`.
    pub others: Vec<(u32, f64)>,
    pub rhs: f64,
    /// [`WorkingRow::reach`] of the pivot row: the largest product of factors by which elimination added a user's equation to the row.
    pub reach: f64,
}

/// A row in which the coefficients of all free DOFs vanished.
#[derive(Clone, Debug)]
pub(crate) struct EmptiedRow {
    pub row: u32,
    /// The largest [`Entry::certain_left`](super::rows::Entry::certain_left) of the row's coefficients: the fraction of a coefficient's
    /// largest term that was treated as zero. Coefficients that were dropped earlier count too. 0 if only rounding was dropped.
    pub dropped: f64,
    /// [`WorkingRow::reach`] of this row: the largest product of factors by which elimination added a user's equation to the row.
    pub reach: f64,
    /// The right-hand side of the row (without prescribed terms) minus that of its certificate.
    pub mismatch: Mismatch,
}

/// Difference between the right-hand side of a dependent row and that of its certificate.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Mismatch {
    pub value: f64,
    /// The largest term of the sum that gave the mismatch.
    pub size: f64,
    /// Bound of the rounding error of the mismatch.
    pub error: f64,
}

impl Mismatch {
    pub fn of_row(row: &WorkingRow) -> Self {
        Self { value: row.effective, size: row.effective_size, error: row.effective_error }
    }

    /// Multiplies value, size and error by `2^exponent`.
    pub fn scaled(self, exponent: i32) -> Self {
        let Self { value, size, error } = self;
        Self { value: ldexp(value, exponent), size: ldexp(size, exponent), error: ldexp(error, exponent) }
    }

    /// Subtracts `factor` times another right-hand side; updates size and error too.
    pub fn subtract(&mut self, factor: f64, other: Self) {
        let part = (factor * other.size).abs();
        self.value -= factor * other.value;
        self.size = self.size.max(part);
        self.error += factor.abs() * other.error + f64::EPSILON * part;
    }
}

/// The result of the elimination.
#[derive(Default)]
pub(crate) struct Eliminated {
    /// For each row, the index of the user's equation.
    pub names: Vec<u32>,
    pub steps: Vec<Step>,
    /// For each row, the steps whose pivot rows were subtracted from it and the factors, in the order of the subtractions.
    pub factors: Vec<Vec<(u32, f64)>>,
    pub dead: Vec<EmptiedRow>,
    /// Rows left for the backend, ascending.
    pub core: Vec<u32>,
    /// The rows after elimination; only rows of the core have entries.
    pub rows: Vec<WorkingRow>,
}

impl Eliminated {
    /// Joins the results of groups of rows; no two groups share a free DOF. Rows are sorted by the user's number, as if all had been
    /// eliminated together.
    pub fn join(mut groups: Vec<Self>) -> Self {
        if groups.len() < 2 {
            return groups.pop().unwrap_or_default();
        }
        let mut order: Vec<(u32, usize, usize)> = Vec::new();
        for (g, group) in groups.iter().enumerate() {
            order.extend(group.names.iter().enumerate().map(|(i, &name)| (name, g, i)));
        }
        order.sort_unstable();
        let mut number: Vec<Vec<u32>> = groups.iter().map(|group| vec![0; group.names.len()]).collect();
        order.iter().zip(0..).for_each(|(&(_, g, i), k)| number[g][i] = k);
        let mut first = vec![0_u32];
        groups.iter().for_each(|group| first.push(first[first.len() - 1] + group.steps.len() as u32));
        let mut all = Self::default();
        for &(name, g, i) in &order {
            all.names.push(name);
            let mut factors = std::mem::take(&mut groups[g].factors[i]);
            factors.iter_mut().for_each(|(step, _)| *step += first[g]);
            all.factors.push(factors);
            all.rows.push(std::mem::take(&mut groups[g].rows[i]));
        }
        for (group, number) in groups.into_iter().zip(&number) {
            let renamed = |row: u32| number[row as usize];
            all.steps.extend(group.steps.into_iter().map(|step| Step { row: renamed(step.row), ..step }));
            all.dead.extend(group.dead.into_iter().map(|dead| EmptiedRow { row: renamed(dead.row), ..dead }));
            all.core.extend(group.core.into_iter().map(renamed));
        }
        all.core.sort_unstable();
        all
    }

    /// The rows of the core by part; `is_free` is indexed by the DOFs of the result.
    pub fn components(&self, is_free: &[bool]) -> Vec<Vec<u32>> {
        let free = |i: u32| self.rows[i as usize].entries.iter().map(|e| e.dof).filter(|&j| is_free[j as usize]);
        components(&self.core, is_free.len(), free)
    }
}
