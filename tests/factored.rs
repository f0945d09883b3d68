//! Reductions in factored form have the same solutions and bounds as explicit ones, and the same bits on any number of threads.

mod support;

use std::sync::Arc;

use qless::change::Refresher;
use qless::{Analysis, ConstraintSystem, Csr, Form, Options, Reduction, SystemBuilder, analyse};
use qless_scenes::families;
use qless_scenes::fssi::{self, Level};

/// A planted system, in mixed units and with a prescribed DOF for some seeds.
fn planted(seed: u64) -> Option<ConstraintSystem> {
    let (rows, more) = (5 + (seed % 40) as usize, (seed / 3 % 30) as usize);
    let base = families::planted(rows, rows + more, (seed % 7) as usize, seed, false).ok()?.system;
    let mut builder = SystemBuilder::new(base.dofs());
    for i in 0..base.equations() {
        builder.equation(base.matrix().row(i).map(|(j, v)| (j, v * unit(seed, j))), base.rhs()[i]);
    }
    if seed.is_multiple_of(3) {
        builder.prescribe(0, 0.5);
    }
    builder.build().ok()
}

/// The unit of a DOF.
fn unit(seed: u64, j: usize) -> f64 {
    [1.0, 1e-5, 7e4, 1.0, 3e2][if seed % 2 == 1 { (j * 7 + seed as usize) % 5 } else { 0 }]
}

fn diagnosed(system: &ConstraintSystem, growth: f64) -> Analysis {
    analyse(system, &Options { growth, ..Options::default() }).expect("valid")
}

fn random(k: usize) -> f64 {
    ((k * 7919 + 13) % 101) as f64 / 50.0 - 1.01
}

/// The dense T by columns.
fn t_of(reduction: &Reduction) -> Csr {
    let mut columns = Csr::empty(reduction.slaves().len());
    (0..reduction.masters().len())
        .for_each(|q| columns.push_row(reduction.column(q).expect("a master")).expect("ascending"));
    columns.transpose().expect("few enough slaves")
}

/// `f . T x = x . T^T f`; columns and rows of T equal its products with unit vectors; no entry exceeds the bound.
fn check(analysis: &Analysis, reduction: &Reduction, growth: f64, what: &str) {
    assert!(analysis.residual(reduction).expect("its own DOFs") < 1e-12, "{what}");
    let t = t_of(reduction);
    let most = t.values().iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    assert!(most <= growth * (1.0 + 1e-6), "{what}: {most} in T");
    let x: Vec<f64> = (0..reduction.masters().len()).map(random).collect();
    let zero = vec![0.0; reduction.prescribed().len()];
    let u = reduction.expand(&x, &zero).expect("of its lengths");
    let size = 1.0 + reduction.g().iter().fold(most, |most, g| most.max(g.abs()));
    for (i, &slave) in reduction.slaves().iter().enumerate() {
        let by_columns: f64 = t.row(i).map(|(q, v)| v * x[q]).sum();
        let by_row: f64 = reduction.row(i).expect("a slave").iter().map(|&(q, v)| v * x[q]).sum();
        assert!((by_columns + reduction.g()[i] - u[slave]).abs() < 1e-9 * size, "{what}: slave {slave}");
        assert!((by_columns - by_row).abs() < 1e-9 * size, "{what}: row of slave {slave}");
    }
    let f: Vec<f64> = (0..reduction.slaves().len()).map(|i| random(i + 5)).collect();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let (one, other) = (
        dot(&f, &t.times(&x).expect("a number for each master")),
        dot(&x, &reduction.apply_transposed(&f).expect("of its lengths")),
    );
    assert!((one - other).abs() < 1e-9 * size * f.len() as f64, "{what}: {one} and {other}");
}

#[test]
fn factors_are_t_within_the_bound() {
    let mut factored = 0;
    for seed in 0..1200 {
        let Some(system) = planted(seed) else { continue };
        for growth in [1.5, 4.0] {
            let analysis = diagnosed(&system, growth);
            if analysis.confidence().ambiguous {
                continue;
            }
            let reduction = analysis.reduction_in(Form::Factored).expect("within the gate");
            assert_eq!(reduction.slaves().len(), analysis.rank());
            factored += usize::from(!reduction.is_explicit());
            check(&analysis, &reduction, growth, &format!("seed {seed}, growth {growth}"));
        }
    }
    assert!(factored > 2000, "{factored} in factor form");
}

/// A solution of the factored form is one of the explicit form and vice versa: both describe the same space.
#[test]
fn both_forms_have_the_same_solutions() {
    for seed in 0..400 {
        let Some(system) = planted(2 * seed) else { continue };
        let analysis = diagnosed(&system, 4.0);
        let explicit = analysis.reduction().expect("within the gate");
        let factored = analysis.reduction_in(Form::Factored).expect("within the gate");
        let given = vec![0.25; factored.prescribed().len()];
        for (a, b) in [(&explicit, &factored), (&factored, &explicit)] {
            let x: Vec<f64> = (0..a.masters().len()).map(random).collect();
            let u = a.expand(&x, &given).expect("of its lengths");
            let again =
                b.expand(&b.masters().iter().map(|&j| u[j]).collect::<Vec<_>>(), &given).expect("of its lengths");
            let size = u.iter().fold(1.0, |most: f64, v| most.max(v.abs()));
            let off = u.iter().zip(&again).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-10 * size, "seed {seed}: {off:e}");
        }
    }
}

#[test]
fn factors_take_new_right_hand_sides() {
    for seed in 0..400 {
        let Some(system) = planted(seed) else { continue };
        let analysis = Arc::new(diagnosed(&system, 4.0));
        let mut reduction = analysis.reduction_in(Form::Factored).expect("within the gate");
        // The right-hand side of some u, with each DOF in its unit, so that nothing conflicts.
        let u: Vec<f64> = (0..system.dofs()).map(|j| random(j) / unit(seed, j)).collect();
        let given: Vec<f64> = system.prescribed().iter().map(|&(j, _)| u[j]).collect();
        let refresher = Refresher::new(Arc::clone(&analysis)).expect("small");
        refresher
            .refresh(&system.matrix().times(&u).expect("a number for each DOF"), &given, &mut reduction)
            .expect("within the gate");
        let again = reduction
            .expand(&reduction.masters().iter().map(|&j| u[j]).collect::<Vec<_>>(), &given)
            .expect("of its lengths");
        let off = (0..u.len()).map(|j| (u[j] - again[j]).abs() * unit(seed, j)).fold(0.0, f64::max);
        assert!(off < 1e-8 || analysis.confidence().ambiguous, "seed {seed}: {off:e}");
    }
}

/// Bits do not depend on the number of threads or on other components.
#[test]
fn factors_are_the_same_bits_everywhere() {
    let scene = fssi::mortar(&Level::P50.mesh(), 1).expect("a scene");
    let applied = |system: &ConstraintSystem, threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| {
            let reduction = diagnosed(system, 4.0).reduction_in(Form::Factored).expect("within the gate");
            let x: Vec<f64> = reduction.masters().iter().map(|&j| random(j)).collect();
            (reduction.expand(&x, &[]).expect("of its lengths"), reduction.slaves().to_vec())
        })
    };
    let alone = applied(&scene.system, 1);
    assert_eq!(alone, applied(&scene.system, 3));
    let beside = scene.beside(&families::rotations(30).expect("a scene")).expect("small");
    let (u, slaves) = applied(&beside.system, 2);
    assert_eq!(u[..alone.0.len()], alone.0);
    assert_eq!(slaves[..alone.1.len()], alone.1);
}

/// The units of one component do not affect another.
#[test]
fn units_beside_change_no_bit() {
    for seed in 0..300 {
        let (Some(plain), Some(mixed)) = (planted(2 * seed), planted(2 * seed + 1)) else { continue };
        let mut builder = SystemBuilder::new(plain.dofs() + mixed.dofs());
        for (system, first) in [(&plain, 0), (&mixed, plain.dofs())] {
            for i in 0..system.equations() {
                builder.equation(system.matrix().row(i).map(|(j, v)| (first + j, v)), system.rhs()[i]);
            }
            system.prescribed().iter().for_each(|&(j, value)| builder.prescribe(first + j, value));
        }
        let both = builder.build().expect("two systems");
        let solved = |system: &ConstraintSystem| {
            let reduction = diagnosed(system, 4.0).reduction_in(Form::Factored).expect("within the gate");
            reduction
                .expand(&vec![0.5; reduction.masters().len()], &vec![0.25; reduction.prescribed().len()])
                .expect("of its lengths")
        };
        let (all, own) = (solved(&both), [solved(&plain), solved(&mixed)].concat());
        let bits = |u: &[f64]| u.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&all), bits(&own), "seed {seed}");
    }
}

/// A dense T stays factored, a sparse T becomes explicit.
#[test]
fn what_is_dense_stays_a_factor() {
    let windows = families::Windows { extent: [30, 30, 1], d: 1, window: 3, stride: 2, rows: 2, combos: 20 };
    let dense = windows.scene(1).expect("a scene").system;
    let analysis = diagnosed(&dense, 4.0);
    let reduction = analysis.reduction_in(Form::Auto).expect("within the gate");
    assert!(!reduction.is_explicit());
    let numbers = analysis.reduction().expect("within the gate").t().nnz();
    let block = &reduction.factored()[0];
    assert!(block.nnz() < numbers && block.predicted() > 4 * block.nnz(), "{} and {numbers}", block.nnz());
    let path = families::path(3000).expect("a scene").system;
    assert!(diagnosed(&path, 4.0).reduction_in(Form::Auto).expect("within the gate").is_explicit());
}
