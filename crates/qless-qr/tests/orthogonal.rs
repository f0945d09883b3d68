//! Q: `Q^T Q = I`, `A P = Q [R1 R2; 0]`; the bits do not depend on the number of vectors or threads.

mod common;

use common::{Matrix, Random, any, dot, minus, norm};
use qless_qr::{Error, Factor, Options};

fn with_q(a: &Matrix, rhs: &[f64]) -> Factor {
    a.analyse().factor(&a.values, rhs, Options::new().keep_q(true)).expect("a factorization")
}

/// Q by columns.
fn formed(factor: &Factor) -> Vec<f64> {
    let m = factor.rows();
    let mut q: Vec<f64> = (0..m * m).map(|at| f64::from(u8::from(at.is_multiple_of(m + 1)))).collect();
    factor.apply_q(&mut q).expect("Q");
    q
}

fn check(a: &Matrix, factor: &Factor, name: &str) {
    let (m, q) = (a.rows, formed(factor));
    for (i, x) in q.chunks_exact(m.max(1)).enumerate() {
        for (j, y) in q.chunks_exact(m.max(1)).enumerate().take(i + 1) {
            let gap = dot(x, y) - f64::from(u8::from(i == j));
            assert!(gap.abs() < 1e-13, "{name}: Q^T Q at {i}, {j} is off by {gap:e}");
        }
    }
    let size = (0..a.cols).map(|j| norm(&a.dense(j))).fold(0.0, f64::max);
    let mut product = vec![0.0; m * a.cols];
    for i in 0..factor.rank() {
        factor.r().row(i).for_each(|(j, v)| product[j * m + i] = v);
    }
    factor.apply_q(&mut product).expect("Q");
    for (at, &j) in factor.order().iter().enumerate() {
        let gap = norm(&minus(&product[at * m..(at + 1) * m], &a.dense(j)));
        assert!(gap <= 1e-13 * size + factor.dropped(), "{name}: column {j} of A P - Q R is {gap:e}");
    }
    let mut back = q;
    factor.apply_q_transposed(&mut back).expect("Q");
    let identity = |at: usize| f64::from(u8::from(at.is_multiple_of(m + 1)));
    assert!(back.iter().enumerate().all(|(at, v)| (v - identity(at)).abs() < 1e-13), "{name}: Q^T (Q I) is not I");
}

#[test]
fn q_is_orthogonal_and_gives_a_back() {
    for seed in 0..2000 {
        let (a, _) = any(seed);
        check(&a, &with_q(&a, &[]), &format!("seed {seed}, {} x {}", a.rows, a.cols));
    }
    for seed in 0..6 {
        let mut random = Random::new(400 + seed);
        let (rows, cols) = [(150, 90), (90, 150), (120, 120)][seed as usize % 3];
        let a = Matrix::random(&mut random, rows, cols, [20, 400][seed as usize / 3]).spoilt(&mut random, 20);
        check(&a, &with_q(&a, &[]), &format!("large, seed {seed}"));
    }
}

#[test]
fn right_hand_sides_meet_the_same_q_before_and_after() {
    for seed in 0..1000 {
        let (a, mut random) = any(seed);
        let b: Vec<f64> = (0..3 * a.rows).map(|_| random.signed()).collect();
        let factor = with_q(&a, &b);
        let mut z = b.clone();
        factor.apply_q_transposed(&mut z).expect("Q");
        for c in 0..factor.rest().len() {
            let (z, size) = (&z[c * a.rows..(c + 1) * a.rows], norm(&b));
            let (head, rest) = z.split_at(factor.rank());
            let gap = norm(&minus(head, &factor.rhs()[c * factor.rank()..]));
            assert!(gap <= 1e-13 * size, "seed {seed}: Q^T b is off by {gap:e}");
            assert!((norm(rest) - factor.rest()[c]).abs() <= 1e-13 * size, "seed {seed}: the rest");
        }
        let plain = a.analyse().factor(&a.values, &b, Options::new()).expect("a factorization");
        assert_eq!((plain.r(), plain.rhs(), plain.order()), (factor.r(), factor.rhs(), factor.order()), "seed {seed}");
        assert_eq!(plain.apply_q(&mut z), Err(Error::NoQ));
    }
}

#[test]
fn one_vector_is_turned_as_many_are() {
    for seed in 0..300 {
        let (a, mut random) = any(seed);
        let factor = with_q(&a, &[]);
        let b: Vec<f64> = (0..19 * a.rows).map(|_| random.signed()).collect();
        for way in [Factor::apply_q, Factor::apply_q_transposed] {
            let (mut many, mut alone) = (b.clone(), b.clone());
            way(&factor, &mut many).expect("Q");
            alone.chunks_exact_mut(a.rows.max(1)).for_each(|b| way(&factor, b).expect("Q"));
            assert_eq!(many, alone, "seed {seed}");
        }
    }
}

#[test]
fn bits_do_not_depend_on_threads() {
    let mut random = Random::new(3);
    let columns: Vec<Vec<(u32, f64)>> = (0..6000_u32)
        .map(|j| {
            [0, 1, 77, 78, 79].iter().map(|d| (j + d, random.signed() + if *d == 77 { 3.0 } else { 0.1 })).collect()
        })
        .collect();
    let a = Matrix::from_columns(6100, &columns);
    let symbolic = a.analyse();
    assert!(symbolic.flops() > 4e6, "large enough for tasks: {}", symbolic.flops());
    let b: Vec<f64> = (0..21 * a.rows).map(|i| (i % 13) as f64 - 6.0).collect();
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| {
            let factor = symbolic.factor(&a.values, &b, Options::new().keep_q(true)).expect("a factorization");
            let (x, y) = (factor.solve(&b).expect("x"), factor.solve_transposed(&b[..12000]).expect("y"));
            (factor, x, y)
        })
    };
    let alone = run(1);
    for threads in [2, 3] {
        assert!(run(threads) == alone, "{threads} threads");
    }
}

#[test]
fn vectors_of_another_length_are_refused() {
    let a = Matrix::from_columns(3, &[vec![(0, 1.0), (2, 2.0)]]);
    let factor = with_q(&a, &[]);
    for length in [1, 2, 4] {
        let refused = Err(Error::Length { what: "b", found: length, expected: 3 });
        assert_eq!(factor.apply_q(&mut vec![1.0; length]), refused);
        assert_eq!(factor.apply_q_transposed(&mut vec![1.0; length]), refused);
    }
    assert_eq!(factor.apply_q(&mut []), Ok(()));
}
