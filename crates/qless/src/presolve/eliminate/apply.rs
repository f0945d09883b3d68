//! Elimination of a pivot from the other rows, and removal of dependent rows.

use super::{EquationState, LowFillElimination, SUSPECT};
use crate::presolve::eliminated::{EmptiedRow, Mismatch, Step};
use crate::presolve::rows::{Entry, WorkingRow};

impl LowFillElimination<'_> {
    /// Classifies a row as dependent if at most the tolerance is left of it, and holds it for the backend if at most [`SUSPECT`] is left.
    /// Returns true in both cases.
    pub(super) fn settle(&mut self, i: u32) -> bool {
        let left = self.left(i);
        if left > SUSPECT {
            return false;
        }
        if left > self.tolerance {
            self.state[i as usize] = EquationState::Held;
            return true;
        }
        let row = &self.out.rows[i as usize];
        let free = row.entries.iter().filter(|entry| self.is_free[entry.dof as usize]);
        let dropped = free.map(Entry::certain_left).fold(row.dropped, f64::max);
        self.out.dead.push(EmptiedRow { row: i, dropped, reach: row.reach, mismatch: Mismatch::of_row(row) });
        self.retire(i);
        true
    }

    /// What is left of row i: the largest [`Entry::left`] of its free DOFs, the fraction of a coefficient's largest term that is left. If
    /// the tolerance is absolute: the largest coefficient of a free DOF.
    fn left(&self, i: u32) -> f64 {
        let entries = self.out.rows[i as usize].entries.iter();
        let free = entries.filter(|entry| self.is_free[entry.dof as usize]);
        free.map(|entry| if self.is_absolute { entry.value.abs() } else { entry.left() }).fold(0.0, f64::max)
    }

    fn retire(&mut self, i: u32) {
        self.state[i as usize] = EquationState::Done;
        self.active -= 1;
        let entries = std::mem::take(&mut self.out.rows[i as usize].entries);
        for j in entries.iter().map(|entry| entry.dof).filter(|&j| self.is_free[j as usize]) {
            self.leave(j);
        }
        self.out.rows[i as usize].entries = entries;
    }

    pub(super) fn leave(&mut self, dof: u32) {
        self.count[dof as usize] -= 1;
        self.enqueue(dof, 0);
    }

    /// Row i becomes the equation of DOF j, which is eliminated from all other rows.
    pub(super) fn pivot(&mut self, i: u32, j: u32) {
        let targets = self.holding(j);
        self.retire(i);
        let mut row = std::mem::take(&mut self.out.rows[i as usize]);
        let position = row.entries.iter().position(|e| e.dof == j).expect("the pivot row holds the pivot DOF");
        let pivot = row.entries.swap_remove(position);
        for (k, entry) in targets.into_iter().filter(|&(k, _)| k != i) {
            self.subtract(k, j, entry.value / pivot.value, &pivot, &row);
        }
        self.count[j as usize] = 0;
        self.holders[j as usize] = Vec::new();
        let path_to_pivot = self.path[j as usize] / pivot.value.abs();
        for entry in &row.entries {
            let path = &mut self.path[entry.dof as usize];
            *path = path.max(path_to_pivot * entry.value.abs());
        }
        let others = row.entries.iter().map(|entry| (entry.dof, entry.value)).collect();
        self.out.steps.push(Step { row: i, dof: j, pivot: pivot.value, others, rhs: row.rhs, reach: row.reach });
    }

    /// `row_k <- row_k - factor row`, where `row` no longer contains the pivot.
    fn subtract(&mut self, k: u32, j: u32, factor: f64, pivot: &Entry, row: &WorkingRow) {
        self.out.factors[k as usize].push((self.out.steps.len() as u32, factor));
        self.largest[k as usize] = f64::NAN;
        let target = &mut self.out.rows[k as usize];
        // Relative error of the factor: the errors of the pivot and of the entry, and one rounding.
        let mut relative = pivot.error() / pivot.value.abs() + f64::EPSILON;
        if let Some(position) = target.position(j) {
            let gone = target.remove(position);
            target.free -= 1;
            relative += gone.error() / gone.value.abs();
        }
        let mut mismatch = Mismatch::of_row(target);
        mismatch.subtract(factor, Mismatch::of_row(row));
        target.rhs -= factor * row.rhs;
        target.reach = target.reach.max(factor.abs() * row.reach);
        (target.effective, target.effective_size, target.effective_error) =
            (mismatch.value, mismatch.size, mismatch.error + relative * (factor * row.effective).abs());
        for entry in &row.entries {
            let part = factor * entry.value;
            let error = relative * part.abs() + factor.abs() * entry.error();
            self.add(k, entry.dof, -part, error, factor.abs() * entry.size());
        }
        match self.out.rows[k as usize].free {
            0 | 1 => self.short_rows.push_front(k),
            2 => self.short_rows.push_back(k),
            _ => {}
        }
    }

    fn add(&mut self, k: u32, l: u32, value: f64, error: f64, size: f64) {
        let free = self.is_free[l as usize];
        let row = &mut self.out.rows[k as usize];
        if free {
            // A product that underflows is not exactly zero, so it counts as dropped.
            let underflow = if value.abs() < f64::MIN_POSITIVE { f64::MIN_POSITIVE } else { 0.0 };
            row.dropped = row.dropped.max(underflow);
        }
        if let Some(position) = row.position(l) {
            if let Some(given_up) = row.add(position, value, error, size) {
                row.remove(position);
                if free {
                    row.dropped = row.dropped.max(given_up);
                    row.free -= 1;
                    self.leave(l);
                }
            }
            return;
        }
        row.insert(Entry::new(l, value, error, size));
        if free {
            row.free += 1;
            self.count[l as usize] += 1;
            self.holders[l as usize].push(k);
        }
    }
}
