//! Predictions for solvers that cannot be run here, from their manuals (docs/solvers.md).

use std::path::Path;

use qless_io::deck::clean::{Finding, findings};
use qless_io::deck::{Deck, Outcome, Solver, UnknownSolver, parse, read_for};

fn deck(solver: Solver, text: &str) -> Deck {
    let mut none = |_: &Path| Err(std::io::ErrorKind::NotFound.into());
    parse(solver, Path::new("deck"), text.as_bytes().to_vec(), &mut none).expect("a deck")
}

fn said(solver: Solver, text: &str) -> Vec<Finding> {
    let deck = deck(solver, text);
    findings(deck.model(), &deck.model().cases()[0], solver)
}

/// The outcome of the only fault.
fn outcome(solver: Solver, text: &str) -> Outcome {
    match said(solver, text)[..] {
        [finding] => finding.outcome,
        ref others => panic!("{others:?}\n{text}"),
    }
}

const NODES: &str = "*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n3,0.,1.,0.\n4,1.,1.,0.\n5,2.,0.,0.\n6,2.,1.,0.\n*NSET,NSET=A\n1\n";
const BODY: &str = "*RIGID BODY,NSET=A,REF NODE=2,ROT NODE=3\n";
const EQUATION: &str = "*EQUATION\n2\n1,1,1.,4,1,-1.\n";

#[test]
fn abaqus() {
    let of = |cards: &str| outcome(Solver::Abaqus, &format!("{NODES}{cards}"));
    assert_eq!(of(&format!("{EQUATION}{EQUATION}")), Outcome::Refused);
    assert_eq!(of(&format!("{EQUATION}*BOUNDARY\n1,1,1\n")), Outcome::Refused);
    assert_eq!(of(&format!("{EQUATION}{BODY}")), Outcome::Refused);
    assert_eq!(of("*EQUATION\n2\n1,1,0.,4,1,-1.\n"), Outcome::Refused);
    let bodies = said(Solver::Abaqus, &format!("{NODES}{BODY}*RIGID BODY,NSET=A,REF NODE=4,ROT NODE=5\n"));
    assert!(bodies.len() == 3 && bodies.iter().all(|finding| finding.outcome == Outcome::Accepted));
}

const BULK: &str =
    "SOL 101\nCEND\nSPC = 1\nMPC = 2\nBEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,2.,0.,0.\n";

#[test]
fn nastran_and_optistruct() {
    let of = |solver, cards: &str| outcome(solver, &format!("{BULK}{cards}ENDDATA\n"));
    let mpc = "MPC,2,3,2,1.,2,2,-1.\n";
    for (cards, optistruct) in [
        ("MPC,2,3,2,1.,1,2,-1.\n", Outcome::Refused),
        ("SPC1,1,2,3\n", Outcome::Refused),
        ("RBE2,9,1,2,3\n", Outcome::Accepted),
    ] {
        assert_eq!(of(Solver::Nastran, &format!("{mpc}{cards}")), Outcome::Refused);
        assert_eq!(of(Solver::Optistruct, &format!("{mpc}{cards}")), optistruct);
    }
    let body = "RBE2,9,1,2,3\nSPC1,1,2,3\nMPC,2,3,3,1.,2,3,-1.\n";
    assert_eq!(of(Solver::Optistruct, body), Outcome::Accepted);
    assert_eq!(of(Solver::Optistruct, &format!("PARAM,AUTOMSET,YES\n{body}")), Outcome::Accepted);
    assert_eq!(of(Solver::Optistruct, &format!("PARAM,AUTOMSET,NO\n{body}")), Outcome::Refused);
}

#[test]
fn ansys_takes_another_dof_of_an_equation() {
    let of = |commands: &str| outcome(Solver::Ansys, commands);
    let shared = "CE,1,0,1,UX,1,2,UX,-1\n";
    assert_eq!(of(&format!("{shared}CE,2,0,1,UX,1,3,UX,-1\n")), Outcome::Accepted);
    assert_eq!(of(&format!("{shared}CE,2,0,1,UX,1,2,UX,1\n")), Outcome::Refused);
    assert_eq!(of(&format!("{shared}D,1,UX,0\n")), Outcome::Accepted);
    assert_eq!(of(&format!("{shared}D,1,UX,0\nD,2,UX,0\n")), Outcome::Refused);
    let grounded = said(Solver::Ansys, "CP,1,UX,1,2\nD,1,UX,0\nD,2,UX,0\n");
    assert!(!grounded.is_empty() && grounded.iter().all(|finding| finding.outcome == Outcome::Refused));
}

/// ANSYS's own verification decks do both.
#[test]
fn ansys_accepts_a_value_in_a_coupled_set_and_chained_regions() {
    for node in [1, 3] {
        assert_eq!(outcome(Solver::Ansys, &format!("CP,1,UX,1,2,3\nD,{node},UX,.1\n")), Outcome::Accepted);
    }
    let nodes = "/PREP7\nN,1,0,0,0\nN,2,1,0,0\nN,3,1,1,0\nN,4,2,0,0\n";
    for (regions, fixed, count) in
        [("CERIG,1,2,ALL\nCERIG,2,3,ALL\nCERIG,3,4,ALL\n", 1, 0), ("CERIG,1,2,ALL\nCERIG,2,3,ALL\n", 3, 6)]
    {
        let said = said(Solver::Ansys, &format!("{nodes}{regions}D,{fixed},ALL,0\n"));
        assert_eq!(said.len(), count);
        assert!(said.iter().all(|finding| finding.outcome == Outcome::Accepted), "{said:?}");
    }
}

/// Before the step that prescribes it, a DOF may still be an equation's own.
#[test]
fn ansys_looks_at_one_load_step() {
    let text = "CE,1,0,1,UX,1,2,UX,-1\n/SOLU\nD,1,UX,0\nSOLVE\nD,2,UX,0\nSOLVE\n";
    let deck = deck(Solver::Ansys, text);
    let of = |case: usize| findings(deck.model(), &deck.model().cases()[case], Solver::Ansys)[0].outcome;
    assert_eq!([of(0), of(1)], [Outcome::Accepted, Outcome::Refused]);
}

/// The first DOF of a coupled set must be in no other set either.
#[test]
fn ansys_takes_a_coupled_dof_once() {
    let words = |text: &str| {
        let deck = deck(Solver::Ansys, text);
        let said = findings(deck.model(), &deck.model().cases()[0], Solver::Ansys);
        said.iter().map(|finding| finding.describe(deck.model(), Solver::Ansys)).collect::<Vec<_>>()
    };
    let of = |claim: &str| vec![format!("1:1 is in the coupled set{claim}: ansys stops")];
    let set = "CP,1,UX,1,2,3\n";
    for other in ["CP,2,UX,1,4,5\n", "CP,2,UX,4,1,5\n"] {
        assert_eq!(words(&format!("{set}{other}")), of("s of line 1 CP 1, and of line 2 CP 2"));
    }
    assert_eq!(words("CP,1,UX,4,1,5\nCP,2,UX,1,2,3\n"), of("s of line 1 CP 1, and of line 2 CP 2"));
    assert_eq!(words(&format!("{set}CP,2,UX,4,2\n")).len(), 1);
    assert!(words(&format!("{set}CP,2,UY,1,2\nD,4,UX\nCE,1,0,1,UX,1,5,UX,1\n")).is_empty());
}

/// ccx refuses repeated terms that cancel, but not a coefficient of zero.
#[test]
fn ccx_refuses_a_slave_that_its_terms_cancel() {
    let of = |terms: &str| outcome(Solver::Ccx, &format!("{NODES}*EQUATION\n{terms}\n"));
    assert_eq!(of("3\n5,3,1.,6,3,-1.,5,3,-1."), Outcome::Refused);
    assert_eq!(of("2\n5,3,0.,6,3,-1."), Outcome::Unsound);
}

#[test]
fn solvers_have_names() {
    for solver in Solver::ALL {
        assert_eq!(solver.to_string().to_uppercase().parse(), Ok(solver));
    }
    assert!("nastrann".parse::<Solver>().is_err_and(|error: UnknownSolver| error.to_string().contains("ansys")));
}

#[test]
fn what_is_left_of_several_claims_meets_the_next() {
    // Two bodies and an equation: ccx drops the claim of the second body, and stops at the equation because of the first.
    let other = "*RIGID BODY,NSET=A,REF NODE=4,ROT NODE=5\n";
    let text = format!("{NODES}{BODY}{other}{EQUATION}");
    let deck = deck(Solver::Ccx, &text);
    let said = findings(deck.model(), &deck.model().cases()[0], Solver::Ccx);
    let words: Vec<String> = said.iter().map(|finding| finding.describe(deck.model(), Solver::Ccx)).collect();
    let dropped = |component: u8| {
        let both = format!("1:{component} is the slave of line 10 *RIGID BODY, and of line 11 *RIGID BODY");
        format!("{both}: ccx drops this equation of line 11 *RIGID BODY in every step")
    };
    let stops = "1:1 is the slave of line 10 *RIGID BODY, and of line 13 *EQUATION: ccx stops".to_owned();
    assert_eq!(words, [dropped(1), dropped(2), dropped(3), stops]);
}

/// A card of Abaqus makes the deck one of Abaqus. Who asks for ccx is told.
#[test]
fn a_solver_that_cannot_read_the_deck_is_replaced_with_a_warning() {
    let place = tempfile::tempdir().expect("a folder");
    let path = place.path().join("generated.inp");
    std::fs::write(&path, "*NODE\n1,0.,0.,0.\n5,4.,0.,0.\n*NGEN\n1,5\n*NGEN\n6,9\n").expect("a deck");
    let said = |asked| {
        let deck = read_for(&path, asked).expect("a deck");
        assert_eq!(deck.solver(), Solver::Abaqus);
        let warnings = deck.model().warnings().iter().filter(|warning| !warning.leaves_out);
        warnings.map(|warning| format!("{}: {}", warning.line, warning.text)).collect::<Vec<_>>()
    };
    let why = "4: only Abaqus knows this *NGEN: the deck is read as one of abaqus, although ccx is asked for";
    assert_eq!(said(Some(Solver::Ccx)), [why]);
    assert_eq!([said(None), said(Some(Solver::Abaqus))], [vec![""; 0], vec![]]);
}
