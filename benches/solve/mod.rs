//! `x = A\b` by qless-qr against SuiteSparseQR's: least squares of tall and square systems, shortest solutions of wide ones.
//!
//! Both have their default tolerance, relative to the largest column. Where x is unique (the rank is full and the condition
//! number far from 1e16) residuals must agree to 1e-12 of |b| and norms of x to 1e-12 of |x|. The other systems have singular
//! values near the tolerance, so the two may find different ranks. They get a b in the range of A, and our residual must be
//! at most theirs or 1e-12 of |b| + |A| |x|.

use std::hint::black_box;

use qless::Csr;
use qless_qr::{Matrix, Options, Solution, least_squares, minimum_norm};
use spqr_sys::solve::{Columns, backslash, minimum_norm as shortest};

use crate::timing::{median, seconds};

/// Largest condition number for which x is compared.
const SURE: f64 = 1e3;
/// Allowed relative difference of residuals and norms.
const CLOSE: f64 = 1e-12;

fn ours(a: &Matrix, b: &[f64]) -> Solution {
    let options = Options::new();
    black_box(if a.rows() < a.cols() { minimum_norm(a, b, options) } else { least_squares(a, b, options) })
        .expect("a solution")
}

fn theirs(a: &Columns, b: &[f64], is_wide: bool) -> Vec<f64> {
    black_box(if is_wide { shortest(a, b) } else { backslash(a, b) }).expect("a solution")
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// `|A x - b|`, A by columns.
fn residual(columns: &Csr, x: &[f64], b: &[f64]) -> f64 {
    let mut left = b.to_vec();
    for (j, x) in x.iter().enumerate() {
        columns.row(j).for_each(|(i, v)| left[i] -= v * x);
    }
    norm(&left)
}

/// Ratio of medians; at least five rounds.
pub fn compare(name: &str, columns: &Csr, in_range: bool) -> f64 {
    let (m, n) = (columns.cols(), columns.rows());
    let mut b: Vec<f64> = (0..m).map(|i| (i % 7) as f64 - 3.0).collect();
    if in_range {
        b.fill(0.0);
        (0..n).for_each(|j| columns.row(j).for_each(|(i, v)| b[i] += v * ((j % 5) as f64 - 1.5)));
    }
    let a = Matrix::by_columns(m, n, columns.starts(), columns.columns(), columns.values()).expect("a matrix");
    let start = columns.starts().iter().map(|&at| at as i64).collect();
    let index = columns.columns().iter().map(|&i| i64::from(i)).collect();
    let c = Columns::new(m, start, index, columns.values().to_vec()).expect("a matrix");
    let (mut x, mut y) = (ours(&a, &b), theirs(&c, &b, m < n));
    let rounds = ((0.5 / seconds(|| x = ours(&a, &b))) as usize).clamp(5, 31);
    let mut times = (Vec::new(), Vec::new());
    for _ in 0..rounds {
        times.0.push(seconds(|| x = ours(&a, &b)));
        times.1.push(seconds(|| y = theirs(&c, &b, m < n)));
    }
    let (first, second) = (median(times.0), median(times.1));
    let (left, their_left) = (residual(columns, &x.x, &b), residual(columns, &y, &b));
    let longer = norm(&x.x) / norm(&y) - 1.0;
    let is_full = x.rank == m.min(n);
    let is_sure = is_full && condition(&a) < SURE;
    println!(
        "{name:<28}{m:>8}{n:>8}{:>9}{:>8}{:>10.2}{:>10.2}{:>8.2}{:>11.2e}{:>11.2e}{longer:>11.1e}{}",
        columns.nnz(),
        x.rank,
        first * 1e3,
        second * 1e3,
        first / second,
        left / norm(&b),
        their_left / norm(&b),
        if is_sure { "" } else { "  x is not unique" }
    );
    if is_sure {
        assert!((left - their_left).abs() <= CLOSE * norm(&b), "{name}: residuals differ");
        assert!(longer.abs() <= CLOSE, "{name}: solutions differ");
    } else {
        let size = (0..n).map(|j| columns.row(j).map(|(_, v)| v * v).sum::<f64>().sqrt()).fold(0.0, f64::max);
        let allowed = CLOSE * (norm(&b) + size * norm(&x.x));
        assert!(left <= allowed.max(their_left), "{name}: the residual is {left:e}");
    }
    first / second
}

/// Of the triangle, in the 1-norm.
fn condition(a: &Matrix) -> f64 {
    let a = if a.rows() < a.cols() { a.transposed() } else { *a };
    let factor = a.analyse().and_then(|symbolic| symbolic.factor(a.values(), &[], Options::new()));
    factor.expect("a factorization").condition()
}

/// The heading of what [`compare`] prints.
pub fn heading() {
    println!(
        "{:<28}{:>8}{:>8}{:>9}{:>8}{:>10}{:>10}{:>8}{:>11}{:>11}{:>11}",
        "A x = b", "m", "n", "nnz", "rank", "ours ms", "spqr ms", "ratio", "residual", "theirs", "norm"
    );
}

/// A square, a tall and a wide system of full rank: a grid of cells whose equations couple neighbours, well conditioned.
pub fn shapes(test: bool) -> Vec<(&'static str, Csr)> {
    let side = if test { 12 } else { 120 };
    let (square, tall) = (grid(side, 1), grid(side, 3));
    let wide = tall.transpose().expect("few enough columns");
    vec![("grid, square", square), ("grid, tall", tall), ("grid, wide", wide)]
}

/// By columns (a row here is a column of A): node j has so many equations, each with its four neighbours.
fn grid(side: usize, each: usize) -> Csr {
    let nodes = side * side;
    let mut state = 1_u64;
    let mut random = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / f64::from(1_u32 << 31) - 0.5
    };
    let mut equations = Csr::empty(nodes);
    for node in 0..nodes {
        let (x, y) = (node % side, node / side);
        for e in 0..each {
            let mut row = vec![(node, 4.0 + e as f64)];
            let beside = [(x > 0, node.wrapping_sub(1)), (x + 1 < side, node + 1)];
            let above = [(y > 0, node.wrapping_sub(side)), (y + 1 < side, node + side)];
            row.extend(beside.iter().chain(&above).filter(|(is_in, _)| *is_in).map(|&(_, at)| (at, random())));
            row.sort_unstable_by_key(|entry| entry.0);
            equations.push_row(row).expect("ascending");
        }
    }
    equations.transpose().expect("few enough columns")
}
