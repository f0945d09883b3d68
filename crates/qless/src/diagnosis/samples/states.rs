//! All DOFs, as far as a pass has come, and what the terms of a row come to.

use super::{Keys, Sample};
use crate::common::random::signed;
use crate::input::numbering::Local;
use crate::input::scale::{Scaling, ldexp};
use crate::presolve::basis::{Kept, Row, Vectors};

/// A DOF of a block moves if its number in a random vector of the null space is more than so many units in the last place times the
/// condition, ...
const ZERO_UNITS: f64 = 8.0;
/// ... and more than this whatever the condition; more than the last is no rounding.
const ZERO: [f64; 2] = [1e-13, 1e-8];

/// A DOF, as far as the pass has come.
#[derive(Clone, Copy)]
pub struct State {
    /// Its value for the random masters; what cancels is exactly zero.
    pub u: f64,
    /// Its value in scaled units for random right-hand sides; 0 for masters and prescribed DOFs only, and for slaves of which
    /// nothing is known.
    pub w: f64,
}

/// Masters at random, prescribed DOFs at zero.
pub fn start(system: Local, scaling: &Scaling, keys: &Keys, seed: u64) -> Vec<State> {
    let master = |j: usize| State { u: ldexp(signed(!seed, keys.dof(j)), scaling.col(j)), w: 0.0 };
    let plain = |j: usize| State { u: signed(!seed, keys.dof(j)), w: 0.0 };
    let mut states: Vec<State> = if scaling.col.is_empty() {
        (0..system.dofs()).map(plain).collect()
    } else {
        (0..system.dofs()).map(master).collect()
    };
    system.prescribed().iter().for_each(|&(j, _)| states[j].u = 0.0);
    states
}

/// The DOFs of a block move as a random vector of its null space says; those that stay are listed.
pub fn enter(block: &Kept, which: Sample, scaling: &Scaling, states: &mut [State], still: &mut Vec<u32>) {
    let zero = (ZERO_UNITS * f64::EPSILON / block.nearness.sigma).clamp(ZERO[0], ZERO[1]);
    let Vectors { moves, sample, .. } = &block.vectors;
    for ((&j, &u), &w) in block.dofs.iter().zip(&moves[which as usize]).zip(sample) {
        let moves = if u.abs() <= zero { 0.0 } else { u };
        if moves == 0.0 {
            still.push(j);
        }
        states[j as usize] = State { u: ldexp(moves, scaling.col(j as usize)), w: apart_from_zero(w) };
    }
}

/// A slave's sample is told from a master's by not being zero.
#[inline]
pub fn apart_from_zero(sample: f64) -> f64 {
    if sample == 0.0 { f64::MIN_POSITIVE } else { sample }
}

/// What the terms of a row come to.
pub struct Sums {
    /// `sum_k value_k u_k`.
    pub moves: f64,
    /// Its largest part.
    pub size: f64,
    /// `sum_k value_k w_k` in scaled columns.
    pub sample: f64,
    /// `max_k |value_k|`; infinite where a slave is among them.
    pub bound: f64,
}

#[expect(clippy::inline_always, reason = "out of line it was a twentieth of the profile of an elimination")]
#[inline(always)]
pub fn sums<const SIZES: bool>(terms: Row, slave: u32, states: &[State], scaling: &Scaling) -> Sums {
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
