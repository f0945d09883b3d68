//! Load cases are analysed separately: their selection and their verdicts.

use serde_json::{Value, json};

use super::harness::Place;

const NODES: &str = "*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n3,2.,0.,0.\n";
const TIE: &str = "*EQUATION\n2\n2,1,1.,3,1,-1.\n";

/// A deck with a tie of 2:1 and 3:1, and the given boundary conditions in its steps.
fn steps(boundaries: &[&str]) -> String {
    let step = |text: &&str| format!("*STEP\n*STATIC\n{text}*END STEP\n");
    format!("{NODES}{TIE}{}", boundaries.iter().map(step).collect::<String>())
}

const QUIET: &str = "";
const REDUNDANT: &str = "*BOUNDARY\n2,1,1,1.\n3,1,1,1.\n";
const CONFLICT: &str = "*BOUNDARY\n2,1,1,1.\n3,1,1,2.\n";

#[test]
fn every_load_case_has_an_entry() {
    let place = Place::new();
    place.file("steps.inp", steps(&[QUIET, QUIET, CONFLICT]));
    let run = place.run("check -q steps.inp --format json");
    let report = run.json();
    assert_eq!((run.code, &report["schema"], &report["status"]), (1, &json!("qless.report/3"), &json!("conflicting")));
    let of = |key: &str| -> Vec<Value> {
        report["cases"].as_array().expect("a list").iter().map(|case| case[key].clone()).collect()
    };
    assert_eq!(of("name"), [json!("step 1"), json!("step 2"), json!("step 3")]);
    assert_eq!(of("status"), [json!("independent"), json!("independent"), json!("conflicting")]);
    assert_eq!(of("rank"), [json!(1), json!(1), json!(0)]);
    assert_eq!(of("same_as"), [Value::Null, json!("step 1"), Value::Null]);
    assert_eq!(of("counts")[2], json!({"independent": 0, "redundant": 0, "conflicting": 1}));
    assert_eq!(of("dependent")[0], json!([]));
    assert_eq!(of("dependent")[2], report["dependent"]);
    let solver = &of("solver")[2];
    assert_eq!(solver["refused"].as_array().map(Vec::len), report["solver"]["refused"].as_array().map(Vec::len));
    for key in ["refused", "implied", "lost", "freed", "unsound", "accepted"] {
        assert!(solver[key].is_array() && report["solver"][key].is_array(), "{key}");
    }
    assert_eq!(report["deck"]["load_case"], "step 3");
    let text = place.run("check -q steps.inp").out;
    for part in [
        "Load cases: 3, shown is step 3.",
        "  step 3: rank 0, 0 redundant, 1 conflicting",
        "  step 1 and step 2: rank 1, 0 redundant, 0 conflicting",
    ] {
        assert!(text.contains(part), "{part}\n{text}");
    }
    // An equation can be independent in one load case and redundant in another.
    place.file("two.inp", steps(&[REDUNDANT, CONFLICT]));
    let report = place.run("check -q two.inp --format json").json();
    assert_eq!(
        (&report["cases"][0]["status"], &report["cases"][1]["status"]),
        (&json!("redundant"), &json!("conflicting"))
    );
}

#[test]
fn one_load_case_can_be_named() {
    let place = Place::new();
    place.file("steps.inp", steps(&[QUIET, CONFLICT]));
    for (choice, code) in [("1", 0), ("2", 1), ("all", 1)] {
        assert_eq!(place.run(&format!("check -q steps.inp --case {choice}")).code, code, "{choice}");
    }
    let run = place.run_words(&["check", "-q", "steps.inp", "--case", "Step 1"]);
    assert!(run.code == 0 && run.out.contains("Load case: step 1 of 2."), "{}", run.out);
    let run = place.run("check -q steps.inp --case 3");
    assert_eq!(run.code, 2);
    assert!(run.err.contains("--case 3: there is no such load case; there are step 1, step 2"), "{}", run.err);
}

#[test]
fn a_reduction_has_to_be_told_which() {
    let place = Place::new();
    place.file("steps.inp", steps(&[QUIET, CONFLICT])).file("same.inp", steps(&[QUIET, QUIET]));
    for choice in ["", " --case all"] {
        let run = place.run(&format!("reduce -q steps.inp -o out{choice}"));
        assert_eq!((run.code, run.out.as_str()), (2, ""));
        let words = "its 2 load cases constrain differently: name one with --case (step 1, step 2)";
        assert!(run.err.contains(words) && !place.path("out").exists(), "{}", run.err);
    }
    assert_eq!(place.run("reduce -q steps.inp -o out --case 2").code, 1);
    assert_eq!(place.run("reduce -q steps.inp -o out --case 1").code, 0);
    assert_eq!(place.run("reduce -q same.inp -o other").code, 0);
}

/// Both ends of a tie prescribed: the values agree at the end, and in between only if they have the same time history.
#[test]
fn values_of_different_amplitudes_conflict() {
    let place = Place::new();
    let ends = |first: &str, second: &str| {
        let nodes = "/PREP7\nN,1,0,0,0\nN,2,1,0,0\nCE,1,0,1,UX,1,2,UX,-1\n";
        format!("{nodes}*DIM,TA,TABLE,2,,,TIME\n*DIM,TB,TABLE,2,,,TIME\nD,1,UX,%{first}%\nD,2,UX,%{second}%\n")
    };
    place.file("same.cdb", ends("TA", "TA")).file("other.cdb", ends("TA", "TB"));
    let run = place.run("check -q same.cdb");
    assert!(run.code == 0 && run.out.contains("1 of 1 equation is redundant"), "{}", run.out);
    let run = place.run("check -q other.cdb");
    assert_eq!(run.code, 1, "{}", run.out);
    assert!(run.out.contains("at times when amplitudes differ: shown for the values"), "{}", run.out);
    let when = place.run("check -q other.cdb --format json").json()["cases"][0]["when"].clone();
    assert!(when.as_str().is_some_and(|when| when.contains("TA")), "{when}");
    assert_eq!(place.run("reduce -q other.cdb -o out").code, 1);
}

#[test]
fn the_page_has_a_table_of_them() {
    let place = Place::new();
    place.file("steps.inp", steps(&[QUIET, CONFLICT]));
    let page = place.run("check -q steps.inp --format html").out;
    assert!(page.contains("id=\"case-rows\"") && page.contains("\"cases\":[{\"name\":\"step 1\""));
}

/// Many faults in many load cases are listed or counted in 24 lines.
#[test]
fn a_full_report_keeps_to_its_lines() {
    let place = Place::new();
    let tie = |k: u32| format!("*EQUATION\n2\n{k},1,1.,{},1,-1.\n2\n{k},1,2.,{},1,-2.\n", k + 1, k + 1);
    let nodes = (1..40).fold(String::new(), |nodes, k| nodes + &format!("{k},{k}.,0.,0.\n"));
    let ties = (1..30).map(tie).collect::<String>();
    let step = |k: u32| {
        format!("*STEP\n*STATIC\n*BOUNDARY\n1,1,1,{k}.\n{},1,1,2.\n*CLOAD\n3,1,1.\n4,1,1.\n*END STEP\n", k + 1)
    };
    let unread = "*MPC\nNOVELTY,1,2\n".repeat(9);
    let all: String = (1..12).map(step).collect();
    place.file("full.inp", format!("*NODE\n{nodes}{ties}{unread}{all}"));
    let out = place.run("check -q full.inp").out;
    assert!(out.lines().count() <= 24, "{}\n{out}", out.lines().count());
    for part in
        ["INCOMPLETE: 9 constraint cards were left out.", "Load cases: 11", "ccx refuses", "Redundant:", "Conflicting:"]
    {
        assert!(out.contains(part), "{part}\n{out}");
    }
}

/// Claims that the solver refuses are reported for every load case.
#[test]
fn the_worst_load_case_is_the_one_that_the_solver_refuses() {
    let place = Place::new();
    let bulk = "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nRBE2,5,1,1,2\nSPC1,1,1,1\nSPC1,2,1,2\nENDDATA\n";
    let deck = format!("SOL 101\nCEND\nSUBCASE 1\n SPC=1\nSUBCASE 2\n SPC=2\nBEGIN BULK\n{bulk}");
    place.file("two.bdf", deck);
    let run = place.run("check -q two.bdf");
    assert_eq!(run.code, 0);
    for part in [
        "shown is subcase 2.",
        "nastran refuses the deck for these reasons:",
        "2:1 is the slave of",
        "Next: `qless clean two.bdf",
    ] {
        assert!(run.out.contains(part), "{part}\n{}", run.out);
    }
    let report = place.run("check -q two.bdf --format json").json();
    assert_eq!(report["deck"]["solver_refuses"], report["solver"]["refused"]);
    assert_eq!(report["solver"]["refused"].as_array().map(Vec::len), Some(1));
    assert!(place.run("check -q two.bdf --case 1").out.contains("Next: nothing to mend."));
}

/// A later step with redundant equations is shown; claims that the solver refuses in another step are listed too.
#[test]
fn what_is_refused_in_a_load_case_that_is_not_shown_is_listed() {
    let place = Place::new();
    place.file("steps.inp", steps(&["*BOUNDARY\n2,1\n", "*BOUNDARY,OP=NEW\n2,1\n3,1\n"]));
    let report = place.run("check -q steps.inp --format json").json();
    assert_eq!(report["deck"]["load_case"], "step 2");
    assert_eq!(report["deck"]["solver_refuses"], report["solver"]["refused"]);
}

#[test]
fn a_deck_without_equations_has_none() {
    let place = Place::new();
    place.file("none.inp", format!("{NODES}*BOUNDARY\n1,1\n"));
    let out = place.run("check -q none.inp").out;
    assert!(out.contains("\nInput: no equations.\n") && !out.contains("0 equations"), "{out}");
}
