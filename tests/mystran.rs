//! The stated behaviour of MYSTRAN against runs of MYSTRAN: cards that claim one DOF, and drawn decks.
//!
//! `scripts/mystran` installs it. If `QLESS_MYSTRAN` is set, it must be installed.

#[path = "mystran/body.rs"]
mod body;
#[path = "mystran/decks.rs"]
mod decks;
#[path = "mystran/drawn.rs"]
mod drawn;
#[path = "mystran/judged.rs"]
mod judged;
#[path = "mystran/solver.rs"]
mod solver;

use std::path::Path;

use qless_io::deck::clean::{self, Finding};
use qless_io::deck::{Outcome, Solver};

use judged::parsed;
use solver::{SolverRun, program};

/// Beams 1-2-3-5 and 1-4 with a load, and a place for more cards.
fn deck(cards: &str) -> String {
    let select = if cards.contains("MPC,") { "MPC = 2\n" } else { "" };
    let grids = "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,2.,0.,0.\nGRID,4,,2.,0.,0.\nGRID,5,,3.,0.,0.\n";
    let beams = "CBAR,1,1,1,2,0.,1.,0.\nCBAR,2,1,2,3,0.,1.,0.\nCBAR,3,1,3,5,0.,1.,0.\nCBAR,4,1,1,4,0.,1.,0.\n";
    let rest = "PBAR,1,1,1.,1.,1.,1.\nMAT1,1,1000.,,.3\nSPC1,1,123456,1\nFORCE,3,5,,10.,0.,1.,0.\n";
    format!("SOL 101\nCEND\nSPC = 1\n{select}LOAD = 3\nDISP = ALL\nBEGIN BULK\n{grids}{beams}{rest}{cards}ENDDATA\n")
}

fn findings(text: &str) -> Vec<Finding> {
    let deck = parsed(text.as_bytes());
    clean::findings(deck.model(), &deck.model().cases()[0], Solver::Mystran)
}

/// Checks that the stated behaviour is that of MYSTRAN; returns whether it stops.
fn judge(program: &Path, cards: &str) -> bool {
    let text = deck(cards);
    let said = findings(&text);
    let is_refused = said.iter().any(|finding| finding.outcome == Outcome::Refused);
    assert!(
        said.iter().all(|finding| !matches!(finding.outcome, Outcome::IgnoresFirst | Outcome::IgnoresSecond)),
        "it drops nothing: {cards}"
    );
    assert_eq!(SolverRun::of(program, text.as_bytes()).completes, !is_refused, "{said:?}\n{cards}");
    is_refused
}

/// Cards with grid point 3, component 2 as a dependent DOF; `#` is their number.
const CARDS: [&str; 4] =
    ["MPC,2,3,2,1.,2,2,-1.\n", "MPC,2,3,2,1.,4,2,-1.\n", "RBE2,#,2,2,3\n", "RBE3,#,,3,2,1.,123,2,4\n"];
const VALUES: [&str; 2] = ["SPC1,1,2,3\n", "SPC,1,3,2,.05\n"];

fn numbered(card: &str, number: usize) -> String {
    card.replace('#', &number.to_string())
}

#[test]
fn every_pair_of_cards_with_one_dependent_dof() {
    let Some(program) = program() else { return };
    for card in CARDS {
        assert!(!judge(&program, &numbered(card, 50)), "{card}");
        for other in CARDS {
            assert!(judge(&program, &(numbered(card, 50) + &numbered(other, 60))), "{card}{other}");
        }
        for value in VALUES {
            assert!(judge(&program, &(numbered(card, 50) + value)), "{card}{value}");
            assert!(judge(&program, &(value.to_owned() + &numbered(card, 50))), "{value}{card}");
        }
    }
}

#[test]
fn independent_dofs_that_are_dependent_elsewhere_and_circles() {
    let Some(program) = program() else { return };
    assert!(!judge(&program, "RBE2,50,2,2,3\nRBE2,51,3,2,4\n"));
    assert!(!judge(&program, "RBE2,50,2,2,3\nMPC,2,4,2,1.,3,2,-1.\n"));
    assert!(judge(&program, "RBE2,50,2,2,3\nMPC,2,2,2,1.,3,2,-1.\n"));
    assert!(judge(&program, "MPC,2,3,2,1.,4,2,-1.\nMPC,2,4,2,1.,3,2,-1.\n"));
    assert!(judge(&program, "MPC,2,3,2,0.,4,2,-1.\n"), "a zero coefficient");
}
