//! What Abaqus reads in another way than ccx.

use qless_io::deck::Solver::{Abaqus, Ccx};

use crate::from_text::{brick, equations, model, prescribed, refused, warnings};

/// ccx reads only the first line of a tie.
#[test]
fn a_tie_of_several_pairs_is_left_out() {
    let cards = "*SURFACE, NAME=A, TYPE=NODE\n9\n*SURFACE, NAME=B, TYPE=NODE\n10\n*TIE, NAME=T, POSITION TOLERANCE=9.\nA,STOP\nB,STOP\n";
    let tied = brick(Abaqus, cards);
    assert_eq!((tied.equations(), tied.left_out().count()), (0, 1));
    let tied = brick(Ccx, cards);
    assert_eq!((tied.equations(), tied.left_out().count()), (3, 0));
    assert!(warnings(&tied).contains("ccx reads only the first"), "{}", warnings(&tied));
}

#[test]
fn a_tie_of_shells_ties_rotations() {
    let shells = "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,.5,0,0\n6,-1,0,0\n7,-1,1,0\n8,0,1,0\n\
        *ELEMENT,TYPE=S4,ELSET=E\n1,1,2,3,4\n2,5,6,7,8\n*SURFACE,NAME=M\n1,SPOS\n*SURFACE,NAME=S,TYPE=NODE\n5\n";
    let turned = "*NSET,NSET=N1\n1\n*TRANSFORM,NSET=N1,TYPE=R\n0.,1.,0.,-1.,0.,0.\n";
    let of = |cards: &str| equations(&model(Abaqus, &format!("{shells}{cards}")));
    assert_eq!(of("*TIE,NAME=T,NO ROTATION\nS,M\n").len(), 3);
    assert_eq!(
        of("*TIE,NAME=T\nS,M\n")[3..],
        ["1 5:4 -0.5 1:4 -0.5 2:4", "1 5:5 -0.5 1:5 -0.5 2:5", "1 5:6 -0.5 1:6 -0.5 2:6"]
    );
    // The first axis of node 1 is the global y axis.
    assert_eq!(of(&format!("{turned}*TIE,NAME=T\nS,M\n"))[3..5], ["1 5:4 0.5 1:5 -0.5 2:4", "1 5:5 -0.5 1:4 -0.5 2:5"]);
}

#[test]
fn generated_nodes_are_in_their_set() {
    let text = "*NODE,NSET=L\n1,0,0,0\n5,4,0,0\n*NGEN,NSET=L\n1,5,1\n*EQUATION\n2\n3,1,1.,2,1,-1.\n*STEP\n*STATIC\n*BOUNDARY\nL,1,1,0.\n*END STEP\n";
    let generated = model(Abaqus, text);
    assert_eq!(prescribed(&generated, &generated.cases()[0]).len(), 5);
}

/// Only the first letter of a kind of axes counts. A rotation needs its axis.
#[test]
fn unknown_axes_are_refused() {
    let coupled = |kind: &str| {
        format!(
            "*NODE\n1,0,0,0\n2,1,1,0\n*SURFACE,NAME=S,TYPE=NODE\n2\n*ORIENTATION,NAME=O{kind}\n1,0,0,0,1,0\n*COUPLING,CONSTRAINT NAME=C,REF NODE=1,SURFACE=S,ORIENTATION=O\n*KINEMATIC\n1,1\n"
        )
    };
    assert_eq!(refused(Abaqus, &coupled("")), "accepted");
    assert_eq!(refused(Abaqus, &coupled(",SYSTEM=RECT")), "accepted");
    let turned = |line: &str| coupled("").replace("0,1,0\n", &format!("0,1,0\n{line}\n"));
    assert_eq!(refused(Abaqus, &turned("2,30.")), "accepted");
    assert_eq!(refused(Abaqus, &turned(",0.")), "accepted");
    // Abaqus turns about the first axis, and ccx does not turn.
    assert!(refused(Abaqus, &turned(",30.")).contains("an axis from 1 to 3"));
    let said = refused(Abaqus, &coupled(",SYSTEM=Z RECTANGULAR"));
    assert!(said.contains("neither rectangular nor cylindrical"), "{said}");
}
