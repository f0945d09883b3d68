//! One pass over the kept equations, last to first, for all that can be told of a DOF from those that make it.

use crate::basis::{Basis, Row};
use crate::certificate::History;
use crate::local::Local;
use crate::presolve::eliminate::Eliminated;
use crate::random::signed;
use crate::scale::{Scaling, ldexp};

/// A sum of parts that cancels to within this, relative to the parts, is zero.
const NOISE: f64 = 1e-11;

/// A slave that moves more than this, for masters of size 1, stands at the end of multipliers that grew: what presolve made of
/// its equations has lost that many digits.
const STEEP: f64 = 1e3;
/// A slave that moves more than this, for right-hand sides of size 1, stands for equations that are nearly dependent.
const WEAK: f64 = 3e5;
/// A row to which more than this of a user's equation was added has lost that many digits.
const FAR: f64 = 1e5;

/// Of the random masters and right-hand sides.
pub(crate) const SEED: u64 = 0x9e37_79b9;

/// What a pass finds.
#[derive(Default)]
pub(crate) struct Sweep {
    /// The row with the largest number of a sample of `C_S^-1`, and its size; C_S as in [`crate::sensitivity`].
    pub worst: Option<(usize, f64)>,
    /// Rows made by presolve that should not be relied on, for growth or for nearness to dependence.
    pub doubtful: Vec<usize>,
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
    /// Its value in scaled units for random right-hand sides; 0 for masters and prescribed DOFs only, and for slaves of which
    /// nothing is known.
    w: f64,
}

/// Masters and right-hand sides by `seed`. O(nnz).
pub(crate) fn sweep(system: Local, basis: &Basis, history: &History, scaling: &Scaling, seed: u64) -> Sweep {
    let mut states = start(system, basis, scaling, seed);
    let of_steps = steps(history, seed);
    let (first, last) = (basis.peeled.len(), basis.peeled.len() + of_steps.len());
    let mut out = Sweep { bounds: vec![0.0; basis.rank()], ..Sweep::default() };
    for t in (0..basis.rank()).rev() {
        let slave = basis.slave(t);
        let terms = basis.row(system, t);
        let Sums { moves, size, sample, bound } = sums(terms, slave, &states, scaling);
        let moves = if moves.abs() > NOISE * size { moves } else { 0.0 };
        out.bounds[t] = bound;
        if moves == 0.0 {
            out.still.push(slave);
        }
        let state = &mut states[slave as usize];
        state.u = moves;
        // Slaves of a block do not rest on one another, and their sample is known already.
        if t < last {
            let right = if t < first { signed(seed, t as u64) } else { of_steps[t - first] };
            state.w = apart_from_zero(sample + right / basis.pivot(t, &terms, scaling));
            let far = t >= first && basis.reach_of_step(t - first) > FAR;
            out.judge(t, state.w.abs(), ldexp(moves.abs(), -scaling.col(slave as usize)), far);
        }
    }
    out
}

impl Sweep {
    #[inline]
    fn judge(&mut self, t: usize, sample: f64, moves: f64, far: bool) {
        if self.worst.is_none_or(|(_, most)| sample > most || sample.is_nan()) {
            self.worst = Some((t, sample));
        }
        // What is no number is no small one.
        if far || !is_at_most(sample, WEAK) || !is_at_most(moves, STEEP) {
            self.doubtful.push(t);
        }
    }
}

/// False for what is no number.
#[inline]
fn is_at_most(x: f64, limit: f64) -> bool {
    x <= limit
}

/// Whether a dependent row was made of more than this of others.
pub(crate) fn is_far(reach: f64) -> bool {
    reach > FAR
}

/// A slave's sample is told from a master's by not being zero.
#[inline]
fn apart_from_zero(sample: f64) -> f64 {
    if sample == 0.0 { f64::MIN_POSITIVE } else { sample }
}

/// Masters at random, prescribed DOFs at zero, slaves of blocks with the samples of their blocks.
fn start(system: Local, basis: &Basis, scaling: &Scaling, seed: u64) -> Vec<State> {
    let master = |j: usize| State { u: ldexp(signed(!seed, j as u64), scaling.col(j)), w: 0.0 };
    let mut states: Vec<State> = (0..system.dofs()).map(master).collect();
    system.prescribed().iter().for_each(|&(j, _)| states[j].u = 0.0);
    for (block, kept) in basis.blocks.iter().enumerate() {
        let slaves = &basis.slaves()[basis.rows_of(block)];
        slaves.iter().zip(&kept.sample).for_each(|(&slave, &w)| states[slave as usize].w = apart_from_zero(w));
    }
    states
}

/// What the terms of a row come to.
struct Sums {
    /// `sum_k value_k u_k`.
    moves: f64,
    /// Its largest part.
    size: f64,
    /// `sum_k value_k w_k` in scaled columns.
    sample: f64,
    /// `max_k |value_k|`; infinite where a slave is among them.
    bound: f64,
}

#[inline]
fn sums(terms: Row, slave: u32, states: &[State], scaling: &Scaling) -> Sums {
    let plain = scaling.col.is_empty();
    let own = scaling.col(slave as usize);
    let (mut moves, mut size, mut sample, mut bound, mut of_slaves) = (0.0, 0.0_f64, 0.0, 0.0_f64, 0.0);
    for (j, v) in terms.entries() {
        let State { u, w } = states[j as usize];
        let part = v * u;
        moves += part;
        size = size.max(part.abs());
        sample += w * if plain { v } else { ldexp(v, scaling.col(j as usize) - own) };
        bound = bound.max(v.abs());
        of_slaves += w.abs();
    }
    Sums { moves, size, sample, bound: if of_slaves == 0.0 { bound } else { f64::INFINITY } }
}

/// `L^-1` times a random right-hand side, by step.
fn steps(history: &History, seed: u64) -> Vec<f64> {
    let mut right: Vec<f64> = Vec::with_capacity(history.steps.len());
    history.steps.iter().for_each(|&row| right.push(after(row, &history.factors[row as usize], &right, seed)));
    right
}

/// The random right-hand side of a row after the steps that were subtracted from it.
fn after(row: u32, factors: &[(u32, f64)], steps: &[f64], seed: u64) -> f64 {
    signed(!seed, u64::from(row)) - factors.iter().map(|&(step, factor)| factor * steps[step as usize]).sum::<f64>()
}

/// A random right-hand side after elimination, for every row that went through it: the one of which blocks give their samples.
pub(crate) fn random_sides(eliminated: &Eliminated) -> Vec<f64> {
    let mut steps: Vec<f64> = Vec::with_capacity(eliminated.steps.len());
    for step in &eliminated.steps {
        steps.push(after(step.row, &eliminated.factors[step.row as usize], &steps, SEED));
    }
    let mut all = vec![0.0; eliminated.rows.len()];
    for &row in &eliminated.core {
        all[row as usize] = after(row, &eliminated.factors[row as usize], &steps, SEED);
    }
    all
}
