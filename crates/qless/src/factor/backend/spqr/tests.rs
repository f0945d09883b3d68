//! Tests that SuiteSparseQR keeps the contract of [`super::Backend`]: identities, faults, threads.

use super::*;

/// A matrix A by columns, with its rank.
struct Case {
    name: &'static str,
    columns: Csr,
    rank: usize,
}

fn case(name: &'static str, rank: usize, rows: &[&[f64]]) -> Case {
    let n = rows.first().map_or(0, |row| row.len());
    let mut a = Csr::empty(n);
    for row in rows {
        a.append(row.iter().copied().enumerate().filter(|e| e.1 != 0.0));
    }
    Case { name, columns: a.transposed(), rank }
}

/// Numbers in -1..1 from a fixed seed.
struct Seeded(u64);

impl Seeded {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next().abs() * n as f64) as usize
    }
}

/// An m x n matrix with a dominant diagonal. Each `period`-th column is the difference of the two columns before it.
fn random(name: &'static str, m: usize, n: usize, period: usize) -> Case {
    let mut seeded = Seeded((m * 1000 + n) as u64);
    let mut dense: Vec<Vec<f64>> = Vec::new();
    for j in 0..n {
        let mut column = vec![0.0; m];
        if j % period == period - 1 {
            column = dense[j - 1].iter().zip(&dense[j - 2]).map(|(a, b)| a - b).collect();
        } else {
            (0..3).for_each(|_| column[seeded.below(m)] += seeded.next());
            column[j % m] += 4.0;
        }
        dense.push(column);
    }
    let mut columns = Csr::empty(m);
    for column in &dense {
        columns.append(column.iter().copied().enumerate().filter(|e| e.1 != 0.0));
    }
    Case { name, columns, rank: (0..n).filter(|j| j % period != period - 1).count().min(m) }
}

fn cases() -> Vec<Case> {
    vec![
        case("one entry", 1, &[&[-3.0]]),
        case("tall", 2, &[&[1.0, 2.0], &[3.0, 4.0], &[5.0, 7.0]]),
        case("wide", 2, &[&[1.0, 2.0, 3.0, 1.0], &[4.0, 5.0, 7.0, 2.0]]),
        case("zero column between", 2, &[&[1.0, 0.0, 2.0], &[3.0, 0.0, 4.0], &[5.0, 0.0, 1.0]]),
        case("duplicate columns", 2, &[&[1.0, 1.0, 2.0], &[3.0, 3.0, 4.0], &[5.0, 5.0, 7.0]]),
        case("first column dead", 1, &[&[0.0, 1.0], &[0.0, 1.0]]),
        case("rank one", 1, &[&[1.0, 2.0, 3.0], &[2.0, 4.0, 6.0], &[3.0, 6.0, 9.0]]),
        case("singletons", 3, &[&[2.0, 1.0, 0.0, 1.0], &[0.0, 3.0, 0.0, 1.0], &[0.0, 0.0, 0.0, 5.0]]),
        case("singletons in one row", 1, &[&[1.0, 2.0, 3.0], &[0.0, 0.0, 0.0]]),
        case("all but one row empty", 2, &[&[0.0; 3], &[1.0, 0.0, 2.0], &[0.0; 3], &[3.0, 0.0, 4.0]]),
        case("zero", 0, &[&[0.0, 0.0], &[0.0, 0.0], &[0.0, 0.0]]),
        random("sparse and tall", 60, 40, 41),
        random("sparse and wide", 30, 45, 46),
        random("sparse, tall, deficient", 400, 300, 7),
        random("sparse, wide, deficient", 40, 50, 5),
    ]
}

fn right_hand_sides(m: usize, count: usize) -> Vec<f64> {
    let mut seeded = Seeded(count as u64);
    (0..m * count).map(|_| seeded.next()).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn dense(rows: &Csr) -> Vec<Vec<f64>> {
    let fill = |i| {
        let mut row = vec![0.0; rows.cols];
        rows.row(i).for_each(|(j, v)| row[j] = v);
        row
    };
    (0..rows.rows()).map(fill).collect()
}

/// Columns of A in the factor's order.
fn ordered(case: &Case, factor: &Factor) -> Vec<Vec<f64>> {
    let a = dense(&case.columns);
    factor.order.iter().map(|&j| a[j].clone()).collect()
}

fn assert_close(case: &Case, a: f64, b: f64, allowed: f64) {
    assert!((a - b).abs() <= allowed, "{}: {a} and {b} differ by more than {allowed}", case.name);
}

fn factored(case: &Case, rhs: &[f64]) -> Factor {
    let factor = Spqr::default().factor(&case.columns, rhs, 1e-10 * norm(&case.columns.val)).unwrap();
    assert_eq!(factor.rank, case.rank, "{}", case.name);
    factor
}

fn every_case(check: impl Fn(&Case, &[f64], &Factor)) {
    for (case, count) in cases().iter().flat_map(|case| [0, 1, 3].map(|count| (case, count))) {
        let rhs = right_hand_sides(case.columns.cols, count);
        check(case, &rhs, &factored(case, &rhs));
    }
}

#[test]
fn shapes_are_those_promised() {
    every_case(|case, rhs, factor| {
        let (n, count) = (case.columns.rows(), rhs.len() / case.columns.cols);
        let mut order = factor.order.clone();
        order.sort_unstable();
        assert!(order.into_iter().eq(0..n), "{}", case.name);
        assert_eq!((factor.r.rows(), factor.r.cols), (factor.rank, n));
        assert_eq!((factor.rhs.len(), factor.rest.len()), (factor.rank * count, count));
    });
}

#[test]
fn r_is_trapezoidal_and_ascends() {
    every_case(|case, _, factor| {
        assert!(is_trapezoidal(&factor.r), "{}", case.name);
        for i in 0..factor.rank {
            assert!(factor.r.row(i).zip(factor.r.row(i).skip(1)).all(|(a, b)| a.0 < b.0), "{}", case.name);
            assert!(factor.r.row(i).all(|(_, v)| v != 0.0), "{}", case.name);
        }
    });
}

#[test]
fn r_has_the_products_of_the_columns() {
    every_case(|case, _, factor| {
        let size = norm(&case.columns.val);
        assert!(factor.dropped <= 1e-13 * size, "{}: dropped {}", case.name, factor.dropped);
        let (a, r) = (ordered(case, factor), dense(&factor.r.transposed()));
        for (i, j) in (0..a.len()).flat_map(|i| (0..=i).map(move |j| (i, j))) {
            let allowed = (1e-13 * size + 2.0 * factor.dropped) * size;
            assert_close(case, dot(&r[i], &r[j]), dot(&a[i], &a[j]), allowed);
        }
    });
}

#[test]
fn right_hand_sides_have_the_products_with_the_columns() {
    every_case(|case, rhs, factor| {
        let (a, r) = (ordered(case, factor), dense(&factor.r.transposed()));
        let allowed = (1e-13 * norm(&case.columns.val) + factor.dropped) * norm(rhs);
        for (k, b) in rhs.chunks(case.columns.cols).enumerate() {
            let head = &factor.rhs[k * factor.rank..(k + 1) * factor.rank];
            (0..a.len()).for_each(|j| assert_close(case, dot(&r[j], head), dot(&a[j], b), allowed));
        }
    });
}

/// Subtracts from b its part along each direction, twice for accuracy.
fn residual(directions: &[Vec<f64>], b: &[f64]) -> Vec<f64> {
    let mut left = b.to_vec();
    for q in directions.iter().chain(directions) {
        let along = dot(q, &left);
        left.iter_mut().zip(q).for_each(|(x, y)| *x -= along * y);
    }
    left
}

#[test]
fn rest_is_the_least_squares_residual() {
    every_case(|case, rhs, factor| {
        let mut directions: Vec<Vec<f64>> = Vec::new();
        for column in &ordered(case, factor)[..factor.rank] {
            let left = residual(&directions, column);
            let length = norm(&left);
            directions.push(left.into_iter().map(|x| x / length).collect());
        }
        for (b, &rest) in rhs.chunks(case.columns.cols).zip(&factor.rest) {
            assert_close(case, rest, norm(&residual(&directions, b)), 1e-13 * norm(b));
        }
    });
}

#[test]
fn rest_of_a_mean_is_its_deviation() {
    let mean = case("mean", 1, &[&[1.0], &[1.0]]);
    let rest = factored(&mean, &[1.0, 0.0, 2.0, 2.0, 3.0, -1.0]).rest;
    for (found, expected) in rest.into_iter().zip([0.5f64.sqrt(), 0.0, 8f64.sqrt()]) {
        assert_close(&mean, found, expected, 1e-15);
    }
}

#[test]
fn matrices_without_rows_or_columns_have_rank_zero() {
    let without_columns = Spqr::default().factor(&Csr::empty(2), &[3.0, 4.0, 0.0, 1.0], 0.0).unwrap();
    assert_eq!((without_columns.rank, without_columns.rest), (0, vec![5.0, 1.0]));
    let without_rows = Spqr::default().factor(&Csr::empty(3).transposed(), &[], 0.0).unwrap();
    assert_eq!((without_rows.order, without_rows.r), (vec![0, 1, 2], Csr::empty(3)));
}

#[test]
fn tolerance_zero_keeps_whatever_is_not_zero() {
    let tiny = case("tiny", 2, &[&[1e-150, 1e-150, 0.0], &[1e-150, -1e-150, 0.0], &[0.0; 3]]);
    assert_eq!(Spqr::default().factor(&tiny.columns, &[], 0.0).unwrap().rank, tiny.rank);
}

#[test]
fn tolerance_is_absolute_and_what_falls_below_is_reported() {
    let square = case("square", 2, &[&[1.0, 1.0], &[1.0, -1.0]]);
    for tolerance in [2.0, f64::INFINITY] {
        let factor = Spqr::default().factor(&square.columns, &[3.0, 4.0], tolerance).unwrap();
        assert_eq!((factor.rank, factor.r.nnz()), (0, 0));
        assert_close(&square, factor.rest[0], 5.0, 1e-15);
        assert_close(&square, factor.dropped, 2.0, 1e-15);
    }
    assert_eq!(Spqr::default().factor(&square.columns, &[], 1.4).unwrap().rank, 2);
}

#[test]
fn negative_tolerances_are_not_read_as_settings() {
    for tolerance in [-2.0, -1e-300, f64::NAN] {
        let error = Spqr::default().factor(&cases()[0].columns, &[], tolerance).unwrap_err().to_string();
        assert!(error.contains("is negative or not a number"), "{error}");
    }
}

/// Results are plain data; values with C memory stay on their thread.
#[test]
fn types_are_send_and_sync_where_that_is_true() {
    trait OrNot {
        fn is_send() -> bool {
            false
        }
    }
    struct Is<T>(std::marker::PhantomData<T>);
    impl<T> OrNot for Is<T> {}
    impl<T: Send> Is<T> {
        fn is_send() -> bool {
            true
        }
    }
    fn both<T: Send + Sync>() {}
    both::<Spqr>();
    both::<Factor>();
    both::<Statistics>();
    both::<BackendError>();
    assert!(Is::<Spqr>::is_send() && !Is::<call::Call>::is_send());
}

/// Empty matrices, single entries, and up to 40 right-hand sides.
#[test]
fn empty_shapes_and_many_right_hand_sides() {
    for (m, n) in [(0, 0), (0, 3), (3, 0), (1, 1), (5, 2), (2, 5)] {
        let columns = from_columns(m, n);
        for count in [0, 1, 40] {
            let rhs = right_hand_sides(m, count);
            let factor = Spqr::default().factor(&columns, &rhs, 1e-10).unwrap();
            let full = usize::from(m == 1);
            assert_eq!((factor.rank, factor.order.len(), factor.rhs.len()), (full, n, full * count), "{m} x {n}");
            assert_eq!(factor.rest.len(), if m == 0 { 0 } else { count });
        }
    }
}

/// An m x n matrix without entries, except that all columns have one entry if m is 1.
fn from_columns(m: usize, n: usize) -> Csr {
    let mut columns = Csr::empty(m);
    (0..n).for_each(|_| columns.append((m == 1).then_some((0, 2.0))));
    columns
}

#[test]
fn sizes_that_overflow_are_refused() {
    // More rows than 64-bit indices of C can count, but no entries, so nothing of that size is allocated.
    let columns = Csr::empty(usize::MAX);
    assert_eq!(
        Spqr::default().factor(&columns, &[], 1e-10).unwrap_err(),
        BackendError::TooLarge { backend: "spqr", rows: usize::MAX, cols: 0 }
    );
}

#[test]
fn numbers_that_are_not_finite_are_refused() {
    let (finite, nan) = (case("one", 1, &[&[1.0]]), case("NaN", 0, &[&[f64::NAN]]));
    let message = |case: &Case, rhs: &[f64]| Spqr::default().factor(&case.columns, rhs, 0.0).unwrap_err().to_string();
    assert!(message(&nan, &[]).contains("the block: number 0 (from 0) is NaN"));
    assert!(message(&finite, &[f64::INFINITY]).contains("B: number 0 (from 0) is inf"));
    let huge = case("huge", 0, &[&[1e308, 1e308], &[1e308, -1e308], &[1e308, 1e307], &[1e308, 1e308]]);
    assert!(message(&huge, &[]).contains("overflows"));
}

#[test]
fn threads_do_not_disturb_each_other() {
    // Values may differ in the last bits if BLAS itself runs threads.
    let orders = || cases().iter().map(|case| factored(case, &[]).order).collect::<Vec<_>>();
    let alone = orders();
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| assert_eq!(orders(), alone));
        }
    });
}

#[test]
fn statuses_become_errors_that_name_the_block() {
    let text = |status| error_of(status, 7, 5).to_string();
    assert!(text(spqr_sys::CHOLMOD_OUT_OF_MEMORY).contains("a block of 7 x 5 needs more memory"));
    assert!(text(spqr_sys::CHOLMOD_TOO_LARGE).contains("a block of 7 x 5 is larger"));
    assert!(text(spqr_sys::CHOLMOD_INVALID).contains("7 x 5 block invalid"));
    assert!(text(spqr_sys::CHOLMOD_NOT_INSTALLED).contains("status -1"));
}

#[test]
fn version_names_both_libraries() {
    let version = Spqr::default().version();
    assert!(version.starts_with("SuiteSparseQR ") && version.contains(", SuiteSparse "), "{version}");
    assert_eq!(Spqr::default().name(), "spqr");
}

#[test]
fn what_is_foreseen_to_need_more_than_the_limit_is_refused_before_the_work() {
    let case = random("a random block", 60, 40, 3);
    let limited = |memory| Spqr { memory, ..Spqr::default() }.factor(&case.columns, &[], 1e-10);
    let error = limited(1000).expect_err("more than 1000 bytes");
    assert!(matches!(error, BackendError::OverLimit { needed, limit: 1000, .. } if needed > 1000), "{error}");
    assert_eq!(limited(1 << 20), limited(usize::MAX));
}
