//! Growth `max |T_ij|`, kept below a bound by exchanging slaves and masters.
//!
//! Where `|T_sq| > bound`, master q becomes the slave and s a master. The determinant of the slaves' columns grows by
//! `|T_sq| > 1` each time, so the exchanges end (Gu and Eisenstat 1996), and any bound above 1 can be reached, as far
//! as no preference stands against it. At 1 itself coefficients that rounding puts above it would be exchanged for ever, so
//! the bound is [`LEAST`] there.

use std::collections::BTreeSet;

use super::exchange::Exchange;
use super::rows::Relation;
use crate::input::preferences::Wishes;

/// A slave with this part of the steepest coefficient may take its place.
const NEARLY: f64 = 0.5;

/// The least bound that is enforced: further above 1 than rounding of T.
pub(super) const LEAST: f64 = 1.0 + 1e-9;

/// Returns the number of exchanges made, those before included.
pub(super) fn bound(relation: &mut Relation, limit: f64, wishes: &Wishes, exchanged: usize) -> usize {
    if exchanged > 0 {
        list_steep(relation, limit);
    }
    if relation.steep.is_empty() {
        return exchanged;
    }
    let steep: BTreeSet<u32> = relation.steep.iter().copied().collect();
    let count = flatten(&mut Exchange::new(relation), steep, limit, wishes);
    list_steep(relation, limit);
    exchanged + count
}

fn list_steep(relation: &mut Relation, limit: f64) {
    let largest: Vec<f64> = (0..relation.rows()).map(|i| relation.largest(i)).collect();
    relation.growth = largest.iter().copied().fold(0.0, f64::max);
    relation.steep = (0..relation.rows() as u32).filter(|&i| largest[i as usize] > limit).collect();
}

fn flatten(exchange: &mut Exchange, mut queue: BTreeSet<u32>, limit: f64, wishes: &Wishes) -> usize {
    let mut count = 0;
    while let Some(i) = queue.pop_last() {
        while let Some(master) = excess(exchange, i, limit, wishes) {
            let Some(row) = pivot_row(exchange, master, wishes) else { break };
            queue.extend(exchange.swap(row, master));
            count += 1;
        }
    }
    count
}

/// Of all slaves that follow a master nearly as steeply as the steepest, which settles most at once, the one with the
/// shortest row, which fills least. By a coefficient of 1 two DOFs could change places for ever.
fn pivot_row(exchange: &Exchange, master: u32, wishes: &Wishes) -> Option<u32> {
    let mut rows = exchange.holding(master);
    rows.retain(|&(k, _)| wishes.of(master) >= wishes.of(exchange.relation.slave[k as usize]));
    let steepest = rows.iter().fold(0.0, |a: f64, (_, v)| a.max(v.abs()));
    let least = (NEARLY * steepest).max(LEAST);
    let fit = rows.iter().filter(|(_, v)| v.abs() >= least).map(|&(k, _)| k);
    fit.min_by_key(|&k| exchange.relation.row(k as usize).len())
}

/// The master with the largest coefficient in row i that may become a slave, if that is above the bound.
fn excess(exchange: &Exchange, i: u32, limit: f64, wishes: &Wishes) -> Option<u32> {
    let own = wishes.of(exchange.relation.slave[i as usize]);
    let mut best: Option<(u32, f64)> = None;
    for (j, v) in exchange.relation.row(i as usize).entries() {
        let larger = best.is_none_or(|(_, most)| v.abs() >= most);
        if v.abs() > limit && larger && exchange.is_free(j) && wishes.of(j) >= own {
            best = Some((j, v.abs()));
        }
    }
    best.map(|(j, _)| j)
}
