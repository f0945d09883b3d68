//! The paper's Table 1 (tie), whole elimination, in units of one transposition of C: `cargo bench --bench tie`.
//!
//! Criterion gives each side's time; the line printed first gives the ratio of medians of both sides taken in turns in one
//! process, which is least sensitive to noise of the machine.

mod timing;

use std::hint::black_box;
use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};
use qless::{ConstraintSystem, Options, analyse};
use qless_scenes::fssi::{self, Level};

use timing::{median, seconds};

fn whole(system: &ConstraintSystem) -> usize {
    let analysis = analyse(system, &Options::default()).expect("a valid system");
    let named: usize =
        analysis.dependent().iter().map(|d| analysis.because(d.row).expect("one of its rows").len()).sum();
    named + analysis.reduction().expect("within the gate").t().nnz()
}

/// Median of the first over median of the second, taken in turns.
fn ratio(rounds: usize, mut first: impl FnMut(), mut second: impl FnMut()) -> (f64, f64) {
    let pairs: Vec<_> = (0..rounds).map(|_| (seconds(&mut first), seconds(&mut second))).collect();
    let (a, b): (Vec<_>, Vec<_>) = pairs.into_iter().unzip();
    (median(a), median(b))
}

fn table_1(criterion: &mut Criterion) {
    for level in [Level::P50, Level::P80, Level::P110] {
        let system = fssi::tie(&level.mesh(), 1).expect("a scene").system;
        let eliminate = || {
            black_box(whole(&system));
        };
        let transpose = || drop(black_box(system.matrix().transpose().expect("it fits")));
        let (a, b) = ratio(51, eliminate, transpose);
        let percent = level.percent();
        println!("tie {percent} %: {:.2} ms, {:.1} transpositions of {:.3} ms", a * 1e3, a / b, b * 1e3);
        let analysis = analyse(&system, &Options::default()).expect("a valid system");
        let reduction = analysis.reduction().expect("within the gate");
        let gate = || {
            black_box(analysis.residual(&reduction).expect("its own DOFs"));
        };
        let (gate, b) = ratio(51, gate, transpose);
        println!("  of which the check against the equations: {:.2} ms, {:.1} transpositions", gate * 1e3, gate / b);
        criterion.bench_function(&format!("tie {percent} %/eliminate"), |bencher| bencher.iter(eliminate));
        criterion.bench_function(&format!("tie {percent} %/transpose"), |bencher| bencher.iter(transpose));
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20).measurement_time(Duration::from_secs(2)).warm_up_time(Duration::from_millis(300));
    targets = table_1
}
criterion_main!(benches);
