//! Coefficients and right-hand sides that contain rounding are told, by the program or by the caller.

use qless::common::SplitMix64;
use qless::diagnosis::OtherReading;
use qless::{Doubt, Noise, Options, SystemBuilder, analyse};

use super::{Equations, counts, each, is_sure, system};

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

/// The product of turns by quarters and halves about axes, as floating point has it: zeros are rounding, and products of rounding.
fn turned(turns: &[(usize, f64)]) -> [[f64; 3]; 3] {
    let mut product = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for &(axis, quarters) in turns {
        let (sin, cos) = (quarters * std::f64::consts::FRAC_PI_2).sin_cos();
        let (p, q) = ((axis + 1) % 3, (axis + 2) % 3);
        for row in &mut product {
            (row[p], row[q]) = (row[p] * cos + row[q] * sin, row[q] * cos - row[p] * sin);
        }
    }
    product
}

/// Two nodes are tied twice along an axis: as it was turned, and as it would be without rounding.
#[test]
fn ties_along_turned_axes_are_the_same_or_in_doubt() {
    let mut random = SplitMix64::new(31);
    for _ in 0..1000 {
        let mut next = |count: u64| random.next() % count;
        let turns: Vec<_> = (0..=next(3)).map(|_| (next(3) as usize, [1.0, -1.0, 2.0][next(3) as usize])).collect();
        for axis in turned(&turns) {
            let mut builder = SystemBuilder::new(6);
            for axis in [axis, axis.map(f64::round)] {
                let terms = axis.iter().enumerate().filter(|(_, v)| **v != 0.0);
                builder.equation(terms.flat_map(|(j, &v)| [(j, v), (j + 3, -v)]), 0.0);
            }
            let analysis = analyse(&builder.build().expect("valid"), &Options::default()).expect("small");
            let is_told = analysis.rank() == 1 || analysis.confidence().ambiguous;
            assert!(is_told, "{turns:?}: {axis:?} {:?}", analysis.confidence());
        }
    }
}

/// A discrete Fourier transform and its inverse, with the zeros that cosines leave: all agree but for numbers of 1e-16, which the report
/// names as the reason for doubt.
#[test]
fn remainders_that_consist_of_rounding_are_told_as_rounding() {
    for n in [4_usize, 8, 12] {
        let angle = |k: usize, x: usize| 2.0 * std::f64::consts::PI * (k * x) as f64 / n as f64;
        // u_x = sum_k a_k cos + b_k sin, and back; DOFs 0..n are values, then a_0..a_(n/2), then b_1..b_(n/2-1).
        let half = n / 2;
        let (a, b) = (|k: usize| n + k, |k: usize| n + half + k);
        let mut builder = SystemBuilder::new(2 * n);
        for k in 0..=half {
            let weight = if k == 0 || k == half { 1.0 } else { 2.0 } / n as f64;
            builder.equation((0..n).map(|x| (x, -weight * angle(k, x).cos())).chain([(a(k), 1.0)]), 0.0);
            if k > 0 && k < half {
                builder.equation((0..n).map(|x| (x, -weight * angle(k, x).sin())).chain([(b(k), 1.0)]), 0.0);
            }
        }
        for x in 0..n {
            let cosines = (0..=half).map(|k| (a(k), -angle(k, x).cos()));
            let sines = (1..half).map(|k| (b(k), -angle(k, x).sin()));
            builder.equation(cosines.chain(sines).chain([(x, 1.0)]), 0.0);
        }
        each(&builder.build().expect("valid"), |analysis, name| {
            let (confidence, other) = (analysis.confidence(), analysis.other_reading());
            assert_eq!(analysis.rank(), n, "{n}, {name}");
            assert!(
                !confidence.ambiguous || other.is_some_and(|other| other.as_zero && other.rank == n),
                "{n}, {name}: {confidence:?}"
            );
        });
    }
}

/// An equation in a small unit beside suspect coefficients is no equation of rounding if its right-hand side is none: it holds.
#[test]
fn a_small_unit_with_a_right_hand_side_is_no_rounding() {
    let small = 2_f64.powi(-23);
    let rows: Equations = &[
        (&[(8, -3e4), (1, -2e-13), (2, 1.0)], 0.0),
        (&[(0, -3e8)], 0.0),
        (&[(4, 6e4), (2, 1.0), (12, -1.525_878_906_25e-5)], 0.0),
        (&[(11, small), (0, -small)], small),
        (&[(3, 1.0), (9, 1.0)], 0.0),
        (&[(11, 1.0), (5, 1.0)], 0.0),
        (&[(13, 1.0), (9, 1.0)], 0.0),
        (&[(4, 1.0), (10, -6e7)], 0.0),
        (&[(12, 1.0), (7, 1.0), (10, 1.0)], 0.0),
        (&[(6, 1.0), (3, 1.0)], 0.0),
        (&[(13, 1.0), (5, 1.0)], 0.0),
        (&[(6, 1.0), (4, 1.0), (7, -1e17)], 0.0),
    ];
    each(&system(14, rows, &[]), |analysis, name| assert_eq!(counts(analysis), [12, 0, 0], "{name}"));
}
