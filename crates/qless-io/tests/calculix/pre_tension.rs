//! `*PRE-TENSION SECTION` as ccx reads it: its equations, what stops ccx, and what is left out. `tests/calculix/pre_tension.rs` runs ccx.

use qless_io::deck::Solver::{Abaqus, Ccx};

use super::from_text::{brick, equations, refused, warnings};

const BEAM: &str = "*ELEMENT, TYPE=B31, ELSET=BEAM\n2,1,7\n";

fn cut(normal: &str) -> String {
    format!("*PRE-TENSION SECTION, SURFACE=STOP, NODE=9\n{normal}")
}

#[test]
fn the_nodes_of_a_surface_get_others_that_move_apart() {
    // The brick lies below its top face.
    for (normal, n) in [("", 1.0), ("0.,0.,-3.\n", -1.0)] {
        let model = brick(Ccx, &cut(normal));
        assert_eq!((model.equations(), model.left_out().count()), (12, 0));
        let expected = format!("1 5 across line 20:3 -1 5:3 {} 9:1", -n);
        assert_eq!(equations(&model)[..3], ["1 5 across line 20:1 -1 5:1", "1 5 across line 20:2 -1 5:2", &expected]);
        assert!(model.cards().get(0).is_some_and(|card| card.is_fixed));
    }
}

#[test]
fn a_beam_is_as_long_as_its_reference_says() {
    let beam = |normal: &str| brick(Ccx, &format!("{BEAM}*PRE-TENSION SECTION, ELEMENT=2, NODE=9\n{normal}"));
    assert_eq!(equations(&beam("0.,2.,0.\n")), ["1 7:2 -1 1:2 1 9:1"]);
    let third = 1.0 / 3.0_f64.sqrt();
    let model = beam("");
    let row = model.equation(0).expect("an equation");
    let signs: Vec<f64> = row.coefficients.iter().map(|a| (a * third * 1e6).round() / (third * 1e6).round()).collect();
    assert_eq!((signs.len(), signs[0]), (7, 1.0));
    assert_eq!(signs.iter().take(6).sum::<f64>(), 0.0);
}

#[test]
fn sets_are_read_with_a_warning() {
    let model = brick(Ccx, &format!("{BEAM}*PRE-TENSION SECTION, ELEMENT=BEAM, NODE=REF\n0.,0.,1.\n"));
    assert_eq!(equations(&model), ["1 7:3 -1 1:3 1 9:1"]);
    let said = warnings(&model);
    assert!(
        said.contains("refuses the set BEAM as an element") && said.contains("refuses the set REF as a node"),
        "{said}"
    );
}

#[test]
fn what_may_name_other_nodes_is_left_out() {
    let shared =
        "*SURFACE, NAME=N, TYPE=NODE\n5\n*COUPLING, REF NODE=10, SURFACE=N, CONSTRAINT NAME=C\n*KINEMATIC\n1,3\n";
    let tetrahedron =
        "*ELEMENT, TYPE=C3D4, ELSET=T\n3,1,2,3,5\n*SURFACE, NAME=ST\nT,S1\n*PRE-TENSION SECTION, SURFACE=ST, NODE=9\n";
    let plane = "*ELEMENT, TYPE=CPS4, ELSET=P\n3,1,2,3,4\n*SURFACE, NAME=SP\nP,S1\n*PRE-TENSION SECTION, SURFACE=SP, NODE=9\n0.,1.,1.\n";
    let shell =
        "*ELEMENT, TYPE=S4, ELSET=P\n3,1,2,3,4\n*SURFACE, NAME=SP\nP,SPOS\n*PRE-TENSION SECTION, SURFACE=SP, NODE=9\n";
    for (cards, part) in [
        (cut("") + shared, "doubles nodes that line"),
        (cut("") + &cut(""), "doubles nodes that line"),
        (tetrahedron.to_owned(), "a given normal at faces of tetrahedra"),
        (plane.to_owned(), "a normal in the plane of the elements"),
        (shell.to_owned(), "edges of plane elements or shells"),
    ] {
        let model = brick(Ccx, &cards);
        assert!(model.left_out().any(|said| said.text.contains(part)), "{cards}: {:?}", model.warnings());
    }
    let equation = brick(Ccx, &(cut("") + "*EQUATION\n2\n5,1,1.,6,1,-1.\n"));
    assert_eq!((equation.equations(), equation.left_out().count()), (13, 0));
    assert_eq!(brick(Abaqus, &cut("")).left_out().count(), 1);
    let given = brick(Ccx, &(tetrahedron.to_owned() + "0.,0.,1.\n"));
    assert_eq!((given.equations(), given.left_out().count()), (9, 0));
}

#[test]
fn errors_name_the_line() {
    for (cards, part) in [
        ("*PRE-TENSION SECTION, NODE=9\n", "the parameter SURFACE is missing"),
        ("*PRE-TENSION SECTION, SURFACE=STOP\n", "the parameter NODE is missing"),
        ("*PRE-TENSION SECTION, SURFACE=NONE, NODE=9\n", "surface NONE is not defined"),
        ("*PRE-TENSION SECTION, ELEMENT=1, NODE=9\n", "expected one beam of type B31"),
        ("*PRE-TENSION SECTION, SURFACE=STOP, NODE=9\n0.,0.,0.\n", "the normal is zero"),
        ("*SURFACE, NAME=STOP\n1,S1\n*PRE-TENSION SECTION, SURFACE=STOP, NODE=9\n", "have no mean normal"),
        ("*SURFACE, NAME=N, TYPE=NODE\n5\n*PRE-TENSION SECTION, SURFACE=N, NODE=9\n", "a surface of element faces"),
    ] {
        let said = refused(Ccx, &format!("{}{cards}", super::from_text::BRICK));
        assert!(said.starts_with("deck.inp:2") && said.contains(part), "{said}");
    }
}
