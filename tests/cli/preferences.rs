//! `--keep`, `--avoid-slaves` and `--prefer-slaves` by numbers, node:component, lines, sets and labels.

use std::fs;

use serde_json::json;

use super::harness::Place;

/// Lines 8 to 13 are three equations; the third is the sum of the others.
const DECK: &str = "*NODE, NSET=ALL\n1,0.,0.,0.\n2,1.,0.,0.\n3,2.,0.,0.\n*NSET, NSET=TOP\n3\n*EQUATION\n2\n1,1,1.,2,1,-1.\n2\n2,1,1.,3,1,-1.\n2\n1,1,1.,3,1,-1.\n";

fn place() -> Place {
    let place = Place::new();
    place.file("ties.inp", DECK);
    let entries = [(1, 1, 1.0), (1, 2, -1.0), (2, 2, 1.0), (2, 3, -1.0), (3, 1, 1.0), (3, 3, -1.0)];
    place.case("case", [3, 3], &entries, &[0.0; 3], &[]);
    place.file("case/rows.txt", "tie A, x\ntie B\ntie C\n").file("case/cols.txt", "left\nmiddle\nright\n");
    place
}

/// The row that is dependent.
fn dependent(place: &Place, input: &str, keep: &str) -> Vec<serde_json::Value> {
    let run = place.run_words(&["check", "-q", input, "--format", "json", "--keep", keep]);
    assert_eq!(run.code, 0, "{keep}: {}", run.err);
    run.json()["dependent"].as_array().expect("a list").iter().map(|equation| equation["row"].clone()).collect()
}

#[test]
fn equations_are_kept_by_any_name() {
    let place = place();
    for (keep, dropped) in [
        ("1,2", 3),
        ("2-3", 1),
        ("line 9,line 11", 3),
        ("line 11,Line 13", 1),
        ("line 9,line 13", 2),
        // The card and the full label.
        ("2:1,line 12 *equation 1:1", 1),
        ("\"line 8 *EQUATION 1:1\",3", 2),
        ("1:1", 2),
    ] {
        assert_eq!(dependent(&place, "ties.inp", keep), [json!(dropped)], "{keep}");
    }
    for (keep, dropped) in [("\"tie A, x\",tie B", 3), ("tie c,TIE B", 1), ("\"tie A, x\",3", 2)] {
        assert_eq!(dependent(&place, "case", keep), [json!(dropped)], "{keep}");
    }
}

/// The slave columns that `reduce` wrote.
fn slaves(place: &Place, input: &str, option: &str, list: &str) -> String {
    let run = place.run_words(&["reduce", "-q", input, "-o", "out", option, list]);
    assert_eq!(run.code, 0, "{list}: {}", run.err);
    fs::read_to_string(place.path("out/slaves.txt")).expect("written")
}

#[test]
fn slaves_are_chosen_by_any_name() {
    let place = place();
    for (option, list, expected) in [
        ("--avoid-slaves", "2", "1\n3\n"),
        ("--avoid-slaves", "2:1", "1\n3\n"),
        ("--avoid-slaves", "top", "1\n2\n"),
        ("--avoid-slaves", "1:1", "2\n3\n"),
        ("--prefer-slaves", "TOP,2:1", "2\n3\n"),
        ("--prefer-slaves", "line 11", "2\n3\n"),
    ] {
        assert_eq!(slaves(&place, "ties.inp", option, list), expected, "{list}");
    }
    assert_eq!(slaves(&place, "case", "--avoid-slaves", "Middle"), "1\n3\n");
}

#[test]
fn words_that_name_nothing_are_named_with_the_nearest() {
    let place = place();
    for (input, option, list, parts) in [
        ("ties.inp", "--avoid-slaves", "TOPP", &["--avoid-slaves: `TOPP`", "did you mean `TOP`?"][..]),
        ("ties.inp", "--avoid-slaves", "1:9", &["`1:9`", "did you mean `1:1`?"]),
        ("ties.inp", "--prefer-slaves", "line 14", &["`line 14`", "the nearest line with a constraint is 12"]),
        ("ties.inp", "--prefer-slaves", "3,xyzzy-q", &["`xyzzy-q` is no label, node set, card or node:component"]),
        ("case", "--prefer-slaves", "midle", &["`midle` is no label", "did you mean `middle`?"]),
        ("case", "--prefer-slaves", "line 1", &["`line 1` is no label"]),
        ("ties.inp", "--keep", "7", &["equation 7, but there are only 3"]),
    ] {
        let run = place.run_words(&["reduce", "-q", input, "-o", "none", option, list]);
        assert_eq!(run.code, 2, "{list}");
        assert!(parts.iter().all(|part| run.err.contains(part)), "{list}: {}", run.err);
    }
    assert!(!place.path("none").exists());
    let run = place.run_words(&["check", "ties.inp", "--keep", "3,,4"]);
    assert!(run.code == 2 && run.err.contains("the list has an empty item"), "{}", run.err);
}

/// A line whose equation a step removes is accepted, but selects nothing.
#[test]
fn removed_equations_are_known() {
    let place = Place::new();
    let step = |text: &str| format!("*STEP\n*STATIC\n{text}*END STEP\n");
    place.file("steps.inp", format!("{DECK}{}{}", step(""), step("*EQUATION, REMOVE\n1,1\n")));
    let run = place.run_words(&["check", "-q", "steps.inp", "--keep", "line 13"]);
    assert_eq!(run.code, 0, "{}", run.err);
}

/// `clean` leaves out what the report calls redundant, in a deck of several steps too, in which a step has fewer equations than the deck.
#[test]
fn clean_keeps_the_same_equations_as_the_report() {
    let place = place();
    let step = |text: &str| format!("*STEP\n*STATIC\n{text}*END STEP\n");
    place.file("steps.inp", format!("{DECK}{}{}", step(""), step("*EQUATION, REMOVE\n1,1\n")));
    for (input, keep, dropped) in [
        ("ties.inp", "line 9,line 11", 12),
        ("ties.inp", "line 11,line 13", 8),
        ("ties.inp", "line 9,line 13", 10),
        ("steps.inp", "line 9,line 11", 12),
    ] {
        let run = place.run_words(&["clean", "-q", input, "-o", "out.inp", "--keep", keep]);
        assert_eq!(run.code, 0, "{keep}: {}", run.err);
        let text = fs::read_to_string(place.path("out.inp")).expect("written");
        assert!(text.contains(&format!("equation of line {dropped} removed")), "{input}, {keep}: {text}");
    }
}
