//! Explanations and repairs in the words of the input; `explain` and `diff`.

use serde_json::json;

use super::harness::Place;

/// A chain of four nodes, tied twice in the middle, with a value at each end; line numbers as in the text.
fn chain(place: &Place) {
    let text = "*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n3,2.,0.,0.\n4,3.,0.,0.\n*EQUATION\n2\n2,1,1.,1,1,-1.\n2\n3,1,1.,2,1,-1.\n2\n\
                4,1,1.,3,1,-1.\n*BOUNDARY\n1,1,1\n*STEP\n*STATIC\n*BOUNDARY\n4,1,1,0.25\n*END STEP\n";
    place.file("chain.inp", text);
}

#[test]
fn a_conflict_shows_its_boundary_cards_and_the_cure() {
    let place = Place::new();
    chain(&place);
    let run = place.run("check -q chain.inp");
    assert_eq!(run.code, 1);
    for part in [
        "[1:1 = 0, line 14 *BOUNDARY]",
        "[4:1 = 0.25, line 18 *BOUNDARY]",
        "(line 18)",
        "but 0 is asked (line ",
        "Next: change 4:1 in line 18 *BOUNDARY from 0.25 to 0:\n    cures row ",
        "\nThen run `qless clean chain.inp -o chain-clean.inp`: ccx refuses the deck even without conflicts.\n",
        "Left sides of what was dropped agree to rounding.",
    ] {
        assert!(run.out.contains(part), "`{part}` is not in:\n{}", run.out);
    }
    let report = place.run("check -q chain.inp --format json").json();
    let conflict = &report["dependent"][0];
    let members = conflict["because"].as_array().expect("a list");
    assert_eq!(members.len(), 4, "two ties and two values: {conflict}");
    let value = members.iter().find(|member| member["label"] == "4:1" && member["dof"].is_u64()).expect("the value");
    assert_eq!((&value["value"], &value["place"]), (&json!(0.25), &json!("line 18 *BOUNDARY")));
    assert!(conflict["arithmetic"].as_str().expect("text").contains("0.25 (line 18)"), "{conflict}");
    let first = &report["repairs"][0]["ways"][0][0];
    assert_eq!((&first["label"], &first["from"], &first["to"]), (&json!("4:1"), &json!(0.25), &json!(0.0)));
    assert_eq!(report["repairs"][0]["count"], 5);
}

/// u1 = u2 = u3 in a circle, u4 = u5 twice, and u1 prescribed.
fn circle(place: &Place, folder: &str, value: f64) {
    let ties = [(1, 2), (2, 3), (3, 1), (4, 5), (4, 5)];
    let entries: Vec<_> = (1..).zip(ties).flat_map(|(row, (a, b))| [(row, a, 1.0), (row, b, -1.0)]).collect();
    place.case(folder, [5, 5], &entries, &[0.0; 5], &[(1, value)]);
}

#[test]
fn explain_answers_for_equations_and_dofs() {
    let place = Place::new();
    circle(&place, "circle", 0.5);
    let text = |what: &str| {
        let run = place.run_words(&["explain", "-q", "circle", what]);
        assert_eq!(run.code, 0, "{what}: {}", run.err);
        run.out
    };
    let redundant = (1..=5).map(|row| text(&format!("row {row}"))).filter(|out| out.contains("is redundant"));
    assert_eq!(redundant.count(), 2);
    assert!(text("row 5").contains("row 4") || text("row 4").contains("row 5"));
    assert!(text("column 1").contains("DOF 1 is prescribed: 0.5"));
    let fixed = text("column 3");
    assert!(fixed.contains("DOF 3 is fixed to 0.5") && fixed.contains("[DOF 1 = 0.5]"), "{fixed}");
    assert!(fixed.contains("Leaving out any one of these frees it: the value of DOF 1."), "{fixed}");
    let slaves = [text("column 4"), text("column 5")];
    let said = |what: &str| slaves.iter().filter(|out| out.contains(what)).count();
    assert_eq!((said("is a slave"), said("is a master")), (1, 1), "{slaves:?}");
    for (what, part) in [("7", "say `row 7`"), ("row 9", "from 1 to 5"), ("tie", "no label")] {
        let run = place.run_words(&["explain", "-q", "circle", what]);
        assert!(run.code == 2 && run.err.contains(part), "{what}: {}", run.err);
    }
}

#[test]
fn explain_finds_lines_and_nodes_of_decks() {
    let place = Place::new();
    chain(&place);
    for (what, part) in [
        ("line 18", "4:1 is prescribed: 0.25, line 18 *BOUNDARY"),
        ("4:1", "4:1 is prescribed"),
        ("line 8", "\"line 7 *EQUATION 2:1\""),
        ("2:1", "2:1 is fixed to 0"),
        ("line8", "\"line 7 *EQUATION 2:1\""),
        ("2:ux", "2:1 is fixed to 0"),
        ("*equation", "\"line 11 *EQUATION 4:1\""),
        ("Equation", "\"line 11 *EQUATION 4:1\""),
        ("line 9 *EQUATION 3:1", "\"line 9 *EQUATION 3:1\""),
        ("row 2 \"line 9 *EQUATION 3:1\"", "\"line 9 *EQUATION 3:1\""),
        ("boundary", "4:1 is prescribed"),
        ("2:1 = 0", "2:1 is fixed to 0"),
    ] {
        let run = place.run_words(&["explain", "-q", "chain.inp", what]);
        assert!(run.code == 0 && run.out.contains(part), "{what}: {} {}", run.out, run.err);
    }
    // The name of a set comes before that of a card.
    let text = std::fs::read_to_string(place.path("chain.inp")).expect("a deck");
    place.file("set.inp", text.replace("*EQUATION\n", "*NSET,NSET=EQUATION\n2\n*EQUATION\n"));
    let of_set = place.run_words(&["explain", "-q", "set.inp", "equation"]);
    assert!(of_set.out.contains(" 2:1\"") && !of_set.out.contains(" 4:1\""), "{} {}", of_set.out, of_set.err);
    for (what, part) in [
        (
            "line 16",
            "`line 16` of the deck gives no equation and no DOF of one; the nearest line with a constraint is 14",
        ),
        ("2:3", "2:3: no equation has this DOF"),
        ("2:7", "2:7: no equation has this DOF"),
        ("2:q", "2:q: write the component as a number, or as UX to UZ and ROTX to ROTZ"),
        ("2", "2: say `row 2` for an equation, `column 2` for a DOF, `2:1` for the first DOF of a node"),
    ] {
        let run = place.run_words(&["explain", "-q", "chain.inp", what]);
        assert!(run.code == 2 && run.err.contains(part), "{what}: {} {}", run.out, run.err);
    }
}

#[test]
fn explain_lists_the_repairs_of_a_conflict() {
    let place = Place::new();
    chain(&place);
    let report = place.run("check -q chain.inp --format json").json();
    let row = report["dependent"][0]["row"].as_u64().expect("a row");
    let text = place.run_words(&["explain", "-q", "chain.inp", &format!("row {row}")]).out;
    for part in ["Each of these 5 ways cures it:\n", "\n  change 4:1 in line 18 *BOUNDARY from 0.25 to 0\n"] {
        assert!(text.contains(part), "{part}\n{text}");
    }
    assert_eq!(text.matches("\n  change ").count(), 5, "{text}");
    let json = place.run_words(&["explain", "-q", "chain.inp", &format!("row {row}"), "--format", "json"]).out;
    let answers: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    let answer = &answers["answers"][0];
    assert_eq!((&answer["verdict"], &answer["row"]), (&json!("conflicting"), &json!(row)));
    assert_eq!((&answer["because"], &answer["repairs"]), (&report["dependent"][0]["because"], &report["repairs"]));
    // Each member is needed, and ties have no rounding.
    assert_eq!((&answer["because_error"], answer.get("because_irreducible")), (&json!(0.0), None));
}

#[test]
fn explain_says_what_the_solver_does() {
    let place = Place::new();
    let nodes = "*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n3,0.,1.,0.\n4,0.,0.,1.\n*NSET,NSET=A\n2\n";
    let body = |node: u32| format!("*RIGID BODY,NSET=A,REF NODE={node},ROT NODE=1\n");
    place.file("bodies.inp", format!("{nodes}{}{}", body(3), body(4)));
    place.file("claim.inp", format!("{nodes}*EQUATION\n2\n2,1,1.,1,1,-1.\n*BOUNDARY\n2,1,1\n"));
    for (deck, what, part, count) in [
        (
            "bodies.inp",
            "line 9",
            "ccx drops this equation of line 9 *RIGID BODY in every step, although what it keeps does not imply it.",
            3,
        ),
        ("bodies.inp", "2:3", "2:3 is the slave of line 8 *RIGID BODY, and of line 9 *RIGID BODY: ccx drops", 1),
        ("bodies.inp", "3:1", "ccx", 0),
        (
            "claim.inp",
            "2:1",
            "2:1 is the slave of line 9 *EQUATION, and prescribed in line 12 *BOUNDARY: ccx stops.",
            1,
        ),
        ("claim.inp", "line 10", "prescribed in line 12 *BOUNDARY: ccx stops.", 1),
    ] {
        let run = place.run_words(&["explain", "-q", deck, what]);
        assert_eq!((run.code, run.out.matches(part).count()), (0, count), "{deck} {what}: {} {}", run.out, run.err);
    }
}

#[test]
fn only_options_with_an_effect_are_offered() {
    let place = Place::new();
    circle(&place, "a", 0.5);
    circle(&place, "b", 0.25);
    for options in ["--format sarif", "--format html", "--deny redundant", "--allow-incomplete"] {
        for command in ["explain a row-1", "diff a b"] {
            let run = place.run(&format!("{command} {options}"));
            assert_eq!((run.code, run.out.as_str()), (2, ""), "{command} {options}");
        }
    }
    assert_eq!(place.run("diff a b --keep 1").code, 2);
    let run = place.run("diff -q a b --format json");
    let answer: serde_json::Value = serde_json::from_str(&run.out).expect("JSON");
    let set = |file: &str, value: &str| json!({"file": file, "conflicting": false, "not_implied": [format!("DOF 1 = {value}")]});
    assert_eq!((run.code, &answer["same"]), (1, &json!(false)));
    assert_eq!(answer["sets"], json!([set("a", "0.5"), set("b", "0.25")]));
}

#[test]
fn diff_names_what_tells_two_sets_apart() {
    let place = Place::new();
    circle(&place, "a", 0.5);
    circle(&place, "b", 0.25);
    // The same as `a` in other equations.
    place.case(
        "c",
        [3, 5],
        &[(1, 1, 2.0), (1, 3, -2.0), (2, 2, 1.0), (2, 3, -1.0), (3, 5, 1.0), (3, 4, -1.0)],
        &[0.0; 3],
        &[(1, 0.5)],
    );
    place.case("d", [2, 5], &[(1, 1, 1.0), (1, 3, -1.0), (2, 2, 1.0), (2, 3, -1.0)], &[0.0; 2], &[(1, 0.5)]);
    let same = place.run("diff -q a c");
    assert_eq!((same.code, same.out.as_str()), (0, "Both sets have the same solutions.\n"));
    // Labels that differ in capitals only are different DOFs if a set has both.
    place.file("case.rel", "1 u - 1 U = 0\n1 u - 1 v = 0\n").file("one.rel", "1 u - 1 v = 0\n");
    assert_eq!(place.run("diff -q case.rel one.rel").code, 1);
    // A list names the label as written, and any case of it only if no label is written so.
    let (small, capital) = (place.run("explain -q case.rel u").out, place.run("explain -q case.rel U").out);
    assert!(!small.contains('U') && capital.starts_with("U ") && !capital.contains("\nu "), "{small}\n{capital}");
    // Sets that agree to the tolerance, but not to rounding, are the same with a doubt.
    place.file("near.rel", "1 u - 1.000000000001 v = 0\n");
    let near = place.run("diff -q one.rel near.rel");
    assert!(near.code == 0 && near.out.starts_with("Both sets have the same solutions.\nAMBIGUOUS: "), "{}", near.out);
    let json = place.run("diff -q one.rel near.rel --format json").out;
    assert!(json.contains("\"ambiguous\": true"), "{json}");
    let values = place.run("diff -q a b");
    assert_eq!(values.code, 1);
    assert!(values.out.contains("a adds 1 relation to the other:\n  DOF 1 = 0.5\n"), "{}", values.out);
    let fewer = place.run("diff -q a d");
    assert!(fewer.code == 1 && fewer.out.contains("row 4\n") && !fewer.out.contains("d adds"), "{}", fewer.out);
    // A large value hides no difference, and values on DOFs without equations count.
    place.case("large", [2, 4], &[(1, 1, 1.0), (1, 2, -1.0), (2, 3, 1.0), (2, 4, 1.0)], &[1e13, 1.0], &[]);
    place.case("alone", [1, 4], &[(1, 1, 1.0), (1, 2, -1.0)], &[1e13], &[]);
    assert!(place.run("diff -q large alone").out.ends_with("to the other:\n  row 2\n"));
    let tied = |value: &str| format!("*NODE\n1,0,0,0\n2,1,0,0\n*BOUNDARY\n1,1,1{value}\n2,1,1{value}\n");
    place.file("values.inp", tied("")).file("other.inp", tied(",5."));
    place.file("tied.inp", tied("") + "*EQUATION\n2\n1,1,1.,2,1,-1.\n");
    assert_eq!(["tied", "other"].map(|name| place.run(&format!("diff -q values.inp {name}.inp")).code), [0, 1]);
    let more = place.run("diff -q d a");
    assert!(more.code == 1 && more.out.contains("a adds 1 relation to the other"), "{}", more.out);
}

#[test]
fn many_redundant_equations_are_read_by_origin() {
    let place = Place::new();
    let ties: Vec<_> = (1..=120).flat_map(|row| [(row, row % 3 + 1, 1.0), (row, row % 3 + 4, -1.0)]).collect();
    place.case("many", [120, 6], &ties, &[0.0; 120], &[]);
    let names: Vec<String> =
        (1..=120).map(|row| format!("{} {row}, x", if row % 2 == 0 { "tie" } else { "body" })).collect();
    place.file("many/rows.txt", names.join("\n"));
    let text = place.run("check -q many").out;
    assert!(text.contains("so are 5") && text.contains("\"tie #, x\"") && text.contains("\"body #, x\""), "{text}");
    let report = place.run("check -q many --format json").json();
    let groups = report["groups"].as_array().expect("a list");
    let rows: usize = groups.iter().map(|group| group["rows"].as_array().expect("rows").len()).sum();
    assert_eq!((groups.len(), rows), (2, 117));
}
