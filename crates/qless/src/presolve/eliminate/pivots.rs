//! The order of the elimination, and the rules for pivots.

use super::{
    EquationState, LARGE, LEVELS, LONG, LowFillElimination, MARKOWITZ, PATH, SUSPECT, THRESHOLD, WITHOUT_FILL,
};
use crate::presolve::rows::Entry;

impl LowFillElimination<'_> {
    pub(super) fn next_dof(&mut self) -> Option<(usize, u32)> {
        let levels = if self.filling && self.active > LARGE { LEVELS.len() } else { WITHOUT_FILL };
        self.rare_dofs[..levels].iter_mut().enumerate().find_map(|(level, queue)| Some((level, queue.pop_front()?)))
    }

    /// Queues a DOF at the first level of elimination, from `least` on, that allows a pivot in as many rows as contain the DOF.
    pub(super) fn enqueue(&mut self, j: u32, least: usize) {
        let levels = if self.filling { LEVELS.len() } else { WITHOUT_FILL };
        let count = self.count[j as usize];
        if let Some(level) = (least..levels).find(|&level| count <= LEVELS[level].rows) {
            self.rare_dofs[level].push_back(j);
        }
    }

    pub(super) fn try_row(&mut self, i: u32) {
        if self.state[i as usize] != EquationState::Active || self.out.rows[i as usize].free > 2 || self.settle(i) {
            return;
        }
        let row = &self.out.rows[i as usize];
        let free: Vec<_> = row.entries.iter().copied().filter(|entry| self.is_free[entry.dof as usize]).collect();
        let dof = match *free.as_slice() {
            [one] => one.dof,
            [one, two] => self.better_of(one, two),
            _ => return,
        };
        self.pivot(i, dof);
    }

    /// The pivot of `a u_i + c u_j`: the larger coefficient, or the DOF in far fewer rows if its coefficient is large enough.
    fn better_of(&self, one: Entry, two: Entry) -> u32 {
        let (large, small) = if two.value.abs() > one.value.abs() { (two, one) } else { (one, two) };
        if large.left() <= SUSPECT && small.left() > SUSPECT {
            return small.dof;
        }
        let cheaper = self.count[large.dof as usize] > 4 * self.count[small.dof as usize];
        let may_be = small.left() > SUSPECT && small.value.abs() >= THRESHOLD * large.value.abs();
        if cheaper && may_be { small.dof } else { large.dof }
    }

    pub(super) fn try_dof(&mut self, j: u32, level: usize) {
        let count = self.count[j as usize];
        if count == 0 || count > LEVELS[level].rows {
            return self.enqueue(j, level + 1);
        }
        let mut holders = self.holding(j);
        holders.sort_unstable_by_key(|&(i, _)| (self.out.rows[i as usize].free, i));
        let Some(&(i, _)) = holders.iter().find(|&&(i, v)| self.may_pivot((i, j), v, &holders, LEVELS[level].of_row))
        else {
            return self.enqueue(j, level + 1);
        };
        if level >= WITHOUT_FILL && (self.out.rows[i as usize].free - 1) * (count - 1) > MARKOWITZ {
            return;
        }
        if !self.settle(i) {
            self.pivot(i, j);
        }
    }

    /// Remaining rows that contain a DOF, with its coefficient; removes the other rows from the list of the DOF.
    pub(super) fn holding(&mut self, j: u32) -> Vec<(u32, Entry)> {
        let mut list = std::mem::take(&mut self.holders[j as usize]);
        list.sort_unstable();
        list.dedup();
        let found = list.iter().filter(|&&i| self.state[i as usize] != EquationState::Done).filter_map(|&i| {
            let row = &self.out.rows[i as usize];
            row.position(j).map(|k| (i, row.entries[k]))
        });
        let found: Vec<_> = found.collect();
        list.clear();
        list.extend(found.iter().map(|&(i, _)| i));
        self.holders[j as usize] = list;
        found
    }

    fn may_pivot(&mut self, (i, j): (u32, u32), entry: Entry, holders: &[(u32, Entry)], of_row: f64) -> bool {
        let value = entry.value;
        let is_short = self.out.rows[i as usize].free <= LONG || holders.len() == 1;
        if self.state[i as usize] != EquationState::Active || !is_short {
            return false;
        }
        let largest = self.largest(i);
        entry.left() > SUSPECT
            && value.abs() >= of_row * largest
            && self.path[j as usize] * largest <= PATH * value.abs()
            && holders.iter().all(|(_, v)| value.abs() >= THRESHOLD * v.value.abs())
    }

    /// Largest coefficient of a free DOF in a row.
    pub(super) fn largest(&mut self, i: u32) -> f64 {
        if self.largest[i as usize].is_nan() {
            let entries = self.out.rows[i as usize].entries.iter();
            let free = entries.filter(|entry| self.is_free[entry.dof as usize]);
            self.largest[i as usize] = free.map(|entry| entry.value.abs()).fold(0.0, f64::max);
        }
        self.largest[i as usize]
    }
}
