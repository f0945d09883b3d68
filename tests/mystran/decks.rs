//! Decks drawn over all pairs of cards and kinds of elements: refused, dropped and enforced as MYSTRAN does, by its results.

use crate::body::KINDS;
use crate::drawn::{CARDS, DrawnCard, deck};
use crate::judged::{DeckEnd, DeckOutcome, judge};
use crate::solver::program;

/// A deck to draw: its seed, its kind of elements and its pair of cards.
type DeckJob = (u64, &'static str, [DrawnCard; 2]);

/// All pairs of cards, each with so many kinds of elements, in turn.
fn jobs(kinds: usize) -> Vec<DeckJob> {
    let pairs = CARDS.iter().enumerate().flat_map(|(i, &a)| CARDS[i..].iter().map(move |&b| [a, b]));
    let step = KINDS.len() / kinds;
    let of_pair = |(at, pair)| (0..kinds).map(move |k| (KINDS[(at + k * step) % KINDS.len()], pair));
    (1..).zip(pairs.enumerate().flat_map(of_pair)).map(|(seed, (kind, pair))| (seed, kind, pair)).collect()
}

#[test]
fn decks_over_all_pairs_of_cards_and_kinds_of_elements() {
    let Some(program) = program() else { return };
    let jobs = jobs(if std::env::var_os("QLESS_THOROUGH").is_some() { KINDS.len() } else { 3 });
    let judged = |&(seed, kind, pair): &DeckJob| {
        judge(&program, &deck(seed, kind, pair), &format!("seed {seed}, {kind}, {pair:?}"))
    };
    let outcomes: Vec<DeckOutcome> = jobs.iter().map(judged).collect();
    let count = |is_counted: fn(&DeckOutcome) -> bool| outcomes.iter().filter(|outcome| is_counted(outcome)).count();
    let often = [
        ("refused", count(|outcome| outcome.end == DeckEnd::Refused)),
        ("dependent", count(|outcome| outcome.is_dependent)),
        ("holding equations", count(|outcome| outcome.held > 0)),
        ("holding values", count(|outcome| outcome.enforced > 0)),
        ("cleaned", count(|outcome| outcome.is_cleaned)),
    ];
    let left_out = count(|outcome| outcome.end == DeckEnd::LeftOut);
    println!("{} decks, {left_out} not understood: {often:?}", jobs.len());
    assert!(jobs.len() >= 200);
    for (name, count) in often {
        assert!(count * 20 >= jobs.len(), "only {count} decks are {name}");
    }
    assert!(left_out * 10 <= jobs.len(), "{left_out} decks are not understood");
}
