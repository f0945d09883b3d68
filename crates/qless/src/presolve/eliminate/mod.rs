//! Elimination with little fill: `row_k <- row_k - (a_kj / a_pj) row_p`, first for pivots that do not add entries.
//!
//! A pivot (p, j) adds no entries if row p has one free DOF (j is fixed: a generated boundary condition), if it has two
//! (`a u_i + c u_j = d`: chains, cycles, trees of equal DOFs), or if DOF j occurs in at most two remaining rows.
//! Long chains take linear time, without recursion. A row whose free coefficients all vanish is dependent. If more than [`LARGE`] rows of
//! a part remain, DOFs that occur in few rows are then eliminated with some fill, by the rule of Markowitz (1957).
//!
//! Each coefficient has a bound of its rounding error, and the size of its largest term. A coefficient of at most 16 times its error bound
//! is zero. A row is also dependent if at most the fraction `tolerance` is left of the terms of each coefficient. A coefficient from which
//! nothing was subtracted is no remainder, however small. If less than [`SUSPECT`] of a row is left, it goes to the backend, whose rank is
//! checked.

use std::collections::VecDeque;

use super::eliminated::Eliminated;
use super::gather::Gathered;
use crate::input::components::components;
use crate::input::scale::ldexp;

mod apply;
mod pivots;

/// A coefficient that retains less than this fraction of its terms is not used as a pivot: it has lost three digits.
pub(crate) const SUSPECT: f64 = 1e-3;
/// A pivot of a DOF in few rows is at least this fraction of each entry that it eliminates, which bounds the multipliers. In a row of two
/// DOFs, the smaller coefficient can be the pivot only if it is at least this fraction of the larger one.
const THRESHOLD: f64 = 0.1;
/// Levels of elimination, tried in this order. A pivot is at least `of_row` times the largest coefficient of its row. Strict levels come
/// first and limit the growth of T. The first three add no fill; the others are used only while a part has more than [`LARGE`] rows.
const LEVELS: [FillLevel; 6] = [
    FillLevel { rows: 2, of_row: 1.0 },
    FillLevel { rows: 2, of_row: 0.1 },
    FillLevel { rows: 2, of_row: 1e-3 },
    FillLevel { rows: 3, of_row: 1.0 },
    FillLevel { rows: 5, of_row: 1.0 },
    FillLevel { rows: 8, of_row: 1.0 },
];
const WITHOUT_FILL: usize = 3;

/// Bound of the product of coefficients along a path of substitutions from slave to slave. Larger products could make entries of T large
/// and inaccurate.
const PATH: f64 = 1e3;

/// A row with more free DOFs than this is not subtracted from other rows, because that would copy all of it.
const LONG: u32 = 64;

/// In a part with more rows than this, elimination with some fill costs less than factorization.
const LARGE: usize = 800;

/// Bound of the entries that one pivot changes, `(row length - 1) (rows - 1)`, in elimination with fill.
const MARKOWITZ: u32 = 48;

/// A level of elimination: which pivots are allowed.
struct FillLevel {
    /// Upper bound of the number of rows that contain the DOF of the pivot.
    rows: u32,
    /// Lower bound of the pivot relative to the largest coefficient of its row.
    of_row: f64,
}

#[derive(Clone, Copy, PartialEq)]
enum EquationState {
    Active,
    Done,
    /// Not used as a pivot row; left to the backend.
    Held,
}

struct LowFillElimination<'a> {
    out: Eliminated,
    state: Vec<EquationState>,
    is_free: &'a [bool],
    /// For each DOF, the rows that may contain it: an unsorted superset; `count` is exact.
    holders: Vec<Vec<u32>>,
    count: Vec<u32>,
    /// For each DOF, the largest product of coefficients along a path of substitutions from a slave to this DOF.
    path: Vec<f64>,
    /// Largest coefficient of a free DOF in each row; NaN if the row has changed since the value was computed.
    largest: Vec<f64>,
    short_rows: VecDeque<u32>,
    /// For each level, DOFs that occur in few rows; a DOF without an allowed pivot moves to the next level.
    rare_dofs: [VecDeque<u32>; LEVELS.len()],
    /// Number of rows that are neither pivot rows nor dependent; while `filling`, only rows of the current part count.
    active: usize,
    filling: bool,
    tolerance: f64,
    is_absolute: bool,
}

/// Eliminates without fill, and with some fill in large parts. Rows of `held` (by the user's row) are not used as pivot rows; they stay for
/// the backend, unless they have no free DOF from the start. DOFs of the result are local. The tolerance is absolute, or relative to the
/// largest term of each coefficient.
pub(crate) fn eliminate(gathered: Gathered, tolerance: f64, is_absolute: bool, held: &[bool]) -> Eliminated {
    let Gathered { names, dofs, free: is_free, power, rows } = gathered;
    let m = rows.len();
    let mut work = LowFillElimination {
        out: Eliminated { rows, factors: vec![Vec::new(); m], ..Eliminated::default() },
        state: names
            .iter()
            .map(|&i| if held[i as usize] { EquationState::Held } else { EquationState::Active })
            .collect(),
        is_free: &is_free,
        holders: vec![Vec::new(); dofs.len()],
        count: vec![0; dofs.len()],
        path: vec![1.0; dofs.len()],
        largest: vec![f64::NAN; m],
        short_rows: VecDeque::new(),
        rare_dofs: Default::default(),
        active: m,
        filling: false,
        tolerance,
        is_absolute,
    };
    work.count();
    work.close_empty();
    work.run();
    work.fill();
    work.finish(names, &dofs, &power)
}

impl LowFillElimination<'_> {
    fn count(&mut self) {
        for (i, row) in self.out.rows.iter_mut().enumerate() {
            row.free = 0;
            for j in row.entries.iter().map(|entry| entry.dof).filter(|&j| self.is_free[j as usize]) {
                row.free += 1;
                self.count[j as usize] += 1;
                self.holders[j as usize].push(i as u32);
            }
        }
        // Fixed DOFs are eliminated first, so that their values lose no digits in differences.
        let (fixed, others): (Vec<u32>, Vec<u32>) =
            (0..self.out.rows.len() as u32).partition(|&i| self.out.rows[i as usize].free == 1);
        self.short_rows = [fixed, others].concat().into();
        self.rare_dofs[0].extend((0..self.count.len() as u32).filter(|&j| self.count[j as usize] <= 2));
    }

    fn run(&mut self) {
        loop {
            if let Some(i) = self.short_rows.pop_front() {
                self.try_row(i);
            } else if let Some((level, j)) = self.next_dof() {
                self.try_dof(j, level);
            } else {
                return;
            }
        }
    }

    /// Continues the elimination with some fill in each part of more than [`LARGE`] rows. Each part is eliminated alone, so its result does
    /// not depend on the other parts.
    fn fill(&mut self) {
        if self.active <= LARGE {
            return;
        }
        let remaining: Vec<u32> =
            (0..self.state.len() as u32).filter(|&i| self.state[i as usize] != EquationState::Done).collect();
        let parts = components(&remaining, self.count.len(), |i| {
            self.out.rows[i as usize].entries.iter().map(|entry| entry.dof).filter(|&j| self.is_free[j as usize])
        });
        self.filling = true;
        for part in parts.into_iter().filter(|part| part.len() > LARGE) {
            let entries = |&i: &u32| self.out.rows[i as usize].entries.iter().map(|entry| entry.dof);
            let mut dofs: Vec<u32> = part.iter().flat_map(entries).filter(|&j| self.is_free[j as usize]).collect();
            dofs.sort_unstable();
            dofs.dedup();
            self.active = part.len();
            dofs.into_iter().for_each(|j| self.enqueue(j, WITHOUT_FILL));
            self.run();
            self.rare_dofs.iter_mut().for_each(VecDeque::clear);
        }
    }

    fn close_empty(&mut self) {
        for i in 0..self.out.rows.len() as u32 {
            if self.out.rows[i as usize].free == 0 {
                self.settle(i);
            }
        }
    }

    /// Replaces gathered DOF numbers by local ones, and converts coefficients to the units before gathering. Lists the remaining rows in
    /// `core`.
    fn finish(mut self, names: Vec<u32>, dofs: &[u32], power: &[i32]) -> Eliminated {
        let restored = |j: u32, v: f64| (dofs[j as usize], ldexp(v, -power[j as usize]));
        self.out.names = names;
        let remains = |&i: &u32| self.state[i as usize] != EquationState::Done;
        self.out.core = (0..self.out.rows.len() as u32).filter(remains).collect();
        for (row, state) in self.out.rows.iter_mut().zip(&self.state) {
            row.forget_table();
            if *state == EquationState::Done {
                row.entries = Vec::new();
            }
            for entry in &mut row.entries {
                *entry = entry.renamed(dofs[entry.dof as usize], -power[entry.dof as usize]);
            }
        }
        for step in &mut self.out.steps {
            step.dof = dofs[step.dof as usize];
            step.others.iter_mut().for_each(|(j, v)| (*j, *v) = restored(*j, *v));
        }
        self.out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::common::SplitMix64;
    use crate::presolve::rows::{Entry, WorkingRow};

    fn eliminated(rows: &[Vec<(u32, f64)>], sides: &[f64], dofs: usize) -> Eliminated {
        let row = |(row, &side): (&Vec<(u32, f64)>, &f64)| {
            let mut new = WorkingRow::new(side);
            row.iter().for_each(|&(j, v)| new.insert(Entry::given(j, v)));
            new
        };
        let gathered = Gathered {
            names: (0..rows.len() as u32).collect(),
            dofs: (0..dofs as u32).collect(),
            free: vec![true; dofs],
            power: vec![0; dofs],
            rows: rows.iter().zip(sides).map(row).collect(),
        };
        eliminate(gathered, 1e-10, false, &vec![false; rows.len()])
    }

    /// The mismatches, and the coefficients and sides of the remaining rows, each with the bound of its error.
    fn numbers(eliminated: &Eliminated) -> Vec<(f64, f64)> {
        let mismatches = eliminated.dead.iter().map(|dead| (dead.mismatch.value, dead.mismatch.error));
        let rows = eliminated.core.iter().map(|&i| &eliminated.rows[i as usize]);
        let sides = rows.clone().map(|row| (row.effective, row.effective_error));
        let entries = rows.flat_map(|row| &row.entries).map(|entry| (entry.value, entry.error()));
        mismatches.chain(sides).chain(entries).collect()
    }

    /// By differences. Coefficients that vanish count as zero, so that mismatches depend on the given sides only.
    #[test]
    fn bounds_of_errors_cover_a_rounding_of_each_number_given() {
        const STEP: f64 = 1e-6;
        let (mut random, mut ratios) = (SplitMix64::new(9), Vec::new());
        for case in 0..1000 {
            let mut below = |most: u64| random.next() % most;
            let (m, n) = (4 + case % 5, 5 + case % 6);
            let number = |k: u64| (if k.is_multiple_of(2) { 1.0 } else { -1.0 }) * (1 + k / 2) as f64 / 500.0;
            let mut rows: Vec<Vec<(u32, f64)>> = Vec::new();
            for _ in 1..m {
                let mut row: Vec<_> =
                    (0..2 + below(4)).map(|_| (below(n as u64) as u32, number(below(2000)))).collect();
                row.sort_unstable_by_key(|&(j, _)| j);
                row.dedup_by_key(|&mut (j, _)| j);
                rows.push(row);
            }
            rows.push(rows[case % (m - 1)].iter().map(|&(j, v)| (j, -2.0 * v)).collect());
            let sides: Vec<f64> = (0..m).map(|_| number(below(2000))).collect();
            let given = eliminated(&rows, &sides, n);
            let found = numbers(&given);
            let mut effects = vec![0.0; found.len()];
            let mut add = |rows: &[Vec<(u32, f64)>], sides: &[f64], first: usize| {
                let changed = eliminated(rows, sides, n);
                let pivots = |of: &Eliminated| of.steps.iter().map(|step| (step.row, step.dof)).collect::<Vec<_>>();
                let new = numbers(&changed);
                if pivots(&changed) == pivots(&given) && new.len() == found.len() {
                    let effect = |k: usize| (new[k].0 - found[k].0).abs() / STEP * f64::EPSILON;
                    (first..new.len()).for_each(|k| effects[k] += effect(k));
                }
            };
            for i in 0..m {
                let mut changed = sides.clone();
                changed[i] *= 1.0 + STEP;
                add(&rows, &changed, 0);
                for k in 0..rows[i].len() {
                    let mut changed = rows.clone();
                    changed[i][k].1 *= 1.0 + STEP;
                    add(&changed, &sides, given.dead.len());
                }
            }
            for ((value, error), effect) in found.into_iter().zip(effects) {
                assert!(effect <= 1.001 * error, "case {case}: {value} +- {error:e}, found {effect:e}");
                ratios.push(error / effect);
            }
        }
        ratios.sort_unstable_by(f64::total_cmp);
        assert!(ratios.len() > 1000 && ratios[ratios.len() / 2] < 2.0, "{} numbers", ratios.len());
    }
}
