//! Mean rotations (`*MPC` of type MEANROT) beside other cards: their slaves are those that ccx chooses.

use qless_io::deck::clean::{self, Finding};
use qless_io::deck::{Outcome, Solver};

use super::loss::{Printed, bars};
use super::solver::{is_there, parse};

/// Mean rotation of the face of nodes 105 to 108 about the axis that a node gives.
fn rotation(axis: u32) -> String {
    let nodes: Vec<String> = (105..=108).map(|node| format!("{node},{node},{node}")).collect();
    format!("*MPC\nMEANROT,{},{axis}\n", nodes.join(","))
}

/// Nodes 204 to 206 give three axes, and nodes 301 to 303 a plane; node 300 is held.
fn deck(cards: &str, step: &str) -> String {
    let nodes = "*NODE, NSET=NALL\n300,9.,9.,9.\n301,3.,0.,5.\n302,3.,5.,0.\n303,3.,5.,5.\n";
    let held = "*BOUNDARY\n300,1,3\n301,1,3\n302,1,3\n303,1,3\n204,1,1,1e-3\n205,1,1,2e-3\n206,1,1,3e-3\n";
    bars(&format!("{nodes}{cards}{held}"), step)
}

/// Whether ccx stops, and how many of its mean rotations do not hold; as said, and in a run.
fn outcomes(text: &str) -> [(bool, usize); 2] {
    let deck = parse(text.as_bytes());
    let (model, case) = (deck.model(), &deck.model().cases()[0]);
    let findings = clean::findings(model, case, Solver::Ccx);
    let stops = findings.iter().any(|finding| finding.outcome == Outcome::Refused);
    let is_mean = |&i: &usize| {
        let columns = model.equation(i).expect("an equation").columns;
        columns.iter().any(|&j| (204..=206).contains(&model.dofs()[j as usize].node))
    };
    let dropped = findings.iter().filter_map(Finding::dropped).filter(is_mean).count();
    let Some(printed) = Printed::run(text) else { return [(stops, 0), (true, 0)] };
    let broken = (0..model.equations()).filter(is_mean).filter(|&i| !printed.holds(model, i)).count();
    [(stops, dropped), (false, broken)]
}

#[test]
fn each_takes_a_slave_that_is_free() {
    if !is_there() {
        return;
    }
    let all = |axes: &[u32]| axes.iter().map(|&axis| rotation(axis)).collect::<String>();
    let mut accepted = vec![deck(&all(&[204]), ""), deck(&all(&[204, 205]), ""), deck(&all(&[206, 205, 204]), "")];
    let (mut stops, mut first) = (0, 0);
    for c in 1..=3 {
        let equation = format!("*EQUATION\n2\n105,{c},1.,300,{c},-1.\n");
        let value = format!("*BOUNDARY\n105,{c},{c}\n");
        accepted.push(deck(&(equation.clone() + &rotation(205)), ""));
        accepted.push(deck(&(value.clone() + &rotation(205)), ""));
        for late in
            [deck(&(rotation(205) + &equation), ""), deck(&(rotation(205) + &value), ""), deck(&rotation(205), &value)]
        {
            let [said, found] = outcomes(&late);
            assert_eq!(said, found, "{late}");
            (stops, first) = (stops + usize::from(found.0), first + usize::from(!found.0));
        }
        // A coupling counts as if it were first, wherever it stands.
        let coupling = format!(
            "*SURFACE, NAME=K, TYPE=NODE\n105\n106\n108\n*COUPLING, REF NODE=203, SURFACE=K, CONSTRAINT NAME=C\n*KINEMATIC\n{c},{c}\n*BOUNDARY\n203,4,6\n"
        );
        accepted.push(deck(&(rotation(205) + &coupling), ""));
    }
    for text in accepted {
        assert_eq!(outcomes(&text), [(false, 0), (false, 0)], "{text}");
    }
    // Of three places, one component is the slave.
    assert_eq!((stops, first), (3, 6));
}

#[test]
fn one_without_a_free_slave_is_not_made() {
    if !is_there() {
        return;
    }
    let face = "*BOUNDARY\n105,1,3\n106,1,3\n107,1,3\n108,1,3\n";
    assert_eq!(outcomes(&deck(&(face.to_owned() + &rotation(205)), "")), [(false, 1), (false, 1)]);
}

#[test]
fn sound_ones_are_not_changed() {
    let text = deck(&(rotation(205) + &rotation(206)), "");
    let deck = parse(text.as_bytes());
    let plan = clean::plan(&deck, &qless::Options::default()).expect("a plan");
    assert!(plan.is_empty() && clean::faults(deck.model()).is_empty(), "{plan:?}");
}
