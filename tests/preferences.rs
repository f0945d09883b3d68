//! Preferences are met as far as possible; the exact rank of the remaining columns or rows shows that no more can be met.

mod support;

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed, TestRunner};
use qless::{BackendChoice, ConstraintSystem, Kind, Options, Preferences, SystemBuilder, analyse};
use qless_scenes::families::Planted;
use qless_scenes::{Rng, oracle};
use support::{check_certificates, check_reduction, settings};

on_each_backend!(
    slaves_are_chosen_as_preferred,
    preferred_slaves_keep_the_bound_of_growth,
    equations_are_kept_as_preferred,
    a_kept_equation_wins_over_one_that_contradicts_it
);

/// A small system with planted combinations, and the DOFs and rows that preferences name.
fn systems() -> impl Strategy<Value = (ConstraintSystem, Vec<bool>)> {
    let sizes = (2_usize..9, 1_usize..6, 1_usize..5, any::<bool>(), 0_u64..500);
    (sizes, vec(any::<bool>(), 40), vec(-8..=8_i32, 12)).prop_map(
        |((rows, more, combos, conflict, seed), named, units)| {
            let planted = Planted { rows, dofs: rows + more, combos, terms: 2, conflict };
            (in_units(&planted.scene(seed).expect("in range").system, &units), named)
        },
    )
}

/// The system with DOFs in other units, which are powers of two.
fn in_units(system: &ConstraintSystem, powers: &[i32]) -> ConstraintSystem {
    let unit = |j: usize| 2_f64.powi(powers[j % powers.len()]);
    let mut builder = SystemBuilder::new(system.dofs());
    for i in 0..system.equations() {
        builder.equation(system.matrix().row(i).map(|(j, v)| (j, v * unit(j))), system.rhs()[i]);
    }
    system.prescribed().iter().for_each(|&(j, value)| builder.prescribe(j, value / unit(j)));
    builder.build().expect("valid")
}

fn hold(test: impl Fn(&ConstraintSystem, &[bool])) {
    let config = Config { cases: 200, rng_seed: RngSeed::Fixed(7), failure_persistence: None, ..Config::default() };
    let result = TestRunner::new(config).run(&systems(), |(system, named)| {
        test(&system, &named);
        Ok(())
    });
    result.unwrap_or_else(|error| panic!("{error}"));
}

fn named(flags: &[bool], count: usize) -> Vec<usize> {
    (0..count).filter(|&k| flags[k % flags.len()]).collect()
}

/// The system with some rows and some columns only.
fn part(system: &ConstraintSystem, rows: &[usize], keeps: impl Fn(usize) -> bool) -> ConstraintSystem {
    let mut builder = SystemBuilder::new(system.dofs());
    for &i in rows {
        builder.equation(system.matrix().row(i).filter(|&(j, _)| keeps(j)), system.rhs()[i]);
    }
    builder.build().expect("valid")
}

/// The number of unwanted slaves is the least possible: `rank C - rank C(wanted columns)`. The rank does not change.
fn slaves_are_chosen_as_preferred(backend: BackendChoice) {
    hold(|system, flags| {
        let masters = named(flags, system.dofs());
        let all: Vec<usize> = (0..system.equations()).collect();
        let forced = oracle::rank_free(system).expect("within reach")
            - oracle::rank_free(&part(system, &all, |j| !masters.contains(&j))).expect("within reach");
        let slaves = (0..system.dofs()).filter(|j| !masters.contains(j)).take(2).collect::<Vec<_>>();
        for options in settings(backend) {
            let preferences =
                Preferences { masters: masters.clone(), slaves: slaves.clone(), ..Preferences::default() };
            let analysis = analyse(system, &Options { preferences, ..options }).expect("valid");
            let reduction = analysis.reduction().expect("within the gate");
            assert_eq!(reduction.unmet_masters().len(), forced, "{reduction:?}");
            assert!(masters.iter().all(|j| !reduction.slaves().contains(j) || reduction.unmet_masters().contains(j)));
            assert!(slaves.iter().all(|j| reduction.slaves().contains(j) || reduction.unmet_slaves().contains(j)));
            check_reduction(system, &analysis, &reduction, 1e-11);
        }
    });
}

/// Equations with coefficients over seven decades, some of them twice.
fn preferred_slaves_keep_the_bound_of_growth(backend: BackendChoice) {
    let mut met = 0;
    for seed in 0..200 {
        let mut random = Rng::new(seed);
        let n = 2 + random.below(5);
        let mut builder = SystemBuilder::new(n);
        for _ in 0..=random.below(n - 1) {
            let row: Vec<(usize, f64)> = (0..n).map(|j| (j, 2_f64.powi(random.below(24) as i32 - 12))).collect();
            (0..=random.below(2)).for_each(|_| _ = builder.equation(row.iter().copied(), 0.0));
        }
        let system = builder.build().expect("valid");
        let slaves: Vec<usize> = (0..n).filter(|_| random.below(2) == 0).collect();
        for options in settings(backend) {
            let preferences = Preferences { slaves: slaves.clone(), ..Preferences::default() };
            let analysis = analyse(&system, &Options { preferences, ..options.clone() }).expect("valid");
            let reduction = analysis.reduction().expect("within the gate");
            assert!(reduction.growth() <= options.growth * (1.0 + 1e-9), "{seed}: {system:?} {slaves:?}");
            met += slaves.len() - reduction.unmet_slaves().len();
        }
    }
    assert!(met > 200, "{met}");
}

/// The number of dependent equations among those to keep is the least possible: `|K| - rank C(K)`.
fn equations_are_kept_as_preferred(backend: BackendChoice) {
    hold(|system, flags| {
        let equations = named(flags, system.equations());
        let forced = equations.len() - oracle::rank_free(&part(system, &equations, |_| true)).expect("within reach");
        for options in settings(backend) {
            let preferences = Preferences { equations: equations.clone(), ..Preferences::default() };
            let analysis = analyse(system, &Options { preferences, ..options }).expect("valid");
            let lost = equations.iter().filter(|&&i| analysis.kinds()[i] != Kind::Independent).count();
            assert_eq!((lost, analysis.unmet_equations().len()), (forced, forced), "{:?}", analysis.unmet_equations());
            assert_eq!(analysis.rank(), oracle::rank_free(system).expect("within reach"));
            assert_eq!(
                analysis.kinds().contains(&Kind::Conflicting),
                !oracle::consistent(system).expect("within reach")
            );
            check_certificates(system, &analysis);
            check_reduction(system, &analysis, &analysis.reduction().expect("within the gate"), 1e-11);
        }
    });
}

/// Two springs of a chain and its closure with a gap. Whichever equation is dropped, T, G and g satisfy the others.
fn a_kept_equation_wins_over_one_that_contradicts_it(backend: BackendChoice) {
    let mut builder = SystemBuilder::new(3);
    builder.equation([(0, 1.0), (1, -1.0)], 0.0);
    builder.equation([(1, 1.0), (2, -1.0)], 0.0);
    builder.equation([(0, 2.0), (2, -2.0)], 1.0);
    let system = builder.build().expect("valid");
    for options in settings(backend) {
        for lost in 0..3 {
            let equations = (0..3).filter(|&i| i != lost).collect();
            let preferences = Preferences { equations, ..Preferences::default() };
            let analysis = analyse(&system, &Options { preferences, ..options.clone() }).expect("valid");
            assert_eq!(analysis.kinds()[lost], Kind::Conflicting, "row {lost}");
            assert!((analysis.dependent()[0].mismatch.abs() - [0.5, 0.5, 1.0][lost]).abs() < 1e-14);
            check_certificates(&system, &analysis);
            check_reduction(&system, &analysis, &analysis.reduction().expect("within the gate"), 1e-13);
        }
    }
}
