//! Several models in a deck: `/CLEAR` ends one and begins the next.

use qless_io::deck::clean::{self, faults};

use crate::parse::{deck, in_force, prescribed, try_deck, warnings};

/// Two models of the same nodes, neither of which has a fault.
const TWO: &str = "CP,1,UX,1,2\nD,4,UX,1\nSOLVE\nFINISH\n/CLEAR\n/PREP7\nCP,2,UX,2,3\nD,5,UX,2\nSOLVE\n";

#[test]
fn models_share_nothing() {
    let deck = deck(TWO);
    let names: Vec<&str> = deck.model().cases().iter().map(|case| case.name.as_str()).collect();
    assert_eq!(names, ["model 1, load step 1", "model 2, load step 1"]);
    assert_eq!(
        (in_force(&deck, 0), in_force(&deck, 1)),
        (vec!["2:1 1, 1:1 -1 = 0".into()], vec!["3:1 1, 2:1 -1 = 0".into()])
    );
    assert_eq!((prescribed(&deck, 0), prescribed(&deck, 1)), (vec!["4:1 1".into()], vec!["5:1 2".into()]));
    // Together they would conflict, and node 2 would be in two coupled sets.
    let count = |text: &str| faults(crate::parse::deck(text).model()).len();
    assert_eq!((count(TWO), count(&TWO.replace("/CLEAR", "")), warnings(&deck)), (0, 1, vec![]));
    let second = deck.model().equation(1).expect("two").origin;
    assert_eq!((deck.model().label(1).as_deref(), second.line), (Some("line 7 CP 2 3:1"), 7));
}

/// `/CLEAR` deletes nodes, components, parameters, selections, element types and the numbers of equations.
#[test]
fn nothing_survives() {
    let cleared = |before: &str, after: &str| try_deck(&format!("N,1\nN,2\n{before}SOLVE\n/CLEAR\n{after}"));
    assert!(cleared("", "N,3\nCE,1,0,1,UX,1,2,UX,1\n").expect_err("nodes").to_string().contains('1'));
    assert!(cleared("CM,G,NODE\n", "D,G,UX\n").is_err());
    assert!(cleared("A=3\n", "N,3\nD,A,UX\n").is_err());
    let next = cleared("CE,5,0,1,UX,1\nNSEL,S,,,1\n", "N,1\nN,2\nCE,NEXT,0,2,UX,1\nD,ALL,UY\n").expect("a deck");
    assert_eq!(next.model().label(1).as_deref(), Some("line 9 CE 1 2:1"));
    assert_eq!(prescribed(&next, 1), ["1:2 0", "2:2 0"].map(String::from));
    assert_eq!(next.positions().len(), 2);
    let moved = cleared("", "N,1,5\nN,3\n").expect("a deck");
    let mut placed: Vec<u32> = moved.positions().into_keys().collect();
    placed.sort_unstable();
    assert_eq!(placed, [2, 3], "node 1 has two places");
}

#[test]
fn models_without_constraints_have_no_load_steps() {
    let one = "CE,1,0,1,UX,1\n";
    for text in [
        format!("/CLEAR\n{one}"),
        format!("FINISH $ /CLEAR\n{one}"),
        format!("FINISH\n/CLEAR,START\nX=1\n/CLEAR\n{one}"),
        format!("{one}/CLEAR\n/POST1\nPLNSOL,U\n"),
        format!("{one}SOLVE\n/CLEAR\n/POST1\nPLNSOL,U\n"),
        format!("{one}/EOF\n/CLEAR\nCE,1,0,2,UX,1\n"),
    ] {
        let deck = deck(&text);
        assert_eq!((deck.model().cases().len(), deck.model().cases()[0].name.as_str()), (1, "load step 1"), "{text}");
        assert_eq!((in_force(&deck, 0), warnings(&deck)), (vec!["1:1 1 = 0".to_owned()], vec![]), "{text}");
    }
    assert_eq!(deck("/CLEAR\n/CLEAR\n").model().cases().len(), 1);
    // What is read for output after the last solution of an earlier model is no model.
    let output = deck(&format!("{one}SOLVE\nSAVE,TABLE\n/CLEAR\nRESUME,TABLE\n"));
    assert_eq!((output.model().left_out().count(), output.model().cases().len()), (0, 1));
    assert_eq!(deck(&format!("{one}/CLEAR\nRESUME,TABLE\n")).model().left_out().count(), 1);
}

/// ANSYS forbids other commands on the line of `/CLEAR`. In a block it deletes the parameters that the block depends on.
#[test]
fn clear_within_blocks_is_not_followed() {
    let one = "CE,1,0,1,UX,1\nSOLVE\n";
    for (before, after) in [
        ("*IF,1,EQ,1,THEN\n", "*ENDIF\n"),
        ("*IF,A,EQ,1,THEN\n", "*ENDIF\n"),
        ("*DO,I,1,2\n", "*ENDDO\n"),
        ("*CREATE,M\n", "*END\n*USE,M\n"),
        ("FINISH $ ", ""),
    ] {
        let deck = deck(&format!("{one}*GET,A,NODE,,COUNT\n{before}/CLEAR\n{after}{one}"));
        assert!(deck.model().left_out().count() > 0, "{before}");
    }
    for unknown in ["/INPUT,second,inp\n", "*USE,second\n", "LSSOLVE,1,1\n"] {
        let deck = deck(&format!("{one}*IF,1,EQ,1,THEN\n/CLEAR\n*ENDIF\n{unknown}"));
        assert_eq!(deck.model().left_out().count(), 1, "{unknown}");
    }
    let skipped = deck(&format!("{one}*IF,1,EQ,2,THEN\n/CLEAR\n*ENDIF\nCE,1,0,2,UX,1\nSOLVE\n"));
    assert_eq!((skipped.model().left_out().count(), in_force(&skipped, 1).len()), (0, 1));
    assert_eq!(in_force(&skipped, 1), ["1:1 1, 2:1 1 = 0".to_owned()]);
}

#[test]
fn decks_of_several_models_are_not_cleaned() {
    let before = deck(TWO);
    let error = clean::plan(&before, &qless::Options::default()).expect_err("two models").to_string();
    assert!(error.starts_with("model 1, load step 1 has other equations"), "{error}");
    // The deck is cleaned if its other texts between /CLEAR commands hold nothing.
    let before = deck("/CLEAR\nCE,1,0,1,UX,1\nCE,2,0,1,UX,2\n/CLEAR\n/POST1\n");
    let plan = clean::plan(&before, &qless::Options::default()).expect("a plan");
    let after = clean::write(&before, &plan).expect("written");
    let after = deck(std::str::from_utf8(&after).expect("text"));
    assert_eq!(in_force(&after, 0).len(), 1);
}

#[test]
fn models_are_limited() {
    let error = try_deck(&"CE,1,0,1,UX,1\n/CLEAR\n".repeat(101)).expect_err("too many").to_string();
    assert!(error.starts_with("deck.cdb:200: /CLEAR: the number of models exceeds"), "{error}");
    assert!(try_deck(&"X=1\n/CLEAR\n".repeat(1000)).is_ok());
}

/// A false start that `/CLEAR` deletes is no model that anybody solves, unless the deck writes it to a file or may solve it unseen.
#[test]
fn what_is_deleted_unsolved_is_not_checked() {
    let conflict = "CE,1,0,1,UX,1\nCE,2,1,1,UX,1\n";
    let good = "CE,1,0,1,UX,1\n";
    for (text, count) in [
        (format!("{conflict}/CLEAR\n{good}SOLVE\n"), 1),
        (format!("{good}SOLVE\n{conflict}/CLEAR\n{good}SOLVE\n"), 2),
        (format!("{good}SOLVE\n/CLEAR\n{conflict}/CLEAR\n"), 1),
        (format!("{good}SOLVE\n/CLEAR\n{conflict}"), 2),
        (format!("{conflict}/CLEAR\n{good}"), 2),
        (format!("{conflict}SAVE\n/CLEAR\n{good}SOLVE\n"), 2),
        (format!("{conflict}CDWRITE,DB,a,cdb\n/CLEAR\n{good}SOLVE\n"), 2),
        (format!("{conflict}MYMACRO\n/CLEAR\n{good}SOLVE\n"), 2),
        (format!("{conflict}LSWRITE,1\n/CLEAR\n{good}SOLVE\n"), 2),
    ] {
        let deck = deck(&text);
        assert_eq!(deck.model().cases().len(), count, "{text}");
        let is_said = warnings(&deck).iter().any(|text| text.contains("deleted without a solution"));
        assert_eq!(
            is_said,
            !text.contains("MYMACRO") && count == text.matches("SOLVE").count() && !text.ends_with(conflict),
            "{text}"
        );
        assert_eq!(deck.model().left_out().count(), 0, "{text}");
    }
}

/// What comes after a `/CLEAR` that cannot be followed is not joined with what comes before it.
#[test]
fn what_is_lost_is_in_no_load_case() {
    for lost in [
        "*IF,1,EQ,1,THEN\n/CLEAR\n*ENDIF\n",
        "FINISH $ /CLEAR\n",
        "*DO,I,1,2\nRESUME\n*ENDDO\n",
        "*DO,I,1,2\nSOLVE\nPARSAV\n/CLEAR\nPARRES\n*ENDDO\n",
        "RESUME,other\n",
    ] {
        let deck = deck(&format!("CE,1,0,1,UX,1\nSOLVE\n{lost}CE,2,1,1,UX,1\nSOLVE\n/CLEAR\nCE,3,0,3,UX,1\nSOLVE\n"));
        assert_eq!(deck.model().left_out().count(), 1, "{lost}");
        let all: Vec<_> = (0..deck.model().cases().len()).map(|case| in_force(&deck, case).len()).collect();
        assert!(all.iter().all(|count| *count == 1) && all.len() >= 2, "{lost}{all:?}");
    }
}
