//! DOFs that must not be slaves, and DOFs preferred as slaves, by exchanges.
//!
//! A slave that should be a master changes places with the master that it follows most steeply and that may be a slave. Where
//! there is none, its row of T holds such DOFs only: they depend on one another by the equations, and one of them is a slave
//! whatever is chosen.

use super::exchange::Exchange;
use super::rows::Relation;
use crate::input::preferences::{Wish, Wishes};

/// Entries below this, relative to the largest of their row, are too small to divide by.
const SMALL: f64 = 1e-8;

/// Meets the wishes as far as they can be met; returns the number of exchanges.
pub(super) fn meet(relation: &mut Relation, wishes: &Wishes, limit: f64) -> usize {
    if !wishes.any() {
        return 0;
    }
    let unwanted = |r: &Relation| wishes.with(Wish::Master).filter(|&j| r.row_of[j as usize] != u32::MAX).collect();
    let unmet: Vec<u32> = unwanted(relation);
    let idle = |j: &u32| relation.row_of[*j as usize] == u32::MAX && relation.system.free()[*j as usize];
    let wanted: Vec<u32> = wishes.with(Wish::Slave).filter(idle).collect();
    if unmet.is_empty() && wanted.is_empty() {
        return 0;
    }
    let mut exchange = Exchange::new(relation);
    let freed = unmet.into_iter().filter(|&slave| release(&mut exchange, slave, wishes)).count();
    freed + wanted.into_iter().filter(|&master| engage(&mut exchange, master, wishes, limit)).count()
}

/// Makes a slave a master.
fn release(exchange: &mut Exchange, slave: u32, wishes: &Wishes) -> bool {
    let row = exchange.relation.row_of[slave as usize];
    let entries = exchange.relation.sorted(row as usize);
    let free = || entries.iter().filter(|&&(j, _)| exchange.is_free(j));
    let least = SMALL * free().fold(0.0, |a: f64, e| a.max(e.1.abs()));
    let fit = free().filter(|&&(j, v)| wishes.of(j) > Wish::Master && v.abs() > least);
    let best =
        fit.max_by(|a, b| (wishes.of(a.0), a.1.abs()).partial_cmp(&(wishes.of(b.0), b.1.abs())).expect("finite"));
    best.map(|&(j, _)| j).is_some_and(|master| {
        exchange.swap(row, master);
        true
    })
}

/// Makes a master a slave in the row that follows it most steeply, unless that adds too much growth.
fn engage(exchange: &mut Exchange, master: u32, wishes: &Wishes, limit: f64) -> bool {
    let rows = exchange.holding(master).into_iter();
    let fit =
        rows.filter(|&(i, v)| wishes.of(exchange.relation.slave[i as usize]) < Wish::Slave && v.abs() * limit >= 1.0);
    fit.reduce(|a, b| if b.1.abs() > a.1.abs() { b } else { a }).is_some_and(|(row, _)| {
        exchange.swap(row, master);
        true
    })
}
