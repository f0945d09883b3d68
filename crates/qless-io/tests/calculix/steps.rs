//! Prescribed values by step, and their time histories.

use std::fmt::Write;

use qless_io::deck::Model;
use qless_io::deck::Solver::{Abaqus, Ccx};
use qless_io::deck::clean;

use super::from_text::{BRICK, brick, parsed, prescribed, refused, warnings};

const COURSES: &str = "*AMPLITUDE, NAME=up\n0.,0.,1.,1.\n*AMPLITUDE, NAME=DOWN\n0.,1.,1.,0.\n";

fn cases(model: &Model) -> Vec<Vec<String>> {
    model.cases().iter().map(|case| prescribed(model, case)).collect()
}

fn steps(model: &str, steps: &[&str]) -> String {
    let step = |cards: &&str| format!("*STEP\n*STATIC\n{cards}*END STEP\n");
    format!("{model}{}", steps.iter().map(step).collect::<String>())
}

#[test]
fn a_value_runs_as_its_amplitude() {
    let cards = "*BOUNDARY, AMPLITUDE=Up\n5,1,1,.1\n6,1\n*BOUNDARY, AMPLITUDE=UP, TIME DELAY=.5\n7,1,1,.1\n*BOUNDARY\n8,1,1,.1\n";
    let model = brick(Ccx, &format!("{COURSES}{cards}"));
    assert_eq!(prescribed(&model, &model.cases()[0]), ["5:1=0.1 UP", "6:1=0", "7:1=0.1 UP .5 later", "8:1=0.1"]);
    let message = refused(Ccx, &format!("{BRICK}*BOUNDARY, AMPLITUDE=NONE\n5,1,1,.1\n"));
    assert!(message.contains("*BOUNDARY: amplitude NONE is not defined"), "{message}");
}

#[test]
fn values_of_one_step_clash_where_their_courses_differ() {
    let clashes = |cards: &str| brick(Ccx, &steps(COURSES, &[cards])).cases()[0].clashes.len();
    let up = "*BOUNDARY, AMPLITUDE=UP\n5,1,1,.1\n";
    assert_eq!(clashes(&format!("{up}{up}")), 0);
    assert_eq!(clashes(&format!("{up}*BOUNDARY, AMPLITUDE=DOWN\n5,1,1,.1\n")), 1);
    assert_eq!(clashes(&format!("{up}*BOUNDARY\n5,1,1,.1\n")), 1);
    // A value of zero is the same in every time history.
    assert_eq!(clashes("*BOUNDARY, AMPLITUDE=DOWN\n5,1\n*BOUNDARY\n5,1\n"), 0);
}

#[test]
fn a_step_inherits_and_replaces() {
    let model = brick(Ccx, &steps("*BOUNDARY\n5,1,1,.1\n", &["*BOUNDARY\n5,1,1,.2\n6,1\n", "*BOUNDARY\n6,1,1,.3\n"]));
    assert_eq!(cases(&model), [vec!["5:1=0.2", "6:1=0"], vec!["5:1=0.2", "6:1=0.3"]]);
    assert!(model.cases().iter().all(|case| case.clashes.is_empty()));
}

#[test]
fn op_new_forgets_earlier_values_and_their_clashes() {
    let twice = "*BOUNDARY\n5,1,1,.1\n5,1,1,.2\n";
    let model = brick(Ccx, &steps("", &[twice, "*BOUNDARY, OP=NEW\n6,1\n"]));
    assert_eq!(cases(&model), [["5:1=0.1"], ["6:1=0"]]);
    assert_eq!(model.cases().iter().map(|case| case.clashes.len()).collect::<Vec<_>>(), [1, 0]);
    // This holds for the values before the first step too.
    assert_eq!(cases(&brick(Ccx, &steps("*BOUNDARY\n5,1\n", &["*BOUNDARY, OP=NEW\n6,1\n"]))), [["6:1=0"]]);
}

#[test]
fn ccx_heeds_op_new_on_the_first_card_of_a_step_only() {
    let text = steps("", &["*BOUNDARY\n5,1,1,.1\n", "*BOUNDARY\n6,1\n*BOUNDARY, OP=NEW\n7,1\n"]);
    let ccx = brick(Ccx, &text);
    assert_eq!(cases(&ccx)[1], ["5:1=0.1", "6:1=0", "7:1=0"]);
    assert!(warnings(&ccx).contains("ccx ignores OP=NEW"));
    assert_eq!(cases(&brick(Abaqus, &text))[1], ["6:1=0", "7:1=0"]);
}

#[test]
fn values_that_are_not_in_the_deck_are_said_to_be_so() {
    let said = "values that are not in the deck, such as that of ";
    for source in ["USER", "SUBMODEL, STEP=1"] {
        // Neither of the two values of 5:1 contradicts the other, in any order.
        for cards in ["5,1\n*BOUNDARY\n5,1,1,2.\n", "6,1\n*BOUNDARY\n5,1,1,2.\n*BOUNDARY,USER\n5,1\n"] {
            // They matter where equations have them.
            for (equation, is_incomplete) in [("", false), ("*EQUATION\n3\n8,1,1.,5,1,-1.,6,1,1.\n", true)] {
                let read = brick(Ccx, &format!("{equation}*BOUNDARY, {source}\n{cards}"));
                assert!((1..=2).contains(&warnings(&read).matches(said).count()), "{}", warnings(&read));
                assert_eq!(read.left_out().count() > 0, is_incomplete, "{}", warnings(&read));
                assert!(read.left_out().all(|one| one.text.contains(said)) && read.cases()[0].clashes.is_empty());
            }
        }
    }
}

/// `FIXED` holds what the step before reaches. This is in the deck if the DOF was prescribed.
#[test]
fn fixed_values_are_those_that_the_step_before_reaches() {
    let read = |model: &str, cards: &[&str]| brick(Ccx, &steps(model, cards));
    let known = read("", &["*BOUNDARY\n5,1,1,.1\n6,1\n", "*BOUNDARY, FIXED, OP=NEW\n5,1\n6,1\n"]);
    assert_eq!((cases(&known)[1].clone(), known.left_out().count()), (vec!["5:1=0.1".into(), "6:1=0".into()], 0));
    let clash = read("", &["*BOUNDARY\n5,1,1,.1\n", "*BOUNDARY, FIXED\n5,1\n*BOUNDARY\n5,1,1,.2\n"]);
    assert_eq!((clash.cases()[1].clashes.len(), clash.left_out().count()), (1, 0));
    let course = read(COURSES, &["*BOUNDARY, AMPLITUDE=UP\n5,1,1,.1\n", "*BOUNDARY, FIXED\n5,1\n"]);
    assert_eq!(cases(&course)[1], ["5:1=0.1 UP at its end"]);
    let first = read("*BOUNDARY\n6,1,1,.1\n", &["*BOUNDARY, FIXED\n5,1\n6,1\n"]);
    assert_eq!((cases(&first)[0].clone(), first.left_out().count()), (vec!["5:1=0".into(), "6:1=0".into()], 0));
    let unknown = read("", &["", "*BOUNDARY, FIXED\n5,1\n*BOUNDARY\n5,1,1,.2\n", "*BOUNDARY, FIXED\n5,1\n"]);
    assert!(unknown.cases().iter().all(|case| case.clashes.is_empty()));
    let said = "values that are not in the deck, such as that of 5:1, count as 0: no equation has these DOFs";
    assert_eq!(warnings(&unknown).matches(said).count(), 2, "{}", warnings(&unknown));
}

#[test]
fn removed_equations_are_those_of_all_cards_and_stay_removed() {
    let cards = "*EQUATION\n2\n5,3,1.,6,3,-1.\n2\n7,3,1.,6,3,-1.\n*COUPLING, REF NODE=9, SURFACE=STOP, CONSTRAINT NAME=C\n*KINEMATIC\n1,1\n";
    let removed = |first: &str, second: &str| {
        let model = brick(Ccx, &steps(cards, &["", first, second]));
        model.cases().iter().map(|case| case.removed.clone()).collect::<Vec<_>>()
    };
    assert_eq!(removed("*EQUATION, REMOVE\n5,3\n", "*EQUATION, REMOVE\n5,1\n"), [vec![], vec![0], vec![0, 2]]);
    assert_eq!(removed("*EQUATION, REMOVE\nTOP,1,3\n", ""), [vec![], vec![0, 1, 2, 3, 4, 5], vec![0, 1, 2, 3, 4, 5]]);
    assert_eq!(removed("", "*EQUATION, REMOVE ALL\n"), [vec![], vec![], vec![0, 1, 2, 3, 4, 5]]);
}

/// Nine equations solved for other slaves: rounding errors of prescribed values are no contradiction.
#[test]
fn rounding_of_a_prescribed_value_is_no_other_meaning() {
    let text = "*NODE\n9,2.05693945,1.882106,0.0930959197\n12,2.06892053,-0.0304074738,1.06699813\n\
        17,0.960684407,2.11358376,0.98903291\n101,0.5,0.5,1.51\n100,0.5291,0.4248,0.0395\n*NSET,NSET=S100\n17,\n12,\n9\n\
        *RIGID BODY,NSET=S100,REF NODE=100,ROT NODE=101\n*BOUNDARY\n9,3,3,0.005\n";
    let deck = parsed(Ccx, text).expect("a deck");
    let plan = clean::plan(&deck, &qless::Options::default()).expect("a plan");
    assert_eq!(plan.written.len(), 9);
    clean::write(&deck, &plan).expect("the same meaning");
}

/// A card that names no slave of the deck may name one of the cleaned equations. 2,000 decks of clashing equations with such cards.
#[test]
fn removals_remove_the_same_from_a_cleaned_deck() {
    let mut state = 7_u64;
    let mut draw = |most: u64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % most
    };
    let nodes = "*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n3,0.,1.,0.\n4,0.,0.,1.\n5,1.,1.,0.\n";
    let mut cleaned = 0;
    for seed in 0..2000 {
        let mut text = format!("{nodes}*EQUATION\n");
        for _ in 0..2 + draw(3) {
            let slave = 1 + draw(5);
            let (master, weight) = (1 + (slave + draw(4)) % 5, [-1, 2][draw(2) as usize]);
            write!(text, "2\n{slave},1,1.,{master},1,{weight}.\n").expect("a string");
        }
        for _ in 0..=draw(2) {
            write!(text, "*STEP\n*STATIC\n*EQUATION, REMOVE\n{},1,3\n*END STEP\n", 1 + draw(5)).expect("a string");
        }
        let deck = parsed(Ccx, &text).expect("a deck");
        let written = clean::plan(&deck, &qless::Options::default()).and_then(|plan| clean::write(&deck, &plan));
        if let Err(error) = &written {
            let is_known = !matches!(error, clean::CleanError::Unproven { .. });
            assert!(is_known, "deck {seed}: {error}\n{text}");
        }
        cleaned += usize::from(written.is_ok());
    }
    assert!(cleaned > 500, "{cleaned} decks were cleaned");
}
