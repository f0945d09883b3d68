//! The output of `check` in both forms, and its exit codes.

use serde_json::{Value, json};

use super::harness::{Place, Run, lines};

const KEYS: [&str; 14] = [
    "schema",
    "input",
    "status",
    "rank",
    "counts",
    "dependent",
    "groups",
    "generated_boundary_conditions",
    "effort",
    "promise",
    "confidence",
    "presolve",
    "backend",
    "timings_ms",
];

fn keys(value: &Value) -> Vec<&str> {
    let mut keys: Vec<&str> = value.as_object().expect("an object").keys().map(String::as_str).collect();
    keys.sort_unstable();
    keys
}

fn sorted<const N: usize>(mut keys: [&str; N]) -> Vec<&str> {
    keys.sort_unstable();
    keys.to_vec()
}

#[test]
fn every_key_of_the_contract_is_there() {
    let report = Place::new().paper("case", 1.0).run("check case --format json").json();
    assert_eq!(keys(&report), sorted(KEYS));
    assert_eq!(report["schema"], "qless.report/3");
    assert_eq!(report["input"], json!({"rows": 3, "dofs": 3, "nnz": 9, "free": 3, "prescribed": 0}));
    assert_eq!(keys(&report["confidence"]), sorted(["digits_kept", "digits_dropped", "ambiguous", "doubt"]));
    assert_eq!(keys(&report["backend"]), ["name", "threads", "version"]);
    assert_eq!(keys(&report["timings_ms"]), sorted(["read", "presolve", "factor", "classify", "reduce", "total"]));
    for key in ["core_rows", "core_dofs", "blocks", "largest_block", "rows_found_dependent"] {
        assert!(report["presolve"][key].is_u64(), "{key}");
    }
}

#[test]
fn the_paper_s_equation_14_is_the_sum_of_the_other_two() {
    for options in ["", "--no-presolve", "--backend gauss", "--paper-tolerance", "--threads 2 -q"] {
        let run = Place::new().paper("case", 1.0).run(&format!("check case --format json {options}"));
        let report = run.json();
        assert_eq!((run.code, &report["status"], &report["rank"]), (0, &json!("redundant"), &json!(2)));
        assert_eq!(report["counts"], json!({"independent": 2, "redundant": 1, "conflicting": 0}));
        let equation = &report["dependent"][0];
        assert_eq!((&equation["row"], &equation["kind"]), (&json!(3), &json!("redundant")), "{options}");
        assert_because(equation, &[(1, 1.0), (2, 1.0)]);
    }
}

#[test]
fn with_another_right_hand_side_it_conflicts() {
    let place = Place::new();
    let run = place.paper("case", 0.0).run("check case --format json");
    let report = run.json();
    assert_eq!((run.code, &report["status"]), (1, &json!("conflicting")));
    let equation = &report["dependent"][0];
    assert_eq!(equation["kind"], "conflicting");
    assert!((equation["mismatch"].as_f64().expect("a number") + 1.0).abs() < 1e-12);
    assert_because(equation, &[(1, 1.0), (2, 1.0)]);

    let text = place.run("check case");
    assert_eq!(text.code, 1);
    for part in [
        "1 of 3 equations conflicts; the rest (2) are independent.",
        "row 3 = 1 * row 1 + 1 * row 2",
        "1 (row 1), but 0 is asked (row 3)",
    ] {
        assert!(text.out.contains(part), "`{part}` is not in: {}", text.out);
    }
}

fn assert_because(equation: &Value, expected: &[(u64, f64)]) {
    let because = equation["because"].as_array().expect("a list");
    assert_eq!(because.len(), expected.len(), "{equation}");
    for (term, &(row, coefficient)) in because.iter().zip(expected) {
        assert_eq!((&term["row"], &term["label"]), (&json!(row), &json!(format!("row {row}"))));
        assert!((term["coefficient"].as_f64().expect("a number") - coefficient).abs() < 1e-12, "{term}");
    }
    assert!(equation.get("because_omitted").is_none());
}

#[test]
fn labels_and_generated_boundary_conditions_are_reported_from_1() {
    let place = Place::new();
    // u1 - u2 = 0.5 with u2 prescribed 2 fixes u1; u3 - u4 = 0 fixes nothing.
    place.case("case", [2, 4], &[(1, 1, 1.0), (1, 2, -1.0), (2, 3, 1.0), (2, 4, -1.0)], &[0.5, 0.0], &[(2, 2.0)]);
    place.file("case/rows.txt", "tie A\ntie B\n").file("case/cols.txt", "7:x\n8:x\n9:x\n10:x\n");
    let report = place.run("check case --format json").json();
    assert_eq!(report["input"], json!({"rows": 2, "dofs": 4, "nnz": 4, "free": 3, "prescribed": 1}));
    let value = json!({"dof": 2, "label": "8:x", "value": 2.0, "coefficient": 1.0});
    let because = json!([{"row": 1, "label": "tie A", "coefficient": 1.0}, value]);
    let expected = json!([{"dof": 1, "label": "7:x", "value": 2.5, "because": because}]);
    assert_eq!(report["generated_boundary_conditions"], expected);
    assert!(place.run("check case").out.contains("7:x = 2.5"));
}

#[test]
fn a_certificate_that_is_too_long_is_left_out_and_counted() {
    let place = Place::new();
    // More terms than the limit of a report, 1,000,000.
    assert_eq!(place.run("generate cycle --nodes 1200000 -o ring").code, 0);
    let report = place.run("check ring --format json").json();
    let ring = &report["dependent"][0];
    assert_eq!((&ring["because"], &ring["because_omitted"]), (&json!([]), &json!(1_199_999)));
    let text = place.run("check ring").out;
    assert!(text.contains("row 1200000 = -1 * row 1") && text.contains("+ ... and 11999"), "{text}");
}

#[test]
fn redundant_equations_can_be_denied() {
    let place = Place::new();
    place.paper("redundant", 1.0).case("independent", [1, 2], &[(1, 1, 1.0), (1, 2, -1.0)], &[0.0], &[]);
    let before = place.everything();
    assert_eq!(place.run("check redundant").code, 0);
    assert_eq!(place.run("check redundant --deny redundant").code, 1);
    assert_eq!(place.run("reduce redundant --deny redundant -o out").code, 1);
    assert_eq!(place.run("check independent --deny redundant").code, 0);
    assert!(place.everything() == before);
}

#[test]
fn every_gate_denies_what_it_names() {
    let place = Place::new();
    place.paper("redundant", 1.0);
    for (list, code) in [("ambiguous,refused", 0), ("incomplete,dropped,lost", 0), ("ambiguous,redundant", 1)] {
        let run = place.run(&format!("check -q redundant --deny {list}"));
        assert_eq!((run.code, run.err.contains("found what --deny names: 1 redundant equation")), (code, code == 1));
    }
    // 2:1 is the slave of the equation, and prescribed: ccx drops the value or refuses the deck.
    place.file(
        "claim.inp",
        "*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n*EQUATION\n2\n2,1,1.,1,1,-1.\n*BOUNDARY\n2,1,1\n*STEP\n*STATIC\n*END STEP\n",
    );
    assert_eq!(place.run("check -q claim.inp").code, 0);
    assert_eq!(place.run("check -q claim.inp --deny refused,dropped").code, 1);
    place.file("unread.bdf", "BEGIN BULK\nGRID,1\nRSPLINE,7,,1,2,123\nENDDATA\n");
    let codes = ["", " --allow-incomplete", " --allow-incomplete --deny incomplete"];
    assert_eq!(codes.map(|options| place.run(&format!("check -q unread.bdf{options}")).code), [4, 0, 1]);
    assert_eq!(place.run("check redundant --deny nonsense").code, 2);
}

/// Pairs of DOFs tied up to 500 times, with very long names; the last tie conflicts if `gap` is not 0.
fn crowded(place: &Place, gap: f64) -> Run {
    let row = |i: usize| [(i + 1, i % 4 + 1, 1.0 + i as f64), (i + 1, i % 4 + 5, -1.0 - i as f64)];
    let entries: Vec<_> = (0..504).flat_map(row).collect();
    let b: Vec<f64> = (0..504).map(|i| if i >= 500 { gap } else { 0.0 }).collect();
    let long = |what: &str, count: usize| {
        lines((1..=count).map(|k| format!("{what} {} number {k} \u{7bc0}\u{70b9}\t!\n", "very ".repeat(30))))
    };
    place.case("crowded", [504, 8], &entries, &b, &[(1, 2.0)]);
    place.file("crowded/rows.txt", long("tie", 504)).file("crowded/cols.txt", long("node", 8));
    place.run("check crowded --effort exact")
}

#[test]
fn the_text_report_fits_a_screen_whatever_the_input() {
    let place = Place::new();
    let scenes = ["figure-6", "near", "rve --n 3", "planted --conflict", "cycle --gap 1", "rbe2 --masters 2"];
    let mut runs = vec![crowded(&place, 0.0), crowded(&place, 1.0)];
    for (k, scene) in scenes.iter().enumerate() {
        assert_eq!(place.run(&format!("generate {scene} -o scene{k}")).code, 0, "{scene}");
        runs.push(place.run(&format!("check scene{k}")));
        runs.push(place.run(&format!("check scene{k} --effort exact")));
        runs.push(place.run(&format!("reduce scene{k} -o reduced{k}")));
    }
    for run in runs {
        assert!(run.out.lines().count() <= 26, "{} lines:\n{}", run.out.lines().count(), run.out);
        assert!(!run.out.contains(['\t', '\u{2026}']) && !run.out.contains("NaN"), "{}", run.out);
    }
}

#[test]
fn the_text_report_says_how_much_it_leaves_out() {
    let text = crowded(&Place::new(), 0.0).out;
    assert!(text.starts_with("500 of 504 equations are redundant; the rest (4) are independent."), "{text}");
    assert!(text.contains("so are 499 more"), "{text}");
}

#[test]
fn help_and_version_succeed() {
    for (arguments, part) in [
        ("--help", "Exit codes"),
        ("check --help", "--paper-tolerance"),
        ("check --help", "--effort"),
        ("reduce --help", "u_s = C_S^-1 (b - C_M u_q - C_p u_p)"),
        ("reduce --help", "As factors where it would have more than 4096 numbers"),
        ("generate --help", "fssi"),
        ("--version", env!("CARGO_PKG_VERSION")),
        ("--version", "faer"),
        ("--version", if cfg!(feature = "spqr") { "GPL" } else { "not compiled in" }),
    ] {
        let run = Place::new().run(arguments);
        assert!(run.code == 0 && run.out.contains(part), "{arguments}: {}", run.out);
    }
}

#[test]
fn preferences_choose_what_is_dependent_and_what_is_a_slave() {
    let place = Place::new();
    place.paper("case", 1.0);
    let kept = place.run("check case --format json --keep 3").json();
    assert_eq!(kept["dependent"][0]["row"], 1);
    assert!(kept.get("unmet_preferences").is_none(), "all is met");
    let forced = place.run("reduce case -o out --format json --keep 1-3 --avoid-slaves 1,2,3").json();
    assert_eq!(forced["unmet_preferences"], json!({"equations": [3], "masters": [1, 2], "slaves": []}));
    let text = place.run("reduce case -o out --avoid-slaves 1,2,3").out;
    assert!(text.contains("Not met: columns 1, 2 are slaves anyway"), "{text}");
}

#[test]
fn lists_that_name_nothing_are_refused() {
    let place = Place::new();
    place.paper("case", 1.0);
    for (options, said) in [
        ("check case --keep 7", "names equation 7, but there are only 3"),
        ("check case --keep 0", "`0`: numbers count from 1"),
        ("check case --keep 9-3", "write 3-9"),
        ("reduce case -o out --avoid-slaves 1 --prefer-slaves 1", "DOF 1 is in --prefer-slaves and in --avoid-slaves"),
    ] {
        let run = place.run(options);
        assert!(run.code == 2 && run.err.contains(said) && run.out.is_empty(), "{options}: {}", run.err);
    }
}
