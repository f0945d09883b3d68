//! Exchanges slaves and masters to meet preferences and to keep the growth `max |T_ij|` below a bound.
//!
//! If `|T_sq| > bound`, master q becomes the slave and s a master. Each exchange multiplies the determinant of the slaves' columns by
//! `|T_sq| > 1`, so the exchanges end (Gu and Eisenstat 1996). Any bound above 1 can be met unless preferences prevent it. With a bound
//! of exactly 1, coefficients that exceed 1 by rounding would be exchanged forever, so the smallest bound is [`LEAST`].

use std::collections::BTreeSet;

use super::exchange::Exchange;
use super::relation::Relation;
use crate::input::preferences::{SlavePreference, SlavePreferences};

/// A row may exchange its slave for a master if its coefficient of this master is at least this fraction of the largest one in any row.
const NEARLY: f64 = 0.5;

/// The smallest bound that is enforced; it exceeds 1 by more than the rounding errors of T.
pub(super) const LEAST: f64 = 1.0 + 1e-9;

/// Exchanges slaves until the growth is at most `limit`, as far as the preferences allow. Returns the number of exchanges, including the
/// `exchanged` earlier ones.
pub(super) fn bound_growth(
    relation: &mut Relation,
    limit: f64,
    preferences: &SlavePreferences,
    exchanged: usize,
) -> usize {
    if exchanged > 0 {
        list_steep(relation, limit);
    }
    if relation.steep.is_empty() {
        return exchanged;
    }
    let steep: BTreeSet<u32> = relation.steep.iter().copied().collect();
    let count = flatten(&mut Exchange::new(relation), steep, limit, preferences);
    list_steep(relation, limit);
    exchanged + count
}

fn list_steep(relation: &mut Relation, limit: f64) {
    let largest: Vec<f64> = (0..relation.rows()).map(|i| relation.largest(i)).collect();
    relation.growth = largest.iter().copied().fold(0.0, f64::max);
    relation.steep = (0..relation.rows() as u32).filter(|&i| largest[i as usize] > limit).collect();
}

fn flatten(exchange: &mut Exchange, mut queue: BTreeSet<u32>, limit: f64, preferences: &SlavePreferences) -> usize {
    let mut count = 0;
    while let Some(i) = queue.pop_last() {
        while let Some(master) = excess(exchange, i, limit, preferences) {
            let Some(row) = pivot_row(exchange, master, preferences) else { break };
            queue.extend(exchange.swap(row, master));
            count += 1;
        }
    }
    count
}

/// Returns true if a master may become the slave in place of `slave` to bound the growth: unless this makes a DOF a slave that must not be
/// one, in place of one that may. A preferred slave gives way, because the bound comes first.
fn may_replace(preferences: &SlavePreferences, master: u32, slave: u32) -> bool {
    let may_be_slave = |dof| preferences.of(dof) > SlavePreference::Master;
    may_be_slave(master) || !may_be_slave(slave)
}

/// The row whose slave is exchanged for `master`. A large coefficient of the master reduces most entries at once, so only rows with nearly
/// the largest one are considered. The shortest of these rows causes the least fill. The coefficient must exceed 1: otherwise two DOFs
/// could be exchanged forever.
fn pivot_row(exchange: &Exchange, master: u32, preferences: &SlavePreferences) -> Option<u32> {
    let mut rows = exchange.sizes(master);
    rows.retain(|&(k, _)| may_replace(preferences, master, exchange.relation.slave[k as usize]));
    let steepest = rows.iter().fold(0.0, |a: f64, &(_, size)| a.max(size));
    let least = (NEARLY * steepest).max(LEAST);
    let fit = rows.iter().filter(|&&(_, size)| size >= least).map(|&(k, _)| k);
    fit.min_by_key(|&k| exchange.relation.row(k as usize).len())
}

/// The master with the largest coefficient above the bound in row i, among those that may become slaves.
fn excess(exchange: &Exchange, i: u32, limit: f64, preferences: &SlavePreferences) -> Option<u32> {
    let own = exchange.relation.slave[i as usize];
    let sizes = exchange.relation.row(i as usize).entries().map(|(j, v)| (j, exchange.relation.size(i as usize, j, v)));
    let large = sizes.filter(|&(_, size)| size > limit);
    let fit = large.filter(|&(j, _)| exchange.is_free(j) && may_replace(preferences, j, own));
    fit.max_by(|(_, a), (_, b)| a.total_cmp(b)).map(|(j, _)| j)
}

/// A master whose coefficient is below this fraction of the largest one in the row is not made the slave of the row.
const SMALL: f64 = 1e-8;

/// Exchanges slaves and masters to meet the preferences, as far as the equations allow; returns the number of exchanges.
pub(super) fn meet_preferences(relation: &mut Relation, preferences: &SlavePreferences, limit: f64) -> usize {
    if !preferences.any() {
        return 0;
    }
    let unwanted = |r: &Relation| {
        preferences.with(SlavePreference::Master).filter(|&j| r.row_of[j as usize] != u32::MAX).collect()
    };
    let unmet: Vec<u32> = unwanted(relation);
    let idle = |j: &u32| relation.row_of[*j as usize] == u32::MAX && relation.system.free()[*j as usize];
    let wanted: Vec<u32> = preferences.with(SlavePreference::Slave).filter(idle).collect();
    if unmet.is_empty() && wanted.is_empty() {
        return 0;
    }
    let mut exchange = Exchange::new(relation);
    let freed = unmet.into_iter().filter(|&slave| release(&mut exchange, slave, preferences)).count();
    freed + wanted.into_iter().filter(|&master| engage(&mut exchange, master, preferences, limit)).count()
}

/// Makes a slave a master, in exchange for the most preferred master of its row; false if no master of the row may become a slave.
fn release(exchange: &mut Exchange, slave: u32, preferences: &SlavePreferences) -> bool {
    let row = exchange.relation.row_of[slave as usize];
    let terms = exchange.relation.sorted(row as usize);
    let free = terms.0.iter().zip(&terms.1).filter(|(j, _)| exchange.is_free(**j));
    let sizes: Vec<_> = free.map(|(&j, &v)| (j, exchange.relation.size(row as usize, j, v))).collect();
    let least = SMALL * sizes.iter().fold(0.0, |a: f64, e| a.max(e.1));
    let fit = sizes.iter().filter(|&&(j, size)| preferences.of(j) > SlavePreference::Master && size > least);
    let best = fit.max_by(|a, b| (preferences.of(a.0), a.1).partial_cmp(&(preferences.of(b.0), b.1)).expect("finite"));
    best.map(|&(j, _)| j).is_some_and(|master| {
        exchange.swap(row, master);
        true
    })
}

/// Makes a master a slave, in the row with its largest coefficient; false if that would add too much growth.
fn engage(exchange: &mut Exchange, master: u32, preferences: &SlavePreferences, limit: f64) -> bool {
    let rows = exchange.sizes(master).into_iter();
    let fit = rows.filter(|&(i, size)| {
        preferences.of(exchange.relation.slave[i as usize]) < SlavePreference::Slave && size * limit >= 1.0
    });
    fit.reduce(|a, b| if b.1 > a.1 { b } else { a }).is_some_and(|(row, _)| {
        exchange.swap(row, master);
        true
    })
}
