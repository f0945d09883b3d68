//! The answer is the same, bit for bit, for every number of threads.

#[macro_use]
mod support;

use qless::{BackendChoice, ConstraintSystem, Options, Reduction, SystemBuilder, analyse};
use qless_scenes::families::{self, Windows};

/// Types that a program keeps with its model are `Send` and `Sync`.
#[test]
fn everything_can_be_sent_and_shared() {
    fn both<T: Send + Sync>() {}
    both::<qless::Analysis>();
    both::<qless::ChangingSystem>();
    both::<qless::Elimination>();
    both::<qless::change::Refresher>();
    both::<ConstraintSystem>();
    both::<Reduction>();
    both::<qless_constraints::ConstraintSet>();
    both::<qless::AnalysisError>();
    both::<qless::ReductionError>();
}

fn on_threads(system: &ConstraintSystem, options: &Options, threads: usize) -> (Vec<usize>, Reduction) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
    pool.install(|| {
        let analysis = analyse(system, options).expect("valid");
        let reduction = analysis.reduction().expect("within the gate");
        (analysis.dependent().iter().map(|d| d.row).collect(), reduction)
    })
}

fn agree(system: &ConstraintSystem, options: &Options) {
    let (rows, reduction) = on_threads(system, options, 1);
    for threads in [2, 3] {
        let (other_rows, other) = on_threads(system, options, threads);
        assert_eq!(rows, other_rows);
        assert!(
            (&reduction.slaves(), &reduction.t(), &reduction.g()) == (&other.slaves(), &other.t(), &other.g())
                && reduction.g_matrix() == other.g_matrix(),
            "{threads} threads give another reduction"
        );
    }
}

/// Enough rows for threads to number DOFs in halves and to write T and G together: `u_2i - 2 u_2i+1 - 3 u_last = i`, DOFs in any order, the last one prescribed.
#[test]
fn many_rows() {
    let (rows, last) = (1_060_000, 2_120_000);
    // 7,777 has no divisor in common with the number of DOFs.
    let anywhere = |j: usize| j * 7_777 % last;
    let mut builder = SystemBuilder::new(last + 1);
    for i in 0..rows {
        builder.equation([(anywhere(2 * i), 1.0), (anywhere(2 * i + 1), -2.0), (last, -3.0)], i as f64);
    }
    builder.prescribe(last, 1.0);
    let system = builder.build().expect("valid");
    agree(&system, &Options::default());
    let reduction = on_threads(&system, &Options::default(), 3).1;
    let masters: Vec<f64> = reduction.masters().iter().map(|&j| j as f64).collect();
    let u = reduction.expand(&masters, &[1.0]).expect("of its lengths");
    for i in 0..rows {
        let (a, b) = (u[anywhere(2 * i)], u[anywhere(2 * i + 1)]);
        assert!((a - 2.0 * b - 3.0 - i as f64).abs() <= 1e-13 * a.abs().max(b.abs()), "equation {i}");
    }
}

fn many_blocks(backend: BackendChoice) {
    let scene = families::random_graph(400, 380, 5).expect("a scene");
    let options = Options { backend, presolve: false, ..Options::default() };
    let blocks = analyse(&scene.system, &options).expect("valid").presolve().blocks;
    assert!(blocks > 1, "several blocks, or there is nothing to share out");
    agree(&scene.system, &options);
}

/// A block with an elimination tree that several threads process.
fn one_large_block(backend: BackendChoice) {
    let windows = Windows { extent: [40, 40, 1], d: 1, window: 4, stride: 2, rows: 2, combos: 60 };
    let scene = windows.scene(3).expect("a scene");
    let options = Options { backend, presolve: false, ..Options::default() };
    agree(&scene.system, &options);
}

on_each_backend!(many_blocks, one_large_block);
