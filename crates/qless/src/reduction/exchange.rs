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

    /// The coefficient of a master in row i, if it is stored; it may be zero.
    fn entry(&self, i: u32, master: u32) -> Option<f64> {
        self.relation.row(i as usize).entries().find(|&(j, _)| j == master).map(|(_, v)| v)
    }

    /// Rows that contain a master, ascending, with its coefficient.
    pub fn holding(&self, master: u32) -> Vec<(u32, f64)> {
        let mut rows = self.holders.get(&master).cloned().unwrap_or_default();
        rows.sort_unstable();
        rows.dedup();
        rows.into_iter().filter_map(|i| Some((i, self.entry(i, master)?))).collect()
    }

    /// Makes `master` the slave of row i; returns the other rows that changed.
    pub fn swap(&mut self, i: u32, master: u32) -> Vec<u32> {
        let targets: Vec<_> = self.holding(master).into_iter().filter(|&(k, _)| k != i).collect();
        let (row, constant) = self.solved_for(i, master);
        self.holders.remove(&master);
        for &(k, factor) in &targets {
            let merged = merge(&self.relation.sorted(k as usize), master, factor, &row);
            self.relation.change(k as usize, &merged);
            self.relation.constant[k as usize] += factor * constant;
        }
        let changed: Vec<u32> = targets.into_iter().map(|(k, _)| k).collect();
        for &(j, _) in &row {
            let holders = self.holders.entry(j).or_default();
            holders.extend(changed.iter().copied().chain([i]));
            if holders.len() > 2 * self.relation.slave.len() {
                holders.sort_unstable();
                holders.dedup();
            }
        }
        let slave = std::mem::replace(&mut self.relation.slave[i as usize], master);
        self.relation.change(i as usize, &row);
        self.relation.constant[i as usize] = constant;
        self.relation.row_of[slave as usize] = u32::MAX;
        self.relation.row_of[master as usize] = i;
        changed
    }

    /// Row i solved for a master.
    fn solved_for(&self, i: u32, master: u32) -> (Vec<(u32, f64)>, f64) {
        let (pivot, slave) = (self.entry(i, master).unwrap_or_default(), self.relation.slave[i as usize]);
        let old = self.relation.sorted(i as usize);
        let mut row: Vec<_> = old.into_iter().filter(|e| e.0 != master).map(|(j, v)| (j, -v / pivot)).collect();
        let place = row.partition_point(|&(j, _)| j < slave);
        row.insert(place, (slave, 1.0 / pivot));
        (row, -self.relation.constant[i as usize] / pivot)
    }
}

/// The row `old` without its entry at `master`, plus `factor` times `row`; ascending, without entries that cancel to rounding.
fn merge(old: &[(u32, f64)], master: u32, factor: f64, row: &[(u32, f64)]) -> Vec<(u32, f64)> {
    let mut merged = Vec::with_capacity(old.len() + row.len());
    let (mut a, mut b) = (old.iter().filter(|e| e.0 != master).peekable(), row.iter().peekable());
    loop {
        let next = match (a.peek(), b.peek()) {
            (None, None) => return merged,
            (Some(x), Some(y)) if x.0 == y.0 => {
                let (own, part) = (x.1, factor * y.1);
                let sum = own + part;
                (x.0, if sum.abs() <= 1e-14 * own.abs().max(part.abs()) { 0.0 } else { sum }, true, true)
            }
            (Some(x), other) if other.is_none_or(|y| x.0 < y.0) => (x.0, x.1, true, false),
            (_, Some(y)) => (y.0, factor * y.1, false, true),
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
