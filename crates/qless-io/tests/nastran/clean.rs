//! Cleaned decks: independent, each dependent component once and not prescribed, equivalent, unchanged the second time.

use qless::{Kind, Options, SystemBuilder, analyse};
use qless_io::deck::clean::{faults, plan, write};
use qless_io::deck::{Deck, Model};

use super::given::parsed;

/// The cleaned text, which is checked to be what it has to be.
fn cleaned(text: &str, files: &[(&str, &str)]) -> String {
    let before = parsed(text, files).unwrap_or_else(|error| panic!("{error}"));
    let after = clean(&before);
    let deck = parsed(&after, files).unwrap_or_else(|error| panic!("{error}\n{after}"));
    for (case, old) in deck.model().cases().iter().zip(before.model().cases()) {
        assert_eq!(case.prescribed.len(), old.prescribed.len());
        let analysis =
            analyse(&deck.model().system(case).expect("a system"), &Options::default()).expect("an analysis");
        assert!(analysis.kinds().iter().all(|kind| *kind == Kind::Independent), "{after}");
    }
    assert_eq!(faults(deck.model()), [], "{after}");
    assert_eq!(clean(&deck), after, "the second time changes something");
    assert_same_space(before.model(), deck.model());
    after
}

pub fn clean(deck: &Deck) -> String {
    let plan = plan(deck, &Options::default()).unwrap_or_else(|error| panic!("{error}"));
    let text = write(deck, &plan).unwrap_or_else(|error| panic!("{error}"));
    String::from_utf8(text).expect("text")
}

/// On the free DOFs of the first load case both span the same.
pub fn assert_same_space(before: &Model, after: &Model) {
    let rank = |models: &[&Model]| {
        let mut columns = std::collections::BTreeMap::new();
        let mut rows = Vec::new();
        for model in models {
            let given = &model.cases()[0].prescribed;
            for i in 0..model.equations() {
                let equation = model.equation(i).expect("an equation");
                let mut row = Vec::new();
                for (&j, &a) in equation.columns.iter().zip(equation.coefficients) {
                    let dof = model.dofs()[j as usize];
                    if given.binary_search_by_key(&dof, |given| given.dof).is_err() {
                        let next = columns.len();
                        row.push((*columns.entry(dof).or_insert(next), a));
                    }
                }
                rows.push(row);
            }
        }
        let mut builder = SystemBuilder::new(columns.len().max(1));
        for row in rows {
            builder.equation(row, 0.0);
        }
        let options = Options { presolve: false, ..Options::default() };
        analyse(&builder.build().expect("a system"), &options).expect("an analysis").rank()
    };
    assert_eq!([rank(&[before, after]), rank(&[before]), rank(&[after])], [rank(&[before]); 3]);
}

const GRIDS: &str = "GRID,1\nGRID,2,,1.\nGRID,3,,,2.\nGRID,4,,,,3.\n";

#[test]
fn a_sound_deck_stays_as_it_is() {
    let text = format!("CEND\nMPC=1\nBEGIN BULK\r\n{GRIDS}RBE2,7,1,123,2\nMPC,1,3,1,1.,4,1,-1.");
    assert_eq!(cleaned(&text, &[]), text);
}

#[test]
fn a_repeated_equation_becomes_a_comment() {
    let text = format!("CEND\nMPC=1\nBEGIN BULK\n{GRIDS}MPC,1,3,1,1.,4,1,-1.\nMPC,1,4,1,2.,3,1,-2.\n");
    let comment = "$ qless: line 9 MPC 1 removed, redundant: line 9 MPC 1 4:1 = -2 * (line 8 MPC 1 3:1)\n";
    let expected = text.replace("MPC,1,4,1,2.,3,1,-2.\n", comment);
    assert_eq!(cleaned(&text, &[]), expected);
}

#[test]
fn a_prescribed_dependent_component_is_exchanged() {
    let text = format!("SOL 101\nCEND\nSPC=2\nBEGIN BULK\n{GRIDS}RBE2,7,1,123,2\nSPC1,2,3,2\nENDDATA\n");
    let after = cleaned(&text, &[]);
    assert!(after.contains("CEND\n$ qless: selects the equations written below\nMPC = 1\nSPC=2\n"), "{after}");
    assert!(after.contains("BEGIN BULK\n$ qless: independent"), "{after}");
    let comment = "$ qless: line 9 RBE2 7 written anew as MPC: 2:3 is the slave of line 9 RBE2 7, and prescribed in line 10 SPC1 2\n";
    assert!(after.contains(comment), "{after}");
}

#[test]
fn closed_loops_of_rigid_elements_lose_an_element_or_become_equations() {
    let loops = "RBE2,1,1,123456,2\nRBE2,2,2,123456,3\nRBE2,3,3,123456,1\nRBAR,4,4,1,123456\n";
    let edited = cleaned(&format!("CEND\nBEGIN BULK\n{GRIDS}{loops}"), &[]);
    assert!(!edited.contains("MPC*") && edited.contains("RBAR,4,4,1,123456\n"), "{edited}");
    // The dependent component of the MPC depends on itself through the loop.
    let after = cleaned(&format!("CEND\nMPC = 6\nBEGIN BULK\n{GRIDS}MPCADD,6,8,9\nMPC,8,4,1,1.,3,1,-1.\n{loops}"), &[]);
    assert!(after.contains("MPC*                   8"), "{after}");
}

/// The third grid point is dependent twice, and rigid anyway: one element loses it, and nothing else changes.
#[test]
fn a_grid_point_that_two_elements_share_leaves_one_of_them() {
    let grids = (5..=30).fold(String::new(), |text, k| text + &format!("GRID,{k},,{k}.,1.,{}.\n", k % 3));
    let many: Vec<String> = (5..=30).map(|point| point.to_string()).collect();
    let wide = |points: &str| format!("RBE2          12       2  123456{points}\n");
    let long = many.iter().zip(4..).fold(String::new(), |text, (point, field)| {
        text + &format!("{}{point:>8}", if field % 8 == 1 { "+\n+       " } else { "" })
    });
    for (second, expected) in [
        ("RBE2,12,2,123456,3,4\n".to_owned(), wide("       4")),
        ("RBE2,12,2,123456,4,THRU,6\n+,3\n".to_owned(), wide("       4       5       6")),
        (format!("RBE2,12,2,123456,3,{}\n", many.join(",")), wide(&long)),
    ] {
        let text = format!("SOL 101\nCEND\nBEGIN BULK\n{GRIDS}{grids}RBE2,11,1,123456,2,3\n{second}ENDDATA\n");
        let comment = "$ qless: 3 of line 35 RBE2 12 removed, redundant: line 35 RBE2 12 3:1 = \
                       -1 * (line 34 RBE2 11 2:1) + 2 * (line 34 RBE2 11 2:6) + 1 * (line 34 RBE2 11 3:1)\n";
        assert_eq!(cleaned(&text, &[]), text.replace(&second, &(comment.to_owned() + &expected)));
    }
    // The lines of the card are apart.
    let text = format!("CEND\nBEGIN BULK\n{GRIDS}RBE2,11,1,123456,2,3\nRBE2,12,2,123456,3,+A\nGRID,5\n+A,4\n");
    let after = cleaned(&text, &[]);
    let apart = "RBE2          12       2  123456       4\nGRID,5\n$ qless: continuation of a removed card\n";
    assert!(after.ends_with(apart), "{after}");
    // Copies need their text.
    let copies = format!("CEND\nBEGIN BULK\n{GRIDS}RBE2,11,1,123456,2,3\nRBE2,12,2,123456,3\n=,*1,*1,=,*1\n");
    let after = cleaned(&copies, &[]);
    assert!(after.ends_with("RBE2          11       1  123456       2\nRBE2,12,2,123456,3\n=,*1,*1,=,*1\n"), "{after}");
}

#[test]
fn bulk_data_alone_are_cleaned() {
    let after = cleaned(&format!("{GRIDS}RBE2,1,1,123456,2\nRBE2,2,3,123456,2\n"), &[]);
    assert!(after.contains("MPC*                   1"), "{after}");
}

#[test]
fn an_included_file_that_changes_is_written_in() {
    let files = [("mesh.inc", GRIDS), ("ties.inc", "INCLUDE 'mesh.inc'\nMPC,1,3,1,1.,4,1,-1.\nMPC,1,4,1,2.,3,1,-2.")];
    let after = cleaned("CEND\nMPC=1\nBEGIN BULK\nINCLUDE 'ties.inc'\nENDDATA\n", &files);
    let expected = format!(
        "CEND\nMPC=1\nBEGIN BULK\n$ qless: included here, because it was changed\n$ qless: included here, because it was changed\n{GRIDS}MPC,1,3,1,1.,4,1,-1.\n\
         $ qless: ties.inc:3 MPC 1 removed, redundant: ties.inc:3 MPC 1 4:1 = -2 * (ties.inc:2 MPC 1 3:1)\nENDDATA\n"
    );
    assert_eq!(after, expected);
}

#[test]
fn a_set_that_loses_its_last_card_is_not_selected_any_more() {
    let text = format!("CEND\nMPC=5\nBEGIN BULK\n{GRIDS}RBE2,1,1,123456,2\nMPC,5,2,1,1.,1,1,-1.\n");
    let after = cleaned(&text, &[]);
    assert!(after.contains("CEND\n$ qless: MPC = 5 removed, as the set has no cards left\nBEGIN"), "{after}");
}

#[test]
fn a_selection_of_set_0_gives_way_to_the_new_one() {
    let text = format!("CEND\nMPC=3\nSUBCASE 1\nSPC=2\nMPC=0\nBEGIN BULK\n{GRIDS}RBE2,7,1,123,2\nSPC1,2,3,2\n");
    let after = cleaned(&text, &[]);
    let control = "MPC = 4\n$ qless: MPC = 3 removed, as another set is selected\nSUBCASE 1\nSPC=2\n\
                   $ qless: MPC = 0 removed, as another set is selected\nBEGIN BULK\n";
    assert!(after.contains(control), "{after}");
}

#[test]
fn what_cannot_be_cleaned_is_said() {
    let refused_with = |text: &str, files: &[(&str, &str)]| {
        let deck = parsed(text, files).unwrap_or_else(|error| panic!("{error}"));
        let plan = plan(&deck, &Options::default());
        plan.and_then(|plan| write(&deck, &plan)).map_or_else(|error| error.to_string(), |_| "cleaned".into())
    };
    let refused = |text: &str| refused_with(text, &[]);
    let differ = format!(
        "CEND\nSUBCASE 1\nMPC=1\nSPC=2\nSUBCASE 2\nSPC=2\nBEGIN BULK\n{GRIDS}MPC,1,1,1,1.,2,1,-1.\nSPC1,2,1,1\n"
    );
    assert_eq!(refused(&differ), "cleaned");
    let union = format!("CEND\nMPC=9\nBEGIN BULK\n{GRIDS}RBE2,1,1,123456,2\nMPC,5,2,1,1.,1,1,-1.\nMPCADD,9,5\n");
    assert_eq!(refused(&union), "cleaned");
    let warm = format!("{GRIDS}RBE2,1,1,123,2,1.-5\nRBE2,2,1,123,2,1.-5\n");
    assert!(refused(&warm).contains("cannot be replaced by equations"), "{}", refused(&warm));
    let begins = "MPC=1\nBEGIN BULK\nMPC,1,1,1,0.,2,1,-1.\n";
    let twice = refused_with("CEND\nINCLUDE 'bulk.inc'\nINCLUDE 'bulk.inc'\n", &[("bulk.inc", begins)]);
    assert!(twice.contains("bulk.inc:3: ") && twice.contains("included more than once"), "{twice}");
}

#[test]
fn a_selection_stands_after_cend_wherever_that_is() {
    let files = [("exec.inc", "SOL 101\nCEND\n")];
    let text = format!("INCLUDE 'exec.inc'\nSPC=2\nBEGIN BULK\n{GRIDS}RBE2,7,1,123,2\nSPC1,2,3,2\n");
    let after = cleaned(&text, &files);
    assert!(
        after.contains("changed\nSOL 101\nCEND\n$ qless: selects the equations written below\nMPC = 1\nSPC=2\n"),
        "{after}"
    );
}

/// A translation follows a rotation on an arm of 2e6 units of length: a large coefficient, but no vanishing slave.
#[test]
fn long_arms_are_no_fault() {
    for arm in ["2.+6", "3.+9"] {
        let text = format!("GRID,1\nGRID,2,,{arm}\nRBE2,7,1,123456,2\nRBE3,8,,3,123456,1.,123456,2\nGRID,3,,,1.\n");
        assert_eq!(cleaned(&text, &[]), text);
        cleaned(&format!("{text}RBE2,9,2,123456,1\n"), &[]);
    }
}

/// What a subcase loses can make it the same as another: then they are one load case, which says what both said.
#[test]
fn subcases_may_come_to_constrain_alike() {
    let text = "SOL 101\nCEND\nSPC = 1\nSUBCASE 1\nLOAD = 3\nSUBCASE 2\nMPC = 2\nLOAD = 3\nBEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\n\
        GRID,3,,1.,0.,0.\nRBE2,5,2,1,3\nMPC,2,3,1,1.,2,1,-1.\nSPC1,1,123456,1\nENDDATA\n";
    let deck = |text: &str| parsed(text, &[]).expect("a deck");
    let before = deck(text);
    assert_eq!(before.model().cases().len(), 2);
    let again = deck(&clean(&before));
    assert_eq!((again.model().cases().len(), again.model().equations()), (1, 1));
}
