//! The same bits for every number of threads, the memory limit, and errors.

mod common;

use common::{Found, Matrix, Random, absolute, found};
use qless_qr::{Error, Symbolic};

/// Rows that couple neighbours on a grid, the last `twice` of them repeated with a factor.
fn grid(side: usize, rows_per_node: usize, twice: usize) -> Matrix {
    let mut random = Random::new(7);
    let mut rows: Vec<Vec<(u32, f64)>> = Vec::new();
    for node in 0..side * side {
        for _ in 0..rows_per_node {
            let (x, y) = (node % side, node / side);
            let near = [(x, y), ((x + 1) % side, y), (x, (y + 1) % side), ((x + 1) % side, (y + 1) % side)];
            let mut row: Vec<(u32, f64)> =
                near.iter().map(|&(x, y)| ((y * side + x) as u32, random.signed() + 0.1)).collect();
            row.sort_by_key(|e| e.0);
            row.dedup_by_key(|e| e.0);
            rows.push(row);
        }
    }
    let doubled: Vec<_> = rows[..twice].iter().map(|row| row.iter().map(|&(j, v)| (j, 2.0 * v)).collect()).collect();
    rows.extend(doubled);
    Matrix::from_columns(side * side, &rows).transposed()
}

fn with_threads(threads: usize, a: &Matrix, symbolic: &Symbolic, rhs: &[f64]) -> Found {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
    found(pool.install(|| symbolic.factor(&a.values, rhs, absolute(1e-9))).expect("a factorization"))
}

#[test]
fn bits_do_not_depend_on_threads() {
    for (a, rank) in [(grid(70, 3, 100), 4900), (grid(150, 3, 100).transposed(), 22500)] {
        let symbolic = a.analyse();
        assert!(symbolic.flops() > 4e6, "large enough for tasks: {}", symbolic.flops());
        let bounds = [1, 2, 16, 64].map(|threads| symbolic.speedup(threads));
        assert!(bounds[0] == 1.0 && bounds[1] > 1.5 && bounds.is_sorted() && bounds[3] <= 64.0, "{bounds:?}");
        let rhs: Vec<f64> = (0..2 * a.rows).map(|i| (i % 11) as f64).collect();
        let alone = with_threads(1, &a, &symbolic, &rhs);
        assert_eq!(alone.rank, rank);
        for threads in [2, 3] {
            assert!(with_threads(threads, &a, &symbolic, &rhs) == alone, "{threads} threads");
        }
    }
}

#[test]
fn a_grid_meets_the_identities() {
    let a = grid(14, 2, 20);
    for a in [a.clone(), a.transposed()] {
        let rhs: Vec<f64> = (0..a.rows).map(|i| (i % 5) as f64).collect();
        common::check(&a, &a.factor(&rhs, 1e-9), &rhs, "grid");
    }
}

#[test]
fn a_limit_below_the_forecast_is_refused_before_the_work() {
    let a = grid(20, 2, 0);
    let symbolic = a.analyse();
    let needed = symbolic.memory(1);
    let rhs = vec![1.0; a.rows];
    let refused = symbolic.factor(&a.values, &rhs, absolute(1e-9).memory(needed - 1));
    assert_eq!(refused.err(), Some(Error::OutOfMemory { needed, limit: needed - 1 }));
    assert!(symbolic.factor(&a.values, &rhs, absolute(1e-9).memory(needed)).is_ok());
    assert!(needed <= symbolic.memory_at_worst(1));
}

#[test]
fn dependent_columns_fit_in_the_worst_forecast() {
    let mut a = grid(20, 2, 0).transposed();
    a.values.fill(1.0);
    let symbolic = a.analyse();
    let limit = symbolic.memory_at_worst(0);
    assert!(symbolic.factor(&a.values, &[], absolute(10.0).memory(limit)).is_ok());
}

#[test]
fn what_is_no_matrix_is_refused() {
    let analyse = |start: &[usize], index: &[u32]| Symbolic::analyse(2, 2, start, index).err();
    assert!(matches!(analyse(&[0, 1], &[0]), Some(Error::Length { what: "start", .. })));
    assert!(matches!(analyse(&[0, 2, 1], &[0]), Some(Error::Pattern { .. })));
    assert!(matches!(analyse(&[0, 1, 2], &[0, 2]), Some(Error::Pattern { column: 1, .. })));
    assert!(matches!(analyse(&[0, 2, 2], &[1, 0]), Some(Error::Pattern { column: 0, .. })));
    assert!(matches!(analyse(&[1, 1, 1], &[0]), Some(Error::Pattern { .. })));
}

#[test]
fn what_is_no_number_is_refused() {
    let symbolic = Symbolic::analyse(2, 2, &[0, 1, 2], &[0, 1]).expect("a pattern");
    let factor = |values: &[f64], rhs: &[f64], tolerance| symbolic.factor(values, rhs, absolute(tolerance)).err();
    assert_eq!(factor(&[1.0, f64::NAN], &[], 0.0), Some(Error::NotFinite("the matrix")));
    assert_eq!(factor(&[1.0, 1.0], &[f64::INFINITY, 0.0], 0.0), Some(Error::NotFinite("the right-hand side")));
    assert_eq!(factor(&[1.0, 1.0], &[], -1.0), Some(Error::Tolerance(-1.0)));
    assert!(matches!(factor(&[1.0], &[], 0.0), Some(Error::Length { what: "values", .. })));
    assert!(matches!(factor(&[1.0, 1.0], &[1.0], 0.0), Some(Error::Length { what: "rhs", .. })));
}

#[test]
fn empty_matrices_have_rank_0() {
    for (rows, cols) in [(0, 0), (0, 3), (3, 0), (4, 4)] {
        let symbolic = Symbolic::analyse(rows, cols, &vec![0; cols + 1], &[]).expect("a pattern");
        let rhs = vec![3.0; rows];
        let factor = found(symbolic.factor(&[], &rhs, absolute(0.0)).expect("a factorization"));
        assert_eq!((factor.rank, factor.order.len()), (0, cols));
        assert_eq!(factor.rest.len(), usize::from(rows > 0));
        factor.rest.iter().for_each(|rest| assert!((rest - common::norm(&rhs)).abs() < 1e-12));
    }
}

/// Bands, arrows and many separate blocks: deep trees, wide trees, dense rows and columns.
#[test]
fn trees_of_every_form_are_walked() {
    let n = 60_000_u32;
    let value = |j: u32| 1.0 + f64::from(j % 3);
    let band: Vec<Vec<(u32, f64)>> = (0..n).map(|j| (j..j + 3).map(|i| (i, value(i + j))).collect()).collect();
    // Two dense rows fill all of R; dense columns (transposed) fill nothing.
    let head = 1000;
    let arrow: Vec<Vec<(u32, f64)>> = (0..head).map(|j| vec![(j, value(j)), (head, 1.0), (head + 1, 2.0)]).collect();
    let blocks: Vec<Vec<(u32, f64)>> =
        (0..n).map(|j| vec![(j / 2 * 3 + j % 2, value(j)), (j / 2 * 3 + 2, 1.0)]).collect();
    for (rows, columns) in [(n + 2, band), (head + 2, arrow), (n / 2 * 3, blocks)] {
        let a = Matrix::from_columns(rows as usize, &columns);
        for a in [a.clone(), a.transposed()] {
            let rhs = vec![1.0; a.rows];
            let symbolic = a.analyse();
            let factor = with_threads(2, &a, &symbolic, &rhs);
            assert_eq!(factor.rank, columns.len());
            common::check_shape(&a, &factor, &rhs, "tree");
            let gap = common::norm(&factor.rhs).hypot(factor.rest[0]) - common::norm(&rhs);
            assert!(gap.abs() < 1e-9, "norm off by {gap:e}");
        }
    }
}
