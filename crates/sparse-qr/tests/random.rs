//! Two thousand seeded matrices of every shape, density and rank against the identities and a dense rank.

mod common;

use common::{Matrix, Random, check, rank};

fn matrix(seed: u64) -> (Matrix, Vec<f64>) {
    let mut random = Random::new(seed + 1);
    let largest = if seed.is_multiple_of(50) { 160 } else { 24 };
    let (rows, cols) = (random.below(largest), random.below(largest));
    let density = [20, 60, 150, 400, 1000][random.below(5)];
    let a = Matrix::random(&mut random, rows, cols, density);
    let spoils = random.below(4) * random.below(3);
    let a = a.spoilt(&mut random, spoils);
    let count = [0, 1, 3][random.below(3)];
    let rhs = (0..rows * count).map(|_| random.signed()).collect();
    (a, rhs)
}

#[test]
fn identities_hold_and_ranks_agree() {
    for seed in 0..2000 {
        let (a, rhs) = matrix(seed);
        let name = format!("seed {seed}, {} x {}", a.rows, a.cols);
        let factor = a.factor(&rhs, 1e-9);
        check(&a, &factor, &rhs, &name);
        assert_eq!(factor.rank, rank(&a, 1e-9), "{name}: rank");
        assert!(factor.dropped < 1e-12, "{name}: dropped {}", factor.dropped);
    }
}

#[test]
fn a_reused_analysis_gives_the_same_bits() {
    for seed in 0..200 {
        let (mut a, rhs) = matrix(seed);
        let symbolic = a.analyse();
        symbolic.factor(&a.values, &rhs, 1e-9, usize::MAX).expect("a factorization");
        a.values.iter_mut().for_each(|v| *v = 1.0 - *v);
        let again = symbolic.factor(&a.values, &rhs, 1e-9, usize::MAX).expect("a factorization");
        assert_eq!(again, a.factor(&rhs, 1e-9), "seed {seed}");
    }
}

#[test]
fn what_is_dropped_is_accounted_for() {
    for seed in 0..200 {
        let (a, rhs) = matrix(seed);
        let factor = a.factor(&rhs, 0.3);
        check(&a, &factor, &rhs, &format!("seed {seed}"));
    }
}
