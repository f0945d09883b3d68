//! Decks drawn over all pairs of cards and kinds of elements: refused, dropped and enforced as MYSTRAN does, by its results.

use crate::body::KINDS;
use crate::drawn::{CARDS, DrawnCard, deck};
use crate::judged::{DeckOutcome, judge};
use crate::solver::program;

/// All pairs of cards, each with every kind of element if `is_full`, and otherwise with three of them in turn.
fn jobs(is_full: bool) -> Vec<(u64, &'static str, [DrawnCard; 2])> {
    let pairs = CARDS.iter().enumerate().flat_map(|(i, &a)| CARDS[i..].iter().map(move |&b| [a, b]));
    let kinds =
        |at: usize| (0..if is_full { 9 } else { 3 }).map(move |k| KINDS[(at + k * if is_full { 1 } else { 3 }) % 9]);
    let all = pairs.enumerate().flat_map(|(at, pair)| kinds(at).map(move |kind| (kind, pair)));
    (1..).zip(all).map(|(seed, (kind, pair))| (seed, kind, pair)).collect()
}

#[test]
fn decks_over_all_pairs_of_cards_and_kinds_of_elements() {
    let Some(program) = program() else { return };
    let jobs = jobs(std::env::var_os("QLESS_THOROUGH").is_some());
    let mut outcomes: Vec<DeckOutcome> = Vec::new();
    for (seed, kind, pair) in &jobs {
        if let Ok(o) = std::panic::catch_unwind(|| {
            judge(&program, &deck(*seed, kind, *pair), &format!("seed {seed}, {kind}, {pair:?}"))
        }) {
            outcomes.push(o);
        } // DEBUG
    }
    let share = |counts: fn(&DeckOutcome) -> bool| outcomes.iter().filter(|outcome| counts(outcome)).count();
    let (refused, dependent, left_out) = (share(|o| o.is_refused), share(|o| o.is_dependent), share(|o| o.is_left_out));
    let (held, enforced, cleaned) = (share(|o| o.held > 0), share(|o| o.enforced > 0), share(|o| o.is_cleaned));
    println!(
        "{} decks: {refused} refused, {dependent} dependent, {held} hold equations, {enforced} values, {cleaned} cleaned, {left_out} left out",
        jobs.len()
    );
    assert!(jobs.len() >= 200);
    for count in [refused, dependent, held, enforced, cleaned] {
        assert!(count * 20 >= jobs.len(), "each outcome occurs in at least one deck of twenty");
    }
    assert!(left_out * 10 <= jobs.len(), "most decks are understood");
}
