//! How time and memory grow: the paper's tie model from 3e4 to 3e6 equations, `cargo bench --bench scaling` (`-- --test` for
//! the two smallest sizes).
//!
//! All sizes are taken in turns, each with one transposition of C, in one process, so that a busy minute of the machine falls on
//! all of them. DOFs are numbered as equations name them, as a mesh generator would, and at random: there passes over DOFs wait
//! for memory as soon as it is larger than the caches, and the exponent of the transposition shows how much of that is the
//! machine's. Exponents are fitted to the medians of all sizes by least squares of logarithms.
//!
//! The process keeps its memory from one round to the next, as it does at small sizes anyway; `-- --fresh` leaves glibc its rule.

mod memory;
mod timing;

use std::hint::black_box;
use std::process::ExitCode;

use peak_alloc::PeakAlloc;
use qless::{ConstraintSystem, Csr, Options, analyse};
use qless_scenes::families;
use qless_scenes::fssi::{self, Mesh};

use timing::{median, seconds};

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

const SIZES: [usize; 5] = [30_000, 100_000, 300_000, 1_000_000, 3_000_000];

/// In each, every size has its turn.
const ROUNDS: usize = 15;

/// Numbers the DOFs of a system again.
type Order = fn(&ConstraintSystem) -> ConstraintSystem;

/// One size: equations, seconds of the whole elimination and of one transposition, bytes.
struct Sample {
    equations: f64,
    eliminate: f64,
    transpose: f64,
    peak: f64,
    csc: f64,
}

fn main() -> ExitCode {
    memory::kept(run)
}

fn run() {
    let short = std::env::args().any(|argument| argument == "--test");
    let sizes = &SIZES[..if short { 2 } else { SIZES.len() }];
    let orders: [(&str, Order); 2] = [("as named", by_appearance), ("random", Clone::clone)];
    let most = orders.map(|(name, order)| growth(name, order, sizes)).into_iter().fold(0.0, f64::max);
    extremes(if short { 10_000 } else { 1_000_000 });
    assert!(most <= 12.0, "peak memory is {most} times the bytes of C");
}

/// Prints a table of all sizes; the largest peak memory over the bytes of C.
fn growth(name: &str, order: Order, sizes: &[usize]) -> f64 {
    println!(
        "{:>9} {:>10} {:>9} {:>12} {:>14} {:>8} {:>12}",
        "equations", "nnz", "DOFs", "time", "transposition", "ratio", "memory / C"
    );
    let system = |&size: &usize| order(&fssi::tie(&Mesh::with_equations(size), 1).expect("a scene").system);
    let mut all: Vec<(ConstraintSystem, Times)> = sizes.iter().map(|size| (system(size), Times::default())).collect();
    for _ in 0..ROUNDS {
        all.iter_mut().for_each(|(system, times)| round(system, times));
    }
    let samples: Vec<Sample> = all.into_iter().map(|(system, times)| sample(name, &system, times)).collect();
    let exponent = |of: &dyn Fn(&Sample) -> f64| fit(samples.iter().map(|s| (s.equations.ln(), of(s).ln())));
    println!(
        "exponents: time {:.2}, peak memory {:.2}, transposition {:.2}",
        exponent(&|s| s.eliminate),
        exponent(&|s| s.peak),
        exponent(&|s| s.transpose)
    );
    samples.iter().map(|s| s.peak / s.csc).fold(0.0, f64::max)
}

/// The same equations with DOFs in the order in which they are named.
fn by_appearance(system: &ConstraintSystem) -> ConstraintSystem {
    let mut number = vec![usize::MAX; system.dofs()];
    let mut count = 0;
    let mut numbered = |j: usize| {
        if number[j] == usize::MAX {
            number[j] = count;
            count += 1;
        }
        number[j]
    };
    let mut matrix = Csr::empty(system.dofs());
    for i in 0..system.equations() {
        let mut row: Vec<_> = system.matrix().row(i).map(|(j, v)| (numbered(j), v)).collect();
        row.sort_unstable_by_key(|&(j, _)| j);
        matrix.push_row(row);
    }
    let prescribed: Vec<_> = system.prescribed().iter().map(|&(j, value)| (numbered(j), value)).collect();
    ConstraintSystem::from_csr(&matrix, system.rhs(), &prescribed).expect("the same system")
}

/// Shapes that make others slow: long chains, a closed one, and DOFs that occur in every equation.
fn extremes(size: usize) {
    let shapes = [
        ("chain", families::path(size + 1)),
        ("cycle", families::cycle(size, 0.0)),
        ("spider", families::spider(size / 10)),
        ("one DOF in all", families::arrow(size / 10)),
    ];
    println!("{:>16} {:>10} {:>10} {:>12}", "shape", "equations", "time", "certificates");
    for (name, scene) in shapes {
        let system = scene.expect("a scene").system;
        let mut terms = 0;
        let time = median((0..3).map(|_| seconds(|| terms = certificates_and_reduction(&system))).collect());
        println!("{name:>16} {:>10} {:>7.0} ms {terms:>6} terms", system.equations(), 1e3 * time);
    }
}

/// Everything, as [`whole`], whatever the growth; returns the number of terms of all certificates.
fn certificates_and_reduction(system: &ConstraintSystem) -> usize {
    let analysis = analyse(system, &Options::default()).expect("a valid system");
    black_box(analysis.reduction(system).t.nnz());
    analysis.dependent.iter().map(|d| analysis.because(d).len()).sum()
}

/// Seconds of the whole elimination and of one transposition, of every round.
type Times = [Vec<f64>; 2];

/// One round of a size: repeated where it is small, so that most do not find another size's data in the caches.
///
/// All the same 3e4 equations numbered at random take about a fifth longer here than alone (3.1 for 2.6 ms), which takes some
/// hundredths from the exponent.
fn round(system: &ConstraintSystem, times: &mut Times) {
    for _ in 0..(600_000 / system.equations()).max(1) {
        times[0].push(seconds(|| {
            black_box(whole(system));
        }));
        times[1].push(seconds(|| drop(black_box(system.matrix().transpose()))));
    }
}

/// Prints a line of the table.
fn sample(name: &str, system: &ConstraintSystem, times: Times) -> Sample {
    let [eliminate, transpose] = times.map(median);
    MEMORY.reset_peak_usage();
    let before = MEMORY.current_usage();
    black_box(whole(system));
    let (nnz, dofs) = (system.matrix().nnz(), system.dofs());
    let sample = Sample {
        equations: system.equations() as f64,
        eliminate,
        transpose,
        peak: (MEMORY.peak_usage() - before) as f64,
        csc: (12 * nnz + 8 * (dofs + 1)) as f64,
    };
    println!(
        "{:>9} {nnz:>10} {name:>9} {:>9.2} ms {:>11.2} ms {:>8.1} {:>12.1}",
        system.equations(),
        1e3 * eliminate,
        1e3 * transpose,
        eliminate / transpose,
        sample.peak / sample.csc
    );
    sample
}

/// Rank, named redundancies, T, G and g.
fn whole(system: &ConstraintSystem) -> usize {
    let analysis = analyse(system, &Options::default()).expect("a valid system");
    let named: usize = analysis.dependent.iter().map(|d| analysis.because(d).len()).sum();
    let reduction = analysis.reduction(system);
    assert!(reduction.growth <= 1.0, "growth {}", reduction.growth);
    named + reduction.t.nnz()
}

/// Slope of the least-squares line through points.
fn fit(points: impl Iterator<Item = (f64, f64)>) -> f64 {
    let points: Vec<_> = points.collect();
    let n = points.len() as f64;
    let mean = points.iter().fold((0.0, 0.0), |a, p| (a.0 + p.0 / n, a.1 + p.1 / n));
    let (above, below) = points.iter().fold((0.0, 0.0), |a, p| {
        let dx = p.0 - mean.0;
        (a.0 + dx * (p.1 - mean.1), a.1 + dx * dx)
    });
    above / below
}
