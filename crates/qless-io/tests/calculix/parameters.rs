//! Parameters of Abaqus, `<name>`.

use qless_io::deck::Solver::{Abaqus, Ccx};
use qless_io::deck::clean;

use crate::abaqus::left_out;
use crate::from_text::{equations, model, parsed, prescribed, warnings};

/// A deck with these lines of `*PARAMETER`: its equation, its prescribed values, and what is left out and said.
fn with_parameters(lines: &str) -> (Vec<String>, Vec<String>, String) {
    let cards = "*NSET,NSET=N1\n1\n*EQUATION\n2\n2,<k>,1.,1,1,<a>\n*BOUNDARY\n<set>,2,2,<A>\n";
    let read = model(Abaqus, &format!("*NODE\n1,0,0,0\n2,1,0,0\n{cards}*PARAMETER\n{lines}"));
    (equations(&read), prescribed(&read, &read.cases()[0]), left_out(&read) + &warnings(&read))
}

#[test]
fn parameters_have_their_values() {
    for (a, value) in [
        ("-2.5", "-2.5"),
        ("-2.5*(3 - 1.) # a comment", "-5"),
        ("b/4.", "2"),
        ("2*sqrt(b*2)", "8"),
        ("cos(pi)*b**2", "-64"),
        ("max(b, 9)", "9"),
    ] {
        let found = with_parameters(&format!("** twice\nb = 8\nk = 2\nset = 'N1'\n a = {a}\n"));
        let expected = (vec![format!("1 2:2 {value} 1:1")], vec![format!("1:2={value}")], String::new());
        assert_eq!(found, expected, "{a}");
    }
    // They may stand in place of names and of numbers of nodes, and on keyword lines.
    let body = "*PARAMETER\nr = 1\nx = 2.\nn = 'N2'\n*NODE\n<r>,0,0,0\n2,<x>,0,0\n*NSET,NSET=<n>\n2\n*RIGID BODY,PIN NSET=N2,REF NODE=<r>\n";
    assert_eq!(equations(&model(Abaqus, body)), ["1 2:1 -1 1:1", "1 2:2 -1 1:2 -2 1:6", "1 2:3 -1 1:3 2 1:5"]);
    // Equations with numbers replace those with parameters.
    let twice = "*PARAMETER\na = 2.\n*NODE\n1,0,0,0\n2,<a>,0,0\n*EQUATION\n2\n2,1,<a>,1,1,-1.\n2\n2,1,4.,1,1,-2.\n";
    let deck = parsed(Abaqus, twice).expect("a deck");
    let plan = clean::plan(&deck, &qless::Options::default()).expect("a plan");
    let text = String::from_utf8(clean::write(&deck, &plan).expect("written")).expect("text");
    assert_eq!(equations(&model(Abaqus, &text)), ["2 2:1 -1 1:1"], "{text}");
    // Only Abaqus has parameters.
    assert_eq!(parsed(Ccx, body).expect("a deck").solver(), Abaqus);
}

#[test]
fn cards_with_parameters_without_a_value_are_left_out() {
    for a in ["7/2", "f(3)", "b[0]", "", "1.\na = 2.", "somewhere*2."] {
        let (equations, prescribed, said) = with_parameters(&format!("k = 2\nset = 'N1'\na = {a}\n"));
        assert_eq!((equations.len(), prescribed.len()), (0, 0), "{a}: {said}");
        for (line, card, name) in [(8, "*EQUATION", "a"), (10, "*BOUNDARY", "A")] {
            let why = format!(
                "{line}: {card} constrains, but it needs the value of the parameter {name}, which this reader does not follow"
            );
            assert!(said.contains(&why), "{said}");
        }
        assert!(said.contains("the value of the parameter A is not followed"), "{said}");
    }
    let count = model(Abaqus, "*PARAMETER\nn = f(2)\n*EQUATION\n2\n1,1,1.,2,1,1.\n<n>\n2,2,1.\n");
    assert_eq!(count.equations(), 1);
    assert!(left_out(&count).contains("6: ") && left_out(&count).contains("left out, with the rest of the card"));
    // Nodes: equations do not need their positions, and rigid bodies do.
    let nodes = "*PARAMETER\nx = f(2)\n*NODE\n1,0,0,0\n2,<x>,0,0\n*EQUATION\n2\n1,1,1.,2,1,1.\n*MPC\nBEAM,2,1\n*NODE\n3,0,0,0\n4,1,0,0\n*MPC\nBEAM,3,4\n";
    let read = model(Abaqus, nodes);
    assert_eq!((read.equations(), left_out(&read).lines().count()), (4, 1), "{}", left_out(&read));
    assert!(left_out(&read).contains("needs the position of node 2"), "{}", left_out(&read));
    let set = model(Abaqus, "*PARAMETER\ns = f(2)\n*NODE\n1,0,0,0\n*RIGID BODY,PIN NSET=<s>,REF NODE=1\n");
    assert!(
        left_out(&set).contains("the value of the parameter s")
            || left_out(&set).contains("the value of the parameter S")
    );
    let elements = model(Abaqus, "*PARAMETER\nn = f(2)\n*ELEMENT,TYPE=B31\n1,<n>,2\n");
    assert!(left_out(&elements).contains("*ELEMENT has a parameter whose value is not known"));
}
