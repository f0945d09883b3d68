//! Right-hand sides of any size: conflicts are found, and every consistent equation holds.

use qless::change::Refresher;
use qless::common::SplitMix64;
use qless::{Options, SystemBuilder, analyse};

use super::{Equations, below, counts, each, is_sure, system, triangular};

/// `u1 + u2 = B + 1e-3; u2 = B; u1 = 1e-3` in any order: the sum has lost digits, so the others are kept. The same if prescribed DOFs have
/// these values and all sides are zero.
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
        let tied: [(&[(usize, f64)], f64); 3] =
            [(&[(0, 1.0), (1, 1.0), (2, -1.0)], 0.0), (&[(1, 1.0), (3, -1.0)], 0.0), (&[(0, 1.0), (4, -1.0)], 0.0)];
        each(&system(5, &order.map(|i| tied[i]), &[(2, size + 1e-3), (3, size), (4, 1e-3)]), |analysis, name| {
            let fixed = analysis.generated().iter().find(|(j, _)| *j == 0).expect("a fixed DOF").1;
            assert!((fixed - 1e-3).abs() <= 1e-13, "{name}, {size:e}, {order:?}: {fixed}");
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

/// A loop of rates whose product is `1 + e`: the equation that is dropped differs by e, whatever the right-hand sides are.
#[test]
fn right_hand_sides_hide_no_remainder() {
    for seed in 0..400 {
        let mut random = SplitMix64::new(seed);
        let n = if seed % 2 == 0 { 4 } else { 6 };
        let e = [1e-12, 9e-12, 9e-11][seed as usize % 3];
        let mut rate = || (1 + below(&mut random, 9999)) as f64 * 10_f64.powi(below(&mut random, 13) as i32 - 8);
        let mut rates: Vec<f64> = (0..n - 1).map(|_| rate()).collect();
        rates.push((1.0 + e) / rates.iter().product::<f64>());
        let u: Vec<f64> = (0..n).map(|_| rate()).collect();
        let sides = |with: bool| {
            let mut builder = SystemBuilder::new(n);
            for (i, &rate) in rates.iter().enumerate() {
                let next = (i + 1) % n;
                builder.equation([(next, 1.0), (i, -rate)], if with { u[next] - rate * u[i] } else { 0.0 });
            }
            builder.build().expect("valid")
        };
        each(&sides(false), |analysis, name| assert!(analysis.confidence().ambiguous, "{seed}, {name}"));
        each(&sides(true), |analysis, name| {
            assert!(analysis.confidence().ambiguous, "{seed}, {name}: {rates:?}, {u:?}, {:?}", analysis.kinds());
        });
    }
}

/// `u0 - u1 = 1e-3`, twice as much with another difference, and a value of u0: whether the two conflict does not depend on it, as long as the
/// digits of the differences are not rounding beside it.
#[test]
fn another_value_hides_no_conflict_and_raises_no_doubt() {
    for value in [1.0, 1e3, 1e5, 1e6, 1e8] {
        for (second, expected, ambiguous) in [(2.2e-3, [2, 0, 1], false), (2e-3, [2, 1, 0], false)] {
            let rows: Equations =
                &[(&[(0, 1.0), (1, -1.0)], 1e-3), (&[(0, 2.0), (1, -2.0)], second), (&[(0, 1.0)], value)];
            each(&system(2, rows, &[]), |analysis, name| {
                let confidence = analysis.confidence();
                assert_eq!(
                    (counts(analysis), confidence.ambiguous),
                    (expected, ambiguous),
                    "{value}, {name}: {confidence:?}"
                );
            });
        }
        // The difference is 1e-10 of the terms of both, so that it may be rounding.
        let rows: Equations = &[
            (&[(0, 1.0), (1, 1.0)], 171_658.643_983_8),
            (&[(0, 6.0), (1, 6.0)], 1_029_951.863_800_656),
            (&[(0, 1.0)], value),
        ];
        each(&system(2, rows, &[]), |analysis, name| assert!(analysis.confidence().ambiguous, "{value}, {name}"));
    }
}

/// Coefficients over hundreds of decades: what is left of a combination is far below the last digit of its terms.
#[test]
fn remainders_below_the_last_digit_are_no_remainders() {
    for power in [60, 100, 200] {
        let (large, small) = (10_f64.powi(power), 10_f64.powi(-power));
        let rows: Equations =
            &[(&[(0, large), (1, small)], 0.0), (&[(0, small), (1, large)], 0.0), (&[(0, 1.0), (1, 1.0)], 0.0)];
        is_sure(&system(2, rows, &[]), [2, 1, 0]);
    }
}
