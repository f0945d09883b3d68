//! Cleaning with bodies and steps: replacements for couplings and rigid bodies, and equations that steps remove.

use qless::Options;
use qless_io::deck::clean::{self, CleanError};

use super::solver::{cleaned, difference, is_there, parse, solve};

/// A brick on supports below a reference node 9; the constraints come before the step.
fn brick(constraints: &str, steps: &str) -> String {
    let nodes = "*NODE, NSET=NALL\n1,0.,0.,0.\n2,1.,0.,0.\n3,1.,1.,0.\n4,0.,1.,0.\n5,0.,0.,1.\n6,1.,0.,1.\n7,1.,1.,1.\n8,0.,1.,1.\n9,.4,.5,2.\n\
        *NSET, NSET=TOP\n5,6,7,8\n";
    let solid = "*ELEMENT, TYPE=C3D8, ELSET=EALL\n1,1,2,3,4,5,6,7,8\n*MATERIAL, NAME=EL\n*ELASTIC\n1000.,0.3\n\
        *SOLID SECTION, ELSET=EALL, MATERIAL=EL\n*SURFACE, NAME=S\nEALL,S2\n";
    format!("{nodes}{solid}*BOUNDARY\n1,1,3\n2,2,3\n3,3\n4,3\n{constraints}{steps}")
}

fn step(lines: &str) -> String {
    format!("*STEP\n*STATIC\n{lines}*NODE PRINT, NSET=NALL\nU\n*END STEP\n")
}

const LOADS: &str = "*CLOAD\n9,1,10.\n9,3,5.\n";

/// The same body in three forms, with a fixed rotation and a moment.
const BODIES: [(&str, &str, &str); 3] = [
    ("*COUPLING, REF NODE=9, SURFACE=S, CONSTRAINT NAME=C\n*KINEMATIC\n1,3\n", "9,5,5\n", "9,6,3.\n"),
    // Without a rotation node no other card can use the rotation.
    ("*RIGID BODY, NSET=TOP, REF NODE=9\n", "9,5\n", "9,6,3.\n"),
    ("*NODE\n10,.4,.5,2.\n*RIGID BODY, NSET=TOP, REF NODE=9, ROT NODE=10\n", "10,2,2\n", "10,3,3.\n"),
];

fn run(text: &[u8]) -> Vec<String> {
    solve(text).unwrap_or_else(|| panic!("ccx stops: {}", String::from_utf8_lossy(text)))
}

fn clean_text(text: &str) -> Vec<u8> {
    cleaned(&parse(text.as_bytes())).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

#[test]
fn a_body_with_a_prescribed_slave_becomes_equations() {
    for (body, held, moment) in BODIES {
        let steps = step(&format!("{LOADS}{moment}"));
        // A stiff spring has the effect of a prescribed value, and every solver accepts it.
        let spring = "*ELEMENT, TYPE=SPRING1, ELSET=ESTIFF\n9,6\n*SPRING, ELSET=ESTIFF\n2\n1.e11\n";
        let sound = brick(&format!("{spring}{body}*BOUNDARY\n{held}"), &steps);
        let spoiled = brick(&format!("{body}*BOUNDARY\n6,2,2\n{held}"), &steps);
        let text = clean_text(&spoiled);
        if is_there() {
            assert!(solve(spoiled.as_bytes()).is_none(), "ccx refuses a prescribed slave");
            let apart = difference(&run(sound.as_bytes()), &run(&text));
            assert!(apart < 1e-6, "{apart:e}: {}", String::from_utf8_lossy(&text));
        }
    }
}

#[test]
fn rotations_named_by_a_set_are_refused() {
    let text = brick(
        "*NSET, NSET=REF\n9\n*COUPLING, REF NODE=9, SURFACE=S, CONSTRAINT NAME=C\n*KINEMATIC\n1,3\n*BOUNDARY\n6,2,2\nREF,5,5\n",
        &step(LOADS),
    );
    let deck = parse(text.as_bytes());
    let plan = clean::plan(&deck, &Options::default()).expect("a plan");
    let error = clean::write(&deck, &plan).expect_err("a set");
    assert!(matches!(error, CleanError::Fixed { .. }) && error.to_string().contains("by a set"), "{error}");
}

/// Two ends of a tie are prescribed in the second step, so that the tie must hold in the first only.
#[test]
fn an_equation_ends_where_a_step_prescribes_all_of_it() {
    let tie = "*EQUATION\n2\n5,1,1.,6,1,-1.\n";
    let first = step("*CLOAD\n7,1,10.\n");
    let both = "*BOUNDARY\n5,1,1,.01\n6,1,1,.01\n";
    let text = brick(tie, &(first.clone() + &step(both)));
    let expected = brick(tie, &(first + &step(&format!("*EQUATION, REMOVE\n5,1,1\n{both}"))));
    let found = clean_text(&text);
    assert!(String::from_utf8_lossy(&found).contains("*EQUATION, REMOVE\n5,1,1\n"));
    if is_there() {
        assert!(difference(&run(expected.as_bytes()), &run(&found)) < 1e-6);
    }
}

/// Equation 2 repeats equation 1 with another slave; the second step removes it by its slave.
#[test]
fn what_a_step_takes_back_stays_taken_back() {
    let ties = "*EQUATION\n2\n5,1,1.,6,1,-1.\n2\n7,3,1.,8,3,-1.\n2\n7,3,2.,8,3,-2.\n";
    let (first, remove) = (step("*CLOAD\n7,1,10.\n"), "*EQUATION, REMOVE\n7,3,3\n");
    let text = brick(&format!("{ties}*BOUNDARY\n7,3,3\n"), &(first.clone() + &step(remove)));
    let found = clean_text(&text);
    let sound = "*EQUATION\n2\n5,1,1.,6,1,-1.\n2\n8,3,1.,7,3,-1.\n*BOUNDARY\n7,3,3\n";
    let expected = brick(sound, &(first + &step("*EQUATION, REMOVE\n8,3,3\n")));
    if is_there() {
        let apart = difference(&run(expected.as_bytes()), &run(&found));
        assert!(apart < 1e-6, "{apart:e}: {}", String::from_utf8_lossy(&found));
    }
}

/// A removed equation cannot be restored, so an equation that is redundant in the first step and needed later is refused.
#[test]
fn equations_that_would_have_to_come_back_are_refused() {
    let tie = "*EQUATION\n2\n5,1,1.,6,1,-1.\n";
    let second = step("*BOUNDARY, OP=NEW\n1,1,3\n2,2,3\n3,3\n4,3\n*CLOAD\n7,1,1.\n");
    let text = brick(tie, &(step("*BOUNDARY\n5,1,1,.01\n6,1,1,.01\n") + &second));
    let error = clean::plan(&parse(text.as_bytes()), &Options::default()).expect_err("no set of equations serves both");
    assert!(matches!(error, CleanError::CasesDiffer { .. } | CleanError::Apart { .. }), "{error}");
}

/// Three bricks that share a face at z = 1: one below, and two above it in the same place.
fn stack(constraints: &str) -> String {
    let corners = ["0.,0.", "1.,0.", "1.,1.", "0.,1."];
    let mut text = "*NODE, NSET=NALL\n".to_owned();
    for (first, z) in [(1, 0), (11, 1), (21, 1)] {
        let node = |k: usize| format!("{},{},{}.\n", first + k, corners[k % 4], z + k / 4);
        (0..8).for_each(|k| text += &node(k));
    }
    text += "30,.4,.5,3.\n31,.4,.5,3.\n*NSET, NSET=ROOF\n15,16,17,18\n*NSET, NSET=PART\n15,16\n";
    for (name, first) in [("E1", 1), ("E2", 11), ("E3", 21)] {
        let nodes: Vec<String> = (first..first + 8).map(|node| node.to_string()).collect();
        text.extend([format!("*ELEMENT, TYPE=C3D8, ELSET={name}\n{},{}\n", nodes[0], nodes.join(","))]);
        text.extend([format!("*SOLID SECTION, ELSET={name}, MATERIAL=EL\n")]);
    }
    text += "*MATERIAL, NAME=EL\n*ELASTIC\n1000.,0.3\n*SURFACE, NAME=A\nE1,S2\n*SURFACE, NAME=B\nE2,S1\n*SURFACE, NAME=C\nE3,S1\n";
    let steps = step("*CLOAD\n15,1,10.\n26,3,5.\n");
    format!("{text}*BOUNDARY\n1,1,3\n2,2,3\n3,3\n4,3\n{constraints}{steps}")
}

/// A redundant card is left out as a whole, and the deck then solves as if it had never had the card.
#[test]
fn a_redundant_card_goes_as_a_whole() {
    let ties = "*TIE, NAME=T1\nB,A\n*TIE, NAME=T2\nC,B\n";
    let body = "*RIGID BODY, NSET=ROOF, REF NODE=30, ROT NODE=31\n";
    for (kept, redundant) in [
        (ties.to_owned(), "*TIE, NAME=T3\nC,A\n"),
        (
            ties.to_owned(),
            "*EQUATION\n2\n22,1,1.,6,1,-1.\n2\n22,2,1.,6,2,-1.\n2\n22,3,1.,6,3,-1.\n2\n11,1,1.,5,1,-1.\n2\n11,2,1.,5,2,-1.\n2\n11,3,1.,5,3,-1.\n",
        ),
        (format!("{ties}{body}"), "*RIGID BODY, NSET=PART, REF NODE=30, ROT NODE=31\n"),
    ] {
        let text = String::from_utf8(clean_text(&stack(&format!("{kept}{redundant}")))).expect("text");
        let is_comment = |line: &&str| line.starts_with("** qless: equation of line");
        let sound = stack(&kept);
        assert!(text.lines().any(|line| is_comment(&line)), "{text}");
        assert!(text.lines().filter(|line| !is_comment(line)).eq(sound.lines()), "{text}");
        if is_there() {
            assert!(difference(&run(sound.as_bytes()), &run(text.as_bytes())) < 1e-9, "{text}");
        }
    }
}

/// Two cards share slave nodes, and agree on them: the later card loses these nodes, and the deck then solves as if it had never named them.
#[test]
fn a_card_loses_the_nodes_that_another_card_has() {
    let (tie, body) = ("*TIE, NAME=T1\nB,A\n", "*RIGID BODY, NSET=ROOF, REF NODE=30, ROT NODE=31\n");
    let sets = "*NSET, NSET=EDGE\n11,12\n*SURFACE, NAME=EDGE, TYPE=NODE\nEDGE\n*NSET, NSET=MORE\n15,25,26,16\n*NSET,NSET=LESS\n25,26\n";
    let later_tie = "*TIE, NAME=T2\n** some\n B ,A\n";
    for (cards, sound, expected) in [
        (
            format!("{sets}*TIE, NAME=T1\nEDGE,A\n{later_tie}"),
            format!("{sets}{tie}"),
            "*NSET, NSET=QLESS1\n13,14\n*SURFACE, NAME=QLESS1, TYPE=NODE\nQLESS1\n*TIE, NAME=T2\n** some\nQLESS1,A\n",
        ),
        (
            // The deck's own set has the name that would be given first, in small letters.
            format!("{sets}*NSET, NSET=qless1\n11\n*TIE, NAME=T1\nEDGE,A\n{later_tie}"),
            format!("{sets}{tie}"),
            "*NSET, NSET=QLESSX1\n13,14\n*SURFACE, NAME=QLESSX1, TYPE=NODE\nQLESSX1\n*TIE, NAME=T2\n** some\nQLESSX1,A\n",
        ),
        (
            format!("{sets}{tie}*TIE, NAME=T2\nC,B\n{body}*RIGID BODY, NSET = MORE,REF NODE=30,ROT NODE=31\n"),
            format!("{sets}{tie}*TIE, NAME=T2\nC,B\n{body}*RIGID BODY,NSET=LESS,REF NODE=30,ROT NODE=31\n"),
            "*NSET, NSET=QLESS1\n25,26\n*RIGID BODY, NSET =QLESS1,REF NODE=30,ROT NODE=31\n",
        ),
    ] {
        let text = String::from_utf8(clean_text(&stack(&cards))).expect("text");
        assert!(text.contains(expected) && !text.contains("written anew"), "{text}");
        if is_there() {
            assert!(difference(&run(stack(&sound).as_bytes()), &run(text.as_bytes())) < 1e-9, "{text}");
        }
        let dos = clean_text(&stack(&cards).replace('\n', "\r\n"));
        assert_eq!(String::from_utf8(dos).expect("text").replace("\r\n", "\n"), text);
    }
}

/// The text of the second tie is not UTF-8, so that no other surface is written into it: the equations are.
#[test]
fn a_card_that_cannot_lose_nodes_becomes_equations() {
    let sets = "*NSET, NSET=EDGE\n11,12\n*SURFACE, NAME=EDGE, TYPE=NODE\nEDGE\n";
    let text = stack(&format!("{sets}*TIE, NAME=T1\nEDGE,A\n*TIE, NAME=T2\n** caf?\nB,A\n"));
    let bytes: Vec<u8> = text.bytes().map(|byte| if byte == b'?' { 0xe9 } else { byte }).collect();
    let deck = parse(&bytes);
    let plan = clean::plan(&deck, &Options::default()).expect("a plan");
    assert!(matches!(clean::write(&deck, &plan), Err(CleanError::Place { line: 61, .. })));
    let (plan, text) = clean::clean(&deck, &Options::default()).expect("equations");
    assert_eq!((plan.written.len(), clean::faults(parse(&text).model()).len()), (12, 0));
}
