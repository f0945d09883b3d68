//! Two thousand seeded matrices of every shape, density and rank against the identities and a dense rank.

mod common;

use common::{Matrix, Random, absolute, check, found, rank};

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
        symbolic.factor(&a.values, &rhs, absolute(1e-9)).expect("a factorization");
        a.values.iter_mut().for_each(|v| *v = 1.0 - *v);
        let again = found(symbolic.factor(&a.values, &rhs, absolute(1e-9)).expect("a factorization"));
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

#[test]
fn large_fronts_meet_the_identities() {
    for seed in 0..12 {
        let mut random = Random::new(900 + seed);
        let (rows, cols) = ([420, 260, 300][seed as usize % 3], [250, 430, 300][seed as usize % 3]);
        let density = [8, 15, 60, 1000][seed as usize / 3];
        let a = Matrix::random(&mut random, rows, cols, density).spoilt(&mut random, 40);
        let rhs: Vec<f64> = (0..rows * 40).map(|_| random.signed()).collect();
        let name = format!("large, seed {seed}");
        let factor = a.factor(&rhs, 1e-9);
        check(&a, &factor, &rhs, &name);
        assert_eq!(factor.rank, rank(&a, 1e-9), "{name}: rank");
    }
}

#[test]
fn scale_does_not_matter() {
    for seed in 0..300 {
        let (mut a, _) = matrix(seed);
        let rank = a.factor(&[], 0.01).rank;
        for scale in [2.0_f64.powi(900), 2.0_f64.powi(-900)] {
            a.values.iter_mut().for_each(|v| *v *= scale);
            let mut factor = a.factor(&[], 0.01 * scale);
            assert_eq!(factor.rank, rank, "seed {seed}, scale {scale:e}");
            a.values.iter_mut().for_each(|v| *v /= scale);
            factor.r.val.iter_mut().for_each(|v| *v /= scale);
            factor.dropped /= scale;
            check(&a, &factor, &[], &format!("seed {seed}, scale {scale:e}"));
        }
    }
}

#[test]
fn what_is_peeled_by_the_pattern_must_be_above_the_tolerance() {
    let columns: Vec<Vec<(u32, f64)>> =
        vec![vec![(0, 1e-12)], vec![(0, 1e-13)], vec![(0, 2.0)], vec![(0, 1e-12), (1, 3.0)]];
    let a = Matrix::from_columns(2, &columns);
    let factor = a.factor(&[3.0, 4.0], 1e-9);
    assert_eq!((factor.rank, &factor.rest[..]), (2, &[0.0][..]));
    check(&a, &factor, &[3.0, 4.0], "peeled");
    let small = Matrix::from_columns(1, &columns[..2]).factor(&[5.0], 1e-9);
    assert_eq!((small.rank, &small.rest[..]), (0, &[5.0][..]));
    assert!((small.dropped - 1e-12_f64.hypot(1e-13)).abs() < 1e-20);
}
