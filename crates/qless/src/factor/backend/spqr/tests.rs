//! The contract of [`super::Backend`] on SuiteSparseQR: identities, faults, threads.

use super::*;

use crate::factor::backend::check::{self, from_dense};

fn factored(columns: &Csr, rhs: &[f64], tolerance: f64) -> Factor {
    Spqr::default().factor(columns, rhs, tolerance).expect("a factorization")
}

fn refused(columns: &Csr, rhs: &[f64], tolerance: f64) -> String {
    Spqr::default().factor(columns, rhs, tolerance).expect_err("refused").to_string()
}

fn assert_close(a: f64, b: f64) {
    assert!((a - b).abs() <= 1e-15, "{a} and {b}");
}

#[test]
fn identities_hold_on_the_test_families() {
    check::families(&Spqr::default());
}

#[test]
fn rest_of_a_mean_is_its_deviation() {
    let rest = factored(&from_dense(&[vec![1.0], vec![1.0]]), &[1.0, 0.0, 2.0, 2.0, 3.0, -1.0], 1e-10).rest;
    rest.into_iter().zip([0.5f64.sqrt(), 0.0, 8f64.sqrt()]).for_each(|(found, expected)| assert_close(found, expected));
}

#[test]
fn matrices_without_rows_or_columns_have_rank_zero() {
    let without_columns = factored(&Csr::empty(2), &[3.0, 4.0, 0.0, 1.0], 0.0);
    assert_eq!((without_columns.rank, without_columns.rest), (0, vec![5.0, 1.0]));
    let without_rows = factored(&Csr::empty(3).transposed(), &[], 0.0);
    assert_eq!((without_rows.order, without_rows.r), (vec![0, 1, 2], Csr::empty(3)));
}

#[test]
fn tolerance_zero_keeps_whatever_is_not_zero() {
    let tiny = from_dense(&[vec![1e-150, 1e-150, 0.0], vec![1e-150, -1e-150, 0.0], vec![0.0; 3]]);
    assert_eq!(factored(&tiny, &[], 0.0).rank, 2);
}

#[test]
fn tolerance_is_absolute_and_what_falls_below_is_reported() {
    let square = from_dense(&[vec![1.0, 1.0], vec![1.0, -1.0]]);
    for tolerance in [2.0, f64::INFINITY] {
        let factor = factored(&square, &[3.0, 4.0], tolerance);
        assert_eq!((factor.rank, factor.r.nnz()), (0, 0));
        assert_close(factor.rest[0], 5.0);
        assert_close(factor.dropped, 2.0);
    }
    assert_eq!(factored(&square, &[], 1.4).rank, 2);
}

#[test]
fn negative_tolerances_are_refused() {
    for tolerance in [-2.0, -1e-300, f64::NAN] {
        let error = refused(&from_dense(&[vec![-3.0]]), &[], tolerance);
        assert!(error.contains("is negative or not a number"), "{error}");
    }
}

/// Results are plain data; what C holds stays on its thread.
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

#[test]
fn empty_shapes_and_many_right_hand_sides() {
    for (m, n) in [(0, 0), (0, 3), (3, 0), (1, 1), (5, 2), (2, 5)] {
        let columns = from_columns(m, n);
        for count in [0, 1, 40] {
            let factor = factored(&columns, &vec![0.5; m * count], 1e-10);
            let full = usize::from(m == 1);
            assert_eq!((factor.rank, factor.order.len(), factor.rhs.len()), (full, n, full * count), "{m} x {n}");
            assert_eq!(factor.rest.len(), if m == 0 { 0 } else { count });
        }
    }
}

/// m x n without entries, but for 1 x 1.
fn from_columns(m: usize, n: usize) -> Csr {
    let mut columns = Csr::empty(m);
    (0..n).for_each(|_| columns.append((m == 1).then_some((0, 2.0))));
    columns
}

#[test]
fn sizes_that_overflow_are_refused() {
    // More rows than 64-bit indices of C count, without an entry: nothing of that size is ever made.
    let columns = Csr::empty(usize::MAX);
    assert_eq!(
        Spqr::default().factor(&columns, &[], 1e-10).unwrap_err(),
        BackendError::TooLarge { backend: "spqr", rows: usize::MAX, cols: 0 }
    );
}

#[test]
fn numbers_that_are_not_finite_are_refused() {
    assert!(refused(&from_dense(&[vec![f64::NAN]]), &[], 0.0).contains("the block: number 0 (from 0) is NaN"));
    assert!(refused(&from_dense(&[vec![1.0]]), &[f64::INFINITY], 0.0).contains("B: number 0 (from 0) is inf"));
    let huge = from_dense(&[vec![1e308, 1e308], vec![1e308, -1e308], vec![1e308, 1e307], vec![1e308, 1e308]]);
    assert!(refused(&huge, &[], 0.0).contains("overflows"));
}

#[test]
fn threads_do_not_disturb_each_other() {
    // Values may differ in the last bits if BLAS itself runs threads.
    let columns = check::random_block(400, 300, 7);
    let orders = || (0..5).map(|_| factored(&columns, &[], 1e-10).order).collect::<Vec<_>>();
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
fn a_block_above_the_memory_limit_is_refused_before_the_work() {
    let columns = check::random_block(60, 40, 3);
    let limited = |memory| Spqr { memory, ..Spqr::default() }.factor(&columns, &[], 1e-10);
    let error = limited(1000).expect_err("more than 1000 bytes");
    assert!(matches!(error, BackendError::OverLimit { needed, limit: 1000, .. } if needed > 1000), "{error}");
    assert_eq!(limited(1 << 20), limited(usize::MAX));
}
