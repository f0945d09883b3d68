//! Cleaning changes constraints only, keeps includes and line ends, and refuses what it cannot express.

use std::path::Path;

use qless::Options;
use qless_io::deck::clean::{self, CleanError};
use qless_io::deck::{Deck, Format};

use super::solver::{cleaned, difference, is_there, parse, solve};

/// A brick on supports, with a place for constraints.
fn brick(constraints: &str) -> String {
    let nodes = "*NODE, NSET=NALL\n1,0.,0.,0.\n2,1.,0.,0.\n3,1.,1.,0.\n4,0.,1.,0.\n5,0.,0.,1.\n6,1.,0.,1.\n7,1.,1.,1.\n8,0.,1.,1.\n";
    let solid = "*ELEMENT, TYPE=C3D8, ELSET=EALL\n1,1,2,3,4,5,6,7,8\n*MATERIAL, NAME=EL\n*ELASTIC\n210000.,0.3\n*SOLID SECTION, ELSET=EALL, MATERIAL=EL\n";
    let step = "*STEP\n*STATIC\n*CLOAD\n5,3,100.\n6,3,50.\n*NODE PRINT, NSET=NALL\nU\n*END STEP\n";
    format!("{nodes}{solid}*BOUNDARY\n1,1,3\n2,2,3\n3,3,3\n4,1,1\n4,3,3\n{constraints}{step}")
}

/// A deck whose included files are given.
fn with_includes(text: &str, files: &[(&str, &str)]) -> Deck {
    let mut open = |path: &Path| {
        let found = files.iter().find(|(name, _)| path.ends_with(name));
        found.map(|(_, text)| text.as_bytes().to_vec()).ok_or_else(|| std::io::ErrorKind::NotFound.into())
    };
    qless_io::deck::parse(Format::Calculix, Path::new("deck.inp"), text.as_bytes().to_vec(), &mut open).expect("a deck")
}

fn text_of(deck: &Deck) -> String {
    String::from_utf8(cleaned(deck).expect("consistent")).expect("text")
}

#[test]
fn a_redundant_equation_leaves_a_comment_and_nothing_else_changes() {
    let text =
        brick("*EQUATION\n2\n5,3,1.,8,3,-1.\n2\n6,3,1.,8,3,-1.\n** kept\n2\n7,3,1.,5,3,-1.\n2\n7,3,2.,6,3,-2.\n");
    let comment = "** qless: equation of line 30 removed, redundant: line 30 *EQUATION 7:3 = \
                   2 * (line 23 *EQUATION 5:3) - 2 * (line 25 *EQUATION 6:3) + 2 * (line 28 *EQUATION 7:3)";
    let expected = text.replace("2\n7,3,2.,6,3,-2.", comment);
    assert_eq!(text_of(&parse(text.as_bytes())), expected);
}

#[test]
fn a_card_without_equations_goes_and_line_ends_stay() {
    let text = brick("*EQUATION\n2\n5,3,1.,8,3,-1.\n*EQUATION\n2\n8,3,1.,5,3,-1.\n").replace('\n', "\r\n");
    let found = text_of(&parse(text.as_bytes()));
    assert_eq!(found.lines().filter(|line| line.starts_with("*EQUATION")).count(), 1);
    assert_eq!(found.matches('\n').count(), found.matches("\r\n").count());
}

#[test]
fn an_included_file_that_changes_is_written_into_the_deck() {
    let ties = "*EQUATION\n2\n5,3,1.,8,3,-1.\n2\n5,3,1.,8,3,-1.\n";
    let deck = with_includes(
        &brick("*INCLUDE, INPUT=ties.inc\n*INCLUDE,INPUT=other.inc\n"),
        &[("ties.inc", ties), ("other.inc", "** nothing\n")],
    );
    assert_eq!(deck.model().label(1).expect("an equation"), "ties.inc:4 *EQUATION 5:3");
    let found = text_of_included(&deck, &[("other.inc", "** nothing\n")]);
    assert!(found.contains("** qless: included here") && found.contains("5,3,1.,8,3,-1."));
    assert!(found.contains("*INCLUDE,INPUT=other.inc") && !found.contains("ties.inc\n"));
}

fn text_of_included(deck: &Deck, files: &[(&str, &str)]) -> String {
    let plan = clean::plan(deck, &Options::default()).expect("consistent");
    let text = String::from_utf8(clean::write(deck, &plan).expect("written")).expect("text");
    let again = with_includes(&text, files);
    assert!(clean::plan(&again, &Options::default()).expect("consistent").is_empty());
    text
}

#[test]
fn a_tie_beside_equations_that_repeat_it() {
    // A smaller second brick on top of the first; its lower face is tied, and tied again by equations.
    let upper = "*NODE, NSET=NALL\n11,.2,.2,1.\n12,.8,.2,1.\n13,.8,.8,1.\n14,.2,.8,1.\n15,.2,.2,2.\n16,.8,.2,2.\n17,.8,.8,2.\n18,.2,.8,2.\n*ELEMENT, TYPE=C3D8, ELSET=EALL\n2,11,12,13,14,15,16,17,18\n";
    let tie = "*SURFACE, NAME=FOOT\n2,S1\n*SURFACE, NAME=TOP\n1,S2\n*TIE, NAME=T, POSITION TOLERANCE=.01\nFOOT,TOP\n";
    let again = "*EQUATION\n5\n11,3,1.,5,3,-.64,6,3,-.16,7,3,-.04\n8,3,-.16\n";
    let place = |extra: &str| brick(extra).replacen("*ELEMENT", &(upper.to_owned() + "*ELEMENT"), 1);
    let (plain, doubled) = (place(tie), place(&(tie.to_owned() + again)));
    let deck = parse(doubled.as_bytes());
    assert_eq!(deck.model().equations(), 13);
    let text = cleaned(&deck).expect("consistent");
    let cards = String::from_utf8_lossy(&text).lines().filter(|line| line.starts_with("*TIE")).count();
    assert_eq!(cards, 1, "the tie stays, the equation goes");
    if is_there() {
        let (a, b) = (solve(plain.as_bytes()).expect("solved"), solve(&text).expect("solved"));
        assert!(difference(&a, &b) <= 1e-6);
    }
}

#[test]
fn a_slave_with_a_vanishing_coefficient_is_not_chosen_again() {
    for equations in
        ["2\n5,1,11.,6,1,-1e8\n2\n5,1,11.,6,1,-1e8\n", "2\n5,1,1.,6,1,-2965324.\n2\n7,1,1.,6,1,-1999999.\n"]
    {
        // `cleaned` checks that no faults remain and that a second cleaning changes nothing.
        let text = brick(&format!("*EQUATION\n{equations}"));
        assert!(cleaned(&parse(text.as_bytes())).is_ok_and(|cleaned| cleaned != text.as_bytes()));
    }
}

#[test]
fn a_node_card_without_nodes_defines_none() {
    let deck = parse(b"*NODE\n** none yet\n*EQUATION\n2\n1,1,1.,2,1,-1.\n");
    assert_eq!(deck.model().equations(), 1);
}

fn refused(text: &str) -> CleanError {
    let deck = parse(text.as_bytes());
    clean::plan(&deck, &Options::default()).expect_err("refused")
}

#[test]
fn what_cannot_be_cleaned_is_refused_in_words() {
    // Two bodies with large rotations claim the same node: no linear equation can replace one of them.
    let bodies = "*NODE\n30,0.,0.,3.\n31,0.,1.,3.\n*NSET, NSET=A\n5,6\n*RIGID BODY, NSET=A, REF NODE=30\n*RIGID BODY, NSET=A, REF NODE=31\n";
    let error = refused(&brick(bodies).replacen("*STEP", "*STEP, NLGEOM", 1)).to_string();
    let linear = brick(bodies).replacen("*STEP", "*STEP, NLGEOM=no", 1);
    assert!(clean::plan(&parse(linear.as_bytes()), &Options::default()).is_ok());
    let why = "5:1 is the slave of line 27 *RIGID BODY, and of line 28 *RIGID BODY";
    assert!(error.starts_with(&format!("line 28 *RIGID BODY cannot be replaced by equations: {why};")), "{error}");
    // Needed in the second step, but without a free DOF in the first.
    let two_steps =
        brick("*EQUATION\n2\n5,1,1.,6,1,-1.\n").replacen("*STATIC\n", "*STATIC\n*BOUNDARY\n5,1,1,.1\n6,1,1,.1\n", 1)
            + "*STEP\n*STATIC\n*BOUNDARY, OP=NEW\n1,1,3\n2,2,3\n3,3,3\n4,1,1\n4,3,3\n*END STEP\n";
    assert!(matches!(refused(&two_steps), CleanError::CasesDiffer { found: 1, common: 0, .. }));
    let conflict =
        brick("*EQUATION\n2\n5,1,1.,6,1,-1.\n").replacen("*STATIC\n", "*STATIC\n*BOUNDARY\n5,1,1,.1\n6,1,1,.2\n", 1);
    assert!(matches!(refused(&conflict), CleanError::Conflicting { .. }));
}
