//! What holds in which subcase, what excludes what, and what `clean` writes where.

use qless_io::deck::Model;
use qless_io::deck::clean::{faults, faults_in};

use super::clean::clean;
use super::given::{model, parsed, refusals, warnings};

const GRIDS: &str = "GRID,1\nGRID,2,,1.\nGRID,3,,2.\n";

fn described(model: &Model) -> Vec<Vec<String>> {
    let of = |case| faults_in(model, case).iter().map(|fault| fault.describe(model)).collect();
    model.cases().iter().map(of).collect()
}

#[test]
fn sets_of_different_subcases_do_not_clash() {
    let control = "CEND\nSUBCASE 1\nSPC=1\nMPC=1\nSUBCASE 2\nSPC=2\nMPC=2\nSUBCASE 3\nSPC=1\nMPC=2\nBEGIN BULK\n";
    let sets = "SPC1,1,1,1\nSPC1,2,2,1\nMPC,1,1,2,1.,2,2,-1.\nMPC,2,1,1,1.,2,1,-1.\nMPC,1,3,1,1.,2,1,-1.\nMPC,2,3,1,1.,2,2,-1.\n";
    let model = model(&format!("{control}{GRIDS}{sets}"));
    let found = described(&model);
    assert_eq!(found[..2], [vec![], vec![]] as [Vec<String>; 2]);
    assert_eq!(found[2], ["1:1 is the slave of line 18 MPC 2, and prescribed in line 15 SPC1 1"]);
    assert_eq!(faults(&model).len(), 1);
}

#[test]
fn sets_of_one_subcase_do() {
    let text = format!("CEND\nMPC=9\nBEGIN BULK\n{GRIDS}MPC,1,1,1,1.,2,1,-1.\nMPC,2,1,1,1.,3,1,-1.\nMPCADD,9,1,2\n");
    assert_eq!(described(&model(&text)), [["1:1 is the slave of line 7 MPC 1, and of line 8 MPC 2"]]);
}

#[test]
fn sets_exclude_each_other() {
    let text = |card: &str| format!("CEND\nSPC=1\nBEGIN BULK\n{GRIDS}RBE2,9,1,123456,2\nSPC1,1,1,1\n{card}\n");
    for (card, name) in [
        ("ASET,2,1", "ASET 2"),
        ("ASET1,1,1,THRU,2", "ASET1 1"),
        ("OMIT,2,1", "OMIT 2"),
        ("OMIT1,1,2", "OMIT1 1"),
        ("SUPORT,2,1", "SUPORT 2"),
        ("QSET,2,1", "QSET 2"),
        ("BSET1,1,2", "BSET1 1"),
        ("CSET,3,1,2,1", "CSET 3"),
    ] {
        let model = model(&text(card));
        let expected =
            format!("2:1 is the slave of line 7 RBE2 9, and in the set of line 9 {name}, which excludes slaves");
        assert_eq!(described(&model), [[expected]], "{card}");
    }
    assert_eq!(described(&model(&text("ASET,1,3"))), [[""; 0]]);
}

#[test]
fn two_sets_of_one_component_are_named() {
    let model = model(&format!("CEND\nSPC=1\nBEGIN BULK\n{GRIDS}ASET,1,12\nOMIT1,1,1,3\nSPC1,1,2,1\n"));
    let expected = [
        "line 8: 1:1 is in the sets of line 7 ASET 1 and of line 8 OMIT1 1, which exclude each other",
        "line 9: 1:2 is in the sets of line 7 ASET 1 and of line 9 SPC1 1, which exclude each other",
    ];
    assert_eq!(refusals(&model), expected);
}

#[test]
fn rigid_elements_with_multipliers_have_no_slaves() {
    let text = |rigid: &str| {
        format!(
            "CEND\n{rigid}\nSPC=1\nMPC=1\nBEGIN BULK\n{GRIDS}RBE2,9,1,123456,2\nMPC,1,3,1,1.,2,1,-1.\nSPC1,1,1,2,3\n"
        )
    };
    assert_eq!(described(&model(&text("RIGID=LINEAR")))[0].len(), 2);
    let multiplied = model(&text("RIGID = LAGRAN"));
    assert_eq!(described(&multiplied), [["3:1 is the slave of line 10 MPC 1, and prescribed in line 11 SPC1 1"]]);
    assert!(
        warnings(&multiplied)[0].starts_with("line 2: RIGID: Lagrange multipliers or stiffness enforce"),
        "{:?}",
        warnings(&multiplied)
    );
}

/// Another `CEND` is no end of executive control: the new selection stands above the first subcase.
#[test]
fn a_second_end_of_executive_control_is_none() {
    let text = format!(
        "SOL 101\nCEND\nSUBCASE 1\nSPC=2\nCEND\nSUBCASE 2\nSPC=2\nLOAD=1\nBEGIN BULK\n{GRIDS}RBE2,7,1,123,2\nSPC1,2,3,2\n"
    );
    let after = clean(&parsed(&text, &[]).unwrap_or_else(|error| panic!("{error}")));
    assert!(
        after.starts_with("SOL 101\nCEND\n$ qless: selects the equations written below\nMPC = 1\nSUBCASE 1\n"),
        "{after}"
    );
    assert_eq!(faults(parsed(&after, &[]).expect("a deck").model()), []);
}

/// Each subcase gets the equations that it needs, whatever the others prescribe or select; `clean::write` proves them the same.
#[test]
fn subcases_are_cleaned_one_by_one() {
    let bulk = "RBE2,7,1,123,2\nMPC,1,3,1,1.,1,1,-1.\nMPC,2,3,1,1.,2,1,-1.\nMPC,2,3,1,2.,2,1,-2.\nSPC1,1,123,1\nSPC1,2,123,2\nMPCADD,9,1,2\n";
    for control in [
        "SUBCASE 1\nSPC=1\nMPC=1\nSUBCASE 2\nSPC=2\nMPC=2\n",
        "SPC=2\nSUBCASE 1\nMPC=1\nSUBCASE 2\nMPC=9\nSUBCASE 3\nMPC=2\nSPC=1\n",
        "MPC=9\nSUBCASE 5\nSPC=1\nSUBCASE 6\nSPC=2\nSUBCASE 7\nSPC=2\nMPC=0\n",
        "SPC=1\nSUBCASE 1\nSUBCASE 2\nMPC=2\nSUBCASE 3\nMPC=9\n",
        "SUBCASE 1\nMPC=9\nSTEP 1\nSPC=1\nSTEP 2\nSPC=2\nSUBCASE 2\nMPC=1\nSTEP 1\nSPC=1\n",
    ] {
        let before = parsed(&format!("SOL 101\nCEND\n{control}BEGIN BULK\n{GRIDS}{bulk}ENDDATA\n"), &[]);
        let before = before.unwrap_or_else(|error| panic!("{error}"));
        let after = clean(&before);
        assert_ne!(after.as_bytes(), before.texts()[0].as_slice());
        let deck = parsed(&after, &[]).unwrap_or_else(|error| panic!("{error}\n{after}"));
        assert_eq!(faults(deck.model()), [], "{after}");
        assert_eq!(clean(&deck), after, "the second time changes something");
        let names =
            |deck: &qless_io::deck::Deck| deck.model().cases().iter().map(|case| case.name.clone()).collect::<Vec<_>>();
        assert_eq!(names(&deck), names(&before));
    }
}

#[test]
fn a_value_is_said_to_be_that_of_its_subcase() {
    let control = "CEND\nMPC=1\nSUBCASE 1\nSUBCASE 2\nSPC=2\nSUBCASE 3\nBEGIN BULK\n";
    let model = model(&format!("{control}{GRIDS}SPC1,2,1,1\nMPC,1,1,1,1.,2,1,-1.\n"));
    let expected = "1:1 is the slave of line 12 MPC 1, and prescribed in line 11 SPC1 2 in subcase 2";
    assert_eq!(faults(&model).iter().map(|fault| fault.describe(&model)).collect::<Vec<_>>(), [expected]);
}

#[test]
fn unions_of_unions_and_of_a_set_twice_are_refused() {
    let mpcs = "MPC,1,1,1,1.,2,1,-1.\nMPC,2,1,2,1.,2,2,-1.\nMPCADD,8,1,1\nMPCADD,9,2,7\nMPCADD,7,1\n";
    let of = |set: u32| refusals(&model(&format!("CEND\nMPC={set}\nBEGIN BULK\n{GRIDS}{mpcs}")));
    assert_eq!(of(8), ["line 9: MPCADD 8 names set 1 twice, which the solver refuses: name it once"]);
    assert_eq!(of(9), ["line 10: MPCADD 9 names the union 7, which the solver refuses: name its sets"]);
    assert_eq!(of(7), [""; 0]);
}
