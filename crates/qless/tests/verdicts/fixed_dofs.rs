//! DOFs that count as fixed do not move, and all others do.

use qless::common::SplitMix64;
use qless::exact::{self, Reading};
use qless::{ConstraintSystem, Noise, Options, SystemBuilder, analyse};

use super::{Equations, below, each, shuffle, system};

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
    for seed in 0..2100 {
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
    assert!(sure > 10_000 && fixed_dofs > 500, "{sure} {fixed_dofs}");
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

/// `u_s = sum_i y_i row_i` of dense equations with coefficients over twelve decades, which are given twice: DOF s is fixed although it is in
/// one equation only, and no other DOF is.
#[test]
fn a_dof_that_sums_of_equations_hold_is_fixed() {
    let mut sure = 0;
    for seed in 0..300 {
        let mut random = SplitMix64::new(seed);
        let (m, n) = (2 + below(&mut random, 3), 6);
        let mut value = || (1 + below(&mut random, 9)) as f64 * 2_f64.powi(below(&mut random, 41) as i32 - 20);
        let rows: Vec<Vec<f64>> = (0..m).map(|_| (0..n).map(|_| value()).collect()).collect();
        let mut builder = SystemBuilder::new(n + 1);
        for row in rows.iter().chain(&rows) {
            builder.equation(row.iter().copied().enumerate(), 0.0);
        }
        let sum = |j: usize| rows.iter().map(|row| row[j]).sum::<f64>();
        builder.equation((0..n).map(|j| (j, sum(j))).chain([(n, 1.0)]), 0.0);
        each(&builder.build().expect("valid"), |analysis, name| {
            assert_eq!(analysis.rank(), m + 1, "{seed}, {name}");
            if !analysis.confidence().ambiguous {
                assert_eq!(analysis.generated(), [(n, 0.0)], "{seed}, {name}");
                sure += 1;
            }
        });
    }
    assert!(sure > 2000, "{sure}");
}

/// A number as typed with `digits` decimals.
fn typed(value: f64, digits: usize) -> f64 {
    format!("{value:.digits$}").parse().expect("a number")
}

/// `a u0 + b u1 + c u2 = 0`, and 500 times as much with another `a`: u0 is fixed by a difference in the fourth to sixth digit, in any unit.
/// Nothing is fixed beside it, and its coefficients are not exact in binary.
#[test]
fn a_dof_that_a_small_difference_fixes_is_told() {
    for seed in 0..300 {
        let mut random = SplitMix64::new(seed);
        let mut value = || typed((11 + below(&mut random, 89)) as f64 / 10.0, 1);
        let (a, b, c) = (value(), value(), value());
        let share = 10_f64.powi(-4 - (seed % 3) as i32);
        let unit = 10_f64.powi((seed / 3 % 5) as i32);
        let rows = [[a, b, c], [typed(500.0 * a * (1.0 + share), 6), typed(500.0 * b, 1), typed(500.0 * c, 1)]];
        let rows = rows.map(|row| [(0, row[0] * unit), (1, row[1]), (2, row[2])]);
        let equations: Equations = &[(&rows[0], 0.0), (&rows[1], 0.0)];
        each(&system(3, equations, &[]), |analysis, name| {
            let found: Vec<usize> = analysis.generated().iter().map(|&(j, _)| j).collect();
            assert_eq!((analysis.rank(), found), (2, vec![0]), "{seed}, {name}: {rows:?}");
        });
    }
}

/// `sum m_i u_i = 0` and `u_4 = sum m_i / M u_i` fix u_4, whatever the masses are.
#[test]
fn the_mean_of_what_has_no_momentum_is_fixed() {
    for seed in 0..300 {
        let mut random = SplitMix64::new(seed);
        let masses: Vec<f64> = (0..3)
            .map(|_| (1 + below(&mut random, 99)) as f64 / 10.0 * 10_f64.powi(below(&mut random, 11) as i32 - 5))
            .collect();
        let all: f64 = masses.iter().sum();
        let mean = |k: usize| (k, -masses[k] / all);
        let some = masses[0] + masses[1];
        let rows: [Vec<(usize, f64)>; 4] = [
            (0..3).map(|k| (k, masses[k])).collect(),
            (0..3).map(mean).chain([(3, 1.0)]).collect(),
            vec![(4, 1.0), (0, -masses[0] / some), (1, -masses[1] / some)],
            vec![(5, all), (4, -some), (2, -masses[2])],
        ];
        let equations: Vec<(&[(usize, f64)], f64)> = rows.iter().map(|row| (&row[..], 0.0)).collect();
        each(&system(6, &equations, &[]), |analysis, name| {
            if !analysis.confidence().ambiguous {
                let found: Vec<usize> = analysis.generated().iter().map(|&(j, _)| j).collect();
                assert_eq!(found, [3, 5], "{seed}, {name}: {masses:?}");
            }
        });
    }
}

/// `u_i = u_(i+1) + 6 u_(i+2)`, of which the end moves by 3^-25 of the start, with rows and DOFs in units of powers of two.
#[test]
fn what_moves_less_and_less_is_not_fixed() {
    for seed in 0..300 {
        let mut random = SplitMix64::new(seed);
        let mut power = || 2_f64.powi(below(&mut random, 61) as i32 - 30);
        let n = 26;
        let units: Vec<f64> = (0..n).map(|_| power()).collect();
        let mut builder = SystemBuilder::new(n);
        for i in 0..n - 1 {
            let unit = power();
            let terms = [(i, 1.0), (i + 1, -1.0), (i + 2, -6.0)];
            // The last equation asks for the growing solution.
            let terms = if i + 2 < n { &terms[..] } else { &[(i, 1.0), (i + 1, -3.0)] };
            builder.equation(terms.iter().map(|&(j, a)| (j, a * unit * units[j])), 0.0);
        }
        each(&builder.build().expect("valid"), |analysis, name| {
            if !analysis.confidence().ambiguous {
                assert_eq!((analysis.rank(), analysis.generated()), (n - 1, [].as_slice()), "{seed}, {name}");
            }
        });
    }
}
