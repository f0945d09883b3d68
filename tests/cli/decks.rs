//! Decks as input: exit codes, names of the deck in the report, and the output and refusals of `clean`.

use std::fs;

use super::harness::Place;

/// Nodes and supports of a brick, with a place for more cards.
fn deck(constraints: &str, step: &str) -> String {
    let nodes = "*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n3,0.,1.,0.\n4,0.,0.,1.\n";
    format!("{nodes}*BOUNDARY\n1,1,3\n{constraints}*STEP\n*STATIC\n{step}*END STEP\n")
}

const TWICE: &str = "*EQUATION\n2\n2,1,1.,3,1,-1.\n2\n3,1,2.,2,1,-2.\n";

#[test]
fn a_redundant_deck_is_named_in_its_own_words_and_cleaned() {
    let place = Place::new();
    place.file("twice.inp", deck(TWICE, ""));
    let run = place.run("check -q twice.inp");
    assert_eq!((run.code, run.err.as_str()), (0, ""));
    for part in [
        "1 of 2 equations is redundant",
        "\"line 11 *EQUATION 3:1\" = -2 * row 1 \"line 9 *EQUATION 2:1\"",
        "qless clean",
    ] {
        assert!(run.out.contains(part), "{part}\n{}", run.out);
    }
    assert_eq!(place.run("check -q twice.inp --deny redundant").code, 1);
    let run = place.run("clean -q twice.inp -o clean.inp");
    assert_eq!(run.code, 0);
    for part in [
        "Wrote clean.inp: without 1 redundant equation.\n  Removed or changed: line 11 *EQUATION\n",
        "It was read again, and has the same solutions; what is said above of ccx no longer applies.\n",
    ] {
        assert!(run.out.contains(part), "{part}\n{}", run.out);
    }
    let cleaned = fs::read_to_string(place.path("clean.inp")).expect("written");
    assert!(
        cleaned.contains(
            "** qless: equation of line 11 removed, redundant: line 11 *EQUATION 3:1 = -2 * (line 9 *EQUATION 2:1)\n"
        ),
        "{cleaned}"
    );
    let run = place.run("clean -q clean.inp -o again.inp");
    assert!(run.out.contains("nothing had to be changed"), "{}", run.out);
    assert_eq!(fs::read_to_string(place.path("again.inp")).expect("written"), cleaned);
    // The same in place.
    let run = place.run("clean -q twice.inp -o twice.inp");
    assert_eq!(run.code, 0);
    assert!(run.out.contains("Replaced twice.inp: without"), "{}", run.out);
    assert_eq!(fs::read_to_string(place.path("twice.inp")).expect("written"), cleaned);
}

#[test]
fn a_comment_names_the_boundary_conditions_from_which_an_equation_follows() {
    let place = Place::new();
    let ties = "*EQUATION\n2\n2,1,1.,1,1,-1.\n*EQUATION\n2\n3,1,1.,2,1,-1.\n*EQUATION\n2\n3,1,1.,1,1,-1.\n";
    place.file("held.inp", deck(ties, "").replace("1,1,3\n", "1,1,3\n3,1,1\n"));
    let run = place.run("check -q held.inp");
    assert!(run.out.contains("writes a deck that the solver takes, without redundant equations."), "{}", run.out);
    let run = place.run("clean -q held.inp -o clean.inp");
    for part in [
        "Removed or changed: line 13 *EQUATION, line 16 *EQUATION\n",
        "; what is said above of ccx no longer applies.\n",
    ] {
        assert!(run.out.contains(part), "{part}\n{}", run.out);
    }
    let cleaned = fs::read_to_string(place.path("clean.inp")).expect("written");
    for comment in [
        "** qless: equation of line 13 removed, redundant: line 13 *EQUATION 3:1 = -1 * (line 10 *EQUATION 2:1), \
         with prescribed DOFs (1:1 in line 7 *BOUNDARY, 3:1 in line 8 *BOUNDARY)\n",
        "** qless: equation of line 16 removed: all of its DOFs are prescribed \
         (1:1 in line 7 *BOUNDARY, 3:1 in line 8 *BOUNDARY)\n",
    ] {
        assert!(cleaned.contains(comment), "{comment}\n{cleaned}");
    }
}

#[test]
fn a_conflicting_deck_is_refused_and_nothing_is_written() {
    let place = Place::new();
    place.file("conflict.inp", deck("*EQUATION\n2\n2,1,1.,3,1,-1.\n", "*BOUNDARY\n2,1,1,1.\n3,1,1,2.\n"));
    let before = place.everything();
    let run = place.run("clean -q conflict.inp -o clean.inp");
    assert_eq!(run.code, 1);
    assert!(run.out.contains("1 of 1 equation conflicts") && run.err.contains("nothing was written to clean.inp"));
    assert_eq!(place.everything(), before);
}

#[test]
fn the_worst_step_is_shown_and_the_others_are_named() {
    let place = Place::new();
    let steps =
        deck("*EQUATION\n2\n2,1,1.,3,1,-1.\n", "") + "*STEP\n*STATIC\n*BOUNDARY\n2,1,1,1.\n3,1,1,2.\n*END STEP\n";
    place.file("steps.inp", steps);
    let run = place.run("check -q steps.inp");
    assert_eq!(run.code, 1);
    assert!(
        run.out
            .contains("Load cases: 2, shown is step 2.\n  step 2: rank 0, 0 redundant, 1 conflicting; ccx: 1 lost\n"),
        "{}",
        run.out
    );
    assert!(run.out.contains("\n  step 1: rank 1, 0 redundant, 0 conflicting\n"), "{}", run.out);
}

#[test]
fn what_the_solver_refuses_and_what_loads_it_swallows() {
    let place = Place::new();
    place.file("fixed.inp", deck("*EQUATION\n2\n1,1,1.,3,1,-1.\n", "*CLOAD\n3,1,5.\n"));
    let run = place.run("check -q fixed.inp");
    assert_eq!(run.code, 0);
    for part in [
        "1:1 is the slave of line 9 *EQUATION, and prescribed in line 7 *BOUNDARY",
        "3:1 in line 14 *CLOAD",
        "Next: `qless clean fixed.inp -o fixed-clean.inp` writes a deck that the solver takes.",
    ] {
        assert!(run.out.contains(part), "{part}\n{}", run.out);
    }
    let run = place.run("check -q fixed.inp --format json");
    let report: serde_json::Value = serde_json::from_str(&run.out).expect("JSON");
    assert_eq!(report["deck"]["load_case"], "step 1");
    assert_eq!(report["deck"]["solver_refuses"].as_array().map(Vec::len), Some(1));
    assert_eq!(report["deck"]["loads_without_effect"][0], "3:1 in line 14 *CLOAD");
    assert_eq!(report["generated_boundary_conditions"][0]["label"], "3:1");
}

/// A tie whose slave nodes a rigid body takes.
const LOST: &str = include_str!("../calculix/tie_and_body.inp");

#[test]
fn what_is_refused_what_is_implied_and_what_is_lost_are_three_things() {
    let place = Place::new();
    // A body of all nodes of both faces implies the tie; one of three nodes of the slave face does not.
    let implied = LOST.replace("101,102,103,104\n*NSET,NSET=OUT", "9,10,11,12,101,102,103,104\n*NSET,NSET=OUT");
    let refused = deck("*EQUATION\n2\n2,1,1.,3,1,-1.\n*EQUATION\n2\n2,1,1.,3,1,-2.\n", "");
    place.file("lost.inp", LOST).file("implied.inp", &*implied).file("refused.inp", refused);
    for (name, counts, freed, status, denies, parts) in [
        (
            "lost",
            [0, 0, 12],
            12,
            "independent",
            [0, 1, 1],
            [
                "LOST: ccx drops 12 claims that the rest does not imply; 12 motions come free, 101:1, 101:2, 101:3, 102:1,",
                "Next: `qless clean lost.inp -o lost-clean.inp` writes a deck in which the lost ones hold.",
            ],
        ),
        (
            "implied",
            [0, 12, 0],
            0,
            "redundant",
            [0, 1, 0],
            [
                "ccx drops these claims without effect: they follow from what it keeps:",
                "Next: `qless clean implied.inp -o implied-clean.inp` writes a deck without redundant equations.",
            ],
        ),
        (
            "refused",
            [1, 0, 0],
            0,
            "independent",
            [1, 0, 0],
            [
                "ccx refuses the deck for these reasons:",
                "Next: `qless clean refused.inp -o refused-clean.inp` writes a deck that the solver takes.",
            ],
        ),
    ] {
        let run = place.run(&format!("check -q {name}.inp"));
        assert_eq!(run.code, 0, "{name}");
        parts.iter().for_each(|part| assert!(run.out.contains(part), "{part}\n{}", run.out));
        let report = place.run(&format!("check -q {name}.inp --format json")).json();
        let length = |key: &str| report["solver"][key].as_array().map(Vec::len).expect("a list");
        assert_eq!(["refused", "implied", "lost"].map(length), counts, "{name}");
        assert_eq!((length("freed"), &report["status"]), (freed, &serde_json::json!(status)), "{name}");
        let code = |what: &str| place.run(&format!("check -q {name}.inp --deny {what}")).code;
        assert_eq!(["refused", "dropped", "lost"].map(code), denies, "{name}");
    }
    let run = place.run("check -q lost.inp --deny lost,refused --format sarif");
    assert!(run.err.contains("error: found what --deny names: 12 lost claims"), "{}", run.err);
    let report: serde_json::Value = serde_json::from_str(&run.out).expect("JSON");
    let results = report["runs"][0]["results"].as_array().expect("results");
    assert!(
        results
            .iter()
            .all(|found| (&found["ruleId"], &found["level"])
                == (&serde_json::json!("lost"), &serde_json::json!("error")))
    );
}

#[test]
fn a_body_on_a_line_names_the_rotation_that_nothing_holds() {
    let place = Place::new();
    let line =
        LOST.replace("101,102,103,104\n*NSET,NSET=OUT", "101,102\n*NSET,NSET=OUT").replace("901,2,.5,.5", "901,2,0,.5");
    let held = line.replace("4,1,3\n*STEP", "4,1,3\n902,3\n*STEP");
    place.file("line.inp", line).file("held.inp", held);
    let run = place.run("check -q line.inp --deny refused");
    assert!(
        run.code == 1 && run.out.contains("nothing holds rotation 902:3: no equation of the body has it"),
        "{}",
        run.out
    );
    assert_eq!(place.run("check -q held.inp --deny refused").code, 0);
}

#[test]
fn a_reduction_names_its_columns() {
    let place = Place::new();
    place.file("twice.inp", deck(TWICE, ""));
    assert_eq!(place.run("reduce -q twice.inp -o reduced").code, 0);
    assert_eq!(fs::read_to_string(place.path("reduced/cols.txt")).expect("written"), "2:1\n3:1\n");
}

#[test]
fn bad_decks_and_bad_usage() {
    let place = Place::new();
    place
        .file("term.inp", deck("*EQUATION\n2\n2,1,1.,3,x,-1.\n", ""))
        .file("short.inp", deck("*EQUATION\n3\n2,1,1.,3,1,-1.\n", ""))
        .file("set.inp", deck("*BOUNDARY\nFIXX,1,3\n", ""))
        .file("node.inp", deck("*EQUATION\n2\n2,1,1.,9,1,-1.\n", ""))
        .file("include.inp", "*INCLUDE, INPUT=include.inp\n")
        .file("good.inp", deck(TWICE, ""))
        .file("lone.mtx", "%%MatrixMarket matrix coordinate real general\n1 1 1\n1 1 1\n");
    for (arguments, parts) in [
        ("check term.inp", ["term.inp:10: *EQUATION, field 5", "`x`"]),
        ("check short.inp", ["short.inp:9: *EQUATION", "3 terms are promised, but the card ends after 2"]),
        ("check set.inp", ["set.inp:9: *BOUNDARY, field 1", "node set FIXX is not defined"]),
        ("check node.inp", ["node.inp:9: *EQUATION", "node 9 is not defined"]),
        ("check include.inp", ["include.inp:1", "the depth of includes exceeds the limit of 20"]),
        ("check good.inp --rhs b.txt", ["good.inp", "a deck has its own"]),
        ("clean good.inp -o good.bdf", ["good.bdf", "give it the same ending"]),
        ("clean lone.mtx -o out.mtx", ["lone.mtx", "only decks"]),
        ("clean missing.inp -o out.inp", ["missing.inp", "No such file"]),
    ] {
        let before = place.everything();
        let run = place.run(&format!("{arguments} -q"));
        assert_eq!((run.code, run.out.as_str()), (2, ""), "{arguments}\n{}", run.err);
        for part in parts {
            assert!(run.err.contains(part), "{arguments}: {part}\n{}", run.err);
        }
        assert_eq!(place.everything(), before, "{arguments}");
    }
}

#[test]
fn nodes_are_written_for_paraview() {
    use vtkio::model::{Attribute, DataSet, Piece, Vtk};
    let place = Place::new();
    place.file("twice.inp", deck(TWICE, ""));
    assert_eq!(place.run("check -q twice.inp --format vtu -o twice.vtu").code, 0);
    let bytes = fs::read(place.path("twice.vtu")).expect("written");
    let vtk = Vtk::parse_xml(&bytes[..]).expect("VTK");
    let DataSet::UnstructuredGrid { pieces, .. } = vtk.data else { panic!("another grid") };
    let Piece::Inline(piece) = &pieces[0] else { panic!("no data") };
    let array = |name: &str| {
        let of_name = |attribute: &&Attribute| matches!(attribute, Attribute::DataArray(array) if array.name == name);
        let Some(Attribute::DataArray(array)) = piece.data.point.iter().find(of_name) else {
            panic!("{name} is not there")
        };
        array.data.clone().into_vec::<i32>().expect("whole numbers")
    };
    // Equations hold 2:1 and 3:1 only; of the two equations the second is redundant.
    assert_eq!(array("node"), [2, 3]);
    assert_eq!(piece.points.clone().into_vec::<f64>().expect("points"), [1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    assert_eq!((array("redundant"), array("conflicting"), array("prescribed")), (vec![1, 1], vec![0, 0], vec![0, 0]));
    let (slaves, masters) = (array("slaves"), array("masters"));
    assert_eq!((slaves[0] + masters[0], slaves[1] + masters[1], slaves[0] + slaves[1]), (1, 1, 1));
    place.file("bare.inp", "*EQUATION\n2\n2,1,1.,3,1,-1.\n");
    let run = place.run("check -q bare.inp --format vtu -o bare.vtu");
    assert_eq!(run.code, 2);
    assert!(run.err.contains("add the cards of the nodes") && !place.path("bare.vtu").exists(), "{}", run.err);
}
