//! Distributes the analysis over the ranks: peels equations that a rank solves alone, assigns components to ranks by predicted work, and
//! sends the equations.
//!
//! A rank keeps components that it holds alone: always the first one, and others while its work is at most 1.25 times the mean of all
//! ranks. All other components are pooled, also each component that has equations on several ranks. The pool fills the free capacity of the
//! ranks, one rank after the other. Each rank sends 24 bytes to each; no rank decides for all.

mod exchange;
mod peel;

use crate::components::{ConnectedComponent, ConnectedComponents};
use crate::ranks::Ranks;
pub(crate) use exchange::{AssignedEquations, exchange_equations};
pub(crate) use peel::{Peel, Sizes, peel, sizes};

/// The number of equations and the number of terms of a fragment or component.
pub(crate) type PredictedWork = [u64; 2];

/// Predicted work of an analysis. Time is about proportional to it, since most equations are solved without a factorization.
fn work(load: PredictedWork) -> u64 {
    load[0] + load[1]
}

/// The rank that analyses the component of each fragment. Collective.
pub(crate) fn balance(
    ranks: &dyn Ranks,
    components: &ConnectedComponents,
    known: &[ConnectedComponent<2>],
) -> Vec<u64> {
    let own = ranks.rank();
    let total: u64 = known.iter().map(|component| work(component.total)).sum();
    let mean = ranks.gather(&[total]).iter().sum::<u64>().div_ceil(ranks.size() as u64);
    let most = mean + mean / 4;
    let mut kept = 0;
    let mut moved: Vec<(usize, u64)> = Vec::new();
    for (k, component) in known.iter().enumerate() {
        let work = work(component.total);
        if component.crosses(own) || kept + work > most && kept > 0 {
            moved.push((k, work));
        } else {
            kept += work;
        }
    }
    let pool: u64 = moved.iter().map(|&(_, work)| work).sum();
    let all = ranks.gather(&[pool, mean.saturating_sub(kept)]);
    let (room, mut place) = room(&all, own);
    let pooled: u64 = all.iter().step_by(2).sum();
    let mut to = vec![own as u64; known.len()];
    for (k, work) in moved {
        // The pooled components follow one another on a line, each as long as its work. The middle of a component, scaled to the free
        // capacity, gives its rank.
        let middle = u128::from(place) * 2 + u128::from(work);
        let scaled = middle * u128::from(room[ranks.size()]) / (2 * u128::from(pooled.max(1)));
        let rank = room.partition_point(|&start| u128::from(start) <= scaled) - 1;
        to[k] = rank.min(ranks.size() - 1) as u64;
        place += work;
    }
    components.broadcast(ranks, known, &to)
}

/// The cumulated free capacity of all ranks, and the pooled work of the ranks before this one. For each rank, `all` holds two numbers: its
/// pooled work and its free capacity.
fn room(all: &[u64], rank: usize) -> (Vec<u64>, u64) {
    let mut starts = vec![0];
    for pair in all.chunks_exact(2) {
        starts.push(starts[starts.len() - 1] + pair[1]);
    }
    (starts, all.chunks_exact(2).take(rank).map(|pair| pair[0]).sum())
}
