//! Primes between 2^60 and 2^61, drawn at random.

use std::sync::OnceLock;

use super::field::Field;
use crate::common::SplitMix64;

/// The first twelve primes: the Miller-Rabin test with these bases is exact below 3.3e24 (Sorenson, Webster 2015).
const BASES: [u64; 12] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37];

/// Two different primes in `2^60..2^61`, the same for the same seed; each is as likely as any other.
pub(in crate::diagnosis) fn two(seed: u64) -> [u64; 2] {
    let mut numbers = SplitMix64::new(seed);
    let first = draw(&mut numbers);
    loop {
        let second = draw(&mut numbers);
        if second != first {
            return [first, second];
        }
    }
}

/// Number of primes in the list of [`first`].
const KNOWN: usize = 64;
/// Seed of the list of primes in [`first`].
const SEED: u64 = 0x7072_696d;

/// The first `count` primes of a fixed list of 64 different primes in `2^60..2^61`.
pub(in crate::diagnosis) fn first(count: usize) -> &'static [u64] {
    static ALL: OnceLock<Vec<u64>> = OnceLock::new();
    let make = || {
        let (mut numbers, mut all) = (SplitMix64::new(SEED), Vec::with_capacity(KNOWN));
        while all.len() < KNOWN {
            let prime = draw(&mut numbers);
            if !all.contains(&prime) {
                all.push(prime);
            }
        }
        all
    };
    &ALL.get_or_init(make)[..count.min(KNOWN)]
}

fn draw(numbers: &mut SplitMix64) -> u64 {
    loop {
        let odd = (numbers.next() >> 4) | (1 << 60) | 1;
        if is_prime(odd) {
            return odd;
        }
    }
}

/// Returns true if n is prime; exact for n below 2^62.
pub(in crate::diagnosis) fn is_prime(n: u64) -> bool {
    if n < 2 || BASES.iter().any(|base| n.is_multiple_of(*base)) {
        return BASES.contains(&n);
    }
    let field = Field::new(n);
    BASES.iter().all(|&base| passes(&field, n, base))
}

/// Miller-Rabin test: `base^d = 1` or `base^(d 2^k) = -1` for a k below s, where `n - 1 = d 2^s` and d is odd. True for every prime n.
fn passes(field: &Field, n: u64, base: u64) -> bool {
    let twos = (n - 1).trailing_zeros();
    let (one, minus_one) = (field.of(1), field.of(n - 1));
    let mut power = field.power(field.of(base), (n - 1) >> twos);
    if power == one {
        return true;
    }
    for _ in 0..twos {
        if power == minus_one {
            return true;
        }
        power = field.mul(power, power);
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_primes_are_those_of_the_sieve() {
        let mut composite = vec![false; 20_000];
        for n in 2..composite.len() {
            assert_eq!(is_prime(n as u64), !composite[n], "{n}");
            (2 * n..composite.len()).step_by(n).for_each(|multiple| composite[multiple] = true);
        }
        assert!(!is_prime(0) && !is_prime(1));
    }

    /// Numbers that pass for primes with fewer bases: Carmichael's, and the least that fool the first 4, 8 and 9 bases.
    #[test]
    fn composites_that_fool_weaker_tests_are_found_out() {
        for n in [561, 41_041, 825_265, 3_215_031_751, 341_550_071_728_321, 3_825_123_056_546_413_051] {
            assert!(!is_prime(n), "{n}");
        }
        // Products of two primes of 30 bits.
        assert!(!is_prime(1_073_741_789 * 1_073_741_783));
        assert!(is_prime(1_073_741_789) && is_prime((1 << 61) - 1) && is_prime((1 << 61) - 31));
        assert!(!is_prime((1 << 61) - 3));
    }

    #[test]
    fn drawn_primes_are_two_primes_of_61_bits_that_depend_on_the_seed() {
        let mut seen = Vec::new();
        for seed in 0..200 {
            let primes = two(seed);
            assert!(primes.iter().all(|&p| is_prime(p) && p >> 60 == 1), "{primes:?}");
            assert_eq!(primes, two(seed));
            seen.extend(primes);
        }
        seen.sort_unstable();
        seen.dedup();
        assert_eq!(seen.len(), 400, "none of 2.7e16 is met twice in 400");
    }
}
