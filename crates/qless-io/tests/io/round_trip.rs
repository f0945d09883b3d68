//! Random systems read back from their files bit for bit.

use proptest::prelude::*;
use qless::ConstraintSystem;
use qless_io::{read_case, write_case};

/// Finite numbers of all magnitudes, with signed zeros and subnormals.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<u64>().prop_map(f64::from_bits).prop_filter("finite", |x| x.is_finite()),
        Just(-0.0),
        Just(5e-324),
        Just(f64::MAX),
        -9.0..9.0,
    ]
}

/// A valid label: one line, not blank.
fn label() -> impl Strategy<Value = String> {
    r"[#%]?[a-z0-9:,é ]{0,6}[a-z]"
}

fn labels(count: usize) -> impl Strategy<Value = Vec<String>> {
    prop_oneof![Just(Vec::new()), proptest::collection::vec(label(), count)]
}

fn systems() -> impl Strategy<Value = ConstraintSystem> {
    (0_usize..6, 1_usize..8).prop_flat_map(|(m, n)| {
        let places = proptest::collection::btree_map((0..m.max(1), 0..n), number(), 0..=(2 * m));
        let prescribed = proptest::collection::btree_map(0..n, number(), 0..=n);
        let rhs = proptest::collection::vec(number(), m);
        (places, rhs, prescribed, labels(m), labels(n)).prop_map(move |(places, rhs, prescribed, rows, columns)| {
            let entries: Vec<_> = places.into_iter().map(|((i, j), v)| (i, j, v)).collect();
            let prescribed: Vec<_> = prescribed.into_iter().collect();
            ConstraintSystem::from_triplets(m, n, &entries, &rhs, &prescribed)
                .and_then(|system| system.with_labels(rows, columns))
                .expect("finite and in range")
        })
    })
}

fn bits(system: &ConstraintSystem) -> Vec<u64> {
    let prescribed = system.prescribed().iter().map(|&(_, value)| value);
    let numbers = system.matrix().values().iter().chain(system.rhs()).copied().chain(prescribed);
    numbers.map(f64::to_bits).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn write_then_read_is_the_same_system(first in systems(), second in systems()) {
        let place = tempfile::tempdir().expect("a temporary folder");
        let folder = place.path().join("case");
        // The second write replaces the first; no optional file of the first may remain.
        for system in [first, second] {
            write_case(&folder, &system).expect("written");
            let back = read_case(&folder, None, None).expect("read");
            prop_assert_eq!(bits(&back), bits(&system));
            prop_assert_eq!(back, system);
        }
    }
}
