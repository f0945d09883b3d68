//! Decks written back: independent equations, each slave once and never prescribed; all else byte for byte.

use qless::Options;
use qless_io::deck::clean;

use crate::parse::{deck, equations, refused};

/// The cleaned text, which a second time leaves as it is and which has the same rank.
fn cleaned(text: &str) -> String {
    let before = deck(text);
    let plan = clean::plan(&before, &Options::default()).expect("a plan");
    let result = String::from_utf8(clean::write(&before, &plan).expect("written")).expect("text");
    let after = deck(&result);
    assert!(refused(&after).is_empty(), "{result}");
    assert!(clean::plan(&after, &Options::default()).expect("a plan").is_empty(), "{result}");
    for (old, new) in before.model().cases().iter().zip(after.model().cases()) {
        let rank = |deck: &qless_io::deck::Deck, case| {
            qless::analyse(&deck.model().system(case).expect("a system"), &Options::default()).expect("analysed").rank()
        };
        assert_eq!(rank(&before, old), rank(&after, new));
    }
    result
}

#[test]
fn a_deck_without_faults_stays_as_it_is() {
    let text = "/PREP7\r\nCE,1,0,1,UX,1,2,UX,-1 ! tie\r\n  D,2,UX,1 $ CP,1,UY,1,2\r\n";
    assert_eq!(cleaned(text), text);
}

#[test]
fn a_redundant_equation_becomes_a_comment() {
    let text = "/PREP7\nCE,R5.0,DEFI,       2,       1,  0.50000000    \n\
        CE,R5.0,NODE,         1,UX  ,  1.00000000    ,         2,UX  , -1.00000000    \n\
        CE,R5.0,DEFI,       2,       2,  1.00000000    \n\
        CE,R5.0,NODE,         2,UX  , -2.00000000    ,         1,UX  ,  2.00000000    \n\
        CECMOD,      1,  0.50000000    \nCECMOD,      2,  1.00000000    \n/GO\n";
    let expected = "/PREP7\nCE,R5.0,DEFI,       2,       1,  0.50000000    \n\
        CE,R5.0,NODE,         1,UX  ,  1.00000000    ,         2,UX  , -1.00000000    \n\
        ! qless: CE 2 removed, redundant: line 4 CE 2 2:1 = 2 * (line 2 CE 1 1:1)\n\
        CECMOD,      1,  0.50000000    \n/GO\n";
    assert_eq!(cleaned(text), expected);
}

#[test]
fn a_prescribed_slave_is_written_anew_in_the_form_of_the_deck() {
    let text = "CE,7,0.25,1,UX,1,2,UX,-1 ! tie\nD,1,UX,1\n";
    assert_eq!(cleaned(text), text, "ANSYS eliminates the other DOF");
    // A coupled set keeps ANSYS from that.
    let text = text.to_owned() + "CP,1,UX,2,3\n";
    assert_eq!(
        cleaned(&text),
        "! qless: CE 7 written anew below: 1:1 is the slave of line 1 CE 7, and prescribed in line 2 D\n\
         D,1,UX,1\n\
         ! qless: CP 1 written anew below: it shares DOFs with equations that are written anew below too\n\
         ! qless: independent equations; each slave, the first term, occurs once and is not prescribed\n\
         CE,8,-0.25,2,UX,1.0,1,UX,-1.0\nCE,9,-0.25,3,UX,1.0,1,UX,-1.0\n"
    );
    let archive = text.replace("CE,7,0.25,", "CE,R5.0,DEFI,2,7,.25\nCE,R5.0,NODE,");
    assert!(
        cleaned(&archive)
            .contains("CE,R5.0,DEFI,       2,       8,-0.25\nCE,R5.0,NODE,         2,UX  ,1.0,         1,UX  ,-1.0\n"),
        "{}",
        cleaned(&archive)
    );
    assert!(cleaned(&archive.replace("R5.0", "UNBL")).contains("CE,UNBL,DEFI,       2,       8,-0.25\nCE,UNBL,NODE,"));
}

#[test]
fn coupled_sets_that_overlap_become_equations() {
    let text = "CP,1,UX,1,2,3\r\nCP,2,UX,3,4,1\r\nCP,3,UY,1,2\r\n";
    let result = cleaned(text);
    assert!(result.contains("! qless: CP 1 written anew") && result.contains("CP,3,UY,1,2\r\n"), "{result}");
    let after = deck(&result);
    assert_eq!(after.model().equations(), 4);
    assert!(!result.replace("\r\n", "").contains('\n'));
}

#[test]
fn other_commands_on_the_line_stay() {
    let text = "/COM,x $ y\nCE,1,0,1,UX,1,2,UX,1 $ F,9,FX,2 $ CE,2,0,1,UX,2,2,UX,2 $ D,9,UY ! both\nFINISH\n";
    let expected = "/COM,x $ y\n! qless: CE 2 removed, redundant: line 2 CE 2 1:1 = 2 * (line 2 CE 1 1:1)\n\
        CE,1,0,1,UX,1,2,UX,1 $ F,9,FX,2 $ D,9,UY ! both\nFINISH\n";
    assert_eq!(cleaned(text), expected);
}

#[test]
fn an_equation_said_in_many_places_goes_everywhere() {
    let text = "CE,1,0,1,UX,1,2,UX,1,3,UX,1\nCE,2,0,1,UX,2\nCE,1,,4,UX,1\nCE,2,,2,UX,2,3,UX,2,4,UX,2\nSOLVE\n";
    let expected = "CE,1,0,1,UX,1,2,UX,1,3,UX,1\n! qless: CE 2 removed, redundant: line 2 CE 2 1:1 = 2 * (line 1 CE 1 1:1)\nCE,1,,4,UX,1\nSOLVE\n";
    assert_eq!(cleaned(text), expected);
}

#[test]
fn what_others_take_their_number_from_is_deleted_below() {
    let text = "CE,1,0,1,UX,1\nCE,5,0,1,UX,2\nCE,NEXT,0,3,UX,1\nCE,6,,4,UX,1\nD,1,UX\n";
    assert_eq!(equations(&deck(text)).len(), 3);
    assert_eq!(
        cleaned(text),
        "CE,1,0,1,UX,1\nCE,5,0,1,UX,2\nCE,NEXT,0,3,UX,1\nCE,6,,4,UX,1\n\
         ! qless: CE 1 removed: all of its DOFs are prescribed (1:1 in line 5 D)\nCEDELE,1\n\
         ! qless: CE 5 removed: all of its DOFs are prescribed (1:1 in line 5 D)\nCEDELE,5\nD,1,UX\n"
    );
}
