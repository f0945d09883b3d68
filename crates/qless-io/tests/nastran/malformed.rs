//! Every kind of fault: file, line, card, field, what was found and what to do.

use super::given::{parsed, refused};

const GRIDS: &str = "GRID,1\nGRID,2,,1.\nGRID,3,,2.\nSPOINT,9\n";

/// The message for a card after four lines of points.
fn message(card: &str) -> String {
    refused(&format!("{GRIDS}{card}\n"))
}

#[test]
fn fields_are_named() {
    for (card, expected) in [
        ("GRID,x", "place/deck.bdf:5: GRID, field 2: expected the number of the grid point, found `x`; correct it"),
        (
            "GRID,4,,1.x",
            "place/deck.bdf:5: GRID 4, field 4: `1.x` is no usable number: not a number; write it as 1.5 or 1.5e-3",
        ),
        (
            "GRID,4,,,,,,127",
            "place/deck.bdf:5: GRID 4, field 8: expected component numbers: digits from 1 to 6, found `127`; correct it",
        ),
        ("GRID,0", "place/deck.bdf:5: GRID 0, field 2: expected the number of the grid point, found `0`; correct it"),
        (
            "RBE2,7,1,,2",
            "place/deck.bdf:5: RBE2 7, field 4: expected one or more component numbers from 1 to 6, found nothing; correct it",
        ),
        (
            "RBE2,7,1,3,2,3,1,2\n,2,-3",
            "place/deck.bdf:6: RBE2 7, field 3: expected a grid or scalar point, found `-3`; correct it",
        ),
        (
            "MPC,5,1,12,1.",
            "place/deck.bdf:5: MPC 5, field 4: expected one component from 1 to 6, or 0 for a scalar point, found `12`; correct it",
        ),
        (
            "MPC,5,1,1,1.,2,1,1.+999",
            "place/deck.bdf:5: MPC 5, field 8: `1.+999` is no usable number: too large for a 64-bit number; rescale the row",
        ),
        (
            "SPC1,1,3,5,THRU,2",
            "place/deck.bdf:5: SPC1 1, field 6: expected a number after THRU that is not below the one before it, found `2`; correct it",
        ),
        (
            "RROD,7,1,2,12",
            "place/deck.bdf:5: RROD 7, field 5: expected one translation, 1, 2 or 3, on one end of the rod, found `12`; correct it",
        ),
        (
            "RBE3,7,,1,123,2,123,3",
            "place/deck.bdf:5: RBE3 7, field 6: expected a weight with a decimal point, found `2`; correct it",
        ),
    ] {
        assert_eq!(message(card), expected);
    }
}

#[test]
fn cards_are_named() {
    for (card, expected) in [
        ("RBE2,7,1,3,8", "place/deck.bdf:5: RBE2 7: grid point 8 is not defined; define it or correct the name"),
        ("RBE2,7,1,3", "place/deck.bdf:5: RBE2 7: nothing is connected; name at least one grid point and component"),
        ("RBE2,7,1,3,1", "place/deck.bdf:5: RBE2 7: 1:3 is both dependent and independent; remove it from one list"),
        (
            "RBAR,7,1,2,123,12",
            "place/deck.bdf:5: RBAR 7: 5 independent components are given; a rigid body has 6, give exactly that many",
        ),
        (
            "RBAR,7,1,2,123,123",
            "place/deck.bdf:5: RBAR 7: the 6 independent components do not fix the body: some motion moves none of them; choose others",
        ),
        (
            "RROD,7,1,2,2",
            "place/deck.bdf:5: RROD 7: 1:2 is at right angles to the rod and cannot depend on it; choose another component",
        ),
        (
            "RBE3,7,,1,12,1.,123,2,3\n,UM,2,1",
            "place/deck.bdf:5: RBE3 7: UM names 1 components, but REFC has 2; name as many",
        ),
        (
            "MPC,5,9,2,1.",
            "place/deck.bdf:5: MPC 5: 9 is a scalar point, which has no component 2; write 0 or leave the field blank",
        ),
        ("MPC,5,1,,1.", "place/deck.bdf:5: MPC 5: 1 is a grid point and needs a component; write digits from 1 to 6"),
        (
            "GRID,1,,5.",
            "place/deck.bdf:5: GRID 1: grid point 1 has another definition in deck.bdf:1; keep one of the two",
        ),
        (
            "CORD2R,4,4,,,,,,1.\n,1.",
            "place/deck.bdf:5: CORD2R 4: coordinate system 4 is defined by itself; break the circle",
        ),
        (
            "CORD2R,4,6,,,,,,1.\n,1.",
            "place/deck.bdf:5: CORD2R 4: coordinate system 6 is not defined; define it or correct the name",
        ),
        (
            "CORD2R,4,,,,,,,1.\n,,,3.",
            "place/deck.bdf:5: CORD2R 4: the three points of the coordinate system are collinear or coincide; correct the coordinates or the nodes",
        ),
    ] {
        assert_eq!(message(card), expected);
    }
}

#[test]
fn lines_are_named() {
    assert_eq!(
        message("RBE2,7,1,3,2,3,2,3,2,,5"),
        "place/deck.bdf:5: RBE2: `5` follows the 8 data fields and the continuation field of the line; use a continuation line"
    );
    assert_eq!(
        message("RBE2    7       1       3       2       3                               +A\n+B      2"),
        "place/deck.bdf:5: RBE2 7: the card continues at `+A`, but no remaining line begins with it; add the line or remove the mark"
    );
    assert_eq!(
        refused("CEND\nSPC = ALL\nBEGIN BULK\n"),
        "place/deck.bdf:2: SPC: expected the number of a set, as in `SPC = 3`, found `SPC = ALL`; correct it"
    );
    assert_eq!(
        refused("CEND\nMPC = 1\nBEGIN BULK\nMPCADD,1,2\nMPCADD,2,1\n"),
        "place/deck.bdf:5: MPCADD 2: set 1 is defined by itself; break the circle"
    );
}

#[test]
fn a_continuation_needs_a_card() {
    let expected =
        "place/deck.bdf:3: continuation: expected a card before the line that continues it, found `+,3`; correct it";
    assert_eq!(refused("CEND\nBEGIN BULK\n+,3\nGRID,1\n"), expected);
}

#[test]
fn includes_have_limits() {
    assert_eq!(
        refused("INCLUDE 'a.inc'\n"),
        "place/deck.bdf:1: include: the included file a.inc cannot be read: entity not found; correct the name or put the file there"
    );
    let circle =
        parsed("INCLUDE 'a.inc'\n", &[("a.inc", "GRID,1\nINCLUDE 'a.inc'\n")]).expect_err("a circle").to_string();
    assert_eq!(
        circle,
        "place/a.inc:2: include: the depth of includes exceeds the limit of 20; break the circle of includes"
    );
    assert!(refused("INCLUDE 'a.inc").contains("expected a file name between quotes"));
    assert!(refused(&format!("GRID,1{}\n", " ".repeat(1 << 20))).contains("the length of a line"));
}

#[test]
fn no_range_is_too_long_to_be_refused() {
    let text = "SPOINT,1,THRU,99999999\nSPC1,1,0,1,THRU,99999999\n";
    assert!(refused(text).contains("the number of constrained points exceeds the limit"), "{}", refused(text));
}

/// Cuts and changed bytes of a deck with every card never make the reader panic.
#[test]
fn no_bytes_are_fatal() {
    let deck = "CEND\nMPC=1\nSPC=2\nBEGIN BULK\nGRDSET,,,,,,,6\nCORD2C,1,,,,,,,1.\n,1.\nGRID,1,1,1.,2.,3.,1\nGRID,2\nGRID,3,,1.,1.\n\
                RBE2    7       1       123     2       THRU    3\nRBE3,8,,1,123456,1.,123,2,3\n,UM,2,123,3,123\nRBAR,9,1,2,123,456\n\
                MPC*,1,1,1,1.\n*,2,1,-1.-1\nSPC,2,1,1,.5\nSPC1,2,123,2,THRU,9\nSPCADD,3,2\nRROD,4,1,2,1\nRBE1,5,1,123456\n,UM,2,1\nENDDATA\n";
    for cut in 0..deck.len() {
        let _ = parsed(&deck[..cut], &[]).map(|deck| deck.model().system(&deck.model().cases()[0]));
    }
    for (at, new) in (0..deck.len()).flat_map(|at| b"\n, *+$9-.T\xff\0".iter().map(move |new| (at, *new))) {
        let mut bytes = deck.as_bytes().to_vec();
        bytes[at] = new;
        let mut none = |_: &std::path::Path| Err(std::io::ErrorKind::NotFound.into());
        let path = std::path::Path::new("deck.bdf");
        let read = qless_io::deck::parse(qless_io::deck::Format::Nastran, path, bytes, &mut none);
        let _ = read.map(|deck| deck.model().system(&deck.model().cases()[0]));
    }
}

#[test]
fn copies_say_what_they_copy() {
    let copy = "place/deck.bdf:6: =: expected a card of one line before its copies, found `=,*1`; correct it";
    assert_eq!(message("RBE2,7,1,3,2,3,2,3,2,3,2\n=,*1"), copy);
    assert!(
        message("RBE2,7,1,3,2\n=(2)").contains("RBE2 7: expected `=`, `=n` or `=(n)`"),
        "{}",
        message("RBE2,7,1,3,2\n=(2)")
    );
    assert!(message("RBE2,7,1,3,2\n=,*1,=,=,*1\n,3").contains("expected a card of one line, since `=` copies"));
    assert_eq!(message("CQUAD4,1,1,1,2,3,4\n=,*(1),=,*(1)"), "accepted");
}

#[test]
fn elements_have_numbers_of_their_own() {
    let expected = "place/deck.bdf:6: RBAR 7, field 2: element 7 is already defined in line 5; give it another number";
    assert_eq!(message("RBE2,7,1,3,2\nRBAR,7,1,3"), expected);
}

#[test]
fn joints_are_at_one_place() {
    let expected = "grid points 1 and 2 of the joint have to be at the same place; correct one of them";
    for card in ["RJOINT,7,1,2,123", "JOINTG,7,,BALL,1,,2"] {
        assert!(message(card).ends_with(expected), "{}", message(card));
    }
}
