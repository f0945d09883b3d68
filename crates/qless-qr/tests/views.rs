//! Matrices in other storage: by rows, other integer types, unsorted, repeated entries; and errors.

mod common;

use common::{Matrix, any};
use qless_qr::{Error, Index, Matrix as View, Options, least_squares};

/// R and the tolerance of the factor, which are equal for equal matrices.
fn read<P: Index, I: Index>(a: &View<P, I>) -> (qless_qr::SparseRows, f64) {
    let factor = a.analyse().expect("a pattern").factor(a.values(), &[], Options::new()).expect("a factorization");
    (factor.r().clone(), factor.tolerance())
}

fn to<T: TryFrom<usize>>(x: impl IntoIterator<Item = usize>) -> Vec<T> {
    x.into_iter().map(|v| T::try_from(v).ok().expect("small")).collect()
}

#[test]
fn every_form_of_a_matrix_is_read_alike() {
    for seed in 0..600 {
        let (a, mut random) = any(seed);
        let plain = read(&a.view());
        let (rows, cols, t) = (a.rows, a.cols, a.transposed());
        let index = |a: &Matrix| a.index.iter().map(|&i| i as usize).collect::<Vec<_>>();
        let (s, i) = (to::<i32>(t.start.clone()), to::<i32>(index(&t)));
        assert_eq!(read(&View::by_rows(rows, cols, &s, &i, &t.values).expect("a matrix")), plain, "seed {seed}");
        let (s, i) = (to::<i64>(t.start.clone()), to::<usize>(index(&t)));
        let view = View::by_columns(cols, rows, &s, &i, &t.values).expect("a matrix");
        assert_eq!(read(&view.transposed()), plain, "seed {seed}");
        let (s, i) = (to::<u32>(a.start.clone()), to::<u64>(index(&a)));
        assert_eq!(read(&View::by_columns(rows, cols, &s, &i, &a.values).expect("a matrix")), plain, "seed {seed}");
        let (s, i, v) = in_parts(&a, &mut random);
        assert_eq!(read(&View::by_columns(rows, cols, &s, &i, &v).expect("a matrix")), plain, "seed {seed}");
        let (s, i, v) = in_parts(&t, &mut random);
        assert_eq!(read(&View::by_rows(rows, cols, &s, &i, &v).expect("a matrix")), plain, "seed {seed}");
    }
}

/// Each entry as two halves, unsorted.
fn in_parts(a: &Matrix, random: &mut common::Random) -> (Vec<usize>, Vec<u32>, Vec<f64>) {
    let (mut start, mut index, mut values) = (vec![0], Vec::new(), Vec::new());
    for j in 0..a.cols {
        let mut entries: Vec<(u32, f64)> = a.column(j).flat_map(|(i, v)| [(i as u32, v / 2.0); 2]).collect();
        for at in (1..entries.len()).rev() {
            entries.swap(at, random.below(at + 1));
        }
        index.extend(entries.iter().map(|entry| entry.0));
        values.extend(entries.iter().map(|entry| entry.1));
        start.push(index.len());
    }
    (start, index, values)
}

#[test]
fn one_analysis_serves_many_values_in_any_form() {
    for seed in 0..200 {
        let (a, mut random) = any(seed);
        let (start, index, mut values) = in_parts(&a, &mut random);
        let symbolic = View::by_columns(a.rows, a.cols, &start, &index, &values).expect("a matrix").analyse();
        let symbolic = symbolic.expect("a pattern");
        for _ in 0..3 {
            values.iter_mut().for_each(|v| *v = 1.0 - 2.0 * *v);
            let b = vec![1.0; a.rows];
            let again = symbolic.factor(&values, &b, Options::new()).expect("a factorization");
            let view = View::by_columns(a.rows, a.cols, &start, &index, &values).expect("a matrix");
            let fresh = view.analyse().expect("a pattern").factor(&values, &b, Options::new());
            assert_eq!(Ok(again), fresh, "seed {seed}");
        }
    }
}

#[test]
fn what_is_no_matrix_is_refused() {
    let of = |start: &[i64], index: &[i32], values: &[f64]| View::by_columns(2, 2, start, index, values).err();
    let start = |at, found, entries| Some(Error::Start { at, found, entries });
    assert!(matches!(of(&[0, 1], &[0], &[1.0]), Some(Error::Length { what: "start", found: 2, expected: 3 })));
    assert!(matches!(of(&[0, 1, 1], &[0], &[]), Some(Error::Length { what: "values", .. })));
    assert_eq!(of(&[1, 1, 1], &[0], &[1.0]), start(0, 1, 1));
    assert_eq!(of(&[0, 0, 0], &[0], &[1.0]), start(2, 0, 1));
    assert_eq!(of(&[0, 2, 1], &[0], &[1.0]), start(1, 2, 1));
    assert_eq!(of(&[0, -1, 1], &[0], &[1.0]), start(1, usize::MAX, 1));
    assert_eq!(of(&[0, 1, 1], &[2], &[1.0]), Some(Error::Index { entry: 0, found: 2, bound: 2 }));
    assert_eq!(of(&[0, 1, 1], &[-1], &[1.0]), Some(Error::Index { entry: 0, found: usize::MAX, bound: 2 }));
    assert_eq!(of(&[0, 1, 1], &[1], &[f64::NAN]), Some(Error::NotFinite("the matrix")));
    let huge = View::by_columns(usize::MAX, 0, &[0_usize], &[0_u32; 0], &[]).expect("nothing in it");
    assert!(matches!(huge.analyse(), Err(Error::TooLarge { .. })));
    let starts = View::by_rows(usize::MAX, 0, &[0_usize], &[0_u32; 0], &[]);
    assert!(matches!(starts.err(), Some(Error::Length { what: "start", .. })));
}

#[test]
fn what_does_not_fit_to_a_matrix_is_refused() {
    let a = View::by_columns(2, 1, &[0_usize, 2], &[0_u32, 1], &[1.0, 1.0]).expect("a matrix");
    let b = |b: &[f64]| least_squares(&a, b, Options::new()).err();
    assert_eq!(b(&[1.0]), Some(Error::Length { what: "b", found: 1, expected: 2 }));
    assert_eq!(b(&[1.0, f64::NAN]), Some(Error::NotFinite("the right-hand side")));
    let wide = qless_qr::minimum_norm(&a.transposed(), &[f64::INFINITY], Options::new()).err();
    assert_eq!(wide, Some(Error::NotFinite("the right-hand side")));
    let factor = a.analyse().expect("a pattern").factor(a.values(), &[], Options::new()).expect("a factorization");
    assert_eq!(factor.solve(&[1.0, 2.0]), Err(Error::NoQ));
    assert_eq!(factor.solve_transposed(&[1.0]), Err(Error::NoQ));
    assert_eq!(factor.refine(&a, &[1.0, 2.0], &mut [1.0], 1), Err(Error::NoQ));
    assert!(matches!(factor.refine(&a, &[1.0, 2.0], &mut [], 1), Err(Error::Length { what: "x", .. })));
    assert!(factor.solve_seminormal(&a.transposed(), &[1.0], 0).is_err());
    assert!(factor.solve_seminormal(&a, &[1.0], 0).is_err());
}
