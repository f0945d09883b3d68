//! Nodes and elements that cards of Abaqus generate or place in systems of their own.

use qless_io::deck::Solver::{Abaqus, Ccx};

use crate::abaqus::{POINTS, left_out};
use crate::from_text::{equations, model, prescribed, refused};

#[test]
fn fields_of_generating_cards_are_numbers() {
    for (cards, message) in [
        ("*NGEN,NSET=L\n1,x,1\n*BOUNDARY\nL,1\n", "deck.inp:5: *NGEN, field 2: `x` is no usable number"),
        ("*SYSTEM\n0,0,O\n", "deck.inp:5: *SYSTEM, field 3: `O` is no usable number"),
        ("*SYSTEM\n0,0,0,1,1,1\n0,l\n", "deck.inp:6: *SYSTEM, field 2: `l` is no usable number"),
        (
            "*ELEMENT,TYPE=B31,ELSET=E\n1,1,2\n*ELGEN,ELSET=E\n1,y,1\n",
            "deck.inp:7: *ELGEN, field 2: `y` is no usable number",
        ),
    ] {
        let found = refused(Abaqus, &format!("*NODE\n1,0,0,0\n2,1,0,0\n{cards}"));
        assert!(found.starts_with(message), "{found}");
    }
}

#[test]
fn generated_nodes_are_in_their_set() {
    let text = "*NODE,NSET=L\n1,0,0,0\n5,4,0,0\n*NGEN,NSET=L\n1,5,1\n*EQUATION\n2\n3,1,1.,2,1,-1.\n*STEP\n*STATIC\n*BOUNDARY\nL,1,1,0.\n*END STEP\n";
    let generated = model(Abaqus, text);
    assert_eq!(prescribed(&generated, &generated.cases()[0]).len(), 5);
}

#[test]
fn generated_nodes_have_positions() {
    let body = "*RIGID BODY,PIN NSET=L,REF NODE=9\n*NODE\n9,0,0,0\n";
    let line = |kind: &str| format!("*NODE,NSET=L\n2,0,0,0\n6,4,0,2\n*NGEN,NSET=L{kind}\n2,6,2\n{body}");
    // The solver is Abaqus, because ccx has no such cards.
    let straight = model(Ccx, &line(""));
    assert_eq!(equations(&straight)[3..6], ["1 4:1 -1 9:1 -1 9:5", "1 4:2 -1 9:2 1 9:4 -2 9:6", "1 4:3 -1 9:3 2 9:5"]);
    let arc = model(Abaqus, &line(",LINE=C"));
    assert_eq!(arc.equations(), 0);
    assert_eq!(
        left_out(&arc),
        "6: *RIGID BODY constrains, but it needs the position of node 4, which this reader does not follow: left out"
    );
    // Their equations need no positions.
    let tied = "*EQUATION\n2\n3,1,1.,2,1,-1.\n";
    let known = format!("*NODE\n1,0,0,0\n5,4,0,0\n*NGEN,LINE=P,NSET=L\n1,5\n{tied}");
    assert_eq!(
        (equations(&model(Abaqus, &known)), left_out(&model(Abaqus, &known))),
        (vec!["1 3:1 -1 2:1".into()], String::new())
    );
    let undefined = known.replace("3,1,1.", "7,1,1.");
    assert!(refused(Abaqus, &undefined).contains("node 7 is not defined"));
    assert!(left_out(&model(Ccx, "*NMAP,NSET=A,TYPE=CYLINDRICAL\n")).starts_with("1: *NMAP moves nodes"));
    let copied = model(
        Abaqus,
        "*NODE,NSET=A\n1,0,0,0\n*NCOPY,OLD SET=A,NEW SET=B,CHANGE NUMBER=10,SHIFT\n0,0,1\n\n*BOUNDARY\nB,1\n",
    );
    assert_eq!(
        left_out(&copied),
        "7: *BOUNDARY constrains, but it needs a set that *NCOPY gives members, which this reader does not follow: left out"
    );
}

#[test]
fn generated_elements_have_nodes() {
    let body = |line: &str| {
        format!("{POINTS}*ELEMENT,TYPE=B31,ELSET=F\n1,1,2\n*ELGEN,ELSET=E\n{line}\n*RIGID BODY,ELSET=E,REF NODE=4\n")
    };
    let nodes = |line: &str| model(Abaqus, &body(line)).equations() / 6;
    assert_eq!((nodes("1,1"), nodes("1,2"), nodes("1,1,1,1,2,1,1")), (2, 3, 3));
    // Three rows of two elements, and two layers of these: 12 elements with nodes 1 to 2, 3 to 4 and so on.
    let numbers = (5..30).map(|node| format!("{node},{node},0,0\n")).collect::<Vec<_>>().concat();
    let layers = body("1,2,2,1,3,4,10,2,12,100").replace("4,0,3,4\n", &format!("4,0,3,4\n{numbers}"));
    assert_eq!(model(Abaqus, &layers).equations() / 6, 24 - 1);
    assert_eq!(left_out(&model(Abaqus, &body("1,0,1,1,4000000000,1,1,4000000000"))).lines().count(), 2);
    let unknown = model(Abaqus, &body("7,2"));
    assert!(left_out(&unknown).starts_with("13: *ELGEN copies an element that no"), "{}", left_out(&unknown));
    assert!(left_out(&unknown).contains("14: *RIGID BODY constrains, but it needs a set that *ELGEN gives members"));
}

#[test]
fn nodes_are_in_their_system() {
    let at = |cards: &str| {
        let body = "*NODE\n1,0,0,0\n*NSET,NSET=N2\n2\n*RIGID BODY,PIN NSET=N2,REF NODE=1\n";
        let read = model(Abaqus, &format!("{cards}{body}"));
        let texts = equations(&read).iter().map(|text| text.split_once(' ').expect("a slave").1.to_owned()).collect();
        (texts, left_out(&read).lines().count())
    };
    let same = |cards: &str, plain: &str| assert_eq!(at(cards), at(&format!("*NODE\n2,{plain}\n")), "{cards}");
    same("*NODE,SYSTEM=R\n2,1,2,3\n", "1,2,3");
    same("*NODE,SYSTEM=C\n2,2,90.,3\n", "0,2,3");
    same("*SYSTEM\n10,0,5\n*NODE\n2,1,2,3\n*SYSTEM\n", "11,2,8");
    same("*SYSTEM\n1,0,0,1,1,7\n*NODE\n2,2,3,4\n*SYSTEM\n", "-2,2,4");
    same("*SYSTEM\n1,0,0,1,0,1\n1,1,0\n*NODE,SYSTEM=C\n2,2,90.,5\n*SYSTEM\n", "-4,2,0");
    assert_eq!(at("*NODE,SYSTEM=S\n2,1,2,3\n"), (vec![], 1));
}
