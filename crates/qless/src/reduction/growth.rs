//! Growth `max |T_ij|`, kept below a bound by exchanging slaves and masters.
//!
//! Where `|T_sq| > bound`, master q becomes the slave and s a master: `u_q = (u_s - sum_{l != q} T_sl u_l) / T_sq`. The
//! determinant of the slaves' columns grows by `|T_sq| > 1` each time, so the exchanges end (Gu and Eisenstat 1996), and
//! any bound of at least 1 can be reached.

use std::collections::{BTreeSet, HashMap};

use super::rows::Relation;

/// Returns the number of exchanges made.
pub(crate) fn bound(relation: &mut Relation, limit: f64) -> usize {
    let mut exchange = Exchange { holders: HashMap::new(), relation, limit };
    let mut queue: BTreeSet<u32> =
        (0..exchange.relation.rows() as u32).filter(|&i| exchange.excess(i).is_some()).collect();
    if queue.is_empty() {
        return 0;
    }
    exchange.index();
    let mut count = 0;
    while let Some(i) = queue.pop_first() {
        while let Some(master) = exchange.excess(i) {
            // Of all slaves that follow this master too steeply the steepest, which settles most at once.
            let steepest = exchange.steepest(master);
            queue.extend(exchange.swap(steepest, master));
            count += 1;
        }
    }
    count
}

struct Exchange<'a> {
    relation: &'a mut Relation,
    /// Rows that may hold a master: a superset.
    holders: HashMap<u32, Vec<u32>>,
    limit: f64,
}

impl Exchange<'_> {
    /// The master with the largest coefficient in row i, if that is above the bound.
    fn excess(&self, i: u32) -> Option<u32> {
        let entries = self.relation.row(i as usize).iter().filter(|(j, _)| !self.relation.is_prescribed[*j as usize]);
        let largest = entries.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
        (largest.1.abs() > self.limit).then_some(largest.0)
    }

    fn index(&mut self) {
        for i in 0..self.relation.rows() {
            for &(j, _) in self.relation.row(i) {
                self.holders.entry(j).or_default().push(i as u32);
            }
        }
    }

    fn coefficient(&self, i: u32, master: u32) -> f64 {
        let row = self.relation.row(i as usize);
        row.binary_search_by_key(&master, |&(j, _)| j).map_or(0.0, |k| row[k].1)
    }

    fn steepest(&self, master: u32) -> u32 {
        let rows = self.holders[&master].iter().copied();
        rows.max_by(|&a, &b| self.coefficient(a, master).abs().total_cmp(&self.coefficient(b, master).abs()))
            .expect("a row holds the master")
    }

    /// Makes `master` the slave of row i; returns the other rows that changed.
    fn swap(&mut self, i: u32, master: u32) -> Vec<u32> {
        let pivot = self.coefficient(i, master);
        let slave = self.relation.slave[i as usize];
        let old = self.relation.row(i as usize);
        let mut row: Vec<_> = old.iter().filter(|e| e.0 != master).map(|&(j, v)| (j, -v / pivot)).collect();
        let place = row.partition_point(|&(j, _)| j < slave);
        row.insert(place, (slave, 1.0 / pivot));
        let constant = -self.relation.constant[i as usize] / pivot;
        let mut targets = self.holders.remove(&master).unwrap_or_default();
        targets.retain(|&k| k != i && self.coefficient(k, master) != 0.0);
        targets.sort_unstable();
        targets.dedup();
        for &k in &targets {
            self.substitute(k, master, &row, constant);
        }
        for &(j, _) in &row {
            let holders = self.holders.entry(j).or_default();
            holders.extend(targets.iter().copied().chain([i]));
            if holders.len() > 2 * self.relation.slave.len() {
                holders.sort_unstable();
                holders.dedup();
            }
        }
        self.relation.changed.insert(i, row);
        self.relation.constant[i as usize] = constant;
        self.relation.slave[i as usize] = master;
        self.relation.row_of[slave as usize] = u32::MAX;
        self.relation.row_of[master as usize] = i;
        targets
    }

    /// Replaces the master in row k by what it now equals.
    fn substitute(&mut self, k: u32, master: u32, row: &[(u32, f64)], constant: f64) {
        let factor = self.coefficient(k, master);
        let merged = merge(self.relation.row(k as usize), master, factor, row);
        self.relation.changed.insert(k, merged);
        self.relation.constant[k as usize] += factor * constant;
    }
}

/// `old - (its entry at master) + factor row`, ascending, without what cancels to rounding.
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
