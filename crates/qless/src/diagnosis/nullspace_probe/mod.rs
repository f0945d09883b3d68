//! One pass over the kept equations, last to first, which estimates the motion and accuracy of every slave.

mod findings;
mod random_keys;

use super::certificate::History;
use crate::common::random::signed;
use crate::input::numbering::LocalSystem;
use crate::input::scale::{Scaling, exponent, free, ldexp};
use crate::presolve::basis::{Basis, BasisRow, Kept, Vectors};

pub(crate) use findings::{NullspaceProbe, is_far};
pub(crate) use random_keys::{RandomKeys, random_sides};
use random_keys::{SEED, random_step_sides, sizes_of_inverse};

/// A sum that cancels to this fraction of its terms is zero.
const NOISE: f64 = 1e-11;
/// A DOF may be fixed if its motion cancels to this fraction of its terms: the error of a motion is `eps / d`, and at distances d below
/// 1e-7 from dependence the verdict is in doubt anyway.
const HARDLY: f64 = 1e-6;

/// How the rows of `C_S^-1` are estimated. C_S holds the columns of the slaves in the kept equations.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum InverseEstimate {
    /// Upper bound of the sum of magnitudes of each row, by substitution with the magnitudes of all coefficients. It depends on the
    /// component alone, not on random numbers.
    Bound,
    /// The value of each slave for random right-hand sides.
    Sample,
}

/// Probes with random masters and right-hand sides. O(nnz).
pub(crate) fn probe(
    system: LocalSystem,
    basis: &Basis,
    history: &History,
    scaling: &Scaling,
    keys: &RandomKeys,
    inverse: InverseEstimate,
) -> NullspaceProbe {
    let pass = ProbePass { system, basis, history, scaling, keys };
    match inverse {
        InverseEstimate::Bound => pass.run::<true>(),
        InverseEstimate::Sample => pass.run::<false>(),
    }
}

/// The input of a pass over the kept equations.
struct ProbePass<'a> {
    system: LocalSystem<'a>,
    basis: &'a Basis,
    history: &'a History,
    scaling: &'a Scaling,
    keys: &'a RandomKeys,
}

impl ProbePass<'_> {
    fn run<const BOUND: bool>(&self) -> NullspaceProbe {
        let Self { system, basis, history, scaling, keys } = *self;
        let mut states = start(system, scaling, keys);
        let mut slow = Vec::new();
        basis.blocks.iter().for_each(|block| enter(block, scaling, &mut states, &mut slow));
        let of_steps = if BOUND { sizes_of_inverse(history) } else { random_step_sides(history, keys) };
        let first = basis.peeled.len();
        let plain = scaling.col.is_empty();
        let mut out = NullspaceProbe { bounds: vec![0.0; basis.rows()], slow, ..NullspaceProbe::default() };
        for t in (0..basis.rows()).rev() {
            let slave = basis.slave(t);
            let terms = basis.row(system, t);
            let Sums { moves, size, sample, bound } = sums::<BOUND>(terms, slave, &states, scaling);
            // A NaN does not count as zero.
            let rests = moves.abs() <= NOISE * size;
            if moves.abs() <= HARDLY * size {
                out.slow.push((slave, rests));
            }
            let moves = if rests { 0.0 } else { moves };
            out.bounds[t] = bound;
            let state = &mut states[slave as usize];
            state.u = moves;
            let right = match t {
                _ if t >= first => of_steps[t - first],
                _ if BOUND => 1.0,
                _ => signed(SEED, keys.row(basis.peeled[t])),
            };
            let pivot = basis.pivot(t, &terms, scaling);
            state.w = apart_from_zero(sample + right / if BOUND { pivot.abs() } else { pivot });
            let far = t >= first && is_far(basis.reach_of_step(t - first));
            let moves = if plain { moves } else { ldexp(moves, -scaling.col(slave as usize)) };
            out.judge(t, t < first, state.w.abs(), moves.abs(), far);
        }
        out
    }
}

/// The state of a DOF during the pass.
#[derive(Clone, Copy)]
pub struct State {
    /// The value of the DOF for the random masters; exactly zero if the terms of its row cancel to rounding.
    pub u: f64,
    /// The value of the DOF in scaled units for random right-hand sides. It is 0 only for masters, prescribed DOFs, and slaves whose value
    /// is not known yet.
    pub w: f64,
}

/// The states at the start: masters are random, prescribed DOFs are zero.
fn start(system: LocalSystem, scaling: &Scaling, keys: &RandomKeys) -> Vec<State> {
    let is_plain = scaling.col.is_empty();
    let random = |j: usize| {
        let u = signed(!SEED, keys.dof(j));
        State { u: if is_plain { u } else { ldexp(u, scaling.col(j)) }, w: 0.0 }
    };
    let mut states: Vec<State> = (0..system.dofs()).map(random).collect();
    system.prescribed().iter().for_each(|&(j, _)| states[j].u = 0.0);
    states
}

/// For each DOF, the exponent of its largest scaled coefficient, relative to the largest of the equation; 0 without coefficients.
fn exponents(system: LocalSystem, scaling: &Scaling) -> Vec<i32> {
    let mut most = vec![None; system.dofs()];
    for i in 0..system.equations() {
        let power = |(j, v): (usize, f64)| exponent(v) + scaling.col(j);
        let largest = free(system, i).filter(|&(_, v)| v != 0.0).map(power).max().unwrap_or_default();
        for (j, v) in free(system, i).filter(|&(_, v)| v != 0.0) {
            most[j] = most[j].max(Some(power((j, v)) - largest));
        }
    }
    most.into_iter().map(Option::unwrap_or_default).collect()
}

/// Random values of the masters and random motions of the blocks; the slaves of other rows are zero. The value of a master is divided by its
/// largest coefficient, relative to the largest of the equation, so that a motion with small coefficients is not lost beside others.
pub(crate) fn random_motions(system: LocalSystem, basis: &Basis, scaling: &Scaling, keys: &RandomKeys) -> Vec<f64> {
    let mut states = start(system, scaling, keys);
    states.iter_mut().zip(exponents(system, scaling)).for_each(|(state, power)| state.u = ldexp(state.u, -power));
    basis.blocks.iter().for_each(|block| enter(block, scaling, &mut states, &mut Vec::new()));
    basis.slaves().iter().for_each(|&slave| states[slave as usize].u = 0.0);
    states.into_iter().map(|state| state.u).collect()
}

/// Moves the DOFs of a block by a random vector of its null space, and lists those that hardly move.
fn enter(block: &Kept, scaling: &Scaling, states: &mut [State], slow: &mut Vec<(u32, bool)>) {
    let Vectors { moves, sample, .. } = &block.vectors;
    let moves = &moves[0];
    let largest = moves.iter().fold(0.0, |most: f64, u| most.max(u.abs()));
    for ((&j, &u), &w) in block.dofs.iter().zip(moves).zip(sample) {
        if u.abs() <= HARDLY * largest {
            slow.push((j, u == 0.0));
        }
        states[j as usize] = State { u: ldexp(u, scaling.col(j as usize)), w: apart_from_zero(w) };
    }
}

/// Makes a slave's sample nonzero, because zero marks a master.
#[inline]
pub fn apart_from_zero(sample: f64) -> f64 {
    if sample == 0.0 { f64::MIN_POSITIVE } else { sample }
}

/// Sums over the terms of a row.
pub struct Sums {
    /// The value of the slave for random masters: `sum_k value_k u_k`.
    pub moves: f64,
    /// The largest term of `moves`.
    pub size: f64,
    /// The value of the slave for random right-hand sides: `sum_k value_k w_k` in scaled columns. If `SIZES` is true, the sum of the
    /// magnitudes of these terms.
    pub sample: f64,
    /// A bound of the row of T: `max_k |value_k|`, or infinity if a slave is among the DOFs.
    pub bound: f64,
}

#[expect(clippy::inline_always, reason = "out of line it was a twentieth of the profile of an elimination")]
#[inline(always)]
pub fn sums<const SIZES: bool>(terms: BasisRow, slave: u32, states: &[State], scaling: &Scaling) -> Sums {
    let plain = scaling.col.is_empty();
    let own = scaling.col(slave as usize);
    let (mut moves, mut size, mut sample, mut bound, mut of_slaves) = (0.0, 0.0_f64, 0.0, 0.0_f64, 0.0);
    for (j, v) in terms.entries() {
        let State { u, w } = states[j as usize];
        let part = v * u;
        moves += part;
        size = size.max(part.abs());
        let scaled = if plain { v } else { ldexp(v, scaling.col(j as usize) - own) };
        sample += if SIZES { (w * scaled).abs() } else { w * scaled };
        bound = bound.max(v.abs());
        of_slaves += w.abs();
    }
    Sums { moves, size, sample, bound: if of_slaves == 0.0 { bound } else { f64::INFINITY } }
}
