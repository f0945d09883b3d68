//! Rows that are dependent to within the tolerance are not kept together, even if no pivot is small.
//!
//! In a triangle of Kahan, `diag(1, s, s^2, ..) (I - c U)` with `s^2 + c^2 = 1` and ones above the diagonal in U, all columns have the same
//! length after each step, so that pivoting exchanges none and no pivot is small. The smallest singular value is much smaller.

use ::faer::Mat;
use qless::{Analysis, BackendChoice, ConstraintSystem, Kind, Options, SystemBuilder, Tolerance};
use qless_scenes::Rng;

use crate::support::{diagnose, settings};

on_each_backend!(triangles_of_kahan_lose_a_row, random_rows_near_the_tolerance);

/// The rows times a product of two random reflections, so that no DOF is in few rows, with 0 as right-hand side.
fn reflected(rows: &Mat<f64>, rng: &mut Rng) -> ConstraintSystem {
    let n = rows.ncols();
    let mut rows = rows.clone();
    for _ in 0..2 {
        let v: Vec<f64> = (0..n).map(|_| if rng.real() < 0.0 { -1.0 } else { 1.0 }).collect();
        for i in 0..rows.nrows() {
            let part: f64 = (0..n).map(|j| rows[(i, j)] * v[j]).sum();
            (0..n).for_each(|j| rows[(i, j)] -= 2.0 * part * v[j] / n as f64);
        }
    }
    let mut builder = SystemBuilder::new(n);
    (0..rows.nrows()).for_each(|i| _ = builder.equation((0..n).map(|j| (j, rows[(i, j)])), 0.0));
    builder.build().expect("valid")
}

/// The distance of row k from the span of the rows of `others`, by Gram-Schmidt that is repeated once.
fn distance(system: &ConstraintSystem, k: usize, others: &[usize]) -> f64 {
    let dense = |i: usize| {
        let mut row = vec![0.0; system.dofs()];
        system.matrix().row(i).for_each(|(j, v)| row[j] = v);
        row
    };
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let reduced = |mut row: Vec<f64>, basis: &[Vec<f64>]| {
        for b in basis.iter().chain(basis) {
            let part = dot(&row, b);
            row.iter_mut().zip(b).for_each(|(x, b)| *x -= part * b);
        }
        row
    };
    for &i in others {
        let row = reduced(dense(i), &basis);
        let length = dot(&row, &row).sqrt();
        basis.push(row.into_iter().map(|x| x / length).collect());
    }
    let rest = reduced(dense(k), &basis);
    dot(&rest, &rest).sqrt()
}

/// The least distance of a kept row from the other kept ones, the largest distance of a dropped row from the kept ones, and the largest
/// coefficient of a certificate.
fn measured(system: &ConstraintSystem, analysis: &Analysis) -> [f64; 3] {
    let of = |kept: bool| {
        let kinds = analysis.kinds().iter().enumerate();
        kinds.filter(move |(_, kind)| (**kind == Kind::Independent) == kept).map(|(i, _)| i).collect::<Vec<_>>()
    };
    let (kept, dropped) = (of(true), of(false));
    let apart = |&k: &usize| {
        let others: Vec<usize> = kept.iter().copied().filter(|&i| i != k).collect();
        distance(system, k, &others)
    };
    let certificates = dropped.iter().map(|&k| analysis.because(k).expect("a row"));
    let steepest = certificates.flatten().fold(0.0, |most: f64, term| most.max(term.coefficient.abs()));
    [
        kept.iter().map(apart).fold(f64::INFINITY, f64::min),
        dropped.iter().map(|&k| distance(system, k, &kept)).fold(0.0, f64::max),
        steepest,
    ]
}

/// A triangle of Kahan of n rows in each of several parts, which share one block of that many DOFs. The tolerance of [`PAPER`] scales
/// nothing.
fn kahan(parts: usize, n: usize, c: f64, dofs: usize, rng: &mut Rng) -> ConstraintSystem {
    let s = (1.0 - c * c).sqrt();
    let entry = |i: usize, j: usize| {
        // Slightly shorter columns come later, so that rounding exchanges none.
        let column = s.powi(j as i32) * (1.0 - 1e-4 * i as f64);
        column * [0.0, 1.0, -c][(1 + i).saturating_sub(j).min(2)]
    };
    let rows = Mat::from_fn(parts * n, dofs, |i, j| if i / n == j / n { entry(i % n, j % n) } else { 0.0 });
    reflected(&rows, rng)
}

/// The tolerance of the paper, which is absolute.
const PAPER: f64 = 1e-5;

fn paper(backend: BackendChoice) -> Options {
    Options { backend, tolerance: Tolerance::Paper, ..Options::default() }
}

fn triangles_of_kahan_lose_a_row(backend: BackendChoice) {
    for (seed, parts) in [1, 2, 1, 2, 1, 2].into_iter().enumerate() {
        let n = 54 + 4 * seed;
        let system = kahan(parts, n, 0.28, parts * n + 3, &mut Rng::new(seed as u64));
        let analysis = diagnose(&system, &paper(backend));
        let [apart, left, steepest] = measured(&system, &analysis);
        assert_eq!(analysis.rank(), parts * (n - 1), "n = {n}, {parts} parts");
        assert!(apart > PAPER && left < PAPER, "n = {n}, {parts} parts: {apart:e} and {left:e}");
        assert!(steepest < 4.0, "n = {n}, {parts} parts: a coefficient of {steepest}");
    }
}

/// Blocks that are too large to be factored again with pivoting.
#[test]
fn large_triangles_of_kahan_lose_a_row() {
    for parts in [1, 2] {
        let n = 240 / parts;
        let system = kahan(parts, n, 0.14, 4500, &mut Rng::new(parts as u64));
        let analysis = diagnose(&system, &paper(BackendChoice::Sparse));
        assert_eq!(analysis.rank(), parts * (n - 1), "{parts} parts");
    }
}

/// Dense rows, one of which is a combination of others up to a vector whose length is near the tolerance, with coefficients of very
/// different sizes.
fn random_rows_near_the_tolerance(backend: BackendChoice) {
    const TOLERANCE: f64 = 1e-10;
    let mut dropped = 0;
    for seed in 0..150 {
        let mut rng = Rng::new(seed);
        let (m, n) = (3 + rng.below(8), 12 + rng.below(6));
        let mut rows = Mat::from_fn(m, n, |_, _| rng.real());
        let off = TOLERANCE * 10_f64.powf(1.5 * rng.real());
        let factors: Vec<f64> = (1..m).map(|_| rng.coefficient(1) * 10_f64.powf(rng.real())).collect();
        let at = rng.below(m);
        for j in 0..n {
            let others = (0..m).filter(|&i| i != at).zip(&factors);
            rows[(at, j)] = others.map(|(i, factor)| factor * rows[(i, j)]).sum::<f64>() + off * rng.real();
        }
        let system = reflected(&rows, &mut rng);
        for options in settings(backend) {
            let analysis = diagnose(&system, &options);
            let [apart, left, _] = measured(&system, &analysis);
            let what = format!("seed {seed}, presolve {}, off {off:e}", options.presolve);
            assert!(analysis.rank() >= m - 1, "{what}: rank {} of {m}", analysis.rank());
            // Rows are scaled by powers of two, and DOFs have units that differ by a few.
            assert!(apart > TOLERANCE / 16.0 && left < 16.0 * TOLERANCE, "{what}: {apart:e} and {left:e}");
            assert!(analysis.confidence().ambiguous, "{what}: no doubt");
            dropped += m - analysis.rank();
        }
    }
    assert!((50..250).contains(&dropped), "{dropped} of 300 systems lose a row");
}
