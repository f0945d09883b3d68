//! Measures the factorizations in turns.

use std::hint::black_box;
use std::time::Instant;

use qless::backend::{Backend, BackendError};
use qless::{BackendChoice, Options};
use rayon::{ThreadPool, ThreadPoolBuilder};

use super::super::systems::{BenchCase, Family, below_table_1};
use super::blocks::{FigureBlock, blocks};
use super::{FigureLevel, FigureSide, GAUSS, Way};
use crate::BenchArgs;

/// The tolerance of the paper, section 3.2: absolute.
const TOLERANCE: f64 = 1e-5;

/// In seconds: a factorization that takes longer than this is measured once.
const SLOW: f64 = 5.0;
/// In seconds: a factorization that takes less than this is measured at least [`REPEATS`] times.
const SHORT: f64 = 0.1;
const REPEATS: usize = 15;

/// Measures every level of the family, and coarser meshes. Returns an error if a scene or a thread cannot be created.
pub fn measure(family: &Family, args: &BenchArgs) -> Result<Vec<FigureLevel>, String> {
    let pool = ThreadPoolBuilder::new().num_threads(1).build().map_err(|error| error.to_string())?;
    let below = below_table_1(family.name);
    below.iter().chain(&family.cases).map(|case| level(case, &pool, args.runs.get())).collect()
}

fn level(case: &BenchCase, pool: &ThreadPool, runs: usize) -> Result<FigureLevel, String> {
    let scene = case.scene()?;
    let blocks = blocks(&scene.system);
    let equations = scene.system.equations();
    let largest = blocks.iter().map(|block| (block.c.cols(), block.c.rows())).max();
    Ok(FigureLevel {
        family: case.family,
        size: case.size.clone(),
        equations,
        rank: scene.truth.rank_free.unwrap_or(equations),
        blocks: blocks.len(),
        largest: largest.unwrap_or_default(),
        ways: pool.install(|| in_turns(&blocks, runs)),
    })
}

/// A running measurement: name, backend, side, times so far, and the rank or an error.
type TimingRound = (&'static str, Box<dyn Backend>, FigureSide, Vec<f64>, Result<usize, String>);

fn in_turns(blocks: &[FigureBlock], runs: usize) -> Vec<Way> {
    let mut turns = turns();
    // The first round only warms the caches, unless it is slow.
    for round in 0..=runs.max(REPEATS) {
        for (_, backend, side, times, rank) in &mut turns {
            if rank.is_err() || is_enough(times, runs) {
                continue;
            }
            let start = Instant::now();
            *rank = factor(blocks, backend.as_ref(), *side, TOLERANCE).map_err(|error| error.to_string());
            let time = start.elapsed().as_secs_f64();
            if round > 0 || time > SLOW {
                times.push(time);
            }
        }
    }
    turns
        .into_iter()
        .map(|(backend, _, side, times, rank)| Way { backend, side, result: median(times, rank) })
        .collect()
}

fn is_enough(times: &[f64], runs: usize) -> bool {
    let enough = |&first: &f64| first > SLOW || (first > SHORT && times.len() >= runs);
    times.first().is_some_and(enough)
}

fn turns() -> Vec<TimingRound> {
    let names =
        [(GAUSS, BackendChoice::Gauss), ("qless-qr", BackendChoice::Sparse), ("SuiteSparseQR", BackendChoice::Spqr)];
    let memory = Options::default().memory;
    let both = FigureSide::BOTH.iter().flat_map(|&side| names.map(|(name, choice)| (name, choice, side)));
    // Backends that are not compiled in are omitted.
    both.filter_map(|(name, choice, side)| Some((name, choice.get(memory).ok()?, side, Vec::new(), Ok(0)))).collect()
}

fn median(mut times: Vec<f64>, rank: Result<usize, String>) -> Result<(f64, usize), String> {
    times.sort_by(f64::total_cmp);
    rank.map(|rank| (times[(times.len() - 1) / 2], rank))
}

/// The rank of all blocks together.
pub fn factor(
    blocks: &[FigureBlock],
    backend: &dyn Backend,
    side: FigureSide,
    tolerance: f64,
) -> Result<usize, BackendError> {
    let rank = |block: &FigureBlock| {
        let factor = match side {
            FigureSide::C => backend.factor(&block.c, &block.rhs, tolerance),
            FigureSide::Transposed => backend.factor(&block.transposed, &[], tolerance),
        };
        factor.map(|factor| black_box(factor).rank)
    };
    blocks.iter().map(rank).sum()
}
