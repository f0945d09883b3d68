//! Sums over ranks are rounded once, whoever has which numbers.

use qless_mpi::{Alone, Ranks, exact_sum, on_threads};
use qless_scenes::Rng;

/// The numbers of a rank: any partition.
fn part(numbers: &[f64], ranks: &dyn Ranks, seed: u64) -> Vec<f64> {
    let mut rng = Rng::new(seed);
    let mut own: Vec<f64> = numbers.iter().copied().filter(|_| rng.below(ranks.size()) == ranks.rank()).collect();
    rng.shuffle(&mut own);
    own
}

fn on_all(numbers: &[f64], seed: u64) -> f64 {
    let alone = exact_sum(&Alone, numbers.iter().copied());
    for size in [1, 2, 3, 4, 7] {
        for sum in on_threads(size, |ranks| exact_sum(ranks, part(numbers, ranks, seed))) {
            assert_eq!(sum.to_bits(), alone.to_bits(), "{size} ranks, seed {seed}");
        }
    }
    alone
}

#[test]
fn sums_are_those_of_whole_numbers() {
    for seed in 0..200 {
        let mut rng = Rng::new(seed);
        // m 2^k 2^shift with m 2^k below 2^113: 128 bits hold the sum, and round it once.
        let whole: Vec<i128> = (0..=rng.below(300))
            .map(|_| {
                let mantissa = (rng.below(1 << 53) as i128) << rng.below(60);
                if rng.below(2) == 0 { mantissa } else { -mantissa }
            })
            .collect();
        let exponent = [0, -300, -1074, 700][seed as usize % 4];
        let scaled = |x: f64| x * 2_f64.powi(exponent / 2) * 2_f64.powi(exponent - exponent / 2);
        let numbers: Vec<f64> = whole.iter().map(|&m| scaled(m as f64)).collect();
        assert_eq!(on_all(&numbers, seed), scaled(whole.iter().sum::<i128>() as f64), "seed {seed}");
    }
}

#[test]
fn what_cancels_leaves_the_rest_to_the_last_bit() {
    for seed in 0..100 {
        let mut rng = Rng::new(seed);
        // Any bits: every size from the smallest to the largest.
        let any = |rng: &mut Rng| {
            let bits = (rng.below(1 << 32) as u64) << 32 | rng.below(1 << 32) as u64;
            Some(f64::from_bits(bits)).filter(|x| x.is_finite()).unwrap_or(1.0)
        };
        let some: Vec<f64> = (0..100).map(|_| any(&mut rng)).collect();
        let rest = any(&mut rng);
        let mut all: Vec<f64> = some.iter().copied().chain(some.iter().map(|x| -x)).chain([rest]).collect();
        rng.shuffle(&mut all);
        assert_eq!(on_all(&all, seed), rest, "seed {seed}");
    }
}

#[test]
fn many_numbers_carry() {
    let mut rng = Rng::new(7);
    let whole: Vec<i128> = (0..200_000).map(|_| rng.below(1 << 53) as i128).collect();
    let numbers: Vec<f64> = whole.iter().map(|&m| m as f64).collect();
    assert_eq!(on_all(&numbers, 7), whole.iter().sum::<i128>() as f64);
    let below: Vec<f64> = numbers.iter().map(|x| -x).collect();
    assert_eq!(on_all(&below, 7), -(whole.iter().sum::<i128>() as f64));
}

#[test]
fn a_tie_is_broken_by_what_stands_far_below() {
    let half = f64::EPSILON / 2.0;
    assert_eq!(on_all(&[1.0, half], 1), 1.0);
    assert_eq!(on_all(&[1.0, half, 1e-300], 1), 1.0 + f64::EPSILON);
    assert_eq!(on_all(&[-1.0, -half, -5e-324], 1), -1.0 - f64::EPSILON);
    assert_eq!(on_all(&[1.0 + f64::EPSILON, half, -5e-324], 1), 1.0 + f64::EPSILON);
}

#[test]
fn beyond_the_largest_number() {
    assert_eq!(on_all(&[f64::MAX, f64::MAX, -f64::MAX], 2), f64::MAX);
    assert_eq!(on_all(&[f64::MAX, f64::MAX], 2), f64::INFINITY);
    assert_eq!(on_all(&[-f64::MAX, -f64::MAX, 1.0], 2), f64::NEG_INFINITY);
    assert_eq!(on_all(&[f64::INFINITY, 1.0], 2), f64::INFINITY);
    assert_eq!(on_all(&[f64::NEG_INFINITY, f64::MAX], 2), f64::NEG_INFINITY);
    assert!(on_all(&[f64::NEG_INFINITY, f64::INFINITY], 2).is_nan());
    assert!(on_all(&[f64::NAN, 1.0], 2).is_nan());
    assert_eq!(on_all(&[], 2), 0.0);
}
