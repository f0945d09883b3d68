//! Load steps: what is prescribed and which equations are in force in each.

use qless_io::deck::clean;

use crate::parse::{deck, in_force, prescribed, warnings};

#[test]
fn equations_of_each_step() {
    let text = "CE,1,0,1,UX,1,2,UX,-1\nCE,2,0,3,UX,1\nCP,1,UY,1,2\nLSWRITE,1\n\
        CECMOD,1,0.5\nCEDELE,2\nCP,1,UY,3\nLSWRITE,2\nCEDELE,ALL\nCPDELE,ALL\nCE,1,0,9,UX,1\nLSWRITE,3\nLSSOLVE,1,3\n";
    let deck = deck(text);
    assert!(warnings(&deck).is_empty(), "{:?}", warnings(&deck));
    assert_eq!(deck.model().cases().len(), 3);
    assert_eq!(in_force(&deck, 0), ["1:1 1, 2:1 -1 = 0", "3:1 1 = 0", "2:2 1, 1:2 -1 = 0"]);
    assert_eq!(in_force(&deck, 1), ["1:1 1, 2:1 -1 = 0.5", "2:2 1, 1:2 -1 = 0", "3:2 1, 1:2 -1 = 0"]);
    assert_eq!(in_force(&deck, 2), ["9:1 1 = 0"]);
}

#[test]
fn terms_that_come_later_hold_later() {
    let deck = deck("CE,1,0,1,UX,1,2,UX,-1\nSOLVE\nCE,1,0,3,UX,1\nCE,5,0,8,UX,1\nSOLVE\nCE,1,0,-2,UX\nSOLVE\n");
    assert_eq!(in_force(&deck, 0), ["1:1 1, 2:1 -1 = 0"]);
    assert_eq!(in_force(&deck, 1), ["8:1 1 = 0", "1:1 1, 2:1 -1, 3:1 1 = 0"]);
    assert_eq!(in_force(&deck, 2), ["1:1 1, 3:1 1 = 0", "8:1 1 = 0"]);
}

#[test]
fn conflicts_are_those_of_one_step() {
    let text = "CE,1,0,1,UX,1,2,UX,-1\nD,1,UX,1\nSOLVE\nCECMOD,1,1\nD,1,UX,2\nD,2,UX,1\nSOLVE\n";
    let deck = deck(text);
    let conflicts = |case: usize| {
        let system = deck.model().system(&deck.model().cases()[case]).expect("a system");
        let analysis = qless::analyse(&system, &qless::Options::default()).expect("analysed");
        analysis.dependent().iter().filter(|dependent| dependent.kind == qless::Kind::Conflicting).count()
    };
    assert_eq!((conflicts(0), conflicts(1)), (0, 0));
    assert_eq!((prescribed(&deck, 0), prescribed(&deck, 1).len()), (vec!["1:1 1".to_owned()], 2));
}

#[test]
fn tables_are_courses() {
    let deck =
        deck("*DIM,RAMP,TABLE,2,,,TIME\nRAMP(1,0)=0,1\nD,1,UX,%RAMP%\nD,2,UX,%other%\nD,3,UX,%ramp%\nD,4,UX,2\n");
    let histories: Vec<Option<&str>> = deck.model().histories().collect();
    assert_eq!(histories, [None, Some("RAMP"), Some("OTHER")]);
    let given = &deck.model().cases()[0].prescribed;
    assert_eq!(given.iter().map(|given| given.history).collect::<Vec<_>>(), [1, 2, 1, 0]);
    assert_eq!(prescribed(&deck, 0), ["1:1 1", "2:1 1", "3:1 1", "4:1 2"]);
    let number = crate::parse::deck("A=3\nD,1,UX,%A%\n");
    assert_eq!((prescribed(&number, 0), number.model().histories().count()), (vec!["1:1 3".to_owned()], 1));
}

#[test]
fn decks_whose_equations_change_are_not_cleaned() {
    let before = deck("CE,1,0,1,UX,1,2,UX,1\nSOLVE\nCE,2,0,1,UX,2,2,UX,2\nSOLVE\n");
    let error = clean::plan(&before, &qless::Options::default()).expect_err("which load step?").to_string();
    assert!(error.starts_with("load step 1 has other equations than earlier load cases"), "{error}");
}
