//! Several inputs in one run, and the documents of pipelines: JSON lists, SARIF and JUnit.

use serde_json::Value;

use super::harness::Place;
use crate::schema::violations;

const GOOD: &str = "*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n*EQUATION\n2\n1,1,1.,2,1,-1.\n";
/// The second equation is twice the first with another right-hand side, which the boundaries give; the third line has a comment.
const BAD: &str =
    "*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n** <a & \"b\">\n*EQUATION\n2\n1,1,1.,2,1,-1.\n*BOUNDARY\n1,1\n2,1,1,0.5\n";

fn place() -> Place {
    let place = Place::new();
    place.file("good.inp", GOOD).file("bad.inp", BAD).file("none.inp", "nothing\n");
    place
}

const SUMMARY: &str =
    "3 inputs: nothing to mend in 1\n  bad.inp: 1 conflicting equation, 1 refused claim\n  none.inp: not checked\n";

#[test]
fn the_worst_input_decides_and_every_input_has_its_report() {
    let place = place();
    for (inputs, code) in [
        ("good.inp good.inp", 0),
        ("good.inp bad.inp", 1),
        ("bad.inp good.inp", 1),
        ("bad.inp none.inp good.inp", 2),
        ("none.inp", 2),
    ] {
        for format in ["text", "json", "sarif", "junit"] {
            let run = place.run(&format!("check -q {inputs} --format {format}"));
            assert_eq!(run.code, code, "{inputs} {format}: {}", run.err);
        }
    }
    let run = place.run("check -q bad.inp none.inp good.inp");
    let headings: Vec<&str> = run.out.lines().filter(|line| line.starts_with("== ")).collect();
    assert_eq!(headings, ["== bad.inp", "== none.inp", "== good.inp"]);
    assert!(run.out.contains("Not checked: none.inp"), "{}", run.out);
    assert!(run.err.ends_with(SUMMARY), "{}", run.err);
}

#[test]
fn json_is_a_list_of_reports_that_follow_the_schema() {
    let place = place();
    let run = place.run("check -q bad.inp none.inp good.inp --format json");
    let list: Vec<Value> = serde_json::from_str(&run.out).expect("a list");
    let files: Vec<_> = list.iter().map(|report| report["file"].as_str().expect("a name")).collect();
    assert_eq!(files, ["bad.inp", "none.inp", "good.inp"]);
    assert_eq!((list[1]["code"].as_u64(), list[1]["error"].is_string()), (Some(2), true));
    for report in [&list[0], &list[2]] {
        assert_eq!(violations(report), [""; 0]);
    }
}

#[test]
fn sarif_has_the_lines_of_findings_and_of_their_causes() {
    let place = place();
    let sarif = |arguments: &str| -> Value {
        serde_json::from_str(&place.run(&format!("check -q {arguments} --format sarif")).out).expect("JSON")
    };
    let document = sarif("bad.inp none.inp");
    assert_eq!(document["version"], "2.1.0");
    let runs = document["runs"].as_array().expect("runs");
    let conflict = &runs[0]["results"][0];
    assert_eq!((conflict["ruleId"].as_str(), conflict["level"].as_str()), (Some("conflicting"), Some("error")));
    let line = |location: &Value| location["physicalLocation"]["region"]["startLine"].as_u64();
    assert_eq!(line(&conflict["locations"][0]), Some(6));
    let causes: Vec<_> = conflict["relatedLocations"].as_array().expect("causes").iter().map(line).collect();
    assert_eq!(causes, [Some(9), Some(10)]);
    let rules = runs[0]["tool"]["driver"]["rules"].as_array().expect("rules");
    assert!(rules.iter().any(|rule| rule["id"] == conflict["ruleId"]));
    assert_eq!(runs[1]["invocations"][0]["executionSuccessful"], false);
    // A gate makes an error of a warning.
    let twice = format!("{GOOD}2\n2,1,1.,1,1,-1.\n");
    place.file("twice.inp", twice);
    let level = |document: &Value| {
        let results = document["runs"][0]["results"].as_array().expect("results").clone();
        results.iter().find(|result| result["ruleId"] == "redundant").expect("found")["level"].clone()
    };
    assert_eq!(level(&sarif("twice.inp")), "note");
    assert_eq!(level(&sarif("twice.inp --deny redundant")), "error");
}

#[test]
fn claims_have_both_of_their_cards_and_conflicts_their_cure() {
    let place = place();
    // 1:1 is the slave of an equation, and prescribed in an included file.
    place.file("claim.inp", format!("{GOOD}*INCLUDE,INPUT=bc.inc\n*STEP\n*STATIC\n*END STEP\n"));
    place.file("bc.inc", "** supports\n*BOUNDARY\n1,1,1\n");
    let document: Value =
        serde_json::from_str(&place.run("check -q claim.inp bad.inp --format sarif").out).expect("JSON");
    let results = |run: usize| document["runs"][run]["results"].as_array().expect("results").clone();
    let refused = results(0).into_iter().find(|result| result["ruleId"] == "refused").expect("found");
    let place_of = |location: &Value| {
        let physical = &location["physicalLocation"];
        (physical["artifactLocation"]["uri"].clone(), physical["region"]["startLine"].clone())
    };
    assert_eq!(place_of(&refused["locations"][0]), ("claim.inp".into(), 5.into()));
    assert_eq!(refused["relatedLocations"].as_array().map(Vec::len), Some(1), "{refused}");
    assert_eq!(place_of(&refused["relatedLocations"][0]), ("bc.inc".into(), 3.into()));
    let cure = "; cure: change 2:1 in line 10 *BOUNDARY from 0.5 to 0 (2 other ways cure too)";
    let message = results(1)[0]["message"]["text"].clone();
    assert!(message.as_str().is_some_and(|text| text.ends_with(cure)), "{message}");
    let junit = place.run("check -q bad.inp --format junit").out;
    assert!(junit.contains(&format!("{cure}</failure>")), "{junit}");
}

#[test]
fn junit_fails_what_the_exit_code_fails_and_escapes_names() {
    let place = place();
    place.file("a & <b>.inp", BAD);
    let run = place.run_words(&["check", "-q", "a & <b>.inp", "none.inp", "good.inp", "--format", "junit"]);
    let text = &run.out;
    assert_eq!(text.matches("<testsuite ").count(), 3);
    assert_eq!((text.matches("<failure ").count(), text.matches("<error ").count()), (1, 1));
    assert!(text.contains("name=\"a &amp; &lt;b&gt;.inp\" tests=\"8\" failures=\"1\""), "{text}");
    assert_eq!(text.matches('<').count(), text.matches('>').count(), "{text}");
}

#[test]
fn options_of_one_input_are_refused_for_several() {
    let place = place();
    for options in ["--rhs b.txt", "--prescribed p.txt", "--format html", "--format vtu -o a.vtu"] {
        let run = place.run(&format!("check -q good.inp bad.inp {options}"));
        assert_eq!((run.code, run.out.as_str()), (2, ""), "{options}: {}", run.err);
    }
    assert_eq!(place.run_fed("check -q - -", b"").code, 2);
    // No output replaces an input, the second one included.
    assert_eq!(place.run("check -q good.inp bad.inp -o bad.inp").code, 2);
    assert_eq!(std::fs::read_to_string(place.path("bad.inp")).expect("there"), BAD);
}
