//! `qless::backend` and `qless-qr`: blocks, right-hand sides and tolerances.

use qless::backend::Factor;
use qless::{BackendChoice, Csr};
use qless_qr::{Options, SparseRows, Symbolic, Tolerance};

use super::{BAD, HUGE, refused, survives};

fn backends() -> Vec<Box<dyn qless::backend::Backend>> {
    let choices = [BackendChoice::Faer, BackendChoice::Faer, BackendChoice::Sparse, BackendChoice::Gauss];
    let all = choices.into_iter().chain(cfg!(feature = "spqr").then_some(BackendChoice::Spqr));
    all.map(|choice| choice.get(1 << 30).expect("compiled in")).collect()
}

fn absolute(tolerance: f64, memory: usize) -> Options {
    Options::new().tolerance(Tolerance::Absolute(tolerance)).memory(memory)
}

fn columns(value: f64) -> Csr {
    let mut columns = Csr::empty(3);
    columns.push_row([(0, 1.0), (2, value)]).expect("ascending");
    columns.push_row([(1, 2.0)]).expect("ascending");
    columns
}

#[test]
fn blocks_that_cannot_be_factored() {
    for backend in backends() {
        let name = backend.name();
        for bad in BAD {
            refused(name, || backend.factor(&columns(bad), &[], 1e-10));
            refused(name, || backend.factor(&columns(1.0), &[0.0, bad, 0.0], 1e-10));
        }
        for length in [1, 2, 4, 7] {
            refused(name, || backend.factor(&columns(1.0), &vec![1.0; length], 1e-10));
        }
        for tolerance in [f64::NAN, -1.0, f64::NEG_INFINITY] {
            refused(name, || backend.factor(&columns(1.0), &[], tolerance));
        }
        refused(name, || backend.factor(&Csr::default(), &[1.0], 0.0));
        for empty in
            [Csr::default(), Csr::empty(3), Csr::from_parts(0, vec![0; 4], Vec::new(), Vec::new()).expect("zeros")]
        {
            let rhs = vec![1.0; empty.cols()];
            let factor = survives(name, || backend.factor(&empty, &rhs, 0.0)).expect("nothing to factor");
            assert_eq!((factor.rank, factor.order.len()), (0, empty.rows()), "{name}");
        }
        survives(name, || backend.factor(&columns(1.0), &[], f64::INFINITY)).ok();
        for huge in [f64::MAX, 1e200, 5e-324] {
            survives(name, || backend.factor(&columns(huge), &[huge; 3], 1e-10)).ok();
        }
    }
}

#[test]
fn factors_that_are_none() {
    let good = backends()[0].factor(&columns(1.0), &[1.0, 2.0, 3.0], 1e-10).expect("factored");
    refused("short", || good.solve(&[1.0]));
    refused("long", || good.solve(&[1.0; 3]));
    for bad in [
        Factor { rank: 7, ..good.clone() },
        Factor { r: Csr::default(), ..good.clone() },
        Factor { rank: usize::MAX, ..good },
    ] {
        refused("solve", || bad.solve(&[1.0, 2.0]));
        refused("coefficients", || bad.coefficients());
    }
}

#[test]
fn patterns_that_are_none() {
    for huge in HUGE {
        refused("rows", || Symbolic::analyse(huge, 0, &[0], &[]));
        refused("columns", || Symbolic::analyse(2, huge, &[0], &[]));
        refused("starts", || Symbolic::analyse(2, 1, &[0, huge], &[0]));
    }
    for (start, index) in [(vec![], vec![]), (vec![0], vec![]), (vec![1, 1], vec![0]), (vec![0, 2], vec![1, 0])] {
        refused("a pattern", || Symbolic::analyse(2, 1, &start, &index));
    }
    for (start, index) in [(vec![0, 1], vec![2]), (vec![0, 2], vec![1, 1]), (vec![0, 1], vec![u32::MAX])] {
        refused("a pattern", || Symbolic::analyse(2, 1, &start, &index));
    }
    survives("nothing", || Symbolic::analyse(0, 0, &[0], &[])).expect("an empty matrix");
}

#[test]
fn numbers_that_do_not_fit_to_a_pattern() {
    let symbolic = Symbolic::analyse(2, 2, &[0, 2, 3], &[0, 1, 1]).expect("a pattern");
    for count in [0, 2, 4] {
        refused("values", || symbolic.factor(&vec![1.0; count], &[], absolute(0.0, 1 << 20)));
    }
    for bad in BAD {
        refused("a value", || symbolic.factor(&[1.0, bad, 1.0], &[], absolute(0.0, 1 << 20)));
        refused("b", || symbolic.factor(&[1.0; 3], &[1.0, bad], absolute(0.0, 1 << 20)));
    }
    refused("b", || symbolic.factor(&[1.0; 3], &[1.0; 3], absolute(0.0, 1 << 20)));
    refused("a tolerance", || symbolic.factor(&[1.0; 3], &[], absolute(f64::NAN, 1 << 20)));
    refused("a tolerance", || symbolic.factor(&[1.0; 3], &[], absolute(-1.0, 1 << 20)));
    refused("no memory", || symbolic.factor(&[1.0; 3], &[], absolute(0.0, 0)));
    for count in [0, usize::MAX] {
        survives("memory", || symbolic.memory(count).max(symbolic.memory_at_worst(count)));
    }
    let same = [1.0, 2.0, 3.0, 4.0];
    survives("one list as both", || symbolic.factor(&same[..3], &same, absolute(0.0, usize::MAX))).expect("valid");
}

#[test]
fn rows_that_are_not_there_are_empty() {
    let rows = SparseRows { start: vec![0, 2, 9, 1], col: vec![0, 1], val: vec![1.0] };
    for i in [0, 1, 2, 3, usize::MAX] {
        assert_eq!(survives("a row", || rows.row(i).count()), 0, "row {i}");
    }
}
