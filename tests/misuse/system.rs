//! `Csr`, `ConstraintSystem`, `SystemBuilder`.

use qless::elimination::{Storage, View};
use qless::{ConstraintSystem, Csr, SystemBuilder, SystemError};

use super::{BAD, HUGE, refused, ring, survives};

#[test]
fn a_matrix_of_nothing_has_no_rows() {
    let none = Csr::default();
    assert_eq!((none.rows(), none.cols(), none.nnz(), none.starts()), (0, 0, 0, &[0][..]));
    assert_eq!(none.transpose(), Ok(none.clone()));
    assert_eq!((none.times(&[]), none.row(0).len(), none.row(usize::MAX).len()), (Ok(Vec::new()), 0, 0));
    refused("a system of it", || ConstraintSystem::from_csr(&none, &[], &[]));
}

#[test]
fn rows_that_are_none_leave_the_matrix_as_it_was() {
    let mut matrix = Csr::empty(3);
    matrix.push_row([(1, 1.0)]).expect("ascending");
    let before = matrix.clone();
    for bad in
        [vec![(0, 1.0), (3, 1.0)], vec![(0, 1.0), (1 << 32, 1.0)], vec![(1, 1.0), (1, 2.0)], vec![(2, 1.0), (0, 1.0)]]
    {
        refused(&format!("{bad:?}"), || matrix.push_row(bad));
        assert_eq!(matrix, before);
    }
    let mut wide = Csr::empty(usize::MAX);
    HUGE.iter().for_each(|&j| _ = refused("a column beyond 32 bits", || wide.push_row([(j, 1.0)])));
    refused("its transpose", || wide.transpose());
    refused("times nothing", || wide.times(&[]));
    refused("times too much", || before.times(&[1.0; 4]));
    refused("times too little", || before.times(&[1.0; 2]));
}

#[test]
fn arrays_that_are_no_matrix() {
    let parts = |start: &[usize], col: &[u32], values: usize| {
        let call = || Csr::from_parts(3, start.to_vec(), col.to_vec(), vec![1.0; values]);
        refused(&format!("{start:?} {col:?} {values}"), call)
    };
    assert_eq!(parts(&[], &[], 0), SystemError::WrongLength { what: "the list of starts", found: 0, expected: 1 });
    for start in [[1, 1, 2], [0, 2, 1], [0, 1, 1], [0, 3, 2], [0, usize::MAX, 2], [0, 1, usize::MAX]] {
        assert!(matches!(parts(&start, &[0, 1], 2), SystemError::BadStarts { .. }), "{start:?}");
    }
    parts(&[0, 1], &[0, 1], 2);
    parts(&[0, 1], &[0], 2);
    assert!(matches!(parts(&[0, 1], &[3], 1), SystemError::DofOutOfRange { .. }));
    assert!(matches!(parts(&[0, 1], &[u32::MAX], 1), SystemError::DofOutOfRange { .. }));
    assert!(matches!(parts(&[0, 2], &[1, 1], 2), SystemError::NotAscending { row: 0, column: 1, before: 1 }));
    refused("columns beyond 32 bits", || Csr::from_parts(usize::MAX, vec![0, 1], vec![u32::MAX], vec![1.0]));
    refused("rows beyond 32 bits", || Csr::zero(usize::MAX, 1));
}

/// Threads check rows in parallel; the error does not depend on which thread finds a fault first.
#[test]
fn of_many_faults_that_of_the_first_row_is_named() {
    let start: Vec<usize> = (0..=100_000).collect();
    for first in [0, 8191, 8192, 40_001, 89_999] {
        let mut col = vec![2_u32; 100_000];
        (col[first], col[first + 1], col[90_000]) = (4, 3, 3);
        let fault = refused("a column", || Csr::from_parts(3, start.clone(), col.clone(), vec![1.0; 100_000]));
        assert!(matches!(fault, SystemError::DofOutOfRange { dof: 4, .. }), "{first}: {fault}");
    }
}

#[test]
fn systems_of_wrong_lists() {
    let b = [0.0; 2];
    for rows in HUGE {
        refused("rows", || ConstraintSystem::from_triplets(rows, 2, &[], &b, &[]));
        refused("rows in columns", || ConstraintSystem::from_csc(rows, &[0], &[], &[], &b, &[]));
        refused("DOFs", || ConstraintSystem::from_triplets(2, rows, &[], &b, &[]));
        refused("a row", || ConstraintSystem::from_triplets(2, 2, &[(rows, 0, 1.0)], &b, &[]));
        refused("a DOF", || ConstraintSystem::from_triplets(2, 2, &[(0, rows, 1.0)], &b, &[]));
        refused("a row index", || ConstraintSystem::from_csc(2, &[0, 1], &[rows], &[1.0], &b, &[]));
        refused("a start", || ConstraintSystem::from_csc(2, &[0, rows, 1], &[0], &[1.0], &b, &[]));
        refused("a prescribed DOF", || ConstraintSystem::from_triplets(2, 2, &[], &b, &[(rows, 0.0)]));
    }
    // Fewer equations than stated: nothing is allocated for the missing ones.
    refused("many rows", || ConstraintSystem::from_triplets(u32::MAX as usize - 1, 2, &[], &b, &[]));
    for bad in BAD {
        refused("a coefficient", || ConstraintSystem::from_triplets(2, 2, &[(0, 0, bad)], &b, &[]));
        refused("b", || ConstraintSystem::from_triplets(2, 2, &[], &[0.0, bad], &[]));
        refused("a value", || ConstraintSystem::from_triplets(2, 2, &[], &b, &[(0, bad)]));
        let matrix = Csr::from_parts(1, vec![0, 1], vec![0], vec![bad]).expect("a matrix");
        refused("from rows", || ConstraintSystem::from_csr(&matrix, &[0.0], &[]));
    }
    for count in [0, 1, 3] {
        refused("a b of another length", || ConstraintSystem::from_triplets(2, 2, &[], &vec![0.0; count], &[]));
    }
    refused("two values", || ConstraintSystem::from_triplets(2, 2, &[], &b, &[(1, 0.0), (1, 1.0)]));
    // The same list as matrix values and right-hand side: only its length matters.
    let numbers = [1.0, 2.0];
    survives("aliases", || ConstraintSystem::from_csc(2, &[0, 2], &[0, 1], &numbers, &numbers, &[])).expect("valid");
}

#[test]
fn builders_say_what_is_wrong_at_the_end() {
    refused("no DOFs", || SystemBuilder::default().build());
    let mut named = SystemBuilder::default();
    named.labelled_equation("a", [(0, 1.0)], 0.0);
    refused("an equation on no DOFs", || named.build());
    for dofs in HUGE {
        refused("too many DOFs", || SystemBuilder::new(dofs).build());
    }
    let with = |change: &dyn Fn(&mut SystemBuilder)| {
        let mut builder = SystemBuilder::new(2);
        builder.equation([(0, 1.0)], 0.0);
        change(&mut builder);
        refused("a builder", || builder.build())
    };
    with(&|builder| _ = builder.equation([(usize::MAX, 1.0)], 0.0));
    with(&|builder| _ = builder.equation([(0, f64::NAN)], 0.0));
    with(&|builder| _ = builder.equation([(0, f64::MAX), (0, f64::MAX)], 0.0));
    with(&|builder| _ = builder.equation([], f64::INFINITY));
    with(&|builder| builder.prescribe(2, 0.0));
    with(&|builder| builder.prescribe(0, f64::NAN));
    with(&|builder| builder.dof_labels(vec!["one".to_owned()]));
}

/// A matrix accepts values that a system refuses.
#[test]
fn values_that_are_written_into_a_matrix() {
    for bad in BAD {
        let mut matrix = ring(3).matrix().clone();
        matrix.values_mut().fill(bad);
        refused("a system of it", || ConstraintSystem::from_csr(&matrix, &[0.0; 3], &[]));
    }
    assert!(Csr::default().values_mut().is_empty());
}

#[test]
fn patterns_that_are_no_matrix() {
    let check = |starts: &[i64], index: &[i32], n: usize| {
        refused("a pattern", || View::rows(starts, index).checked(n).map(drop))
    };
    for n in [0, 1, 3].into_iter().chain(HUGE) {
        check(&[0, 1, 2], &[0, 1], n);
        check(&[], &[], n);
    }
    for starts in [[-1, 1, 2], [0, 3, 2], [0, 1, i64::MAX], [1, 2, 2], [i64::MIN, 0, 2]] {
        check(&starts, &[0, 1], 2);
        refused("from 1", || View::columns(&starts, &[0, 1_i32]).one_based().checked(2).map(drop));
    }
    for index in [[-1, 0], [0, 2], [i32::MIN, i32::MAX]] {
        check(&[0, 1, 2], &index, 2);
    }
    for (index, storage) in [([1, 1], Storage::Lower), ([0, 0], Storage::Upper)] {
        refused("the other half", || View::rows(&[0_u32, 1, 2], &index).storing(storage).checked(2).map(drop));
    }
    // Starts and indices may be one list.
    let both = [0_u32, 1, 2];
    assert_eq!(survives("one list", || View::rows(&both, &both[..2]).checked(2)).expect("a diagonal").nnz(), 2);
}

#[test]
fn labels_of_what_is_not_there() {
    let system = ring(3);
    assert_eq!(survives("a label", || system.equation_label(usize::MAX)), "row 18446744073709551616");
    assert_eq!(survives("a label", || system.dof_label(usize::MAX)), "DOF 18446744073709551616");
    refused("one label", || system.clone().with_labels(vec!["a".to_owned()], Vec::new()));
    refused("one DOF label", || system.clone().with_labels(Vec::new(), vec!["a".to_owned()]));
}

/// Copies share the numbers, so an analysis keeps its system at no cost.
#[test]
fn a_copy_is_the_same_numbers() {
    let system = ring(5);
    let copy = system.clone().with_labels(Vec::new(), Vec::new()).expect("none");
    assert!(std::ptr::eq(system.matrix(), copy.matrix()));
    let analysis = qless::analyse(&system, &qless::Options::default()).expect("analysed");
    assert!(std::ptr::eq(analysis.system().matrix(), system.matrix()));
}
