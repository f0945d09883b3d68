//! The forecast bounds what is booked.

use super::{Numbers, run};
use crate::Symbolic;

/// A repeatable number below n.
fn below(state: &mut u64, n: u64) -> u64 {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    (*state >> 33) % n
}

fn random(seed: u64) -> (Symbolic, Vec<f64>, usize) {
    let mut state = (seed + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let (rows, cols) = (below(&mut state, 60) as usize, below(&mut state, 60) as usize);
    let density = 1 + below(&mut state, 30);
    let (mut start, mut index) = (vec![0], Vec::new());
    for _ in 0..cols {
        index.extend((0..rows as u32).filter(|_| below(&mut state, 100) < density));
        start.push(index.len());
    }
    let values = index.iter().map(|_| 0.5 + below(&mut state, 1000) as f64).collect();
    (Symbolic::analyse(rows, cols, &start, &index).expect("a pattern"), values, rows)
}

#[test]
fn bookings_stay_within_the_forecast() {
    for seed in 0..300 {
        let (symbolic, values, rows) = random(seed);
        let rhs = vec![1.0; 2 * rows];
        let count = if rows == 0 { 0 } else { 2 };
        let numbers = |tolerance| Numbers { values: &values, rhs: &rhs, count, tolerance, keep_q: false };
        let (_, most) = run(&symbolic, &numbers(0.0), usize::MAX).expect("a factorization");
        assert!(most <= symbolic.memory(count), "seed {seed}: {most} of {}", symbolic.memory(count));
        let (_, most) = run(&symbolic, &Numbers { keep_q: true, ..numbers(0.0) }, usize::MAX).expect("a factorization");
        let foreseen = symbolic.memory(count) + symbolic.memory_of_q();
        assert!(most <= foreseen, "seed {seed}: {most} of {foreseen} with Q");
        for tolerance in [100.0, 700.0, 1e4] {
            let (_, most) = run(&symbolic, &numbers(tolerance), usize::MAX).expect("a factorization");
            let worst = symbolic.memory_at_worst(count);
            assert!(most <= worst, "seed {seed}: {most} of {worst}");
        }
    }
}
