//! How time grows: the paper's tie model from 3e4 to 3e6 equations, `cargo bench --bench scaling` (`-- --test` for the two
//! smallest sizes).
//!
//! All sizes run in turns, each with one transposition of C, in one process, so that a busy minute of the machine affects
//! all of them. DOFs are numbered in the order of the equations, as by a mesh generator, and at random: then passes over DOFs wait
//! for memory as soon as the data exceed the caches, and the exponent of the transposition shows the share of
//! the machine. Exponents are fitted to the medians of all sizes by least squares of logarithms.
//!
//! The process keeps its memory from one round to the next, as it does at small sizes anyway; `-- --fresh` leaves glibc its rule.

mod sizes;
mod timing;

use std::hint::black_box;
use std::process::ExitCode;

use qless::{ConstraintSystem, Options, analyse};
use qless_scenes::{families, memory};

use sizes::{ORDERS, Order, exponent, sizes, system, whole};
use timing::{median, seconds};

/// Number of rounds; each runs every size.
const ROUNDS: usize = 15;

fn main() -> ExitCode {
    memory::kept(run)
}

fn run() {
    for (name, order) in ORDERS {
        growth(name, order);
    }
    extremes(if sizes().len() < 3 { 10_000 } else { 1_000_000 });
}

/// Prints a table of all sizes.
fn growth(name: &str, order: Order) {
    println!("{:>9} {:>10} {:>9} {:>12} {:>14} {:>8}", "equations", "nnz", "DOFs", "time", "transposition", "ratio");
    let mut all: Vec<(ConstraintSystem, Times)> =
        sizes().iter().map(|&size| (system(size, order), Times::default())).collect();
    for _ in 0..ROUNDS {
        all.iter_mut().for_each(|(system, times)| round(system, times));
    }
    let medians: Vec<[f64; 3]> = all.into_iter().map(|(system, times)| line(name, &system, times)).collect();
    let of = |k: usize| exponent(medians.iter().map(|m| (m[0], m[k])));
    println!("exponents: time {:.2}, transposition {:.2}", of(1), of(2));
}

/// Seconds of the whole elimination and of one transposition, of every round.
type Times = [Vec<f64>; 2];

/// One round of a size. Small sizes are repeated, so that most runs do not find data of another size in the caches.
///
/// Nevertheless 3e4 equations numbered at random take about a fifth longer here than alone (2.9 instead of 2.4 ms), which reduces
/// the exponent by some hundredths.
fn round(system: &ConstraintSystem, times: &mut Times) {
    for _ in 0..(600_000 / system.equations()).max(1) {
        times[0].push(seconds(|| {
            black_box(whole(system));
        }));
        times[1].push(seconds(|| drop(black_box(system.matrix().transpose().expect("it fits")))));
    }
}

/// Prints a line of the table: equations, medians of the elimination and of the transposition.
fn line(name: &str, system: &ConstraintSystem, times: Times) -> [f64; 3] {
    let [eliminate, transpose] = times.map(median);
    println!(
        "{:>9} {:>10} {name:>9} {:>9.2} ms {:>11.2} ms {:>8.1}",
        system.equations(),
        system.matrix().nnz(),
        1e3 * eliminate,
        1e3 * transpose,
        eliminate / transpose
    );
    [system.equations() as f64, eliminate, transpose]
}

/// Shapes that are slow for other algorithms: long chains, a closed chain, and DOFs that occur in every equation.
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

/// The whole elimination as in [`whole`] without the check of growth; returns the number of terms of all certificates.
fn certificates_and_reduction(system: &ConstraintSystem) -> usize {
    let analysis = analyse(system, &Options::default()).expect("a valid system");
    black_box(analysis.reduction().expect("within the gate").t().nnz());
    analysis.dependent().iter().map(|d| analysis.because(d.row).expect("one of its rows").len()).sum()
}
