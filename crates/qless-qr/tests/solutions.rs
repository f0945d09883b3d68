//! Residuals are orthogonal to the range, minimum-norm solutions equal those of the pseudoinverse, and refinement reaches the last digits.

mod common;

use common::dense::Svd;
use common::{Matrix, any, dot, minus, multiply, norm};
use qless_qr::{Error, Options, Solution, Tolerance, least_squares, minimum_norm, solve};

/// Allowed rounding error for a system of known rank.
fn slack(svd: &Svd, rank: usize, x: &[f64], left: f64) -> f64 {
    let condition = if rank == 0 { 1.0 } else { svd.values[0] / svd.values[rank - 1] };
    let size = svd.values.first().copied().unwrap_or(1.0);
    2e-13 * (condition * norm(x) + condition * condition * left / size)
}

/// Right-hand sides: random, in the range of A, and zero.
fn right(a: &Matrix, random: &mut common::Random, seed: u64) -> Vec<f64> {
    let x: Vec<f64> = (0..a.cols).map(|_| random.signed()).collect();
    match seed % 4 {
        0 => multiply(a, &x),
        1 => vec![0.0; a.rows],
        _ => (0..a.rows).map(|_| random.signed()).collect(),
    }
}

fn is_orthogonal(a: &Matrix, solution: &Solution, b: &[f64], name: &str) {
    let left = minus(b, &multiply(a, &solution.x));
    let size = (0..a.cols).map(|j| norm(&a.dense(j))).fold(0.0, f64::max);
    for j in 0..a.cols {
        let gap = dot(&a.dense(j), &left).abs();
        let allowed = 1e-12 * size * (norm(b) + size * norm(&solution.x));
        assert!(gap <= allowed, "{name}: the residual meets column {j} by {gap:e} of {allowed:e}");
    }
    if let [found] = solution.residuals[..] {
        assert!((found - norm(&left)).abs() <= 1e-13 * (norm(b) + size * norm(&solution.x)), "{name}: residual");
    }
}

#[test]
fn least_squares_and_shortest_solutions_are_those_of_the_pseudoinverse() {
    let (mut compared, count) = (0, 3000);
    for seed in 0..count {
        let (a, mut random) = any(seed);
        let (b, name) = (right(&a, &mut random, seed), format!("seed {seed}, {} x {}", a.rows, a.cols));
        let options = Options::new().refinements(seed as usize % 3);
        let basic = least_squares(&a.view(), &b, options).expect("a solution");
        let short = minimum_norm(&a.view(), &b, options).expect("a solution");
        is_orthogonal(&a, &basic, &b, &name);
        is_orthogonal(&a, &short, &b, &name);
        assert!(basic.x.iter().filter(|&&x| x != 0.0).count() <= basic.rank, "{name}: more than a basis");
        let svd = Svd::new(&a);
        let rank = svd.rank(1e-11);
        // If a singular value is near the tolerance, the rank is not unique.
        if svd.values.iter().any(|&s| s > 1e-14 && s < 1e-6 * svd.values[0]) {
            continue;
        }
        compared += 1;
        assert_eq!((basic.rank, short.rank), (rank, rank), "{name}: rank, {:?}", svd.values);
        let exact = svd.shortest(rank, a.cols, &b);
        let allowed = slack(&svd, rank, &basic.x, norm(&minus(&b, &multiply(&a, &exact))));
        let gap = norm(&minus(&short.x, &exact));
        assert!(gap <= allowed, "{name}: the shortest is off by {gap:e} of {allowed:e}");
        if rank == a.cols {
            assert!(norm(&minus(&basic.x, &exact)) <= allowed, "{name}: the only solution");
        }
    }
    assert!(compared > count * 9 / 10, "only {compared} compared");
}

#[test]
fn later_right_hand_sides_give_the_same() {
    let mut of_another_rank = 0;
    for seed in 0..1500 {
        let (a, mut random) = any(seed);
        let b: Vec<f64> = (0..2 * a.rows).map(|_| random.signed()).collect();
        let svd = Svd::new(&a);
        let factor = a.analyse().factor(&a.values, &b, Options::new().keep_q(true)).expect("a factorization");
        if a.rows == 0 || svd.values.iter().any(|&s| s > 1e-14 && s < 1e-5 * svd.values[0]) {
            continue;
        }
        let complete = factor.complete(usize::MAX).expect("a factorization");
        let (basic, short) = (factor.basic().expect("x"), complete.minimum_norm().expect("x"));
        let allowed = slack(&svd, factor.rank(), &basic, norm(&b)) * 10.0 + 1e-15;
        // R1 of a basic solution may have a larger condition number than A.
        let worse = factor.condition() / svd.values.first().map_or(1.0, |s| s / svd.values[svd.rank(1e-11) - 1]);
        let near = |x: &[f64], y: &[f64], what: &str| {
            let gap = norm(&minus(x, y));
            assert!(gap <= allowed * worse.max(1.0).powi(2), "seed {seed}: {what} is off by {gap:e} of {allowed:e}");
        };
        near(&factor.solve(&b).expect("x"), &basic, "with Q");
        near(&factor.solve_seminormal(&a.view(), &b, 2).expect("x"), &basic, "seminormal");
        near(&complete.solve(&b).expect("x"), &short, "shortest");
        let c: Vec<f64> = (0..a.cols).map(|_| random.signed()).collect();
        let transposed = minimum_norm(&a.transposed().view(), &c, Options::new()).expect("x");
        // Heath's test can miss a dependent column, and may miss different ones in A and A^T.
        if transposed.rank == factor.rank() {
            near(&complete.solve_transposed(&c).expect("x"), &transposed.x, "transposed");
        } else {
            of_another_rank += 1;
        }
    }
    assert!(of_another_rank < 5, "{of_another_rank} of 1500 ranks differ between A and A^T");
}

#[test]
fn square_systems_are_solved_or_said_to_be_singular() {
    let (mut solved, mut refused) = (0, 0);
    for seed in 0..1500 {
        let (a, mut random) = any(seed);
        let b = right(&a, &mut random, seed);
        let found = solve(&a.view(), &b, Options::new());
        if a.rows != a.cols {
            assert_eq!(found, Err(Error::NotSquare { rows: a.rows, cols: a.cols }));
            continue;
        }
        match found {
            Ok(solution) => {
                let size = (0..a.cols).map(|j| norm(&a.dense(j))).sum::<f64>();
                let gap = norm(&minus(&b, &multiply(&a, &solution.x)));
                assert!(gap <= 1e-13 * (norm(&b) + size * norm(&solution.x)), "seed {seed}: residual {gap:e}");
                solved += 1;
            }
            Err(error) => {
                let rank = least_squares(&a.view(), &b, Options::new()).expect("a solution").rank;
                assert_eq!(error, Error::Singular { rank, cols: a.cols });
                assert!(rank < a.cols);
                refused += 1;
            }
        }
    }
    assert!(solved > 100 && refused > 100, "{solved} solved, {refused} refused");
}

/// `A = [B; B]`, `b = A x + [s; -s]` with integers, so that x is the exact solution, and columns of graded size.
#[test]
fn refinement_gives_all_digits() {
    let (mut before, mut after) = (0.0_f64, 0.0_f64);
    for seed in 0..200 {
        let mut random = common::Random::new(seed + 5);
        let n = 2 + random.below(10);
        let mut columns = vec![Vec::new(); n];
        for (j, column) in columns.iter_mut().enumerate() {
            for i in 0..n as u32 {
                // The second column equals the first except for a change of one entry by 2^-18.
                let v = if j == 1 { 0.0 } else { (random.below(1 << 16) + 1) as f64 };
                column.push((i, v));
                column.push((i + n as u32, v));
            }
            column.sort_by_key(|entry| entry.0);
        }
        columns[1] = columns[0].iter().map(|&(i, v)| (i, 4.0 * v + f64::from(u8::from(i % n as u32 == 0)))).collect();
        let a = Matrix::from_columns(2 * n, &columns);
        let x: Vec<f64> = (0..n).map(|_| random.below(100) as f64 - 50.0).collect();
        let mut b = multiply(&a, &x);
        for i in 0..n {
            let s = random.below(1000) as f64;
            b[i] += s;
            b[i + n] -= s;
        }
        let error = |steps| {
            let solution = least_squares(&a.view(), &b, Options::new().refinements(steps)).expect("a solution");
            norm(&minus(&solution.x, &x)) / norm(&x)
        };
        before = before.max(error(0));
        after = after.max(error(3));
    }
    assert!(before > 1e-12 && after < 1e-15, "{before:e} before, {after:e} after");
}

#[test]
fn many_right_hand_sides_are_solved_as_one() {
    for seed in 0..300 {
        let (a, mut random) = any(seed);
        let b: Vec<f64> = (0..5 * a.rows).map(|_| random.signed()).collect();
        for way in [least_squares, minimum_norm] {
            let all = way(&a.view(), &b, Options::new().refinements(1)).expect("solutions");
            assert_eq!(all.residuals.len(), if a.rows == 0 { 1 } else { 5 });
            for (c, b) in b.chunks_exact(a.rows.max(1)).enumerate() {
                let one = way(&a.view(), b, Options::new().refinements(1)).expect("a solution").x;
                let x = &all.x[c * a.cols..(c + 1) * a.cols];
                let allowed = 1e-11 * (1.0 + norm(x)) * (1.0 + norm(x));
                assert!(norm(&minus(x, &one)) <= allowed, "seed {seed}: {x:?} {one:?}");
            }
        }
    }
}

#[test]
fn the_relative_tolerance_follows_the_scale() {
    for seed in 0..500 {
        let (mut a, _) = any(seed);
        let size = (0..a.cols).map(|j| norm(&a.dense(j))).fold(0.0, f64::max);
        let rank = |a: &Matrix, tolerance| {
            let options = Options::new().tolerance(tolerance);
            a.analyse().factor(&a.values, &[], options).map(|factor| (factor.rank(), factor.tolerance()))
        };
        let (plain, tolerance) = rank(&a, Tolerance::Relative).expect("a factorization");
        let expected = 20.0 * (a.rows + a.cols) as f64 * f64::EPSILON * size;
        assert!((tolerance - expected).abs() <= 1e-14 * expected, "seed {seed}: {tolerance:e}, not {expected:e}");
        let tenth = rank(&a, Tolerance::Scaled(0.1)).expect("a factorization");
        assert_eq!(Ok(tenth), rank(&a, Tolerance::Absolute(tenth.1)), "seed {seed}");
        assert!((tenth.1 - 0.1 * size).abs() <= 1e-14 * size, "seed {seed}");
        for scale in [2.0_f64.powi(800), 2.0_f64.powi(-800)] {
            a.values.iter_mut().for_each(|v| *v *= scale);
            assert_eq!(rank(&a, Tolerance::Relative).expect("a factorization").0, plain, "seed {seed}, {scale:e}");
            a.values.iter_mut().for_each(|v| *v /= scale);
        }
    }
}

#[test]
fn estimates_bound_the_condition_from_the_side_that_they_say() {
    let mut worst = (1.0_f64, 1.0_f64);
    for seed in 0..1500 {
        let (a, _) = any(seed);
        let factor = a.analyse().factor(&a.values, &[], Options::new()).expect("a factorization");
        let r = factor.rank();
        if r == 0 {
            assert_eq!((factor.condition(), factor.smallest_singular_value()), (1.0, f64::INFINITY));
            continue;
        }
        let rows = |i: usize| factor.r().row(i).filter(|&(j, _)| j < r).map(|(j, v)| (j as u32, v)).collect();
        let upper = Matrix::from_columns(r, &(0..r).map(rows).collect::<Vec<_>>()).transposed();
        let svd = Svd::new(&upper);
        let inverse = |j: usize| {
            let mut x: Vec<f64> = (0..r).map(|i| f64::from(u8::from(i == j))).collect();
            for i in (0..r).rev() {
                let row: Vec<(usize, f64)> = factor.r().row(i).filter(|&(j, _)| j < r).collect();
                x[i] = (x[i] - row[1..].iter().map(|&(k, v)| v * x[k]).sum::<f64>()) / row[0].1;
            }
            x.iter().map(|x| x.abs()).sum::<f64>()
        };
        let size = (0..r).map(|j| upper.column(j).map(|(_, v)| v.abs()).sum::<f64>()).fold(0.0, f64::max);
        let exact = size * (0..r).map(inverse).fold(0.0, f64::max);
        let (low, high) = (factor.condition() / exact, factor.smallest_singular_value() / svd.values[r - 1]);
        assert!(low < 1.0 + 1e-10 && high > 1.0 - 1e-6, "seed {seed}: {low}, {high}");
        worst = (worst.0.min(low), worst.1.max(high));
    }
    assert!(worst.0 > 0.1 && worst.1 < 2.0, "{worst:?}");
}
