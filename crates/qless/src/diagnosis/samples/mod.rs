//! One pass over the kept equations, last to first, for all that can be told of a DOF from those that make it.

mod found;
mod keys;
mod sides;
mod states;

use crate::common::random::signed;
use crate::diagnosis::certificate::History;
use crate::input::numbering::Local;
use crate::input::scale::{Scaling, ldexp};
use crate::presolve::basis::Basis;

pub(crate) use found::{Sweep, is_far, is_harmless};
pub(crate) use keys::Keys;
pub(crate) use sides::random_sides;
use states::{Sums, apart_from_zero, enter, start, sums};

/// A sum of parts that cancels to within this, relative to the parts, is zero.
const NOISE: f64 = 1e-11;

/// Of the random masters and right-hand sides.
const SEEDS: [u64; 2] = [0x9e37_79b9, 0x85eb_ca6b];

/// Which random numbers.
#[derive(Clone, Copy)]
pub(crate) enum Sample {
    First,
    Second,
}

/// How large `C_S^-1` is, row by row.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Inverse {
    /// The sum of the sizes of its numbers, along all ways from slave to slave: it depends on the component alone, however numbers
    /// are drawn.
    Bound,
    /// For random right-hand sides.
    Sample,
}

/// The first or the second sample, of masters and right-hand sides. O(nnz).
pub(crate) fn sweep(
    system: Local,
    basis: &Basis,
    history: &History,
    scaling: &Scaling,
    keys: &Keys,
    which: Sample,
    inverse: Inverse,
) -> Sweep {
    let pass = Pass { system, basis, history, scaling, keys, which };
    match inverse {
        Inverse::Bound => pass.run::<true>(),
        Inverse::Sample => pass.run::<false>(),
    }
}

/// What a pass needs.
struct Pass<'a> {
    system: Local<'a>,
    basis: &'a Basis,
    history: &'a History,
    scaling: &'a Scaling,
    keys: &'a Keys,
    which: Sample,
}

impl Pass<'_> {
    fn run<const BOUND: bool>(&self) -> Sweep {
        let Self { system, basis, history, scaling, keys, which } = *self;
        let seed = SEEDS[which as usize];
        let mut states = start(system, scaling, keys, seed);
        let mut still = Vec::new();
        basis.blocks.iter().for_each(|block| enter(block, which, scaling, &mut states, &mut still));
        let of_steps = if BOUND { sides::bounds(history) } else { sides::random(history, keys, seed) };
        let first = basis.peeled.len();
        let plain = scaling.col.is_empty();
        let mut sizes = vec![0.0; basis.rows()];
        let mut out = Sweep { bounds: vec![0.0; basis.rows()], still, ..Sweep::default() };
        for t in (0..basis.rows()).rev() {
            let slave = basis.slave(t);
            let terms = basis.row(system, t);
            let Sums { moves, size, sample, bound } = sums::<BOUND>(terms, slave, &states, scaling);
            let moves = if moves.abs() > NOISE * size { moves } else { 0.0 };
            out.bounds[t] = bound;
            if moves == 0.0 {
                out.still.push(slave);
            }
            let state = &mut states[slave as usize];
            state.u = moves;
            let right = match t {
                _ if t >= first => of_steps[t - first],
                _ if BOUND => 1.0,
                _ => signed(seed, keys.row(basis.peeled[t])),
            };
            let pivot = basis.pivot(t, &terms, scaling);
            state.w = apart_from_zero(sample + right / if BOUND { pivot.abs() } else { pivot });
            sizes[t] = state.w.abs();
            let far = t >= first && is_far(basis.reach_of_step(t - first));
            let moves = if plain { moves } else { ldexp(moves, -scaling.col(slave as usize)) };
            out.judge(t, state.w.abs(), moves.abs(), far);
        }
        let of_inverse = if BOUND { &mut out.bound_of_inverse } else { &mut out.sample_of_inverse };
        *of_inverse = sizes;
        out
    }
}
