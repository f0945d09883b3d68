//! Distance of the kept equations K from dependence: the smallest d such that K + E is rank deficient for some E with
//! `|E_ij| <= d |K_ij|`.
//!
//! ```text
//! d >= 1 / rho(|K| |X|)    for any X with K X = I       (y^T (K + E) = 0  ->  |y|^T <= d |y|^T |K| |X|)
//! rho = 1                  for triangular parts, so only cores are computed
//! v <- |K| |X| v           power method from v = 1; (|X| v)_j as the root mean square of (X (v * s))_j over random signs s
//! ```
//!
//! X is applied by its factors: steps of elimination, then the minimum-norm solution of each block, then back substitution. Scaling rows
//! and columns by any numbers does not change rho.

use rayon::prelude::*;

use super::certificate::History;
use super::core::{Core, cores};
use crate::common::random::signed;
use crate::factor::block::Block;
use crate::factor::block::triangle::Triangle;
use crate::input::components::Labels;
use crate::input::noise::{TYPED, last_digit, typed_precision};
use crate::input::numbering::LocalSystem;
use crate::input::scale::{Scaling, ldexp};
use crate::presolve::basis::Basis;

/// Number of right-hand sides with random signs that are solved together.
const SIGNS: usize = 8;
/// Steps of the power method.
const STEPS: usize = 3;
/// Seed of the random signs.
const SEED: u64 = 0x2545_f491;

type Lanes = [f64; SIGNS];

/// The kept equations and their factorization: steps of elimination, blocks and triangles.
pub(crate) struct KeptRows<'a> {
    pub system: LocalSystem<'a>,
    pub basis: &'a Basis,
    pub history: &'a History,
    pub scaling: &'a Scaling,
    pub blocks: &'a [Block],
    pub triangles: &'a [Triangle],
}

/// The distance of a core from dependence.
#[derive(Clone, Copy)]
pub(crate) struct CoreDistance {
    /// One of the equations of the core.
    pub row: u32,
    /// The estimate of the distance d from dependence, at most 1.
    pub distance: f64,
    /// True if changes in the last digit with which coefficients were typed can make the core dependent.
    pub is_typed: bool,
}

/// For each component, the least distance of its cores from dependence; 1 without cores. Each core is given by one of its equations.
pub(crate) fn least_distances(labels: &Labels, of_cores: &[(u32, f64)]) -> Vec<f64> {
    let mut least = vec![1.0_f64; labels.count];
    for &(row, distance) in of_cores {
        let of_component = &mut least[labels.of_row[row as usize] as usize];
        *of_component = of_component.min(distance);
    }
    least
}

impl KeptRows<'_> {
    /// The distance of each core.
    pub fn distances(&self) -> Vec<CoreDistance> {
        let cores = cores(self.system, &self.candidates());
        if cores.is_empty() {
            return Vec::new();
        }
        let of_core = |rho: f64| if rho >= 1.0 { 1.0 / rho } else { f64::from(rho < 1.0) };
        let distances = self.growths(&cores).into_iter().map(of_core);
        let of = |(distance, core): (f64, &Core)| {
            let is_typed = distance < precision(core, distance);
            CoreDistance { row: core.rows[0], distance, is_typed }
        };
        distances.zip(&cores).map(of).collect()
    }

    /// Kept rows that were not peeled, ascending.
    fn candidates(&self) -> Vec<u32> {
        let name = |&row: &u32| self.history.rows[row as usize];
        let of_blocks = self.basis.blocks.iter().flat_map(|block| &block.rows);
        let mut rows: Vec<u32> = self.history.steps.iter().chain(of_blocks).map(name).collect();
        rows.sort_unstable();
        rows
    }

    /// The spectral radius rho of `|K| |X|` for each core, where K X = I.
    fn growths(&self, cores: &[Core]) -> Vec<f64> {
        let mut weights: Vec<Vec<f64>> = cores.iter().map(|core| vec![1.0; core.rows.len()]).collect();
        let mut growth = vec![1.0; cores.len()];
        let mut sides = vec![None; self.system.equations()];
        let blocks = self.blocks.par_iter().zip(self.triangles).zip(&self.basis.blocks);
        let is_accurate =
            blocks.map(|((block, triangle), kept)| triangle.is_accurate(block, kept.nearness.sigma)).collect();
        for step in 0..STEPS {
            for (core, weights) in cores.iter().zip(&weights) {
                for ((&row, weight), k) in core.rows.iter().zip(weights).zip(0..) {
                    let drawn = |lane: usize| signed(SEED + (step * SIGNS + lane) as u64, k);
                    sides[row as usize] = Some(std::array::from_fn(|lane| weight.copysign(drawn(lane))));
                }
            }
            let u = self.solved(&sides, &is_accurate);
            let size = |j: u32| (u[j as usize].iter().map(|u| u * u).sum::<f64>() / SIGNS as f64).sqrt();
            for ((core, weights), growth) in cores.iter().zip(&mut weights).zip(&mut growth) {
                let entry = |i: u32, j: u32, v: f64| self.scaling.entry(i as usize, j as usize, v).abs();
                for ((weight, &i), entries) in weights.iter_mut().zip(&core.rows).zip(&core.entries) {
                    *weight = entries.iter().map(|&(j, v)| entry(i, j, v) * size(j)).sum();
                }
                *growth = weights.iter().fold(0.0, |most: f64, w| if *w <= most { most } else { *w });
                weights.iter_mut().for_each(|w| *w /= *growth);
            }
        }
        growth
    }

    /// A solution `u = X g` of `K u = g` for the kept equations K, by DOF. `sides` holds the right-hand sides g by the user's row. Both u
    /// and g are in scaled rows and columns. `is_accurate` says for each block whether [`Triangle::is_accurate`].
    fn solved(&self, sides: &[Option<Lanes>], is_accurate: &Vec<bool>) -> Vec<Lanes> {
        let Self { system, basis, history, scaling, .. } = *self;
        let mut after: Vec<Lanes> = Vec::with_capacity(history.steps.len());
        let own = |row: u32| sides[history.rows[row as usize] as usize].unwrap_or_default();
        let side = |row: u32, after: &[Lanes]| {
            let mut side = own(row);
            for &(step, factor) in &history.factors[row as usize] {
                add(&mut side, -factor, &after[step as usize]);
            }
            side
        };
        for &row in &history.steps {
            after.push(side(row, &after));
        }
        let mut u = vec![Lanes::default(); system.dofs()];
        let of_block = |((block, triangle), &is_accurate): ((&Block, &Triangle), &bool)| {
            let right = |&i: &usize| side(block.rows[i], &after).map(|v| ldexp(v, block.exponents[i]));
            shortest(block, triangle, is_accurate, &triangle.rows.iter().map(right).collect())
        };
        let blocks = self.blocks.par_iter().zip(self.triangles).zip(is_accurate);
        let solved: Vec<Vec<Lanes>> = blocks.map(of_block).collect();
        for (block, x) in self.blocks.iter().zip(solved) {
            let restored = x.iter().zip(&block.units).map(|(x, &unit)| x.map(|x| ldexp(x, unit)));
            block.dofs.iter().zip(restored).for_each(|(&j, x)| u[j as usize] = x);
        }
        let first = basis.peeled.len();
        for t in (first..basis.rows()).rev() {
            let slave = basis.slave(t);
            let row = basis.row(system, t);
            let pivot = basis.pivot(t, &row, scaling);
            let mut sum = after[t - first].map(|v| v / pivot);
            for (j, v) in row.entries() {
                add(&mut sum, ldexp(v, scaling.col(j as usize) - scaling.col(slave as usize)), &u[j as usize]);
            }
            u[slave as usize] = sum;
        }
        u
    }
}

/// The relative size of the last digit of the core's equation that was typed with the fewest digits, or 0 if the core is too far from
/// dependence for typed digits to matter.
fn precision(core: &Core, distance: f64) -> f64 {
    if distance >= last_digit(*TYPED.start()) {
        return 0.0;
    }
    typed_precision(core.entries.iter().map(|row| row.iter().map(|&(_, value)| value)))
}

/// The minimum-norm solutions of a block. With several threads, each half of the right-hand sides is solved on its own thread.
fn shortest(block: &Block, triangle: &Triangle, is_accurate: bool, sides: &Vec<Lanes>) -> Vec<Lanes> {
    if rayon::current_num_threads() == 1 {
        return triangle.nearly_shortest(block, sides, is_accurate);
    }
    let half = |first: usize| {
        let sides = sides.iter().map(|side| std::array::from_fn(|lane| side[first + lane])).collect();
        triangle.nearly_shortest::<{ SIGNS / 2 }>(block, &sides, is_accurate)
    };
    let (first, second) = rayon::join(|| half(0), || half(SIGNS / 2));
    let join = |(a, b): (&[f64; SIGNS / 2], &[f64; SIGNS / 2])| {
        std::array::from_fn(|lane| if lane < SIGNS / 2 { a[lane] } else { b[lane - SIGNS / 2] })
    };
    first.iter().zip(&second).map(join).collect()
}

/// `a <- a + v b`.
fn add(a: &mut Lanes, v: f64, b: &Lanes) {
    a.iter_mut().zip(b).for_each(|(a, b)| *a += v * b);
}
