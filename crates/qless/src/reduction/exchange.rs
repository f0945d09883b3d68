//! Exchanges a slave s and a master q: `u_q = (u_s - sum_{l != q} T_sl u_l) / T_sq`, and q is replaced in all other rows.

use std::collections::HashMap;

use super::relation::Relation;

/// The relation `u_s = T u_q + ...`, with an index from masters to rows.
pub(super) struct Exchange<'a, 'b> {
    pub relation: &'a mut Relation<'b>,
    /// For each DOF, a superset of the rows that contain it.
    holders: HashMap<u32, Vec<u32>>,
}

impl<'a, 'b> Exchange<'a, 'b> {
    pub fn new(relation: &'a mut Relation<'b>) -> Self {
        let mut holders: HashMap<u32, Vec<u32>> = HashMap::new();
        for i in 0..relation.rows() {
            relation.row(i).dofs().for_each(|j| holders.entry(j).or_default().push(i as u32));
        }
        Self { relation, holders }
    }

    pub fn is_free(&self, dof: u32) -> bool {
        self.relation.system.free()[dof as usize]
    }

    /// Rows that contain a master, ascending, with the [`Relation::size`] of its coefficient.
    pub fn sizes(&self, master: u32) -> Vec<(u32, f64)> {
        let size = |(i, v)| (i, self.relation.size(i as usize, master, v));
        self.holding(master).into_iter().map(size).collect()
    }

    /// Rows that contain a master, ascending, with its coefficient.
    fn holding(&self, master: u32) -> Vec<(u32, f64)> {
        let mut rows = self.holders.get(&master).cloned().unwrap_or_default();
        rows.sort_unstable();
        rows.dedup();
        rows.into_iter().filter_map(|i| Some((i, self.relation.coefficient(i as usize, master)?))).collect()
    }

    /// Makes `master` the slave of row i; returns the other rows that changed.
    pub fn swap(&mut self, i: u32, master: u32) -> Vec<u32> {
        let targets: Vec<_> = self.holding(master).into_iter().filter(|&(k, _)| k != i).collect();
        let (row, constant) = self.solved_for(i, master);
        self.holders.remove(&master);
        let slave = std::mem::replace(&mut self.relation.slave[i as usize], master);
        self.holders.entry(slave).or_default().push(i);
        for &(k, factor) in &targets {
            let (merged, new) = merge(&self.relation.sorted(k as usize), master, factor, &row);
            new.into_iter().for_each(|j| self.hold(j, k));
            self.relation.change(k as usize, &merged);
            self.relation.constant[k as usize] += factor * constant;
        }
        self.relation.change(i as usize, &row);
        self.relation.constant[i as usize] = constant;
        self.relation.row_of[slave as usize] = u32::MAX;
        self.relation.row_of[master as usize] = i;
        targets.into_iter().map(|(k, _)| k).collect()
    }

    /// Notes that row k contains a DOF. Where entries cancel and come back, a row is noted again.
    fn hold(&mut self, dof: u32, k: u32) {
        let holders = self.holders.entry(dof).or_default();
        holders.push(k);
        if holders.len() > 2 * self.relation.slave.len() {
            holders.sort_unstable();
            holders.dedup();
        }
    }

    /// Row i solved for a master.
    fn solved_for(&self, i: u32, master: u32) -> (Vec<(u32, f64)>, f64) {
        let pivot = self.relation.coefficient(i as usize, master).unwrap_or_default();
        let slave = self.relation.slave[i as usize];
        let old = self.relation.sorted(i as usize);
        let mut row: Vec<_> = old.into_iter().filter(|e| e.0 != master).map(|(j, v)| (j, -v / pivot)).collect();
        let place = row.partition_point(|&(j, _)| j < slave);
        row.insert(place, (slave, 1.0 / pivot));
        (row, -self.relation.constant[i as usize] / pivot)
    }
}

/// The row `old` without its entry at `master`, plus `factor` times `row`; ascending, without entries that cancel to rounding. Also the
/// DOFs that are not in `old`.
fn merge(old: &[(u32, f64)], master: u32, factor: f64, row: &[(u32, f64)]) -> (Vec<(u32, f64)>, Vec<u32>) {
    let mut merged = Vec::with_capacity(old.len() + row.len());
    let mut new = Vec::new();
    let (mut a, mut b) = (old.iter().filter(|e| e.0 != master).peekable(), row.iter().peekable());
    loop {
        let next = match (a.peek(), b.peek()) {
            (None, None) => return (merged, new),
            (Some(x), Some(y)) if x.0 == y.0 => {
                let (own, part) = (x.1, factor * y.1);
                let sum = own + part;
                (x.0, if sum.abs() <= 1e-14 * own.abs().max(part.abs()) { 0.0 } else { sum }, true, true)
            }
            (Some(x), other) if other.is_none_or(|y| x.0 < y.0) => (x.0, x.1, true, false),
            (_, Some(y)) => {
                new.push(y.0);
                (y.0, factor * y.1, false, true)
            }
            (Some(_), None) => unreachable!("covered by the arm before"),
        };
        if next.2 {
            a.next();
        }
        if next.3 {
            b.next();
        }
        if next.1 != 0.0 {
            merged.push((next.0, next.1));
        }
    }
}
