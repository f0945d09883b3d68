//! Decks that stop ccx when it reads them: ccx does stop, the reader says why, and the deck is not cleaned.

use qless_io::deck::Solver::{Abaqus, Ccx};
use qless_io::deck::clean;

use super::ccx::{deck, is_there, solve};
use super::from_text::{model, parsed};

const COUPLING: &str = "*COUPLING, REF NODE=9, SURFACE=STOP, CONSTRAINT NAME=C\n*KINEMATIC\n";

/// Text before the first step, text in it, and the expected message.
fn decks() -> Vec<(String, &'static str, &'static str)> {
    let equation = |terms: &str| format!("*NSET, NSET=SB\n6\n*EQUATION\n{terms}\n");
    let kinematic = |from: &str, to: &str| format!("{}1,3\n*BOUNDARY\n9,2,6\n", COUPLING.replace(from, to));
    vec![
        (String::new(), "*EQUATION\n2\n5,3,1.,6,3,-1.\n", "*EQUATION follows the start of a step"),
        (
            "*BOUNDARY\n9,1,3\n".into(),
            "*PRE-TENSION SECTION, SURFACE=STOP, NODE=9\n0.,0.,1.\n",
            "*PRE-TENSION SECTION follows the start of a step",
        ),
        (equation("2\n5,3,1.,SB,3,-1."), "", "names a node set"),
        (equation("2\n5,3,1.,6,3"), "", "has no coefficient"),
        (equation("2\n5,3,1.,6,3,"), "", "has no coefficient"),
        (equation("6\n5,3,1.,6,3,-1.,7,3,1.,8,3,-1.,5,1,.1,6,1,.2"), "", "more than 16 fields"),
        (equation("2\n5,7,1.,6,7,-1."), "", "not defined in ccx"),
        (equation("2\n5,9,1.,6,9,-1."), "", "not defined in ccx"),
        (kinematic("NODE=9", "NODE=5"), "", "on its own surface"),
        (kinematic(", CONSTRAINT NAME=C", ""), "", "no CONSTRAINT NAME"),
        ("*MPC\nTIE,5,6\n".into(), "", "does not know *MPC TIE"),
        ("*MPC\nPIN,5,6\n".into(), "", "does not know *MPC PIN"),
        ("*MPC\nLINK,5,6\n".into(), "", "does not know *MPC LINK"),
        ("*NSET, NSET=SB\n6,7\n*MPC\nBEAM,SB,5\n".into(), "", "names a node set"),
        (format!("{COUPLING}1,6\n*BOUNDARY\n9,2,6\n"), "", "components above 3"),
    ]
}

fn texts() -> Vec<(String, &'static str)> {
    let load = "*CLOAD\n7,3,1.\n";
    let mut texts: Vec<_> =
        decks().into_iter().map(|(cards, step, said)| (deck(&cards, &[&format!("{step}{load}")]), said)).collect();
    texts.push((format!("\u{feff}{}", deck("", &[load])), "byte order mark"));
    texts
}

#[test]
fn what_ccx_stops_at_is_said_and_is_not_cleaned() {
    for (text, said) in texts() {
        let deck = parsed(Ccx, &text).unwrap_or_else(|error| panic!("{error}"));
        let refusals = deck.model().refusals();
        assert!(refusals.len() == 1 && refusals[0].text.contains(said), "{said}: {refusals:?}");
        assert!(refusals[0].line > 0 && refusals[0].text.starts_with("ccx stops: "), "{refusals:?}");
        let error = clean::plan(&deck, &qless::Options::default()).expect_err("refused").to_string();
        assert!(error.starts_with(&format!("line {}: ccx stops: ", refusals[0].line)), "{error}");
        assert!(model(Abaqus, &text).refusals().is_empty(), "{said}");
    }
}

#[test]
fn ccx_does_stop_at_what_is_said_and_at_nothing_like_it() {
    if !is_there() {
        return;
    }
    for (text, said) in texts() {
        assert!(solve(&text).is_none(), "{said}: ccx runs\n{text}");
    }
    let load = "*CLOAD\n7,3,1.\n";
    let mut sound: Vec<String> = [
        "*EQUATION\n3\n5,3,1.,6,3,,7,3,-1.\n",
        "*EQUATION\n2\n5,3,1.,6,3,,\n",
        "*EQUATION\n5\n5,3,1.,6,3,-1.,7,3,1.,8,3,-1.,5,1,.1,\n",
        "*EQUATION\n2\n5,4,1.,6,4,-1.\n2\n5,11,1.,6,11,-1.\n",
        "*EQUATION\n2\n5,8,1.,6,8,-1.\n",
        "*COUPLING, REF NODE=5, SURFACE=STOP, CONSTRAINT NAME=C\n*DISTRIBUTING\n1,6\n",
    ]
    .iter()
    .map(|cards| deck(cards, &[load]))
    .collect();
    sound.push(deck("*EQUATION\n2\n5,3,1.,6,3,-1.\n", &[load, &format!("*EQUATION, REMOVE\n5,3\n{load}")]));
    for before in ["\u{feff}*HEADING\nA deck\n", "\u{feff}** a deck\n", "\u{feff}\n"] {
        sound.push(format!("{before}{}", deck("", &[load])));
    }
    for text in sound {
        let refusals = model(Ccx, &text).refusals().to_vec();
        assert!(refusals.is_empty() && solve(&text).is_some(), "{refusals:?}\n{text}");
    }
}
