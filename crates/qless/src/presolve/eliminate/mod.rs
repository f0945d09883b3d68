//! Elimination with little fill: `row_k <- row_k - (a_kj / a_pj) row_p`, first wherever that adds no net entry.
//!
//! A pivot (p, j) adds none if row p has one free DOF (j is fixed: a generated boundary condition), if it has two
//! (`a u_i + c u_j = d`: chains, cycles, trees of equal DOFs), or if DOF j occurs in at most two remaining rows.
//! Long chains take linear time, without recursion. A row whose free part vanishes is dependent. In a connected part that keeps more than
//! [`LARGE`] rows, DOFs that occur in few rows are then eliminated with some fill, as by Markowitz (1957).
//!
//! Every coefficient carries a bound of its rounding error, and every row the size of the largest part that went into it.
//! What cancels to the first is zero; a row all below `tolerance` times the second is dependent too; a row below
//! [`SUSPECT`] times it is left to the backend, whose rank is checked.

use std::collections::VecDeque;

use super::eliminated::Eliminated;
use super::gather::Gathered;
use crate::input::components::components;
use crate::input::scale::ldexp;

mod order;
mod pivot;

/// A row whose remaining part is smaller than this, relative to what went into it, is no pivot.
pub(crate) const SUSPECT: f64 = 1e-3;
/// A pivot is at least this fraction of the entries that it eliminates, which bounds the multipliers, ...
const THRESHOLD: f64 = 0.1;
/// ... and at least a fraction of its own row, the strictest first, which bounds the growth of T as long as it can be.
/// The first levels make no fill; the others follow only while the core is [`LARGE`].
const LEVELS: [FillLevel; 6] = [
    FillLevel { rows: 2, of_row: 1.0 },
    FillLevel { rows: 2, of_row: 0.1 },
    FillLevel { rows: 2, of_row: 1e-3 },
    FillLevel { rows: 3, of_row: 1.0 },
    FillLevel { rows: 5, of_row: 1.0 },
    FillLevel { rows: 8, of_row: 1.0 },
];
const WITHOUT_FILL: usize = 3;

/// Most that coefficients along a way from slave to slave may multiply to: with it numbers of T could grow, and lose digits.
const PATH: f64 = 1e3;

/// A row with more free DOFs is no pivot for others: each time all of it would go over.
const LONG: u32 = 64;

/// A connected part with more rows than this is worth some fill: factoring it costs more than eliminating from it.
const LARGE: usize = 800;

/// Most entries that one pivot may touch, `(row length - 1) (rows - 1)`, where there is fill.
const MARKOWITZ: u32 = 48;

/// Which DOFs may be eliminated: in at most so many rows, with at least this size relative to their pivot row.
struct FillLevel {
    rows: u32,
    of_row: f64,
}

#[derive(Clone, Copy, PartialEq)]
enum EquationState {
    Active,
    Done,
    /// Too small for a pivot here: for the backend.
    Held,
}

struct LowFillElimination<'a> {
    out: Eliminated,
    state: Vec<EquationState>,
    is_free: &'a [bool],
    /// Rows that may hold a DOF: a superset without order; `count` is exact.
    holders: Vec<Vec<u32>>,
    count: Vec<u32>,
    /// For each DOF the largest product of coefficients along a way from a slave to it.
    path: Vec<f64>,
    /// Largest coefficient of a free DOF in each row; no number where the row has changed since it was last asked for.
    largest: Vec<f64>,
    short_rows: VecDeque<u32>,
    /// DOFs in at most two rows; those whose coefficients are too small in their rows wait in the next queue.
    rare_dofs: [VecDeque<u32>; LEVELS.len()],
    /// Rows that are neither pivots nor dependent; while filling, those of the part that is worked on.
    active: usize,
    filling: bool,
    tolerance: f64,
}

/// Eliminates without fill, and with some in large parts. Rows of `held` (by the user's row) are not used as pivots, but are classified if empty.
/// DOFs of the result are local ones.
pub(crate) fn eliminate(gathered: Gathered, tolerance: f64, held: &[bool]) -> Eliminated {
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
        short_rows: (0..m as u32).collect(),
        rare_dofs: Default::default(),
        active: m,
        filling: false,
        tolerance,
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

    /// Goes on with some fill in each connected part that is large, which no other part has a say in.
    fn fill(&mut self) {
        if self.active <= LARGE {
            return;
        }
        let left: Vec<u32> =
            (0..self.state.len() as u32).filter(|&i| self.state[i as usize] != EquationState::Done).collect();
        let parts = components(&left, self.count.len(), |i| {
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

    /// DOFs by their numbers and in their units again.
    fn finish(mut self, names: Vec<u32>, dofs: &[u32], power: &[i32]) -> Eliminated {
        let of_user = |j: u32, v: f64| (dofs[j as usize], ldexp(v, -power[j as usize]));
        self.out.names = names;
        let left = |&i: &u32| self.state[i as usize] != EquationState::Done;
        self.out.core = (0..self.out.rows.len() as u32).filter(left).collect();
        for (row, state) in self.out.rows.iter_mut().zip(&self.state) {
            row.forget_table();
            if *state == EquationState::Done {
                row.entries = Vec::new();
            }
            for entry in &mut row.entries {
                (entry.dof, entry.value) = of_user(entry.dof, entry.value);
            }
        }
        for step in &mut self.out.steps {
            step.dof = dofs[step.dof as usize];
            step.others.iter_mut().for_each(|(j, v)| (*j, *v) = of_user(*j, *v));
        }
        self.out
    }
}
