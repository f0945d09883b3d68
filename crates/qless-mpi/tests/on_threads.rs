//! Ranks within one process exchange the expected messages, and their traffic is counted.

mod rounds;

use qless_mpi::{Alone, on_threads};
use rounds::play::play;

#[test]
fn random_rounds() {
    for size in [1, 2, 3, 4, 7, 16] {
        let told = on_threads(size, |ranks| play(ranks, 23, 1000));
        assert!(told.iter().all(|line| *line == told[0]), "{told:?}");
        assert!(told[0].starts_with(&format!("{size} ranks, 1000 rounds")), "{told:?}");
    }
}

#[test]
fn one_rank_alone_says_the_same() {
    assert_eq!([play(&Alone, 5, 1000)], on_threads(1, |ranks| play(ranks, 5, 1000))[..]);
}

#[test]
#[should_panic(expected = "on purpose")]
fn a_panic_ends_all() {
    on_threads(3, |ranks| {
        assert!(ranks.rank() != 0, "on purpose");
        ranks.exchange(Vec::new())
    });
}
