//! Diagnosis and reductions of hard blocks against the bare sparse QR of SuiteSparse: `OPENBLAS_NUM_THREADS=1 cargo bench --bench blocks
//! --features spqr`.
//!
//! In one process and in turns, one thread each, ratios of medians: `analyse` over the factorization of C^T, and of C where that is
//! cheaper (its rank is printed: it may be wrong); then one thread over two. For the mortar twin also the reduction in factor form, g,
//! one product with T and one with T^T. `--test` takes the smallest systems only, any other word those whose names hold it.

mod timing;

use std::hint::black_box;

use qless::backend::{Backend, spqr::Spqr};
use qless::{Analysis, ConstraintSystem, Csr, Form, Options, SystemBuilder, analyse};
use qless_qr::Symbolic;
use qless_scenes::families::{MortarSurface, Surface, Windows};
use qless_scenes::fssi::{self, Level, Mesh};
use qless_scenes::{Scene, SceneError, families};

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
        "mortar {name:>9}: analyse {:>7.1} ms, bare QR {:>7.1} ms: {:.2}; factor form and its use {:>7.1} ms: {:.2}; two threads {:.2} ({}); rank {}, the bare QR's {rank}",
        ours * 1e3,
        theirs * 1e3,
        ours / theirs,
        factors * 1e3,
        factors / theirs,
        ours / parallel,
        bounds(&system),
        analysis.rank(),
    );
    [ours, theirs]
}

/// What the tree of fronts of C^T allows on 2, 16 and 64 threads.
fn bounds(system: &ConstraintSystem) -> String {
    let c = system.matrix();
    let symbolic = Symbolic::analyse(c.cols(), c.rows(), c.starts(), c.columns()).expect("a pattern");
    let [two, sixteen, many] = [2, 16, 64].map(|threads| symbolic.speedup(threads));
    format!("at most {two:.1}, {sixteen:.1} and {many:.1} times as fast on 2, 16 and 64")
}

/// One system with one large block: `analyse`, the bare QR of both orientations, and two threads.
fn block(name: &str, system: &ConstraintSystem, rounds: usize) {
    let transposed = system.matrix().transpose().expect("few enough rows");
    let (analysis, rank) = (diagnosed(system), bare(system));
    let of_c = |c: &Csr| black_box(Spqr::default().factor(c, &[], 1e-10).expect("a factorization")).rank;
    let other_rank = of_c(&transposed);
    let pools = [1, 2].map(|threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool"));
    let [ours, theirs, others, parallel] = medians(
        rounds,
        [
            &mut || drop(pools[0].install(|| black_box(diagnosed(system)))),
            &mut || _ = black_box(bare(system)),
            &mut || _ = of_c(&transposed),
            &mut || drop(pools[1].install(|| black_box(diagnosed(system)))),
        ],
    );
    println!(
        "{name:<32} {:>7} equations: analyse {:>8.1} ms, bare QR of C^T {:.2}, of C {:.2}; two threads {:.2} ({}); rank {}, the bare QR's {rank} and {other_rank}",
        system.equations(),
        ours * 1e3,
        ours / theirs,
        ours / others,
        ours / parallel,
        bounds(system),
        analysis.rank(),
    );
}

/// A system with one large block: name, how to build it, and rounds.
type Block = (String, Box<dyn Fn() -> Result<Scene, SceneError>>, usize);

fn blocks(test: bool) -> Vec<Block> {
    let flat = |side: usize, combos: usize| {
        let windows = Windows { extent: [side, side, 1], d: 1, window: 4, stride: 2, rows: 2, combos };
        (format!("windows {side} x {side}, {combos} combinations"), windows)
    };
    let solid = |side: usize| {
        let windows = Windows { extent: [side; 3], d: 1, window: 4, stride: 2, rows: 2, combos: 0 };
        (format!("windows {side} x {side} x {side}"), windows)
    };
    let windows = if test {
        vec![flat(16, 20), solid(8)]
    } else {
        vec![flat(160, 0), flat(160, 3_000), flat(400, 15_000), solid(24), solid(40)]
    };
    let surfaces = [("curved mortar", Surface::Sphere), ("mortar of waves", Surface::Waves)];
    let equations = if test { 300 } else { 12_000 };
    let mut all: Vec<Block> = Vec::new();
    for (name, windows) in windows {
        let rounds = if test || windows.dofs() > 50_000 { 1 } else { 5 };
        all.push((name, Box::new(move || windows.scene(1)), rounds));
    }
    for (name, surface) in surfaces {
        let mortar = MortarSurface::with_equations(surface, equations);
        all.push((name.into(), Box::new(move || mortar.scene(1)), if test { 1 } else { 5 }));
    }
    all
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
    let words: Vec<String> = std::env::args().skip(1).filter(|arg| !arg.starts_with("--bench")).collect();
    let test = words.iter().any(|word| word == "--test");
    let names: Vec<&String> = words.iter().filter(|word| !word.starts_with("--")).collect();
    let is_wanted = |name: &str| names.is_empty() || names.iter().any(|word| name.contains(word.as_str()));
    for (name, scene, rounds) in blocks(test).into_iter().filter(|(name, ..)| is_wanted(name)) {
        block(&name, &scene().expect("a scene").system, rounds);
    }
    let levels = if test { &Level::ALL[..1] } else { &Level::ALL[..] };
    let rounds = if test { 1 } else { 5 };
    let of_level = |level: &&Level| is_wanted(&format!("level {} %", level.percent()));
    let times: Vec<_> = levels
        .iter()
        .filter(of_level)
        .map(|of| mortar(&format!("level {} %", of.percent()), &of.mesh(), rounds))
        .collect();
    if !test && is_wanted("level 4 x 110 %") {
        // Four times the equations of the largest level.
        let large = mortar("level 4 x 110 %", &Mesh::with_equations(4 * Level::P110.equations()), 1);
        if let Some(first) = times.first().filter(|_| times.len() == levels.len()) {
            let growth = 4.0 * Level::P110.equations() as f64 / Level::P50.equations() as f64;
            let [ours, theirs] = [0, 1].map(|k| (large[k] / first[k]).ln() / growth.ln());
            println!("exponents from 50 % to 4 x 110 %: analyse {ours:.2}, bare QR {theirs:.2}");
        }
    }
    if is_wanted("components") {
        let count = if test { 10 } else { 1000 };
        components("a chain", &families::path(1001).expect("a scene"), count, rounds);
        components("random blocks on a grid", &families::gradient([16, 17, 1], 2, 1).expect("a scene"), count, rounds);
    }
}
