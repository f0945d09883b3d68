//! `check --effort exact`: the rank of the numbers as typed, in every form of the report.

use serde_json::json;

use super::harness::{HEADER, Place, Run};

/// Writes C, b and the prescribed values as typed: rows of numbers with the right-hand side last, and `column value` lines.
fn typed(place: &Place, folder: &str, rows: &[&str], prescribed: &str) {
    let rows: Vec<Vec<&str>> = rows.iter().map(|row| row.split_whitespace().collect()).collect();
    let columns = rows[0].len() - 1;
    let mut entries = Vec::new();
    for (i, row) in rows.iter().enumerate() {
        let entry = |(j, number): (usize, &&str)| format!("{} {} {number}\n", i + 1, j + 1);
        entries.extend(row[..columns].iter().enumerate().filter(|(_, number)| **number != "0").map(entry));
    }
    let matrix = format!("{HEADER}{} {columns} {}\n{}", rows.len(), entries.len(), entries.concat());
    let b: Vec<String> = rows.iter().map(|row| format!("{}\n", row[columns])).collect();
    place.file(&format!("{folder}/C.mtx"), matrix).file(&format!("{folder}/b.txt"), b.concat());
    place.file(&format!("{folder}/prescribed.txt"), prescribed);
}

fn assert_says(run: &Run, parts: &[&str]) {
    for part in parts {
        assert!(run.out.contains(part), "`{part}` is not in: {}{}", run.out, run.err);
    }
}

/// `u_(i-1) + 4 u_i + u_(i+1) = 0` with `u_1` and `u_2` prescribed: each equation gives the next DOF, so the rank is full.
fn recurrence(place: &Place) {
    let rows = 40;
    let entries: Vec<_> = (1..=rows).flat_map(|i| [(i, i, 1.0), (i, i + 1, 4.0), (i, i + 2, 1.0)]).collect();
    place.case("recurrence", [rows, rows + 2], &entries, &[0.0; 40], &[(1, 0.0), (2, 1.0)]);
}

#[test]
fn without_the_option_there_is_no_word_of_it() {
    let place = Place::new();
    place.paper("case", 1.0);
    assert!(place.run("check case --format json").json().get("exact_rank").is_none());
    assert!(!place.run("check case").out.contains("xact"));
}

#[test]
fn where_both_agree_one_line_says_so() {
    let place = Place::new();
    place.paper("case", 1.0);
    typed(&place, "tenths", &["0.1 1 0.1", "0.2 2 0.2", "0.3 3 0.3"], "");
    let run = place.run("check case --effort exact");
    assert_eq!(run.code, 0);
    assert_says(&run, &["\nExact arithmetic on the numbers as typed: rank 2 of 3, as in floating point.\n"]);
    assert_eq!(run.out.lines().count(), place.run("check case").out.lines().count() + 2);

    let exact = &place.run("check tenths --effort exact --format json").json()["exact_rank"];
    let primes: Vec<u64> = exact["primes"]
        .as_array()
        .expect("a list")
        .iter()
        .map(|p| p.as_str().and_then(|p| p.parse().ok()).expect("text"))
        .collect();
    assert!(primes.len() == 2 && primes.iter().all(|p| p >> 60 == 1));
    let expected = json!({"reading": "typed", "rank": 1, "augmented_rank": 1, "solvable": true,
        "error_chance": 0.0, "primes": exact["primes"], "differences": []});
    assert_eq!(exact, &expected);
}

#[test]
fn the_exact_rank_of_a_recurrence_is_full() {
    let place = Place::new();
    recurrence(&place);
    let report = place.run("check recurrence --effort exact --format json").json();
    let exact = &report["exact_rank"];
    assert_eq!((&exact["rank"], &exact["augmented_rank"], &exact["solvable"]), (&json!(40), &json!(40), &json!(true)));
    // The text states whether the exact rank is that of the analysis.
    let text = place.run("check recurrence --effort exact");
    let rank = report["rank"].as_u64().expect("a number");
    let said =
        if rank == 40 { ", as in floating point.".to_owned() } else { format!(" (floating point says {rank}).") };
    assert_says(&text, &[&format!("Exact arithmetic on the numbers as typed: rank 40 of 40{said}")]);
    assert_eq!(exact["differences"].as_array().map(Vec::len), Some(usize::from(rank != 40)));
}

/// The second equation is off by 1e-13, which the tolerance accepts as rounding; the third component is not involved.
#[test]
fn a_difference_names_its_connected_part() {
    let place = Place::new();
    typed(&place, "near", &["0 0 1 1 0", "1 1 0 0 0", "1 1.0000000000001 0 0 0"], "");
    place.file("near/rows.txt", "tie A\ntie B\ntie C\n");
    let run = place.run("check near --effort exact --format json");
    let report = run.json();
    assert_eq!((run.code, &report["rank"], &report["exact_rank"]["rank"]), (0, &json!(2), &json!(3)));
    let expected = json!([{"row": 2, "label": "tie B", "equations": 2, "rank": 2, "analysis_rank": 1,
        "solvable": true, "analysis_solvable": true}]);
    assert_eq!(report["exact_rank"]["differences"], expected);
    let text = place.run("check near --effort exact");
    let parts = ["rank 3 of 3 (floating point says 2).", "part of row 2 \"tie B\" (2 equations)."];
    assert_says(&text, &parts);
}

/// In binary 0.1 + 0.2 is not 0.3.
#[test]
fn numbers_are_read_as_typed_or_as_stored() {
    let place = Place::new();
    typed(&place, "tenths", &["0.1 1 0.1", "0.2 2 0.2", "0.3 3 0.3"], "");
    assert_says(
        &place.run("check tenths --effort exact"),
        &["on the numbers as typed: rank 1 of 3, as in floating point."],
    );
    assert_says(
        &place.run("check tenths --effort exact --numbers stored"),
        &["on the numbers as stored: rank 2 of 3 (floating point says 1)."],
    );
    assert_eq!(place.run("check tenths --effort exact --numbers binary").code, 2);
}

#[test]
fn a_doubtful_rank_is_confirmed_and_a_tolerance_settles_it() {
    let place = Place::new();
    typed(&place, "third", &["0.333333 1 0", "1 3 0"], "");
    let confirmed = place.run("check third --effort exact");
    assert_says(
        &confirmed,
        &["AMBIGUOUS", "rank 2 of 2, as in floating point.", "  That confirms rank 2, for numbers meant as typed."],
    );
    for (tolerance, rank) in [("1e-5", 1), ("1e-8", 2)] {
        let stated = place.run(&format!("check third --tolerance {tolerance}"));
        assert!(stated.out.contains(&format!("Rank {rank}. It stands")), "{}", stated.out);
    }
    let differs = place.run("check third --effort exact --tolerance 1e-5");
    assert_says(
        &differs,
        &[
            "AMBIGUOUS",
            "rank 2 of 2 (floating point says 1).",
            "  In exact arithmetic more equations are independent; rounding of the input can cause this.",
        ],
    );
}

#[test]
fn a_solution_that_only_one_of_the_two_finds_is_said() {
    let place = Place::new();
    typed(&place, "off", &["1 1 1", "2 2 2.0000000000001"], "");
    let run = place.run("check off --effort exact");
    assert_eq!(run.code, 0, "the exit code is that of the analysis");
    assert_says(&run, &["rank 1 of 2, as in floating point.", "As typed the equations have no solution"]);
    let exact = &place.run("check off --effort exact --format json").json()["exact_rank"];
    assert_eq!((&exact["augmented_rank"], &exact["solvable"]), (&json!(2), &json!(false)));
    // As typed, 1000 * 0.1 = 100. In doubles the sum is off by 1e-12, which exceeds this small tolerance.
    let n = 1000;
    let entries: Vec<_> = (1..=n).flat_map(|i| [(i, i, 1.0), (n + 1, i, 1.0)]).collect();
    let b: Vec<f64> = (0..=n).map(|i| if i < n { 0.1 } else { 100.0 }).collect();
    place.case("sum", [n + 1, n], &entries, &b, &[]);
    let run = place.run("check sum --effort exact --tolerance 1e-15 --noise none");
    assert_eq!(run.code, 1);
    assert_says(&run, &["rank 1000 of 1001, as in floating point.", "As typed the equations have a solution"]);
    let exact =
        &place.run("check sum --effort exact --tolerance 1e-15 --noise none --format json").json()["exact_rank"];
    let part = &exact["differences"][0];
    assert_eq!((&part["solvable"], &part["analysis_solvable"]), (&json!(true), &json!(false)));
    // A conflict that both find is not a difference.
    let exact = &place.paper("conflict", 0.0).run("check conflict --effort exact --format json").json()["exact_rank"];
    assert_eq!((&exact["solvable"], &exact["differences"]), (&json!(false), &json!([])));
}

#[test]
fn what_does_not_fit_into_memory_is_a_resource_failure() {
    let place = Place::new();
    assert_eq!(place.run("generate cycle --nodes 40000 -o ring").code, 0);
    let run = place.run("check ring --effort exact --memory 16MiB");
    assert!(run.code == 3 && run.out.is_empty(), "{}{}", run.out, run.err);
    assert!(run.err.contains("--memory allows 16.0 MiB"), "{}", run.err);
    assert_says(&place.run("check ring --effort exact --memory 4GiB"), &["rank 39999 of 40000, as in floating point."]);
}

#[test]
fn the_page_for_a_browser_has_it_too() {
    let place = Place::new();
    typed(&place, "third", &["0.333333 1 0", "1 3 0"], "");
    let run = place.run("check third --effort exact --format html");
    assert_says(&run, &["\"Exact arithmetic on the numbers as typed: rank 2 of 2"]);
    assert!(!place.run("check third --format html").out.contains("Exact arithmetic"));
}
