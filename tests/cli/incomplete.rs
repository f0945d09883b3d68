//! Decks with constraint cards that are not understood: no verdict that these cards could change.

use serde_json::json;

use super::harness::Place;

const NODES: &str = "*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n3,2.,0.,0.\n";
const TIE: &str = "*EQUATION\n2\n2,1,1.,3,1,-1.\n";
/// A constraint of an unknown type.
const UNREAD: &str = "*MPC\nNOVELTY,1,2\n";

fn place() -> Place {
    let place = Place::new();
    let conflict = "*STEP\n*STATIC\n*BOUNDARY\n2,1,1,1.\n3,1,1,2.\n*END STEP\n";
    place
        .file("sound.inp", format!("{NODES}{TIE}"))
        .file("alone.inp", format!("{NODES}{UNREAD}"))
        .file("rest.inp", format!("{NODES}{TIE}{UNREAD}"))
        .file("twice.inp", format!("{NODES}{TIE}{TIE}{UNREAD}"))
        .file("conflict.inp", format!("{NODES}{TIE}{UNREAD}{conflict}"));
    place
}

#[test]
fn what_was_left_out_has_a_status_and_an_exit_code_of_its_own() {
    let place = place();
    for (deck, code, allowed, status) in [
        ("sound.inp", 0, 0, "independent"),
        ("alone.inp", 4, 0, "incomplete"),
        ("rest.inp", 4, 0, "incomplete"),
        ("twice.inp", 4, 0, "incomplete"),
        // A conflict does not depend on the unread cards.
        ("conflict.inp", 1, 1, "conflicting"),
    ] {
        let run = place.run(&format!("check -q {deck} --format json"));
        let report = run.json();
        assert_eq!((run.code, &report["status"]), (code, &json!(status)), "{deck}");
        assert_eq!(place.run(&format!("check -q {deck} --allow-incomplete")).code, allowed, "{deck}");
        assert_eq!(report["incomplete"].as_array().map(Vec::len), (deck != "sound.inp").then_some(1), "{deck}");
    }
    // A redundancy does not depend on the unread cards either.
    assert_eq!(place.run("check -q twice.inp --deny redundant").code, 1);
    assert_eq!(place.run("check -q rest.inp --deny redundant").code, 4);
}

#[test]
fn every_report_lists_it() {
    let place = place();
    let text = place.run("check -q rest.inp").out;
    for part in [
        "INCOMPLETE: 1 constraint card was left out. The only equation is independent.",
        "Constraints that were left out:\n  rest.inp:",
        "--allow-incomplete",
    ] {
        assert!(text.contains(part), "{part}\n{text}");
    }
    assert!(
        place
            .run("check -q alone.inp")
            .out
            .starts_with("INCOMPLETE: 1 constraint card was left out. No equation was read.")
    );
    let page = place.run("check -q rest.inp --format html").out;
    assert!(page.contains("\"incomplete\":[\"rest.inp:") && page.contains("INCOMPLETE: 1 constraint"));
    assert!(
        place.run("check --help").out.contains("4  incomplete") || place.run("--help").out.contains("4  incomplete")
    );
}

#[test]
fn nothing_is_reduced_that_lacks_constraints_unless_that_is_allowed() {
    let place = place();
    let run = place.run("reduce -q rest.inp -o out");
    assert_eq!(run.code, 4);
    assert!(run.err.contains("nothing was written to out") && run.err.contains("--allow-incomplete"), "{}", run.err);
    assert!(!place.path("out").exists());
    assert_eq!(place.run("reduce -q rest.inp -o out --allow-incomplete").code, 0);
    assert!(place.path("out/T.mtx").exists());
}

/// Cards that do not constrain are skipped without a message.
#[test]
fn other_unknown_cards_leave_nothing_out() {
    let place = Place::new();
    place.file("other.inp", format!("{NODES}{TIE}*NOVEL OUTPUT\n1\n"));
    assert_eq!(place.run("check -q other.inp").code, 0);
}
