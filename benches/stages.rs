//! Every stage by itself: `cargo bench --bench stages` (`-- --test` for small systems, once each).
//!
//! Presolve (with scaling), factor (with its checked rank) and classify as the analysis times them; reduce, condense
//! (`T^T K T`, its factorization and u) and refresh around their calls. Each on a system that gives the stage work.

use std::hint::black_box;
use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};
use faer::sparse::{SparseColMat, Triplet};
use qless::change::Refresher;
use qless::diagnosis::Timings;
use qless::{Analysis, ConstraintSystem, Options, analyse};
use qless_scenes::families::Windows;
use qless_scenes::fssi::{self, Level, Mesh};
use qless_solve::enforce::reduced;

type Stage = fn(Timings) -> Duration;

/// Presolve peels nearly all of it: work for presolve, classify and reduce.
fn tie(short: bool) -> ConstraintSystem {
    let level = if short { Level::P50 } else { Level::P110 };
    fssi::tie(&level.mesh(), 1).expect("a scene").system
}

/// Presolve leaves one large sparse block.
fn windows(short: bool) -> ConstraintSystem {
    let side = if short { 16 } else { 40 };
    let windows = Windows { extent: [side, side, 1], d: 1, window: 4, stride: 2, rows: 2, combos: 20 };
    windows.scene(1).expect("a scene").system
}

/// Dense rows: work for refresh and condense.
fn mortar(short: bool) -> ConstraintSystem {
    fssi::mortar(&Mesh::with_equations(if short { 300 } else { 1_000 }), 1).expect("a scene").system
}

fn analysed(system: &ConstraintSystem) -> Analysis {
    analyse(system, &Options::default()).expect("a valid system")
}

/// Springs of stiffness 1 from each DOF to the next and to the ground.
fn springs(dofs: usize) -> SparseColMat<usize, f64> {
    let ends = |i: usize| if i == 0 || i + 1 == dofs { 2.0 } else { 3.0 };
    let own = (0..dofs).map(|i| Triplet::new(i, i, ends(i)));
    let next = (1..dofs).flat_map(|i| [Triplet::new(i, i - 1, -1.0), Triplet::new(i - 1, i, -1.0)]);
    let entries: Vec<_> = own.chain(next).collect();
    SparseColMat::try_new_from_triplets(dofs, dofs, &entries).expect("a matrix")
}

fn stages(criterion: &mut Criterion) {
    let short = std::env::args().any(|argument| argument == "--test");
    let (tie, windows, mortar) = (tie(short), windows(short), mortar(short));
    let timed: [(&str, &ConstraintSystem, Stage); 3] = [
        ("presolve (tie)", &tie, |timings| timings.presolve),
        ("factor (windows)", &windows, |timings| timings.factor),
        ("classify (tie)", &tie, |timings| timings.classify),
    ];
    for (name, system, stage) in timed {
        criterion.bench_function(name, |bencher| {
            bencher.iter_custom(|rounds| (0..rounds).map(|_| stage(analysed(system).timings())).sum());
        });
    }
    let analysis = analysed(&tie);
    criterion.bench_function("reduce (tie)", |bencher| {
        bencher.iter(|| black_box(analysis.reduction().expect("within the gate")));
    });
    let reduction = analysis.reduction().expect("within the gate");
    // This is included in the line above: every reduction is checked against the user's equations.
    criterion.bench_function("gate (tie)", |bencher| {
        bencher.iter(|| black_box(analysis.residual(&reduction).expect("its own DOFs")));
    });
    condense_and_refresh(criterion, &mortar);
}

fn condense_and_refresh(criterion: &mut Criterion, system: &ConstraintSystem) {
    let analysis = analysed(system);
    let mut reduction = analysis.reduction().expect("within the gate");
    let (k, f) = (springs(system.dofs()), vec![1.0; system.dofs()]);
    let values: Vec<f64> = system.prescribed().iter().map(|&(_, value)| value).collect();
    criterion.bench_function("condense (mortar)", |bencher| {
        bencher.iter(|| reduced(&k, &f, &reduction, &values).expect("a solution"));
    });
    let refresher = Refresher::new(analysis).expect("factored");
    criterion.bench_function("refresh (mortar)", |bencher| {
        bencher.iter(|| refresher.refresh(system.rhs(), &values, &mut reduction).expect("valid"));
    });
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10).measurement_time(Duration::from_secs(3)).warm_up_time(Duration::from_millis(300));
    targets = stages
}
criterion_main!(benches);
