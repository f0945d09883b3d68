//! Every allocation of SuiteSparseQR and of its task tree fails in turn. The result is a typed error or the right answer, without a leak or
//! a crash; the next call works; and two other users of CHOLMOD, who run all the time, are not affected.
#![allow(unsafe_code, reason = "the neighbours call CHOLMOD without a wrapper")]

mod neighbours;

use std::sync::atomic::{AtomicUsize, Ordering::SeqCst};

use qless::Csr;
use qless::backend::spqr::{Spqr, faults};
use qless::backend::{Backend, BackendError};

struct System {
    name: &'static str,
    columns: Csr,
    rhs: Vec<f64>,
    spqr: Spqr,
}

fn from_entries(m: usize, n: usize, entry: impl Fn(usize, usize) -> f64) -> Csr {
    let mut columns = Csr::empty(m);
    for j in 0..n {
        columns.push_row((0..m).map(|i| (i, entry(i, j))).filter(|e| e.1 != 0.0)).expect("ascending");
    }
    columns
}

fn number(i: usize, j: usize) -> f64 {
    ((i * 31 + j * 17) % 23) as f64 - 11.0 + if i == j { 40.0 } else { 0.0 }
}

fn band(i: usize, j: usize) -> f64 {
    if i.abs_diff(j) < 4 { number(i, j) } else { 0.0 }
}

/// A row for each edge of a square grid, a column for each node.
fn grid(side: usize) -> Csr {
    let edges = (0..side * side).flat_map(|node| {
        let right = (node % side + 1 < side).then_some((node, node + 1));
        let below = (node + side < side * side).then_some((node, node + side));
        right.into_iter().chain(below)
    });
    let mut rows = Csr::empty(side * side);
    edges.for_each(|(a, b)| rows.push_row([(a, 1.0), (b, -1.5)]).expect("ascending"));
    rows.transpose().expect("few columns")
}

fn systems() -> Vec<System> {
    let shapes = [
        ("singletons", from_entries(9, 9, |i, j| if i <= j { number(i, j) } else { 0.0 })),
        ("rank-deficient", from_entries(40, 30, |i, j| band(i, j / 3 * 3))),
        ("zero columns between", from_entries(12, 9, |i, j| if j % 3 == 1 { 0.0 } else { number(i, j) })),
        ("wide", from_entries(20, 45, |i, j| band(2 * i, j))),
        ("tall", from_entries(60, 25, |i, j| band(i, 2 * j))),
        ("rank one", from_entries(6, 6, |i, j| ((i + 1) * (j + 1)) as f64)),
        ("many fronts", from_entries(160, 120, band)),
        ("a tree of tasks", grid(14)),
    ];
    let in_sequence = Spqr::default();
    let on_a_tree = Spqr { small: 1.0, grain: 32.0, ..Spqr::on(2) };
    let mut systems = Vec::new();
    for (name, columns) in shapes {
        for count in [0, 1, 3] {
            let rhs: Vec<f64> = (0..columns.cols() * count).map(|i| (i % 7) as f64 - 3.0).collect();
            systems.push(System { name, columns: columns.clone(), rhs: rhs.clone(), spqr: in_sequence });
            systems.push(System { name, columns: columns.clone(), rhs, spqr: on_a_tree });
        }
    }
    systems
}

/// A single test, because injected failures affect the whole process.
#[test]
fn every_allocation_may_fail() {
    let trees = AtomicUsize::new(0);
    neighbours::undisturbed(|| {
        for system in systems() {
            trees.fetch_add(usize::from(system.fails_in_turn() > 2), SeqCst);
        }
    });
    let trees = trees.into_inner();
    println!("{} failures injected, {trees} of the systems with a task tree", faults::injected());
    assert!(!Spqr::has_trees() || trees >= 3, "{trees}");
}

impl System {
    /// Number of tasks.
    fn fails_in_turn(&self) -> usize {
        let Self { name, columns, rhs, spqr } = self;
        // One-time allocations of oneTBB are not counted.
        spqr.factor(columns, rhs, 1e-10).expect("a factorization");
        let before = faults::asked();
        let (right, statistics) = spqr.factor_measured(columns, rhs, 1e-10).expect("a factorization");
        let allocations = u32::try_from(faults::asked() - before).expect("few");
        assert!(allocations > 10, "{name}: the guard counts {allocations} allocations");
        for k in 0..allocations {
            let (leaked, injected) = (faults::leaked(), faults::injected());
            faults::fail_at(k);
            let found = spqr.factor(columns, rhs, 1e-10);
            faults::stop();
            let what = format!("{name}, {} threads, allocation {k}", spqr.threads);
            assert!(faults::injected() > injected, "{what}: nothing failed");
            match found {
                Ok(factor) => assert!(factor == right, "{what}: another answer"),
                Err(error) => assert!(matches!(error, BackendError::OutOfMemory { .. }), "{what}: {error}"),
            }
            assert_eq!(faults::leaked(), leaked, "{what}: a leak");
            assert!(spqr.factor(columns, rhs, 1e-10).is_ok_and(|f| f == right), "{what}: the next call");
        }
        statistics.tasks
    }
}
