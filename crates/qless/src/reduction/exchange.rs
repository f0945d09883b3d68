//! Exchanges a slave s and a master q: `u_q = (u_s - sum_{l != q} T_sl u_l) / T_sq`, and q is replaced in all other rows.

use std::collections::HashMap;

use rayon::prelude::*;

use super::relation::{Relation, RelationRow};

/// Number of rows that change at the same time; their new terms wait in memory until the last of them is computed.
const TOGETHER: usize = 64;
/// Number of terms below which rows do not change on several threads: another thread begins within some microseconds, in which one thread
/// merges about as many.
const GRAIN: usize = 1 << 13;

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
        for targets in targets.chunks(TOGETHER) {
            let merged = |&(k, factor): &(u32, f64)| merge(&self.relation.sorted(k as usize), master, factor, &row);
            let rows: Vec<(RelationRow, Vec<u32>)> =
                targets.par_iter().with_min_len(GRAIN.div_ceil(row.0.len())).map(merged).collect();
            for (&(k, factor), (terms, new)) in targets.iter().zip(rows) {
                new.into_iter().for_each(|j| self.hold(j, k));
                self.relation.change(k as usize, terms);
                self.relation.constant[k as usize] += factor * constant;
            }
        }
        self.relation.change(i as usize, row);
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
    fn solved_for(&self, i: u32, master: u32) -> (RelationRow, f64) {
        let pivot = self.relation.coefficient(i as usize, master).unwrap_or_default();
        let slave = self.relation.slave[i as usize];
        let (mut dofs, mut values) = self.relation.sorted(i as usize).into_owned();
        if let Ok(at) = dofs.binary_search(&master) {
            dofs.remove(at);
            values.remove(at);
        }
        values.iter_mut().for_each(|v| *v = -*v / pivot);
        let place = dofs.partition_point(|&j| j < slave);
        dofs.insert(place, slave);
        values.insert(place, 1.0 / pivot);
        ((dofs, values), -self.relation.constant[i as usize] / pivot)
    }
}

/// The row `old` without its entry at `master`, plus `factor` times `row`; ascending, without entries that cancel to rounding. Also the
/// DOFs that are not in `old`.
fn merge(old: &RelationRow, master: u32, factor: f64, row: &RelationRow) -> (RelationRow, Vec<u32>) {
    let most = old.0.len() + row.0.len();
    let (mut merged, mut new) = ((Vec::with_capacity(most), Vec::with_capacity(most)), Vec::new());
    let mut push = |j: u32, v: f64| {
        if v != 0.0 {
            merged.0.push(j);
            merged.1.push(v);
        }
    };
    let mut others = row.0.iter().zip(&row.1).map(|(&j, &v)| (j, factor * v)).peekable();
    for (&j, &own) in old.0.iter().zip(&old.1).filter(|(j, _)| **j != master) {
        while let Some((other, v)) = others.next_if(|&(other, _)| other < j) {
            new.push(other);
            push(other, v);
        }
        match others.next_if(|&(other, _)| other == j) {
            Some((_, part)) => {
                let sum = own + part;
                push(j, if sum.abs() <= 1e-14 * own.abs().max(part.abs()) { 0.0 } else { sum });
            }
            None => push(j, own),
        }
    }
    for (other, v) in others {
        new.push(other);
        push(other, v);
    }
    merged.0.shrink_to_fit();
    merged.1.shrink_to_fit();
    (merged, new)
}
