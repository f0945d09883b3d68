//! Diagnosis and reductions of hard blocks against the bare sparse QR of SuiteSparse: `OPENBLAS_NUM_THREADS=1 cargo bench --bench blocks
//! --features spqr`.
//!
//! Mortar twin, all levels, one thread each, in one process and in turns, ratios of medians: `analyse` over the factorization of the
//! same C^T; the reduction in factor form, g, one product with T and one with T^T over the same; then one thread over two. `--test`
//! takes the smallest level only.

mod timing;

use std::hint::black_box;

use qless::backend::{Backend, spqr::Spqr};
use qless::{Analysis, ConstraintSystem, Form, Options, SystemBuilder, analyse};
use qless_scenes::fssi::{self, Level, Mesh};
use qless_scenes::{Scene, families};

use timing::{median, seconds};

fn diagnosed(system: &ConstraintSystem) -> Analysis {
    analyse(system, &Options::default()).expect("a diagnosis")
}

fn bare(system: &ConstraintSystem) -> usize {
    black_box(Spqr::default().factor(system.matrix(), &[], 1e-10).expect("a factorization")).rank
}

/// Reduction in factor form, g, one product with T and one with its transpose.
fn used(_system: &ConstraintSystem, analysis: &Analysis) -> f64 {
    let reduction = analysis.reduction_in(Form::Factored).expect("within the gate");
    let u = reduction
        .expand(&vec![1.0; reduction.masters().len()], &vec![0.0; reduction.prescribed().len()])
        .expect("of its lengths");
    let f = reduction.apply_transposed(&vec![1.0; reduction.slaves().len()]).expect("of its lengths");
    black_box(u[0] + f[0])
}

/// Medians of the works in turns.
fn medians<const N: usize>(rounds: usize, mut works: [&mut dyn FnMut(); N]) -> [f64; N] {
    let mut times = [(); N].map(|()| Vec::new());
    for _ in 0..rounds {
        works.iter_mut().zip(&mut times).for_each(|(work, times)| times.push(seconds(&mut **work)));
    }
    times.map(median)
}

/// Seconds of the analysis and of the bare QR.
fn mortar(name: &str, mesh: &Mesh, rounds: usize) -> [f64; 2] {
    let system = fssi::mortar(mesh, 1).expect("a scene").system;
    let (analysis, rank) = (diagnosed(&system), bare(&system));
    let pools = [1, 2].map(|threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool"));
    let [one, two] = &pools;
    let [ours, theirs, factors, parallel] = medians(
        rounds,
        [
            &mut || drop(one.install(|| black_box(diagnosed(&system)))),
            &mut || {
                black_box(bare(&system));
            },
            &mut || {
                black_box(one.install(|| used(&system, &analysis)));
            },
            &mut || drop(two.install(|| black_box(diagnosed(&system)))),
        ],
    );
    println!(
        "mortar {name:>9}: analyse {:>7.1} ms, bare QR {:>7.1} ms: {:.2}; factor form and its use {:>7.1} ms: {:.2}; two threads {:.2}; rank {}, the bare QR's {rank}",
        ours * 1e3,
        theirs * 1e3,
        ours / theirs,
        factors * 1e3,
        factors / theirs,
        ours / parallel,
        analysis.rank(),
    );
    [ours, theirs]
}

/// Equal components of about 1,000 equations on one thread and on two.
fn components(name: &str, scene: &Scene, count: usize, rounds: usize) {
    let (rows, dofs) = (scene.system.equations(), scene.system.dofs());
    let mut builder = SystemBuilder::new(count * dofs);
    for k in 0..count {
        for i in 0..rows {
            builder.equation(scene.system.matrix().row(i).map(|(j, v)| (k * dofs + j, v)), scene.system.rhs()[i]);
        }
    }
    let system = builder.build().expect("copies of a system");
    let pools = [1, 2].map(|threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool"));
    let [one, two] = medians(
        rounds,
        [&mut || drop(pools[0].install(|| black_box(diagnosed(&system)))), &mut || {
            pools[1].install(|| drop(black_box(diagnosed(&system))));
        }],
    );
    println!("{count} times {name}, {rows} equations: {:.1} ms, two threads {:.2}", one * 1e3, one / two);
}

fn main() {
    let test = std::env::args().any(|arg| arg == "--test");
    let levels = if test { &Level::ALL[..1] } else { &Level::ALL[..] };
    let rounds = if test { 1 } else { 5 };
    let times: Vec<_> = levels.iter().map(|of| mortar(&format!("{} %", of.percent()), &of.mesh(), rounds)).collect();
    if !test {
        // Four times the equations of the largest level.
        let growth = 4.0 * Level::P110.equations() as f64 / Level::P50.equations() as f64;
        let large = mortar("4 x 110 %", &Mesh::with_equations(4 * Level::P110.equations()), 1);
        let [ours, theirs] = [0, 1].map(|k| (large[k] / times[0][k]).ln() / growth.ln());
        println!("exponents from 50 % to 4 x 110 %: analyse {ours:.2}, bare QR {theirs:.2}");
    }
    let count = if test { 10 } else { 1000 };
    components("a chain", &families::path(1001).expect("a scene"), count, rounds);
    components("random blocks on a grid", &families::gradient([16, 17, 1], 2, 1).expect("a scene"), count, rounds);
}
