//! What ccx drops: implied equations hold in its results, and lost ones do not. Runs named and random decks.

use std::fmt::Write;

use qless_io::deck::clean::{self, Finding, Loss};
use qless_io::deck::{Deck, Dof, Model, Outcome, Solver};
use qless_scenes::Rng;

use super::solver::{SINGULAR, cleaned, is_there, parse, run, solve};

/// Two bars of two bricks each, end to end: nodes 1 to 12 and 101 to 112, of which 9 to 12 and 101 to 104 coincide. The
/// far ends are held. Nodes above 200 are free for references.
pub fn bars(cards: &str, step: &str) -> String {
    let mut text = "*NODE, NSET=NALL\n".to_owned();
    for (first, x) in [(0, 0.0), (100, 2.0)] {
        for k in 0..12 {
            let (i, j, l) = (f64::from(k / 4), f64::from(k / 2 % 2), f64::from(k % 2));
            writeln!(text, "{},{},{j},{l}", first + k + 1, x + i).expect("text");
        }
    }
    text += "201,2.,.5,.5\n202,2.,.5,.5\n203,2.2,.4,.3\n204,1.,.4,.7\n205,0.,1.,0.\n206,.6,0.,.8\n207,3.,.5,.2\n208,3.,.5,.2\n";
    text += "*ELEMENT, TYPE=C3D8, ELSET=EALL\n1,1,5,7,3,2,6,8,4\n2,5,9,11,7,6,10,12,8\n";
    text += "3,101,105,107,103,102,106,108,104\n4,105,109,111,107,106,110,112,108\n";
    text += "*SURFACE, NAME=SM\n2,S4\n*SURFACE, NAME=SS\n3,S6\n";
    text += "*MATERIAL, NAME=M\n*ELASTIC\n2.1e5,.3\n*SOLID SECTION, ELSET=EALL, MATERIAL=M\n";
    text += "*BOUNDARY\n1,1,3\n2,1,3\n3,1,3\n4,1,3\n109,1,3\n110,1,3\n111,1,3\n112,1,3\n";
    let load = "*CLOAD\n5,1,31.\n8,2,-57.\n9,3,43.\n10,1,71.\n12,2,29.\n101,2,83.\n103,3,-37.\n104,1,61.\n106,2,47.\n107,1,-59.\n";
    format!("{text}{cards}*STEP\n*STATIC\n{step}{load}*NODE PRINT, NSET=NALL\nU\n*END STEP\n")
}

/// Displacements by DOF; `None` if ccx stops.
pub struct Printed(Vec<(u32, [f64; 3])>);

impl Printed {
    pub fn run(text: &str) -> Option<Self> {
        solve(text.as_bytes()).map(|words| Self::parse(&words))
    }

    fn parse(words: &[String]) -> Self {
        let numbers: Vec<f64> =
            words.iter().skip_while(|word| *word != "time").skip(2).filter_map(|w| w.parse().ok()).collect();
        Self(numbers.chunks_exact(4).map(|row| (row[0] as u32, [row[1], row[2], row[3]])).collect())
    }

    /// The displacement of the first node.
    pub fn first(&self) -> [f64; 3] {
        self.0[0].1
    }

    /// The last three numbers.
    pub fn last(&self) -> [f64; 3] {
        self.0[self.0.len() - 1].1
    }

    /// The mean displacement of all nodes.
    pub fn mean(&self) -> [f64; 3] {
        [0, 1, 2].map(|k| self.0.iter().map(|(_, u)| u[k]).sum::<f64>() / self.0.len() as f64)
    }

    /// A translation; rotations of references are prescribed as zero.
    fn value(&self, dof: Dof) -> f64 {
        let row = self.0.iter().find(|(node, _)| *node == dof.node);
        if dof.component > 3 { 0.0 } else { row.map_or(f64::NAN, |(_, u)| u[usize::from(dof.component) - 1]) }
    }

    /// How far an equation is off, relative to the largest displacement.
    pub fn off(&self, model: &Model, equation: usize) -> f64 {
        let largest = self.0.iter().flat_map(|(_, u)| u).fold(0.0_f64, |largest, u| u.abs().max(largest));
        let equation = model.equation(equation).expect("an equation");
        let dofs = equation.columns.iter().map(|&j| model.dofs()[j as usize]);
        let sum: f64 = dofs.zip(equation.coefficients).map(|(dof, a)| a * self.value(dof)).sum();
        (sum - equation.rhs).abs() / largest
    }

    pub fn holds(&self, model: &Model, equation: usize) -> bool {
        self.off(model, equation) < 1e-5
    }
}

/// What is said of the only step of a deck.
fn said(deck: &Deck) -> (Vec<Finding>, Loss) {
    let (model, case) = (deck.model(), &deck.model().cases()[0]);
    let findings = clean::findings(model, case, Solver::Ccx);
    let loss = clean::loss(model, case, &findings, Solver::Ccx, &qless::Options::default());
    (findings, loss)
}

fn is_refused(deck: &Deck, findings: &[Finding]) -> bool {
    !deck.model().refusals().is_empty() || findings.iter().any(|finding| finding.outcome == Outcome::Refused)
}

/// Runs ccx and compares: it stops where that is said, and of the deck's equations exactly the lost ones do not hold.
/// Returns whether it stops, and the numbers of implied and of lost equations.
fn judge(name: &str, text: &str) -> (bool, usize, usize) {
    let deck = parse(text.as_bytes());
    let (findings, loss) = said(&deck);
    let words: Vec<String> = findings.iter().map(|finding| finding.describe(deck.model(), Solver::Ccx)).collect();
    let show = || format!("{name}: {words:#?}\n{:?}\n{loss:?}\n{text}", deck.model().refusals());
    let found = run(text.as_bytes());
    // A motion that comes free may leave a reference that nothing holds.
    let is_loose = found == Err(SINGULAR) && !loss.freed.is_empty();
    assert_eq!(found.is_err() && !is_loose, is_refused(&deck, &findings), "{found:?} {}", show());
    let Ok(words) = found else { return (!is_loose, 0, 0) };
    let printed = Printed::parse(&words);
    for i in 0..deck.model().equations() {
        let off = printed.off(deck.model(), i);
        assert_eq!(off < 2e-6, !loss.equations.contains(&i), "equation {i}, off by {off}: {}", show());
    }
    let dropped = findings.iter().filter(|finding| finding.dropped().is_some()).count();
    (false, dropped - loss.equations.len(), loss.equations.len())
}

const TIE: &str = "*TIE, NAME=T, ADJUST=NO, POSITION TOLERANCE=.1\nSS,SM\n";

fn body(nodes: &str) -> String {
    format!("*NSET, NSET=BODY\n{nodes}\n*RIGID BODY, NSET=BODY, REF NODE=201, ROT NODE=202\n")
}

#[test]
fn a_tie_that_a_rigid_body_displaces_is_lost_or_implied() {
    if !is_there() {
        return;
    }
    let lost = bars(&(TIE.to_owned() + &body("101,102,103,104")), "");
    assert_eq!(judge("lost", &lost), (false, 0, 12));
    let (_, loss) = said(&parse(lost.as_bytes()));
    let all: Vec<String> = (101..=104).flat_map(|node| (1..=3).map(move |c| format!("{node}:{c}"))).collect();
    assert_eq!(loss.freed.iter().map(Dof::to_string).collect::<Vec<_>>(), all);
    let implied = bars(&(TIE.to_owned() + &body("9,10,11,12,101,102,103,104")), "");
    assert_eq!(judge("implied", &implied), (false, 12, 0));
    // A body of three of the nodes implies what the body says of the fourth, but not the tie.
    let some = bars(&(TIE.to_owned() + &body("9,10,11,101,102,103")), "");
    assert_eq!(judge("some", &some), (false, 9, 0));
}

/// ccx drops a value that a later step prescribes at a slave.
#[test]
fn a_dropped_value_is_implied_by_the_same_value_of_its_master() {
    let deck = |value: &str| {
        let step = |cards: &str| format!("*STEP\n*STATIC\n{cards}*END STEP\n");
        let nodes = "*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n*EQUATION\n2\n1,1,1.,2,1,-1.\n";
        parse(format!("{nodes}{}{}", step(""), step(&format!("*BOUNDARY\n1,1,1,.5\n{value}"))).as_bytes())
    };
    let dof = Dof { node: 1, component: 1 };
    for (value, is_lost, is_freed) in [("", true, true), ("2,1,1,.5\n", false, false), ("2,1,1,.25\n", true, false)] {
        let deck = deck(value);
        let (model, case) = (deck.model(), &deck.model().cases()[1]);
        let findings = clean::findings(model, case, Solver::Ccx);
        let loss = clean::loss(model, case, &findings, Solver::Ccx, &qless::Options::default());
        let list = |is: bool| if is { vec![dof] } else { Vec::new() };
        assert_eq!((loss.values, loss.freed, loss.equations.len()), (list(is_lost), list(is_freed), 0), "{value}");
    }
}

/// What follows from another lost claim is lost too, but only one of them sets a motion free.
#[test]
fn what_only_lost_claims_imply_is_lost() {
    let body = |reference: u32| format!("*RIGID BODY, NSET=A, REF NODE={reference}, ROT NODE=3\n");
    let nodes = "*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n3,0.,1.,0.\n4,1.,1.,0.\n*NSET, NSET=A\n1\n";
    let (_, loss) = said(&parse(format!("{nodes}{}{}{}", body(2), body(4), body(4)).as_bytes()));
    assert_eq!((loss.equations, loss.freed.len()), ((3..9).collect(), 3));
}

#[test]
fn lost_ties_hold_in_the_cleaned_deck() {
    if !is_there() {
        return;
    }
    let text = include_bytes!("tie_and_body.inp");
    let pulled = |text: &[u8]| {
        let words = solve(text).expect("solved");
        let at = words.iter().position(|word| word == "901").expect("printed");
        words[at + 1].parse::<f64>().expect("a number")
    };
    assert!(pulled(text) > 1e9, "the second bar is loose");
    let cleaned = cleaned(&parse(text)).expect("cleaned");
    assert!((pulled(&cleaned) - 8.666_667e-4).abs() < 1e-9);
}

const FACES: [&str; 6] =
    ["101,102,103,104", "9,10,11,12", "105,106,107,108", "5,6,7,8", "9,11,104", "9,10,11,12,101,102,103,104"];

/// A random deck of cards that claim the nodes where the bars meet, and their neighbours.
fn drawn(seed: u64) -> String {
    let mut rng = Rng::new(seed);
    let mut cards = Vec::new();
    let near = [5, 6, 7, 8, 9, 10, 11, 12, 101, 102, 103, 104, 105, 106, 107, 108];
    if rng.below(3) > 0 {
        cards.push(TIE.to_owned());
    }
    if rng.below(2) == 0 {
        cards.push(body(FACES[rng.below(6)]));
    }
    if rng.below(3) == 0 {
        let set = FACES[rng.below(5)].replace(',', "\n");
        let range = ["1,3", "1,2", "2,2", "1,1", "2,3"][rng.below(5)];
        cards.push(format!(
            "*SURFACE, NAME=KIN, TYPE=NODE\n{set}\n*COUPLING, REF NODE=203, SURFACE=KIN, CONSTRAINT NAME=C\n*KINEMATIC\n{range}\n*BOUNDARY\n203,4,6\n"
        ));
    }
    for axis in [204, 205, 206].into_iter().take(rng.below(4)) {
        let nodes: Vec<String> = FACES[rng.below(4)].split(',').map(|node| format!("{node},{node},{node}")).collect();
        // A rotation without a value has no effect.
        cards.push(format!("*MPC\nMEANROT,{},{axis}\n*BOUNDARY\n{axis},1,1,1e-3\n", nodes.join(",")));
    }
    for _ in 0..rng.below(3) {
        let (a, b, c) = (near[rng.below(16)], near[rng.below(16)], 1 + rng.below(3));
        if a != b {
            cards.push(format!("*EQUATION\n2\n{a},{c},1.,{b},{c},-1.\n"));
        }
    }
    let value = |rng: &mut Rng| {
        format!("*BOUNDARY\n{},{c},{c},{}\n", near[rng.below(16)], [0.0, 2e-3][rng.below(2)], c = 1 + rng.below(3))
    };
    if rng.below(3) == 0 {
        cards.push(value(&mut rng));
    }
    let step = if rng.below(3) == 0 { value(&mut rng) } else { String::new() };
    rng.shuffle(&mut cards);
    bars(&cards.concat(), &step)
}

#[test]
fn random_decks_lose_what_is_said() {
    if !is_there() {
        return;
    }
    let all: Vec<(bool, usize, usize)> = (0..150).map(|seed| judge(&format!("seed {seed}"), &drawn(seed))).collect();
    let count = |is: fn(&(bool, usize, usize)) -> bool| all.iter().filter(|found| is(found)).count();
    let (refused, implied, lost) = (count(|found| found.0), count(|found| found.1 > 0), count(|found| found.2 > 0));
    println!("150 decks: {refused} refused; {implied} with implied and {lost} with lost equations");
    assert!(refused >= 30 && implied >= 5 && lost >= 30);
}
