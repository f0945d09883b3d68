//! Real decks with `*EQUATION` constraints only: the counts are as expected, and cleaning does not change the results of ccx.

use qless::{Options, analyse};
use qless_io::deck;

use super::solver::{cleaned, decks, difference, is_there, solve, stem};

/// A line of expected.csv: the deck and seven of its numbers.
struct Expected {
    name: String,
    equations: usize,
    terms: usize,
    nonzero: usize,
    prescribed: usize,
    rank: Option<usize>,
}

fn expected(line: &str) -> Expected {
    let fields: Vec<&str> = line.split(',').collect();
    let number = |k: usize| fields[k].parse().expect("a number");
    Expected {
        name: fields[0].to_owned(),
        equations: number(1),
        terms: number(2),
        nonzero: number(3),
        prescribed: number(5),
        rank: fields[6].parse().ok(),
    }
}

#[test]
fn real_decks_are_counted_and_solved_as_before() {
    let Some(folder) = decks("plain-equation").filter(|_| is_there()) else { return };
    let list = std::fs::read_to_string(folder.join("expected.csv")).expect("expected.csv");
    let mut same = 0;
    for expected in list.lines().skip(1).map(expected) {
        let path = folder.join(&expected.name).with_extension("inp");
        let name = stem(&path);
        let deck = deck::read(&path).unwrap_or_else(|error| panic!("{error}"));
        let system = deck.model().system(&deck.model().cases()[0]).expect("a system");
        let analysis = analyse(&system, &Options::default()).expect("analysed");
        assert_eq!(deck.model().equations(), expected.equations, "{name}");
        assert_eq!(deck.model().terms(), expected.terms, "{name}");
        assert_eq!(system.prescribed().len(), expected.prescribed, "{name}");
        assert_eq!(analysis.rank(), expected.rank.unwrap_or(expected.equations), "{name}");
        // ccx turns the equations of segmentm into global axes, which gives them more terms.
        assert!(name == "segmentm" || system.matrix().nnz() == expected.nonzero, "{name}");
        let text = cleaned(&deck).unwrap_or_else(|error| panic!("{name}: {error}"));
        if text == *deck.texts()[0] {
            same += 1; // Byte for byte the same deck, so the same results.
            continue;
        }
        let after = solve(&text).unwrap_or_else(|| panic!("{name}: ccx refuses the cleaned deck"));
        let before = solve(&deck.texts()[0]).unwrap_or_else(|| panic!("{name}: ccx refuses the deck itself"));
        assert!(difference(&before, &after) <= 1e-6, "{name}");
    }
    println!("30 decks, {same} of them need no change");
}
