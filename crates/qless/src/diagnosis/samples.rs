//! One pass over the kept equations, last to first, for all that can be told of a DOF from those that make it.

use crate::common::random::signed;
use crate::diagnosis::certificate::History;
use crate::input::components::Labels;
use crate::input::numbering::Local;
use crate::input::scale::{Scaling, ldexp};
use crate::presolve::basis::Vectors;
use crate::presolve::basis::{Basis, Kept, Row};
use crate::presolve::eliminated::Eliminated;

/// A sum of parts that cancels to within this, relative to the parts, is zero.
const NOISE: f64 = 1e-11;

/// A slave that moves more than this, for masters of size 1, stands at the end of multipliers that grew: what presolve made of
/// its equations has lost that many digits.
const STEEP: f64 = 1e3;
/// A slave that moves more than this, for right-hand sides of size 1, stands for equations that are nearly dependent.
const WEAK: f64 = 3e4;
/// A row to which more than this of a user's equation was added has lost that many digits.
const FAR: f64 = 1e5;

/// Of the random masters and right-hand sides.
const SEEDS: [u64; 2] = [0x9e37_79b9, 0x85eb_ca6b];

/// Which random numbers.
#[derive(Clone, Copy)]
pub(crate) enum Sample {
    First,
    Second,
}

/// A DOF of a block moves if its number in a random vector of the null space is more than so many units in the last place times the
/// condition, ...
const ZERO_UNITS: f64 = 8.0;
/// ... and more than this whatever the condition; more than the last is no rounding.
const ZERO: [f64; 2] = [1e-13, 1e-8];

/// A sample that is nearer to its limit than this factor is drawn again with numbers that depend on the component alone.
const NEARLY: f64 = 0.1;

/// Rows of `C_S^-1` up to this size are looked at no closer.
const HARMLESS: f64 = 8.0;

/// Whether a row of `C_S^-1` says all that is worth knowing.
pub(crate) fn is_harmless(size: f64) -> bool {
    is_at_most(size, HARMLESS)
}

/// By what random numbers are drawn: places within the component, so that they are the same whatever stands beside it, or, where
/// nothing hangs on them, places in the whole.
#[derive(Default)]
pub(crate) struct Keys {
    rows: Vec<u32>,
    dofs: Vec<u32>,
}

impl Keys {
    /// Places within components.
    pub fn within(labels: &Labels, system: Local) -> Self {
        let (mut next_row, mut next_dof) = (vec![0; labels.count], vec![0; labels.count]);
        let mut rows = Vec::with_capacity(labels.of_row.len());
        let mut dofs = vec![u32::MAX; system.dofs()];
        let draw = |next: &mut u32| {
            *next += 1;
            *next - 1
        };
        for (i, &label) in labels.of_row.iter().enumerate() {
            rows.push(draw(&mut next_row[label as usize]));
            for &j in system.parts(i).0.iter().filter(|&&j| system.free()[j as usize]) {
                if dofs[j as usize] == u32::MAX {
                    dofs[j as usize] = draw(&mut next_dof[label as usize]);
                }
            }
        }
        Self { rows, dofs }
    }

    pub fn are_within(&self) -> bool {
        !self.rows.is_empty()
    }

    #[inline]
    fn row(&self, i: u32) -> u64 {
        u64::from(self.rows.get(i as usize).copied().unwrap_or(i))
    }

    #[inline]
    pub fn dof(&self, j: usize) -> u64 {
        self.dofs.get(j).map_or(j as u64, |&key| u64::from(key))
    }
}

/// What a pass finds.
#[derive(Default)]
pub(crate) struct Sweep {
    /// By row, the size of the slave for right-hand sides of size 1, C_S as in [`crate::diagnosis::sensitivity`]: [`Inverse::Bound`] of it, ...
    pub bound_of_inverse: Vec<f64>,
    /// ... and, where some bound is large, a sample.
    pub sample_of_inverse: Vec<f64>,
    /// The largest move of a slave.
    steepest: f64,
    /// Rows made by presolve that should not be relied on, for growth or for nearness to dependence.
    pub doubtful: Vec<Doubtful>,
    /// Slaves that stay at zero for random masters, each in its unit, and zero prescribed values.
    pub still: Vec<u32>,
    /// For each row of the basis a bound of that row of T: its own largest coefficient, infinite where it names other slaves.
    pub bounds: Vec<f64>,
}

/// A row of the basis that should not be relied on.
#[derive(Clone, Copy)]
pub(crate) struct Doubtful {
    pub row: usize,
    pub sample: f64,
    /// No digits were lost: it may merely be near to dependence.
    pub is_near_only: bool,
}

impl Doubtful {
    /// Whether the rows are no nearer to dependence than the tolerance, as far as the sample can tell.
    pub fn is_within(&self, tolerance: f64) -> bool {
        self.is_near_only && is_at_most(self.sample, 4.0 / tolerance)
    }
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
        let of_steps = if BOUND { bounds_of_steps(history) } else { steps(history, keys, seed) };
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
            let far = t >= first && basis.reach_of_step(t - first) > FAR;
            let moves = if plain { moves } else { ldexp(moves, -scaling.col(slave as usize)) };
            out.judge(t, state.w.abs(), moves.abs(), far);
        }
        let of_inverse = if BOUND { &mut out.bound_of_inverse } else { &mut out.sample_of_inverse };
        *of_inverse = sizes;
        out
    }
}

impl Sweep {
    /// Whether no number is large, so that nothing hangs on how others were drawn.
    pub fn is_harmless(&self) -> bool {
        is_at_most(self.steepest, NEARLY * STEEP) && self.doubtful.is_empty() && is_harmless(self.largest())
    }

    /// The largest bound of a row of `C_S^-1`.
    pub fn largest(&self) -> f64 {
        self.bound_of_inverse.iter().fold(0.0, |most, &size| if is_at_most(size, most) { most } else { size })
    }

    #[inline]
    fn judge(&mut self, t: usize, sample: f64, moves: f64, far: bool) {
        self.steepest = if is_at_most(moves, self.steepest) { self.steepest } else { moves };
        // What is no number is no small one.
        if far || !is_at_most(sample, WEAK) || !is_at_most(moves, STEEP) {
            let is_near_only = !far && is_at_most(moves, STEEP);
            self.doubtful.push(Doubtful { row: t, sample, is_near_only });
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

/// Masters at random, prescribed DOFs at zero.
fn start(system: Local, scaling: &Scaling, keys: &Keys, seed: u64) -> Vec<State> {
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
fn enter(block: &Kept, which: Sample, scaling: &Scaling, states: &mut [State], still: &mut Vec<u32>) {
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

#[expect(clippy::inline_always, reason = "out of line it was a twentieth of the profile of an elimination")]
#[inline(always)]
fn sums<const SIZES: bool>(terms: Row, slave: u32, states: &[State], scaling: &Scaling) -> Sums {
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

/// `L^-1` times a random right-hand side, by step.
fn steps(history: &History, keys: &Keys, seed: u64) -> Vec<f64> {
    let mut right: Vec<f64> = Vec::with_capacity(history.steps.len());
    for &row in &history.steps {
        let own = signed(seed, keys.row(history.rows[row as usize]));
        right.push(after(own, &history.factors[row as usize], &right));
    }
    right
}

/// The sizes of the rows of `L^-1`, by step.
fn bounds_of_steps(history: &History) -> Vec<f64> {
    let mut bounds: Vec<f64> = Vec::with_capacity(history.steps.len());
    for &row in &history.steps {
        let parts = history.factors[row as usize].iter().map(|&(step, factor)| factor.abs() * bounds[step as usize]);
        bounds.push(parts.fold(1.0, |sum, part| sum + part));
    }
    bounds
}

/// A right-hand side after the steps that were subtracted from its row.
fn after(own: f64, factors: &[(u32, f64)], steps: &[f64]) -> f64 {
    own - factors.iter().map(|&(step, factor)| factor * steps[step as usize]).sum::<f64>()
}

/// A random right-hand side after elimination, for every row of the core: the one of which blocks give their samples.
pub(crate) fn random_sides(eliminated: &Eliminated, keys: &Keys) -> Vec<f64> {
    let own = |row: u32| signed(SEEDS[0], keys.row(eliminated.names[row as usize]));
    let mut steps: Vec<f64> = Vec::with_capacity(eliminated.steps.len());
    for step in &eliminated.steps {
        steps.push(after(own(step.row), &eliminated.factors[step.row as usize], &steps));
    }
    let mut all = vec![0.0; eliminated.rows.len()];
    for &row in &eliminated.core {
        all[row as usize] = after(own(row), &eliminated.factors[row as usize], &steps);
    }
    all
}
