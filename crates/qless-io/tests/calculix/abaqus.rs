//! What Abaqus reads in another way than ccx.

use qless_io::deck::Solver::{Abaqus, Ccx};

use crate::from_text::{brick, equations, model, parsed, prescribed, refused, warnings};

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

/// What is not followed is left out each time, and named.
#[test]
fn cards_that_use_what_is_not_followed_are_left_out() {
    let twice = "*NODE\n1,0,0,0\n2,1,0,0\n*NSET,NSET=X\n1,2\n*NCOPY,CHANGE NUMBER=100,OLD SET=X,SHIFT,NEW SET=Y\n0,0,1\n\n\
        *STEP\n*STATIC\n*BOUNDARY\nY,1,1\n*BOUNDARY\nY,2,2\n*END STEP\n";
    assert!(left_out(&model(Abaqus, twice)).lines().count() >= 2, "{}", left_out(&model(Abaqus, twice)));
    for (line, cards) in
        [(5, "*NGEN\n1,12,5\n*EQUATION\n2\n77,1,1.,78,1,-1.\n"), (5, "*NGEN\n2,1,-1\n"), (4, "*SYSTEM\n0,0,0,0,0,0\n")]
    {
        let read = model(Abaqus, &format!("*NODE\n1,0,0,0\n2,1,0,0\n{cards}"));
        assert!(left_out(&read).starts_with(&format!("{line}: ")), "{cards}{}", left_out(&read));
    }
    let moved =
        "*NODE\n1,0,0,0\n2,1,0,0\n*NSET,NSET=N\n1,2\n*NMAP,NSET=N,TYPE=RECTANGULAR\n0,0,0,0,1,0\n*MPC\nBEAM,2,1\n";
    let read = model(Abaqus, moved);
    assert_eq!((read.equations(), left_out(&read).lines().count()), (0, 2), "{}", left_out(&read));
}

/// The other lines of a card count, and other equations do not take the DOFs of one that is left out as slaves.
#[test]
fn single_lines_of_a_card_are_left_out() {
    let copied = "*NODE\n1,0,0,0\n2,1,0,0\n3,1,0,0\n*NCOPY,CHANGE NUMBER=100,OLD SET=X,SHIFT,NEW SET=Y\n0,0,1\n\n";
    let read = model(Abaqus, &format!("{copied}*BOUNDARY\n1,1\nY,1\n2,1\n"));
    assert_eq!(prescribed(&read, &read.cases()[0]), ["1:1=0", "2:1=0"]);
    let why = "constrains, but it needs a set that *NCOPY gives members, which this reader does not follow: left out";
    assert_eq!(left_out(&read), format!("10: *BOUNDARY {why}"));
    let terms = "3\n2,3,1.\nY,2,1.,2,2,-1.\n";
    let read = model(Abaqus, &format!("{copied}*EQUATION\n2\n1,2,1.,2,2,-1.\n{terms}2\n2,3,1.,3,3,-1.\n"));
    assert_eq!(equations(&read), ["1 1:2 -1 2:2", "1 2:3 -1 3:3"]);
    assert_eq!(left_out(&read), format!("13: *EQUATION {why}"));
    assert_eq!(read.left_out_claims().iter().map(|(dof, _)| dof.to_string()).collect::<Vec<_>>(), ["2:3"]);
    let many = refused(Abaqus, &format!("{copied}*EQUATION\n2\nY,2,1.,2,2,-1.,3,2,1.\n2\n2,3,1.,3,3,-1.,1,1,1.\n"));
    assert!(many.contains("deck.inp:12: *EQUATION, field 7: expected no more terms than promised"), "{many}");
    let moved = "*NODE\n1,0,0,0\n2,1,0,0\n3,1,0,0\n*NGEN,LINE=C\n1,5\n*MPC\nPIN,2,1\nLINK,4,1\nPIN,3,1\n";
    let read = model(Abaqus, moved);
    assert_eq!(read.equations(), 6);
    let why = "*MPC of type LINK constrains 2 nodes, but it needs the position of node 4, which this reader does not follow: left out";
    assert!(left_out(&read).contains(&format!("7: {why}")), "{}", left_out(&read));
}

#[test]
fn imperfections_are_said_to_be_left_aside() {
    let read = model(Abaqus, "*NODE\n1,0,0,0\n2,1,0,0\n*IMPERFECTION,FILE=modes,STEP=1\n1,.1\n*MPC\nBEAM,2,1\n");
    assert_eq!(read.equations(), 3);
    assert!(warnings(&read).contains("*IMPERFECTION moves nodes"), "{}", warnings(&read));
}

pub const POINTS: &str = "*NODE\n1,0,0,0\n2,1,0,0\n3,2,0,0\n4,0,3,4\n*NSET,NSET=N1\n1\n*NSET,NSET=N2\n2\n";
/// The first axis of the nodes in a set is the global y axis.
const TURNED: &str = "*TRANSFORM,NSET=N2,TYPE=R\n0.,1.,0.,-1.,0.,0.\n";

pub fn left_out(model: &qless_io::deck::Model) -> String {
    model.left_out().map(|warning| format!("{}: {}", warning.line, warning.text)).collect::<Vec<_>>().join("\n")
}

#[test]
fn pipes_rotate_and_continuum_shells_do_not() {
    let beam =
        |kind: &str| format!("{POINTS}*ELEMENT,TYPE={kind},ELSET=E\n1,2,3\n*RIGID BODY,TIE NSET=N2,REF NODE=1\n");
    for (kind, count) in [("B31", 6), ("PIPE31H", 6), ("ELBOW31", 6), ("T3D2", 3), ("SFM3D4", 3)] {
        assert_eq!(model(Abaqus, &beam(kind)).equations(), count, "{kind}");
    }
    let top = |kind: &str| {
        let cards = "*COUPLING,CONSTRAINT NAME=C,REF NODE=9,SURFACE=STOP\n*KINEMATIC\n1,6\n";
        model(Abaqus, &format!("{}{cards}", crate::from_text::BRICK.replace("C3D8", kind))).equations()
    };
    assert_eq!((top("C3D8"), top("SC8R"), top("CSS8")), (12, 12, 12));
}

/// Beams in the plane have the components 1, 2 and 6. ccx takes them as beams in space.
#[test]
fn beams_in_the_plane_have_three_components() {
    let nodes = "*NODE\n1,0,0\n2,1,0\n3,1,0\n9,5,0\n*NSET,NSET=N\n2\n*SURFACE,NAME=S,TYPE=NODE\nN\n";
    let slaves = |solver, kind: &str, card: &str| {
        let read = model(solver, &format!("{nodes}*ELEMENT,TYPE={kind}\n1,1,2\n2,3,1\n{card}"));
        equations(&read).iter().map(|text| text.split(' ').nth(1).expect("a slave").to_owned()).collect::<Vec<_>>()
    };
    let coupling = "*COUPLING,CONSTRAINT NAME=C,REF NODE=9,SURFACE=S\n*KINEMATIC\n1,6\n";
    for card in ["*RIGID BODY,TIE NSET=N,REF NODE=9\n", "*MPC\nBEAM,2,9\n", "*MPC\nTIE,2,3\n", coupling] {
        for kind in ["B21", "B23H", "PIPE21"] {
            assert_eq!(slaves(Abaqus, kind, card), ["2:1", "2:2", "2:6"], "{kind} {card}");
        }
        assert_eq!(slaves(Abaqus, "B31", card).len(), 6, "{card}");
    }
    let body = "*RIGID BODY,NSET=N,REF NODE=9\n";
    assert_eq!([slaves(Abaqus, "T2D2", body).len(), slaves(Ccx, "T2D2", body).len()], [2, 3]);
}

#[test]
fn rotations_are_about_the_axes_of_each_node() {
    let beam = format!("{POINTS}*ELEMENT,TYPE=B31,ELSET=E\n1,2,3\n");
    let body = "*RIGID BODY,TIE NSET=N2,REF NODE=1\n";
    assert_eq!(
        equations(&model(Abaqus, &format!("{beam}{TURNED}{body}")))[3..],
        ["1 2:4 -1 1:5", "1 2:5 1 1:4", "1 2:6 -1 1:6"]
    );
    let reference = TURNED.replace("N2", "N1");
    assert_eq!(
        equations(&model(Abaqus, &format!("{beam}{reference}{body}")))[3..],
        ["1 2:4 1 1:5", "1 2:5 -1 1:4", "1 2:6 -1 1:6"]
    );
    // A part of the rotations is coupled about the axes of the coupling.
    let oriented = "*ORIENTATION,NAME=O\n0.,1.,0.,-1.,0.,0.\n*SURFACE,NAME=S,TYPE=NODE\nN2\n*COUPLING,CONSTRAINT NAME=C,REF NODE=1,SURFACE=S,ORIENTATION=O\n*KINEMATIC\n4,4\n";
    assert_eq!(equations(&model(Abaqus, &format!("{beam}{oriented}"))), ["1 2:5 -1 1:5"]);
}

#[test]
fn pins_are_global() {
    let pin = |kind: &str| {
        equations(&model(Abaqus, &format!("{POINTS}*ELEMENT,TYPE=B31\n1,1,2\n{TURNED}*MPC\n{kind},2,1\n")))
    };
    assert_eq!(pin("PIN"), ["1 2:1 -1 1:2", "1 2:2 1 1:1", "1 2:3 -1 1:3"]);
    assert_eq!(pin("TIE")[3..], ["1 2:4 -1 1:5", "1 2:5 1 1:4", "1 2:6 -1 1:6"]);
}

/// Sets pair by number, unless they are unsorted. ccx refuses sets in equations.
#[test]
fn sets_ascend_unless_they_are_unsorted() {
    let paired = |solver, unsorted: &str| {
        let cards = "3,1,2\n*NSET,NSET=B\n4,5,6\n*EQUATION\n2\nA,1,1.,B,1,-1.\n";
        equations(&model(solver, &format!("*NSET,NSET=A{unsorted}\n{cards}")))
    };
    let in_order = ["1 3:1 -1 4:1", "1 1:1 -1 5:1", "1 2:1 -1 6:1"];
    assert_eq!(paired(Abaqus, ""), ["1 1:1 -1 4:1", "1 2:1 -1 5:1", "1 3:1 -1 6:1"]);
    assert_eq!(
        (paired(Abaqus, ",UNSORTED"), paired(Ccx, "")),
        (in_order.map(str::to_owned).into(), in_order.map(str::to_owned).into())
    );
}

#[test]
fn edges_of_shells_are_faces() {
    let shell = |solver, face: &str| {
        let text = format!(
            "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n9,0,0,0\n*ELEMENT,TYPE=S4,ELSET=E\n1,1,2,3,4\n*SURFACE,NAME=S\nE,{face}\n*COUPLING,CONSTRAINT NAME=C,REF NODE=9,SURFACE=S\n*KINEMATIC\n1,3\n"
        );
        parsed(solver, &text).map_or_else(
            |error| error.to_string(),
            |deck| {
                let slaves = equations(deck.model()).iter().map(|text| text[2..3].to_owned()).collect::<Vec<_>>();
                slaves.chunks(3).map(|three| three[0].clone()).collect::<String>() + &left_out(deck.model())
            },
        )
    };
    assert_eq!([("E1"), ("E4"), ("SPOS"), ("")].map(|face| shell(Abaqus, face)), ["12", "14", "1234", "1234"]);
    assert_eq!(["S3", "S6", "SNEG"].map(|face| shell(Ccx, face)), ["12", "14", "1234"]);
    assert!(shell(Abaqus, "E5").contains("expected a face that the element has"), "{}", shell(Abaqus, "E5"));
    assert!(shell(Abaqus, "EDGE").contains("the face EDGE of E, which this reader does not follow"));
}

#[test]
fn a_reference_at_the_centre_of_mass_is_left_out() {
    let body = |position: &str| model(Abaqus, &format!("{POINTS}*RIGID BODY,PIN NSET=N2,REF NODE=1{position}\n"));
    assert_eq!((body(",POSITION=INPUT").equations(), body(",POSITION=CENTER OF MASS").equations()), (3, 0));
    let moved = body(",POSITION=CENTER OF MASS");
    assert!(left_out(&moved).contains("the centre of mass of the body"));
    // Its nodes must not become slaves of other equations.
    let claims: Vec<String> = moved.left_out_claims().iter().map(|(dof, _)| dof.to_string()).collect();
    assert_eq!(claims, ["1:1", "1:2", "1:3", "2:1", "2:2", "2:3"]);
}

#[test]
fn rates_have_histories_of_their_own() {
    let step = "*STEP\n*DYNAMIC\n*BOUNDARY,TYPE=VELOCITY\n1,1,1,5.\n2,1,1,0.\n*BOUNDARY\n3,1,1,5.\n*END STEP\n";
    let given = |solver, text: &str| {
        let read = model(solver, text);
        (prescribed(&read, read.cases().last().expect("a step")), read.left_out().count())
    };
    assert_eq!(given(Abaqus, step), (vec!["1:1=5 velocity".into(), "2:1=0".into(), "3:1=5".into()], 0));
    // A later step starts where the one before ends.
    assert_eq!(given(Abaqus, &step.repeat(2)).1, 1);
    // ccx ignores the parameter.
    assert_eq!(given(Ccx, step), (vec!["1:1=5".into(), "2:1=0".into(), "3:1=5".into()], 0));
}

/// What is prescribed before has a perturbation of zero, and the values of a perturbation step end with it.
#[test]
fn perturbation_steps_are_on_their_own() {
    let general = "*STEP\n*STATIC\n*BOUNDARY\n1,1,1,5.\n*CLOAD\n2,1,1.\n*END STEP\n";
    for begins in ["*STEP,PERTURBATION\n*STATIC\n", "*STEP\n*FREQUENCY\n"] {
        let text = format!("{general}{begins}*BOUNDARY\n2,1,1,1.\n*END STEP\n*STEP\n*STATIC\n*END STEP\n");
        let read = model(Abaqus, &text);
        let given = read.cases().iter().map(|case| (prescribed(&read, case).join(" "), case.loads.len()));
        assert_eq!(given.collect::<Vec<_>>(), [("1:1=5".into(), 1), ("1:1=0 2:1=1".into(), 0), ("1:1=5".into(), 1)]);
    }
}

/// A value of a perturbation step tells nothing of the one that returns after it.
#[test]
fn unknown_values_return_after_perturbation_steps() {
    let user = "*STEP\n*STATIC\n*BOUNDARY,USER\n1,1\n*END STEP\n";
    let between = "*STEP,PERTURBATION\n*STATIC\n*BOUNDARY\n1,1,1,2.\n*END STEP\n";
    let read = model(Abaqus, &format!("{user}{between}*STEP\n*STATIC\n*BOUNDARY,FIXED,OP=NEW\n1,1\n*END STEP\n"));
    let said: String = read.warnings().iter().map(|warning| warning.text.as_str()).collect();
    assert_eq!(said.matches("values that are not in the deck").count(), 2, "{said}");
}

#[test]
fn a_second_load_case_is_left_out() {
    for solver in [Abaqus, Ccx] {
        let step = "*STEP\n*STEADY STATE DYNAMICS\n1.,2.\n*BOUNDARY,LOAD CASE=1\n1,1,1,1.\n*BOUNDARY,LOAD CASE=2\n1,1,1,2.\n*END STEP\n";
        let read = model(solver, step);
        assert_eq!((prescribed(&read, &read.cases()[0]), read.cases()[0].clashes.len()), (vec!["1:1=1".to_owned()], 0));
        assert!(left_out(&read).starts_with("6: *BOUNDARY of a second load case"), "{}", left_out(&read));
    }
}

/// The first byte of a keyword line that is not blank is a star.
#[test]
fn keyword_lines_may_be_indented() {
    for solver in [Abaqus, Ccx] {
        let text = "*NODE\n1,0,0,0\n2,1,0,0\n*MATERIAL,NAME=M\n*ELASTIC\n1.,0.3\n \t*EQUATION\n 2\n  ** a comment\n2,1,1.,1,1,-1.\n  *EQUATION\n2\n1,2,1.,2,2,-1.\n";
        let read = model(solver, text);
        assert_eq!(equations(&read), ["1 2:1 -1 1:1", "1 1:2 -1 2:2"]);
        assert_eq!(read.label(1).as_deref(), Some("line 12 *EQUATION 1:2"));
    }
}

/// The equation of a coupling along the first axis of an orientation, at a node without local axes.
fn coupled(solver: qless_io::deck::Solver, kind: &str, lines: &str) -> String {
    let text = format!(
        "*NODE\n1,0,0,0\n2,0,0,0\n*SURFACE,NAME=S,TYPE=NODE\n2\n*ORIENTATION,NAME=O{kind}\n{lines}\n*COUPLING,CONSTRAINT NAME=C,REF NODE=1,SURFACE=S,ORIENTATION=O\n*KINEMATIC\n1,1\n"
    );
    parsed(solver, &text)
        .map_or_else(|error| error.to_string(), |deck| equations(deck.model()).join("; ") + &left_out(deck.model()))
}

#[test]
fn axes_begin_at_their_origin() {
    assert_eq!(coupled(Abaqus, "", "2,3,0,1,4,0,2,2,0"), "1 2:2 -1 1:2");
    assert_eq!(coupled(Abaqus, ",SYSTEM=Z RECTANGULAR", "0,0,1,0,1,0"), "1 2:2 -1 1:2");
    assert_eq!(coupled(Abaqus, ",SYSTEM=RECT", "1,0,0,0,1,0"), "1 2:1 -1 1:1");
    // ccx reads two points only, and takes all axes but cylindrical ones as rectangular.
    assert_eq!(coupled(Ccx, "", "0,3,0,1,4,0,2,2,0"), "1 2:2 -1 1:2");
    assert_eq!(coupled(Ccx, ",SYSTEM=SPHERICAL", "0,1,0,1,0,0"), "1 2:2 -1 1:2");
    let spherical = model(Ccx, "*ORIENTATION,NAME=O,SYSTEM=SPHERICAL\n0,1,0,1,0,0\n");
    assert!(warnings(&spherical).contains("it takes these as rectangular"), "{}", warnings(&spherical));
}

#[test]
fn unknown_axes_are_left_out() {
    let unknown = "needs axes that are neither rectangular nor cylindrical";
    for kind in [",SYSTEM=SPHERICAL", ",SYSTEM=USER"] {
        assert!(coupled(Abaqus, kind, "1,0,0,0,1,0").contains(unknown), "{kind}");
    }
    for kind in [",DEFINITION=OFFSET TO NODES", ",DEFINITION=NODES"] {
        assert!(coupled(Abaqus, kind, "1,0,0,0,1,0").contains("needs axes that nodes define"), "{kind}");
    }
    assert!(coupled(Ccx, ",SYSTEM=SPHERICAL", "0,0,0,0,0,1").contains(unknown));
    let turned = |solver, line: &str| coupled(solver, "", &format!("1,0,0,0,1,0\n{line}"));
    assert_eq!((turned(Abaqus, "3,90."), turned(Ccx, "3,90.")), ("1 2:2 -1 1:2".into(), "1 2:2 -1 1:2".into()));
    // Abaqus turns about the first axis by default, and ccx about none.
    assert_eq!((turned(Abaqus, ",30."), turned(Ccx, ",90.")), ("1 2:1 -1 1:1".into(), "1 2:1 -1 1:1".into()));
    assert_eq!(turned(Ccx, "4,90."), "1 2:1 -1 1:1");
    assert!(
        turned(Abaqus, "4,90.").contains("an axis from 1 to 3")
            && turned(Ccx, "3.,90.").contains("an axis from 1 to 3")
    );
    let cylinder = |solver| coupled(solver, ",SYSTEM=CYLINDRICAL", "0,0,0,0,0,1\n3,90.");
    assert!([Abaqus, Ccx].into_iter().all(|solver| cylinder(solver).contains("additional rotation (where ccx stops)")));
    // Nodes with axes that are not known: what needs their axes is left out, and other cards are read.
    let nodes = format!("{POINTS}{}*EQUATION\n2\n2,1,1.,3,1,-1.\n", TURNED.replace("TYPE=R", "TYPE=S"));
    let read =
        model(Abaqus, &format!("{nodes}*RIGID BODY,PIN NSET=N2,REF NODE=1\n*RIGID BODY,PIN NSET=N1,REF NODE=4\n"));
    assert_eq!((equations(&read).len(), read.left_out().count()), (4, 1));
}
