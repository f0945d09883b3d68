//! Small systems whose verdict is certain, in every unit, on every backend, with and without presolve.

#[path = "verdicts/fixed_dofs.rs"]
mod fixed_dofs;
#[path = "verdicts/noise.rs"]
mod noise;
#[path = "verdicts/reductions.rs"]
mod reductions;
#[path = "verdicts/right_hand_sides.rs"]
mod right_hand_sides;

use qless::common::SplitMix64;
use qless::{Analysis, BackendChoice, ConstraintSystem, Kind, Options, SystemBuilder, Tolerance, analyse};

/// Equations as lists of terms, with their right-hand sides.
type Equations<'a> = &'a [(&'a [(usize, f64)], f64)];

fn system(dofs: usize, equations: Equations, prescribed: &[(usize, f64)]) -> ConstraintSystem {
    let mut builder = SystemBuilder::new(dofs);
    equations.iter().for_each(|(terms, rhs)| _ = builder.equation(terms.iter().copied(), *rhs));
    prescribed.iter().for_each(|&(j, value)| builder.prescribe(j, value));
    builder.build().expect("valid")
}

fn backends() -> Vec<BackendChoice> {
    let all = [BackendChoice::Faer, BackendChoice::Sparse, BackendChoice::Gauss];
    all.into_iter().chain(cfg!(feature = "spqr").then_some(BackendChoice::Spqr)).collect()
}

/// Every backend, with and without presolve.
fn settings(options: &Options) -> Vec<Options> {
    let both = |backend| [true, false].map(|presolve| Options { backend, presolve, ..options.clone() });
    backends().into_iter().flat_map(both).collect()
}

fn each(system: &ConstraintSystem, mut check: impl FnMut(&Analysis, &str)) {
    for options in settings(&Options::default()) {
        let name = format!("{:?}, presolve {}", options.backend, options.presolve);
        check(&analyse(system, &options).expect("small"), &name);
    }
}

fn counts(analysis: &Analysis) -> [usize; 3] {
    [Kind::Independent, Kind::Redundant, Kind::Conflicting]
        .map(|kind| analysis.kinds().iter().filter(|&&of| of == kind).count())
}

fn is_sure(system: &ConstraintSystem, expected: [usize; 3]) {
    each(system, |analysis, name| {
        assert_eq!(counts(analysis), expected, "{name}: {:?}", analysis.confidence());
        assert!(!analysis.confidence().ambiguous, "{name}: {:?}", analysis.confidence());
    });
}

/// Two shims under one pressure: compliances of 5e-15 m/Pa, then with the pressure in MPa.
#[test]
fn compliances_in_any_unit() {
    for unit in [1.0, 1e6] {
        let (a, b) = (-5e-15 * unit, -2.5e-15 * unit);
        let shim: Equations = &[
            (&[(0, 1.0), (1, -1.0), (2, a)], 0.0),
            (&[(0, 1.0), (1, -1.0), (2, b)], 1e-6),
            (&[(2, 1.0), (3, -1.0)], 0.0),
        ];
        is_sure(&system(4, shim, &[]), [3, 0, 0]);
        is_sure(&system(4, shim, &[(3, 1e8 / unit)]), [2, 0, 1]);
    }
}

/// `u_i = 10 u_(i+1)`, the last prescribed by an equation, also with units 1, 1e2, 1e4 in turn.
#[test]
fn gear_trains() {
    for (stages, units) in [(12, [1.0; 3]), (36, [1.0, 1e2, 1e4])] {
        let mut builder = SystemBuilder::new(stages);
        for i in 0..stages - 1 {
            builder.equation([(i, units[i % 3]), (i + 1, -10.0 * units[(i + 1) % 3])], 0.0);
        }
        builder.equation([(stages - 1, 1.0)], 1.0);
        is_sure(&builder.build().expect("valid"), [stages, 0, 0]);
    }
}

/// A spline through n points, twice: `(1, 4, 1) / 6` beyond both ends, so that the first n equations substitute into one another and
/// grow by 3.73 each; two equations follow from the others.
fn splines(n: usize, random: &mut SplitMix64) -> ConstraintSystem {
    let weights = |first: usize, at: isize| {
        let of = move |k: usize| {
            let j = at + k as isize - 1;
            (0..n as isize).contains(&j).then(|| (first + j as usize, [0.166_666_667, 0.666_666_667, 0.166_666_667][k]))
        };
        (0..3).filter_map(of).collect::<Vec<_>>()
    };
    let mut rows: Vec<Vec<(usize, f64)>> = (-1..=n as isize).map(|at| weights(0, at)).collect();
    rows.extend((0..n).map(|i| vec![(n + i, 4.0), (i, -1.0)]));
    rows.extend((0..n).map(|i| [weights(2 * n, i as isize), vec![(n + i, -1.0)]].concat()));
    let u: Vec<f64> = (0..3 * n).map(|_| below(random, 9) as f64 - 4.0).collect();
    let mut builder = SystemBuilder::new(3 * n);
    for row in rows {
        let b = row.iter().map(|&(j, v)| v * u[j]).sum();
        builder.equation(row, b);
    }
    builder.build().expect("valid")
}

#[test]
fn equations_that_grow_when_substituted() {
    let mut random = SplitMix64::new(7);
    for n in [3, 10, 30, 100, 300] {
        let system = splines(n, &mut random);
        each(&system, |analysis, name| {
            let confidence = analysis.confidence();
            assert_eq!(counts(analysis), [3 * n, 2, 0], "{n}, {name}: {confidence:?}");
            assert!(!confidence.ambiguous, "{n}, {name}: {confidence:?}");
            let reduction = analysis.reduction().unwrap_or_else(|error| panic!("{n}, {name}: {error}"));
            assert!(reduction.growth() < 1e3, "{n}, {name}: {}", reduction.growth());
        });
    }
}

/// Two equations and a combination of them with a relative change of 1e-9 to 1e-11 in one coefficient, with DOFs in other units.
#[test]
fn a_small_difference_of_one_coefficient_is_not_dropped_without_doubt_in_any_unit() {
    let mut random = SplitMix64::new(23);
    for seed in 0..300 {
        let mut digit = || (1 + below(&mut random, 5)) as f64 * if below(&mut random, 2) == 0 { 1.0 } else { -1.0 };
        let rows = [(); 2].map(|()| [(); 3].map(|()| digit()));
        let mut last = [0, 1, 2].map(|j| rows[0][j] - 2.0 * rows[1][j]);
        let changed = seed % 3;
        let others = [(changed + 1) % 3, (changed + 2) % 3];
        if last[changed] == 0.0 || rows[0][others[0]] * rows[1][others[1]] == rows[0][others[1]] * rows[1][others[0]] {
            continue;
        }
        last[changed] *= 1.0 + 10f64.powi(-9 - (seed / 3 % 3) as i32);
        let units = [(); 3].map(|()| 2f64.powi(below(&mut random, 21) as i32 - 10));
        let mut builder = SystemBuilder::new(3);
        for row in [rows[0], last, rows[1]] {
            builder.equation((0..3).map(|j| (j, row[j] * units[j])), 0.0);
        }
        each(&builder.build().expect("valid"), |analysis, name| {
            let is_right = analysis.rank() == 3 || analysis.confidence().ambiguous;
            assert!(is_right, "{seed}, {name}: {rows:?} {last:?} {units:?} {:?}", analysis.confidence());
        });
    }
}

/// A sum of equations whose small coefficients are rounded to the last places of large ones.
#[test]
fn sums_that_round_small_coefficients_are_redundant_without_doubt() {
    let mut random = SplitMix64::new(29);
    for seed in 0..300 {
        let small = 1e-7 * (1 + below(&mut random, 2000)) as f64;
        let turns = (1 + below(&mut random, 4)) as f64;
        let beam = [(2, -1.0), (3, -small), (4, 1.0), (5, -small)];
        let sum = [(1, turns), (2, -1.0), (3, -(turns + small)), (4, 1.0), (5, -small)];
        let mut builder = SystemBuilder::new(6);
        builder.equation(beam, -0.04);
        builder.equation([(0, -1.0), (1, -0.006), (2, 1.0), (3, -0.006)], -3.5);
        builder.equation(sum, -0.04);
        builder.equation([(1, 1.0), (3, -1.0)], 0.0);
        each(&builder.build().expect("valid"), |analysis, name| {
            let is_sure = analysis.rank() == 3 && !analysis.confidence().ambiguous;
            assert!(is_sure, "{seed}, {name}: {small:e} {turns} {:?}", analysis.confidence());
        });
    }
}

/// `0 = b` is a conflict if b was typed, however small it is beside other right-hand sides; a computed b may be rounding of them.
#[test]
fn an_equation_without_coefficients_has_no_unit() {
    let other: (&[(usize, f64)], f64) = (&[(0, 1.0)], 1e9);
    each(&system(1, &[other, (&[], 1.0)], &[]), |analysis, name| {
        assert_eq!((counts(analysis), analysis.confidence().ambiguous), ([1, 0, 1], false), "{name}");
    });
    each(&system(1, &[other, (&[], 0.1 + 0.2 - 0.3)], &[]), |analysis, name| {
        assert!(analysis.confidence().ambiguous, "{name}: {:?}", counts(analysis));
    });
}

/// Absolute 1e-5 without scaling, as the paper says.
#[test]
fn the_papers_tolerance_is_absolute() {
    let rows: Equations = &[(&[(0, 1.0), (1, 1.0)], 0.0), (&[(0, 1e-7), (1, 2e-7)], 0.0)];
    for (scale, rank) in [(1.0, 1), (1e4, 2)] {
        let rows: Vec<_> =
            rows.iter().map(|(terms, _)| terms.iter().map(|&(j, v)| (j, v * scale)).collect::<Vec<_>>()).collect();
        let rows: Vec<_> = rows.iter().map(|terms| (terms.as_slice(), 0.0)).collect();
        let system = system(2, &rows, &[]);
        for options in settings(&Options { tolerance: Tolerance::Paper, ..Options::default() }) {
            let found = analyse(&system, &options).expect("small").rank();
            assert_eq!(found, rank, "{:?}, presolve {}, {scale:e}", options.backend, options.presolve);
        }
        assert_eq!(analyse(&system, &Options::default()).expect("small").rank(), 2);
    }
}

fn below(random: &mut SplitMix64, count: usize) -> usize {
    (random.next() % count as u64) as usize
}

fn shuffle<T>(random: &mut SplitMix64, list: &mut [T]) {
    (1..list.len()).rev().for_each(|k| list.swap(k, below(random, k + 1)));
}

/// Equations with one solution, triangular after a permutation, with couplings far below and above the pivots.
fn triangular(random: &mut SplitMix64) -> Vec<Vec<(usize, f64)>> {
    let n = 2 + below(random, 5);
    let power = |random: &mut SplitMix64, least: i32, most: usize| 10f64.powi(least + below(random, most) as i32);
    let mut names: Vec<usize> = (0..n).collect();
    shuffle(random, &mut names);
    let mut equations = Vec::new();
    for i in 0..n {
        let pivot = [1.0, 2.0, -3.0, 5.0][below(random, 4)] * power(random, -6, 16);
        let mut row = vec![(names[i], pivot)];
        for &name in &names[..i] {
            let coupling = [1.0, -2.0, 7.0][below(random, 3)] * power(random, -8, 12);
            row.extend((below(random, 2) == 0).then_some((name, coupling)));
        }
        equations.push(row);
    }
    shuffle(random, &mut equations);
    equations
}
