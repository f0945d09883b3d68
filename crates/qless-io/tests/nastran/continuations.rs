//! Continuations by name, copies, longer lines: the same equations as on lines that follow each other.

use qless_io::deck::Solver;

use super::given::{equations, model, parsed, prescribed, refused, warnings};

const GRIDS: &str = "GRID,1\nGRID,2,,1.\nGRID,3,,2.\nGRID,4,,3.\nGRID,5,,4.\nGRID,6,,5.\nGRID,7,,6.\n";
const TOGETHER: &str = "RBE2,9,1,3,2,3,4,5,6,+A\n+A,7\nMPC,1,2,1,1.,3,1,-1.,,+B\n+B,,4,1,-1.\n";

/// Equations of a deck, in any order.
fn sorted(cards: &str) -> Vec<String> {
    let mut found = equations(&model(&format!("{GRIDS}{cards}")));
    found.sort();
    found
}

#[test]
fn lines_are_found_by_name_wherever_they_are() {
    let lines: Vec<&str> = TOGETHER.lines().collect();
    let expected = sorted(TOGETHER);
    assert_eq!(expected.len(), 7);
    let unread = ["CBAR,1,1,1,2,0.,1.,0.", "CBAR,2,1,1,2,0.,1.,0.,,+C", "+C,1"];
    let mut state = 7_usize;
    for _ in 0..200 {
        let mut all: Vec<&str> = lines.iter().chain(&unread).copied().collect();
        for i in (1..all.len()).rev() {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            all.swap(i, (state >> 33) % (i + 1));
        }
        assert_eq!(sorted(&all.join("\n")), expected, "{all:#?}");
    }
}

#[test]
fn a_line_that_none_names_is_that_of_the_card_before_it() {
    let expected = sorted("RBE2,9,1,3,2,3\n,4");
    assert_eq!(sorted("RBE2,9,1,3,2,3\n+X,4"), expected);
    assert_eq!(sorted("RBE2,9,1,3,2,3\n+X,4\nCBAR,1,1,1,2,0.,1.,0.\n"), expected);
    // Here another card names it.
    assert_eq!(sorted("RBE2,9,1,3,2,3\n+X,4\nRBE2,8,1,1,2,+X"), sorted("RBE2,9,1,3,2,3\nRBE2,8,1,1,2,4"));
}

/// The last field of a line without a `+` may be a remark: the next line follows then, whatever its name.
#[test]
fn a_second_continuation_reads_like_the_first() {
    let text = "SPC1    1       1       1       2       3       4       5       6       CSPC-A
+SPC-A  7       8       9       10      11      12      13      14      CSPC-B
+SPC-B  15      16\n";
    let held = |text: &str| prescribed(&model(&format!("CEND\nSPC=1\nBEGIN BULK\n{GRIDS}{text}")).cases()[0]).len();
    assert_eq!(held(text), 16);
    assert_eq!(sorted("RBE2,9,1,3,2,3\n+X,4\n+Y,5\n+Z,6"), sorted("RBE2,9,1,3,2,3,4,5,6"));
    assert_eq!(sorted("CBAR,9,1,3,2\n+X,4\n+Y,5\nRBE2,9,1,3,2"), sorted("RBE2,9,1,3,2"));
    // Here another card names the second continuation.
    let named = "RBE2,8,1,1,2,+Y\nRBE2,9,1,3,2,3\n+X,4\n+Y,5\n+Z,6";
    assert_eq!(sorted(named), sorted("RBE2,8,1,1,2,5,6\nRBE2,9,1,3,2,3,4"));
}

#[test]
fn pieces_go_on_in_pieces() {
    let apart = "MPC,1,2,1,1.,3,1,-1.,,+A\nCBAR,1,1,1,2\n+B,,5,1,-1.\nCBAR,2,1,1,2\n+A,,4,1,-1.,,,,,+B\n";
    assert_eq!(sorted(apart), ["1 2:1 -1 3:1 -1 4:1 -1 5:1"]);
}

#[test]
fn what_does_not_come_is_said() {
    let refused = |cards: &str| refused(&format!("GRID,1\nGRID,2\n{cards}"));
    let expected = "place/deck.bdf:3: RBE2 9: the card continues at `+A`, but no remaining line begins with it; add the line or remove the mark";
    assert_eq!(refused("RBE2,9,1,3,2,+A\n"), expected);
    assert_eq!(refused("RBE2,9,1,3,2,+A\n+A,2\nRBE2,8,1,1,2,+A\n").replace(":5: RBE2 8", ":3: RBE2 9"), expected);
    let orphan = "place/deck.bdf:4: continuation: the line continues a card at `+B`, but no card names it; put the line right after its card";
    assert_eq!(refused("RBE2,9,1,3,2,+A\n+B,2\n+A,2\n"), orphan);
    // A card of one line has remarks in its last field.
    assert_eq!(refused("SPC     1       1       3       0.                                      +REM\n"), "accepted");
}

#[test]
fn lines_of_other_files_are_found() {
    let files = [("more.inc", "+A,3\nGRID,3\n")];
    let deck =
        parsed("GRID,1\nGRID,2\nRBE2,9,1,3,2,+A\nINCLUDE 'more.inc'\n", &files).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(deck.model().equations(), 2);
    let deck =
        parsed("GRID,1\nGRID,2\nINCLUDE 'more.inc'\nRBE2,9,1,3,2,+A\n", &files).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(deck.model().equations(), 2);
}

/// To OptiStruct the next line is the continuation, whatever its name; MYSTRAN drops what is not the next line, and what stands beyond
/// the last field (found by running it).
#[test]
fn solvers_differ() {
    let read = |solver, cards: &str| {
        let text = format!("GRID,1\nGRID,2\nGRID,3\n{cards}");
        let mut none = |_: &std::path::Path| Err(std::io::ErrorKind::NotFound.into());
        let deck = qless_io::deck::parse(solver, std::path::Path::new("d.bdf"), text.into(), &mut none);
        deck.map(|deck| deck.model().equations()).map_err(|error| error.to_string())
    };
    let misnamed = "RBE2,9,1,3,2,+A\n+B,3\n";
    assert_eq!(read(Solver::Optistruct, misnamed), Ok(2));
    assert!(read(Solver::Nastran, misnamed).is_err() && read(Solver::Mystran, misnamed).is_err());
    let apart = "RBE2,9,1,3,2,+A\nGRID,4\n+A,3\n";
    let dropped = "d.bdf:6: RBE2 9: MYSTRAN silently ignores this continuation, because it does not follow its card directly; move it there";
    assert_eq!((read(Solver::Nastran, apart), read(Solver::Mystran, apart)), (Ok(2), Err(dropped.to_owned())));
    assert_eq!(read(Solver::Mystran, "RBE2,9,1,3,2,+A\n"), Ok(1));
    assert!(read(Solver::Nastran, "RBE2,9,1,3,2,+A\n").is_err());
    let long = "RBE2,9,1,3,2,3,2,3,2,3\n";
    assert_eq!(read(Solver::Nastran, long), Ok(6));
    assert!(
        read(Solver::Mystran, long)
            .is_err_and(|error| error.contains("d.bdf:4: RBE2 9: MYSTRAN silently ignores everything after"))
    );
}

#[test]
fn copies_are_the_cards_that_they_stand_for() {
    let expected = sorted("RBE2,9,1,3,2\nRBE2,10,1,3,3\nRBE2,11,1,3,4\nRBE2,12,1,3,5\n");
    for copies in ["=,*1,=,=,*1\n=(2)", "=,*(1),==\n", "=       *1      =       =       *1\n=2", "=(3),*1,=,=,*(1)"] {
        let found = sorted(&format!("RBE2,9,1,3,2\n{copies}\n"));
        if copies.contains("==") {
            assert_eq!(found, ["1 2:3 -1 1:3 1 1:5", "1 2:3 -1 1:3 1 1:5"]);
        } else {
            assert_eq!(found, expected, "{copies}");
        }
    }
    let grids = "GRID,1,,0.,0.,0.\n=,*1,=,*2.,==\n=(2)\n";
    let typed = "GRID,1\nGRID,2,,2.\nGRID,3,,4.\nGRID,4,,6.\n";
    let of = |grids: &str| equations(&model(&format!("{grids}RBE2,9,1,123456,4")));
    assert_eq!(of(grids), of(typed));
}

#[test]
fn blanks_between_components_and_longer_lines_do_not_matter() {
    assert_eq!(sorted("RBE2    9       1       1 2 3   2"), sorted("RBE2,9,1,123,2"));
    assert_eq!(sorted("RBE2,9,1,12 3,2"), sorted("RBE2,9,1,123,2"));
    assert_eq!(sorted("RBE2,9,1,3,2,3,4,5,6,7"), sorted("RBE2,9,1,3,2,3,4,5,6\n,7"));
    let held = model("GRID,1\nSPC1,1,1 3,1\n");
    assert_eq!(super::given::prescribed(&held.cases()[0]), ["1:1=0", "1:3=0"]);
}

#[test]
fn a_point_in_large_field_has_its_second_line_anywhere() {
    let apart = "GRID*                  2                              1.              2.*G\nGRID,1\n*G                    3.\nRBE2,9,1,1,2\n";
    assert_eq!(equations(&model(apart)), ["1 2:1 -1 1:1 -3 1:5 2 1:6"]);
}

#[test]
fn a_point_may_be_given_twice_alike() {
    let text = format!("{GRIDS}GRID,2,,1.\nRBE2,9,1,3,2\n");
    assert_eq!(warnings(&model(&text)), [""; 0]);
}
