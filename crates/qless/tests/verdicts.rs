//! Small systems whose verdict is certain, in every unit, on every backend, with and without presolve.

use qless::change::Refresher;
use qless::common::SplitMix64;
use qless::diagnosis::OtherReading;
use qless::exact::{self, Reading};
use qless::{
    Analysis, BackendChoice, ConstraintSystem, Doubt, Kind, Noise, Options, SystemBuilder, Tolerance, analyse,
};

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

/// `u1 + u2 = B + 1e-3; u2 = B; u1 = 1e-3` in any order: the sum has lost digits, so the others are kept.
#[test]
fn every_consistent_equation_holds() {
    let orders = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
    for (size, order) in [1e6, 1e9, 1e12].into_iter().flat_map(|size| orders.map(|order| (size, order))) {
        let wide: [(&[(usize, f64)], f64); 3] =
            [(&[(0, 1.0), (1, 1.0)], size + 1e-3), (&[(1, 1.0)], size), (&[(0, 1.0)], 1e-3)];
        each(&system(2, &order.map(|i| wide[i]), &[]), |analysis, name| {
            assert_eq!(analysis.rank(), 2, "{name}");
            let reduction = analysis.reduction().expect("small");
            let u = reduction.expand(&[], &[]).expect("no masters");
            assert!((u[0] - 1e-3).abs() <= 1e-13, "{name}, {size:e}, {order:?}: {u:?}");
        });
    }
}

/// A planar four-bar as a spatial mechanism, turned against the axes: rows that should be zero are rounding.
#[test]
fn rows_of_rounding_are_told() {
    let e = f64::EPSILON;
    let rows: Equations = &[
        (&[(0, -e), (1, 7.833_269_096_274_826e-1), (2, -3.138_982_972_843_685e-1)], 0.0),
        (
            &[(0, 4.0 * e), (1, -6.216_099_682_706_635e-1), (2, 1.050_543_387_530_544_5), (3, 1.999_999_999_999_999_6)],
            0.0,
        ),
        (&[(0, 1.5 * e), (1, e), (2, 1.8125 * e), (3, 1.5 * e)], 0.0),
        (&[(0, -e), (1, -e), (2, -e), (3, -e)], 0.0),
        (&[(0, -0.75 * e), (1, -0.75 * e), (2, -0.75 * e), (3, -0.75 * e)], 0.0),
        (&[(0, 1.0), (1, 1.0), (2, 1.0), (3, 1.0)], 0.0),
    ];
    let system = system(4, rows, &[]);
    each(&system, |analysis, name| {
        let other = analysis.other_reading().map(|other| (other.as_zero, other.rank));
        assert_eq!((analysis.rank(), other), (3, Some((false, 4))), "{name}");
        assert_eq!((analysis.confidence().doubt, analysis.noise().len()), (Some(Doubt::Noise), 12), "{name}");
    });
    for (noise, rank) in [(Noise::None, 4), (Noise::Relative(1e-12), 3)] {
        let analysis = analyse(&system, &Options { noise: noise.clone(), ..Options::default() }).expect("small");
        let other: Option<&OtherReading> = analysis.other_reading();
        assert_eq!((analysis.rank(), analysis.confidence().ambiguous, other), (rank, false, None), "{noise:?}");
    }
    let noise = Noise::Floors { coefficients: vec![1e-14; 6], rhs: vec![0.0; 6] };
    assert_eq!(analyse(&system, &Options { noise, ..Options::default() }).expect("small").rank(), 3);
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

/// Equations typed with 4 to 8 digits, and one of them twice as large, with a right-hand side that is off by less than the last digit.
#[test]
fn conflicts_in_the_last_digit_that_was_typed_are_in_doubt() {
    let mut random = SplitMix64::new(11);
    for case in 0..400 {
        let (digits, m) = (4 + case % 5, 2 + below(&mut random, 5));
        let unit = 10_f64.powi(1 - digits as i32);
        let typed = |random: &mut SplitMix64| {
            let value = 1.0 + 8.9 * below(random, 1 << 30) as f64 / f64::from(1 << 30);
            format!("{value:.*}", digits - 1).parse::<f64>().expect("a number")
        };
        let mut rows: Vec<Vec<(usize, f64)>> = Vec::new();
        for i in 0..m {
            let dofs: Vec<usize> = (i..m + 3).filter(|&j| j == i || below(&mut random, 2) == 0).collect();
            rows.push(dofs.into_iter().map(|j| (j, typed(&mut random))).collect());
        }
        for (off, is_doubt) in [(0.4 * unit, true), (0.02, false)] {
            let mut builder = SystemBuilder::new(m + 3);
            rows.iter().for_each(|row| _ = builder.equation(row.iter().copied(), 3.0));
            builder.equation(rows[0].iter().map(|&(j, v)| (j, 2.0 * v)), 6.0 * (1.0 + off));
            let analysis = analyse(&builder.build().expect("valid"), &Options::default()).expect("small");
            let confidence = analysis.confidence();
            assert_eq!(counts(&analysis), [m, 0, 1], "case {case}, off by {off}");
            assert_eq!(confidence.ambiguous, is_doubt, "case {case}, {digits} digits, off by {off}: {confidence:?}");
        }
    }
}

/// `2 row 1 - row 3 = row 5`, beside nearly parallel rows 1 and 4 whose combination is absurd; and two equal equations with different
/// right-hand sides, in which a large value is substituted.
#[test]
fn sides_that_exact_arithmetic_contradicts_are_in_doubt() {
    let nearly_parallel: Equations = &[
        (&[(0, 1.0)], 0.25),
        (&[(1, 1.0), (3, -1.0)], 0.25),
        (&[(2, 1.0), (3, 2.0), (4, -1.0), (5, 3.0)], 2e-7),
        (&[(0, 1.0), (1, -1e-14)], 0.0),
        (&[(0, 2.0), (2, -1.0), (3, -2.0), (4, 1.0), (5, -3.0)], 0.499_999_8),
    ];
    each(&system(6, nearly_parallel, &[]), |analysis, name| {
        let is_right = counts(analysis) == [4, 1, 0];
        assert!(is_right || analysis.confidence().ambiguous, "{name}: {:?}", counts(analysis));
    });
    // The bound of rounding is that of a large right-hand side in another unit: rows 2 and 3 say u1 = 5e-6, row 4 says u1 = -4.
    let hidden: Equations = &[
        (&[(0, 1.97e-9), (1, 1.0), (2, 7.15e8), (3, 3.0)], 4.44e9),
        (&[(0, 6.4e7), (3, -2.42e-2)], 3.0),
        (&[(0, 3.0), (1, 1.0), (3, -2.7e-6)], 2.77e-6),
        (&[(0, 3.79e-9), (1, 1.0), (2, -2.17e-9), (3, 3.0)], -1.0),
    ];
    each(&system(4, hidden, &[(3, 1.0)]), |analysis, name| {
        let is_right = counts(analysis) == [3, 0, 1];
        assert!(is_right || analysis.confidence().ambiguous, "{name}: {:?}", counts(analysis));
    });
    let equal: Equations = &[(&[(0, 1.0), (1, 1.0), (2, -1.0)], 0.1), (&[(0, 1.0), (1, 1.0), (2, -1.0)], 0.2)];
    for size in [1.0, 1e6, 1e9, 1e12, 1e13] {
        each(&system(3, equal, &[(1, size)]), |analysis, name| {
            let is_right = counts(analysis) == [1, 0, 1];
            assert!(is_right || analysis.confidence().ambiguous, "{size}, {name}: {:?}", counts(analysis));
        });
    }
}

/// Row 4 contradicts rows 1, 5 and 6 by as much as its terms. In this order the elimination adds and subtracts 222.65625 / 0.003 of row 3.
#[test]
fn the_path_of_an_elimination_makes_no_conflict_small() {
    let equations: Equations = &[
        (&[(3, -0.2932), (4, -0.916), (0, 244_800.0)], 0.0),
        (&[(3, -4.72), (1, -1052.0), (2, 6.0), (4, 1.964)], -274_000.0),
        (&[(2, -0.000_465_820_312_5), (0, 0.002_929_687_5)], 222.656_25),
        (&[(3, 2.0), (4, -0.0012), (0, -9.75)], -0.000_832),
        (&[(3, 3.0), (4, 0.000_584), (0, -0.00834)], 1.0),
        (&[(3, 432_500.0), (4, 30.5)], 0.0),
    ];
    is_sure(&system(5, equations, &[]), [5, 0, 1]);
}

/// Six combinations of three equations, with errors of 1e-13 in every coefficient: more than rounding, but within stated errors of 1e-12.
#[test]
fn stated_errors_explain_what_combinations_leave() {
    let mut random = SplitMix64::new(11);
    let mut signed = || random.next() as i64 as f64 / 2_f64.powi(63);
    for seed in 0..200 {
        let rows: Vec<Vec<f64>> = (0..3).map(|_| (0..7).map(|_| signed()).collect()).collect();
        let mut builder = SystemBuilder::new(7);
        for i in 0..9 {
            let factors: Vec<f64> =
                (0..3).map(|k| if i < 3 { f64::from(u8::from(i == k)) } else { signed() }).collect();
            let sum = |j: usize| factors.iter().zip(&rows).map(|(f, row)| f * row[j]).sum::<f64>();
            let terms: Vec<_> = (0..7).map(|j| (j, sum(j) + 1e-13 * signed())).collect();
            builder.equation(terms, 0.0);
        }
        let system = builder.build().expect("valid");
        let noise = |floor: f64| Noise::Floors { coefficients: vec![floor; 9], rhs: vec![floor; 9] };
        for (floor, is_ambiguous) in [(1e-12, false), (1e-16, true)] {
            let options = Options { noise: noise(floor), ..Options::default() };
            let analysis = analyse(&system, &options).expect("small");
            let found = (analysis.rank(), analysis.confidence().ambiguous);
            assert_eq!(found, (3, is_ambiguous), "{seed}, {floor}: {:?}", analysis.confidence());
        }
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

/// `u3 = -c u4` for any c that is not zero: small beside what cancels, but alone.
#[test]
fn what_moves_a_little_is_not_fixed() {
    for power in 0..40 {
        let c = 10_f64.powi(-power);
        let equations: Equations = &[(&[(0, 1.0), (1, 1.0)], 0.0), (&[(0, 1.0), (1, 1.0), (2, 1.0), (3, c)], 0.0)];
        let analysis = analyse(&system(4, equations, &[]), &Options::default()).expect("small");
        assert_eq!((analysis.rank(), analysis.generated()), (2, [].as_slice()), "1e-{power}");
    }
}

/// DOFs 0, 1 and 2 are fixed together; DOF 3 moves by `-2^-100` of DOF 4. The row that needs its motion contains DOF 0, too.
#[test]
fn dofs_that_are_fixed_together_do_not_move_for_another() {
    let far = 2_f64.powi(100);
    let row = [(0, far), (3, far), (4, 1.0)];
    let sum = [(0, 1.0), (3, 1.0), (4, 1.0), (5, 1.0)];
    let fixed: [&[(usize, f64)]; 3] =
        [&[(0, 1.0), (1, 1.0), (2, 1.0)], &[(0, 1.0), (1, -1.0), (2, 2.0)], &[(0, 1.0), (1, 3.0), (2, -5.0)]];
    let mut equations: Vec<(&[(usize, f64)], f64)> = fixed.iter().map(|&terms| (terms, 0.0)).collect();
    (0..3).for_each(|_| equations.extend([(&row[..], 0.0), (&sum[..], 0.0)]));
    each(&system(6, &equations, &[]), |analysis, name| {
        let found: Vec<usize> = analysis.generated().iter().map(|&(j, _)| j).collect();
        assert!(analysis.confidence().ambiguous || found.starts_with(&[0, 1, 2]), "{name}: {found:?}");
    });
}

/// Equations with coefficients over 24 decades, each two or three times. DOF j is fixed if the rank falls by one without its column.
#[test]
fn only_fixed_dofs_count_as_fixed() {
    let (mut sure, mut fixed_dofs) = (0, 0);
    for seed in 0..400 {
        let mut random = SplitMix64::new(seed);
        let n = 3 + below(&mut random, 3);
        let mut rows = Vec::new();
        for _ in 0..2 + below(&mut random, n - 2) {
            let has = |random: &mut SplitMix64| below(random, 5) > 0;
            let dofs: Vec<usize> = (0..n).filter(|_| has(&mut random)).collect();
            let mut value = || (1 + below(&mut random, 9)) as f64 * 2_f64.powi(below(&mut random, 81) as i32 - 40);
            let row: Vec<(usize, f64)> = dofs.into_iter().map(|j| (j, value())).collect();
            rows.extend(vec![row; 2 + below(&mut random, 2)]);
        }
        shuffle(&mut random, &mut rows);
        let without = |gone: Option<usize>| {
            let mut builder = SystemBuilder::new(n);
            for row in &rows {
                builder.equation(row.iter().copied().filter(|&(j, _)| Some(j) != gone), 0.0);
            }
            builder.build().expect("valid")
        };
        let rank = |system: &ConstraintSystem| exact::rank(system, Reading::Stored).expect("small").rank;
        let system = without(None);
        let all = rank(&system);
        let fixed: Vec<usize> = (0..n).filter(|&j| rank(&without(Some(j))) < all).collect();
        each(&system, |analysis, name| {
            if !analysis.confidence().ambiguous {
                let found: Vec<usize> = analysis.generated().iter().map(|&(j, _)| j).collect();
                assert_eq!((analysis.rank(), &found), (all, &fixed), "{seed}, {name}: {system:?}");
                sure += 1;
                fixed_dofs += fixed.len();
            }
        });
    }
    assert!(sure > 2000 && fixed_dofs > 100, "{sure} {fixed_dofs}");
}

/// `sin(2 pi i j / n)`: zeros that were computed are 1e-16 to 1e-15, in DOFs and equations that have nothing else.
#[test]
fn zeros_that_were_computed_are_never_sure() {
    for n in 3..40_usize {
        let row = |i: usize| (0..n).map(move |j| (j, (2.0 * std::f64::consts::PI * (i * j) as f64 / n as f64).sin()));
        let mut builder = SystemBuilder::new(n);
        (0..n).for_each(|i| _ = builder.equation(row(i), 0.0));
        each(&builder.build().expect("valid"), |analysis, name| {
            let (rank, confidence) = (analysis.rank(), analysis.confidence());
            assert!(rank == (n - 1) / 2 || confidence.ambiguous, "{n}, {name}: {rank}, {confidence:?}");
        });
    }
}

/// A redundant equation with a computed zero in a DOF of its own: independent as given, redundant where it is zero.
#[test]
fn a_computed_zero_that_is_all_that_a_dof_has_is_told() {
    let zero = 4.440_892_098_500_626e-16;
    let equations: Equations =
        &[(&[(0, 1.0), (1, -1.0)], 0.0), (&[(1, 1.0), (2, -1.0)], 0.0), (&[(0, 1.0), (2, -1.0), (3, zero)], 0.0)];
    let system = system(4, equations, &[]);
    each(&system, |analysis, name| {
        assert_eq!(analysis.rank(), 3, "{name}");
        let other = analysis.other_reading().unwrap_or_else(|| panic!("{name}: {:?}", analysis.confidence()));
        assert_eq!((other.as_zero, other.rank, other.conflicting), (true, 2, 0), "{name}");
    });
    for (noise, rank) in [(Noise::None, 3), (Noise::Relative(1e-12), 2)] {
        let analysis = analyse(&system, &Options { noise: noise.clone(), ..Options::default() }).expect("small");
        assert_eq!((analysis.rank(), analysis.confidence().ambiguous), (rank, false), "{noise:?}");
    }
}

/// Newton at convergence: `u1 - u2 = 5.6e-17` and `u1 - u2 = 0`.
#[test]
fn right_hand_sides_of_rounding_are_told() {
    let rows: Equations = &[
        (&[(0, 1.0), (1, -1.0)], 5.551_115_123_125_783e-17),
        (&[(0, 1.0), (1, -1.0)], 0.0),
        (&[(1, 1.0), (2, -1.0)], 0.3),
        (&[(2, 1.0), (3, 1.0)], 1.5),
    ];
    let system = system(4, rows, &[]);
    each(&system, |analysis, name| {
        assert_eq!(counts(analysis), [3, 1, 0], "{name}");
        assert!(matches!(analysis.confidence().doubt, None | Some(Doubt::Mismatch)), "{name}");
    });
    let floors = |rhs: f64| Noise::Floors { coefficients: vec![0.0; 4], rhs: vec![rhs; 4] };
    for (noise, conflicting) in [(Noise::None, 1), (Noise::Relative(1e-14), 0), (floors(1e-16), 0), (floors(1e-18), 1)]
    {
        let analysis = analyse(&system, &Options { noise: noise.clone(), ..Options::default() }).expect("small");
        assert_eq!((counts(&analysis)[2], analysis.confidence().ambiguous), (conflicting, false), "{noise:?}");
    }
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

#[test]
fn floors_are_checked() {
    let system = system(2, &[(&[(0, 1.0), (1, 1.0)], 0.0)], &[]);
    for (coefficients, rhs) in
        [(vec![], vec![0.0]), (vec![0.0], vec![0.0; 2]), (vec![-1.0], vec![0.0]), (vec![0.0], vec![f64::NAN])]
    {
        let noise = Noise::Floors { coefficients, rhs };
        assert!(analyse(&system, &Options { noise: noise.clone(), ..Options::default() }).is_err(), "{noise:?}");
    }
    for part in [0.0, 1.0, -1.0, f64::NAN] {
        assert!(analyse(&system, &Options { noise: Noise::Relative(part), ..Options::default() }).is_err());
    }
}

/// `u1 = a u2`, `u2 - u1 = 5` and `u1 = 3`: elimination leaves nothing of one equation but its right-hand side.
#[test]
fn what_loses_all_its_coefficients_may_conflict() {
    for a in [0.9999, 1.0001, 1.0 - 1e-6, 1.0 + 1e-6] {
        let last: Equations = &[(&[(0, 1.0), (1, -a)], 0.0), (&[(0, -1.0), (1, 1.0)], 5.0), (&[(0, 1.0)], 3.0)];
        is_sure(&system(2, last, &[]), [2, 0, 1]);
        let first: Equations = &[(&[(0, 1.0)], 3.0), (&[(0, 1.0), (1, -a)], 0.0), (&[(0, -1.0), (1, 1.0)], 5.0)];
        is_sure(&system(2, first, &[]), [2, 0, 1]);
    }
}

/// The second equation gives u2; the first one would lose it in a difference.
#[test]
fn small_values_beside_large_ones_keep_their_digits() {
    for (a, c) in [(8e-6, 1e9), (1e-6, 1e7), (1e-3, 1e6)] {
        each(&system(2, &[(&[(0, 1.0), (1, a)], 1.0), (&[(1, c)], 1.0)], &[]), |analysis, name| {
            let reduction = analysis.reduction().expect("within the gate");
            let place = reduction.slaves().iter().position(|&slave| slave == 1).expect("a slave");
            let fixed = analysis.generated().iter().find(|(j, _)| *j == 1).expect("a fixed DOF").1;
            for value in [reduction.g()[place], fixed] {
                assert!((value * c - 1.0).abs() < 1e-12, "{name}: {value} for {}", 1.0 / c);
            }
        });
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

/// By how much u misses the right-hand sides that are not zero, relative to the terms of each equation.
fn missed(equations: &[Vec<(usize, f64)>], b: &[f64], u: &[f64]) -> f64 {
    let missed = |(row, &b): (&Vec<(usize, f64)>, &f64)| {
        let parts = row.iter().map(|&(j, v)| v * u[j]);
        let (sum, size) = parts.fold((-b, b.abs()), |(sum, size), part| (sum + part, size.max(part.abs())));
        if b == 0.0 { 0.0 } else { sum.abs() / size }
    };
    equations.iter().zip(b).map(missed).fold(0.0, f64::max)
}

/// Large DOFs elsewhere do not hide that g, a refreshed g or the value of a fixed DOF misses a right-hand side.
#[test]
fn each_right_hand_side_holds_by_its_own_terms() {
    let mut random = SplitMix64::new(5);
    for seed in 0..1500_u32 {
        let equations = triangular(&mut random);
        let n = equations.len();
        let mut sides = || -> Vec<f64> { (0..n).map(|_| [0.0, 1.0, -2.0, 1e-3, 1e4][below(&mut random, 5)]).collect() };
        let (b, next) = (sides(), sides());
        let mut builder = SystemBuilder::new(n);
        equations.iter().zip(&b).for_each(|(row, &b)| _ = builder.equation(row.iter().copied(), b));
        let analysis = analyse(&builder.build().expect("valid"), &Options::default()).expect("small");
        let mut fixed = vec![0.0; n];
        analysis.generated().iter().for_each(|&(j, value)| fixed[j] = value);
        assert_eq!(analysis.generated().len(), n, "{seed}: {equations:?}");
        let mut reduction = analysis.reduction().expect("independent");
        let refresher = Refresher::new(analysis).expect("small");
        for (what, b, u) in [("fixed", &b, fixed), ("g", &b, reduction.g().to_vec())] {
            assert!(missed(&equations, b, &u) < 1e-9, "{seed}, {what}: {equations:?} {b:?} {u:?}");
        }
        let refreshed = refresher.refresh(&next, &[], &mut reduction).expect("independent");
        let generated = refreshed.generated.iter().map(|&(_, value)| value).collect();
        for (what, u) in [("refreshed g", reduction.g().to_vec()), ("refreshed values", generated)] {
            assert!(missed(&equations, &next, &u) < 1e-9, "{seed}, {what}: {equations:?} {next:?} {u:?}");
        }
    }
}

/// A component that needs a refinement changes no bit of another: g and refreshed g of two systems side by side are those of each alone.
#[test]
fn refinement_stays_within_its_component() {
    let mut random = SplitMix64::new(9);
    for seed in 0..300_u32 {
        let parts = [triangular(&mut random), triangular(&mut random)];
        let n = parts[0].len();
        let shifted = |row: &Vec<(usize, f64)>| row.iter().map(|&(j, v)| (j + n, v)).collect::<Vec<_>>();
        let both: Vec<Vec<(usize, f64)>> = parts[0].iter().cloned().chain(parts[1].iter().map(shifted)).collect();
        let mut sides = |count: usize| -> Vec<f64> {
            (0..count).map(|_| [0.0, 1.0, -2.0, 1e-3, 1e4][below(&mut random, 5)]).collect()
        };
        let (b, next) = (sides(both.len()), sides(both.len()));
        let solved = |equations: &[Vec<(usize, f64)>], b: &[f64], next: &[f64]| {
            let mut builder = SystemBuilder::new(equations.len());
            equations.iter().zip(b).for_each(|(row, &b)| _ = builder.equation(row.iter().copied(), b));
            let analysis = analyse(&builder.build().expect("valid"), &Options::default()).expect("small");
            let mut reduction = analysis.reduction().expect("independent");
            let first = reduction.g().to_vec();
            Refresher::new(analysis).expect("small").refresh(next, &[], &mut reduction).expect("independent");
            [first, reduction.g().to_vec()]
        };
        let together = solved(&both, &b, &next);
        let first = solved(&parts[0], &b[..n], &next[..n]);
        let second = solved(&parts[1], &b[n..], &next[n..]);
        for k in 0..2 {
            assert_eq!(together[k], [first[k].as_slice(), &second[k]].concat(), "{seed}: {both:?} {b:?} {next:?}");
        }
    }
}

/// An equation below the limit as a whole may have coefficients below its own limit too.
#[test]
fn noise_is_listed_once_and_in_order() {
    let mut builder = SystemBuilder::new(3);
    builder.equation([(0, 1.0), (1, 1e-16), (2, 1.0)], 0.0);
    builder.equation([(0, 1e-14), (1, -1e-30)], 0.0);
    builder.equation([(0, 1.0), (2, -1e-15)], 0.0);
    let options = Options { noise: Noise::Relative(1e-12), ..Options::default() };
    let analysis = analyse(&builder.build().expect("valid"), &options).expect("small");
    let found: Vec<(usize, usize)> = analysis.noise().iter().map(|term| (term.row, term.dof)).collect();
    assert_eq!(found, [(0, 1), (1, 0), (1, 1), (2, 2)]);
}
