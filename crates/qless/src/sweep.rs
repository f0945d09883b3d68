//! One pass over the kept equations, last to first, for all that can be told of a DOF from those that make it.

use crate::basis::{Basis, Row};
use crate::certificate::History;
use crate::local::Local;
use crate::random::randoms;
use crate::scale::{Scaling, ldexp};

/// A sum of parts that cancels to within this, relative to the parts, is zero.
const NOISE: f64 = 1e-11;

/// What a pass finds.
#[derive(Default)]
pub(crate) struct Sweep {
    /// The slave with the largest bound of `sum_i |(C_S^-1)_si|`, and the bound; C_S as in [`crate::sensitivity`].
    pub worst: Option<(u32, f64)>,
    /// Slaves that stay at zero for random masters, each in its unit, and zero prescribed values.
    pub still: Vec<u32>,
    /// For each row of the basis a bound of that row of T: its own largest coefficient, infinite where it names other slaves.
    pub bounds: Vec<f64>,
}

/// A DOF, as far as the pass has come.
#[derive(Clone, Copy)]
struct State {
    /// Its value for the random masters; what cancels is exactly zero.
    u: f64,
    /// The bound of its row sum of the inverse, 0 for masters and prescribed DOFs only.
    sum: f64,
}

/// Masters by `seed`. O(nnz).
pub(crate) fn sweep(system: Local, basis: &Basis, history: &History, scaling: &Scaling, seed: u64) -> Sweep {
    let mut states = start(system, basis, scaling, seed);
    let of_steps = row_sums_of_l(history);
    let (first, last) = (basis.peeled.len(), basis.peeled.len() + of_steps.len());
    let mut out = Sweep { bounds: vec![0.0; basis.rank()], ..Sweep::default() };
    for t in (0..basis.rank()).rev() {
        let slave = basis.slave(t);
        let terms = basis.row(system, t);
        let Sums { moves, size, total, bound } = sums(terms, slave, &states, scaling);
        let moves = if moves.abs() > NOISE * size { moves } else { 0.0 };
        out.bounds[t] = bound;
        if moves == 0.0 {
            out.still.push(slave);
        }
        let state = &mut states[slave as usize];
        state.u = moves;
        // Slaves of a block do not rest on one another, and how near to dependence a block is was estimated already.
        if t < last {
            state.sum =
                total + if t < first { 1.0 } else { of_steps[t - first] } / basis.pivot(t, &terms, scaling).abs();
            if out.worst.is_none_or(|(_, most)| state.sum > most) {
                out.worst = Some((slave, state.sum));
            }
        }
    }
    out
}

/// Masters at random, prescribed DOFs at zero, slaves of blocks with the bounds of their blocks.
fn start(system: Local, basis: &Basis, scaling: &Scaling, seed: u64) -> Vec<State> {
    let master = |(j, u)| State { u: ldexp(u, scaling.col(j)), sum: 0.0 };
    let mut states: Vec<State> = (0..system.dofs()).zip(randoms(seed)).map(master).collect();
    system.prescribed().iter().for_each(|&(j, _)| states[j].u = 0.0);
    for (block, kept) in basis.blocks.iter().enumerate() {
        let sum = 1.0 / kept.sigma.max(1e-300);
        basis.slaves()[basis.rows_of(block)].iter().for_each(|&slave| states[slave as usize].sum = sum);
    }
    states
}

/// What the terms of a row come to.
struct Sums {
    /// `sum_k value_k u_k`.
    moves: f64,
    /// Its largest part.
    size: f64,
    /// `sum_k |value_k| sum_k` in scaled columns.
    total: f64,
    /// `max_k |value_k|`; infinite where a slave is among them.
    bound: f64,
}

#[inline]
fn sums(terms: Row, slave: u32, states: &[State], scaling: &Scaling) -> Sums {
    let plain = scaling.col.is_empty();
    let own = scaling.col(slave as usize);
    let (mut moves, mut size, mut total, mut bound, mut of_slaves) = (0.0, 0.0_f64, 0.0, 0.0_f64, 0.0);
    for (j, v) in terms.entries() {
        let State { u, sum } = states[j as usize];
        let part = v * u;
        moves += part;
        size = size.max(part.abs());
        total += sum * if plain { v.abs() } else { ldexp(v.abs(), scaling.col(j as usize) - own) };
        bound = bound.max(v.abs());
        of_slaves += sum;
    }
    Sums { moves, size, total, bound: if of_slaves == 0.0 { bound } else { f64::INFINITY } }
}

/// Row sums of `|L^-1|`, by step: how much of the user's equations goes into each step.
fn row_sums_of_l(history: &History) -> Vec<f64> {
    let mut sums: Vec<f64> = Vec::with_capacity(history.steps.len());
    for &row in &history.steps {
        let parts = history.factors[row as usize].iter().map(|&(step, factor)| factor.abs() * sums[step as usize]);
        let sum = 1.0 + parts.sum::<f64>();
        sums.push(sum);
    }
    sums
}
