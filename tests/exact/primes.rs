//! A matrix that was chosen for one prime gives a wrong rank for this prime only; the second prime detects it.

use qless::exact::{self, ExactRank, Reading};
use qless::{ConstraintSystem, SystemBuilder};

fn typed(system: &ConstraintSystem) -> ExactRank {
    exact::rank(system, Reading::Typed).expect("small")
}

/// The primes of the standard seed.
fn primes() -> [u64; 2] {
    typed(&SystemBuilder::new(1).build().expect("valid")).primes
}

/// Numbers below 2^32 with `a b - c = p`.
fn split(p: u64) -> [f64; 3] {
    let a = p.isqrt() + 1;
    let b = p.div_ceil(a);
    let c = a * b - p;
    assert!([a, b, c].iter().all(|x| *x < 1 << 32));
    [a, b, c].map(|x| x as f64)
}

/// `[1 a; b c]` has the determinant -p, which is 0 modulo p only.
#[test]
fn a_determinant_that_is_one_of_the_primes_is_not_zero() {
    let mut builder = SystemBuilder::new(4);
    for (part, p) in primes().into_iter().enumerate() {
        let [a, b, c] = split(p);
        builder.equation([(2 * part, 1.0), (2 * part + 1, a)], 1.0);
        builder.equation([(2 * part, b), (2 * part + 1, c)], 0.0);
    }
    let exact = typed(&builder.build().expect("valid"));
    assert_eq!((exact.rank, exact.augmented_rank), (4, 4));
    assert!(exact.parts.iter().all(|part| part.rank == 2 && part.solvable));
}

/// `u = a` and `b u = c` contradict by p.
#[test]
fn a_mismatch_that_is_one_of_the_primes_is_a_conflict() {
    for p in primes() {
        let [a, b, c] = split(p);
        let mut builder = SystemBuilder::new(1);
        builder.equation([(0, 1.0)], a);
        builder.equation([(0, b)], c);
        let exact = typed(&builder.build().expect("valid"));
        assert_eq!((exact.rank, exact.augmented_rank, exact.parts[0].solvable), (1, 2, false));
    }
}
