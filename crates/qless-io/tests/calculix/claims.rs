//! Cards that are left out, and the DOFs that they claim.

use qless_io::deck::Model;
use qless_io::deck::Solver::{Abaqus, Ccx};

use super::from_text::{brick, equations, warnings};

fn claimed(model: &Model) -> Vec<String> {
    let mut nodes: Vec<String> = model.left_out_claims().iter().map(|(dof, _)| model.node_name(dof.node)).collect();
    nodes.dedup();
    nodes
}

#[test]
fn what_is_left_out_claims_the_nodes_that_it_names() {
    let foot = "*SURFACE, NAME=FOOT\nE,S1\n";
    let roof = ["5", "6", "7", "8"];
    let all = ["1", "2", "3", "4", "5", "6", "7", "8"];
    for (cards, name, nodes) in [
        ("*PRE-TENSION SECTION, SURFACE=STOP, NODE=9\n0.,0.,1.\n", "*PRE-TENSION SECTION", &roof[..]),
        ("*PRE-TENSION SECTION, ELEMENT=1, NODE=9\n", "*PRE-TENSION SECTION", &all),
        ("*EMBEDDED ELEMENT\nE\n", "*EMBEDDED ELEMENT", &all),
        ("*CONTACT PAIR, INTERACTION=I, TIED\nFOOT,STOP\n", "*CONTACT PAIR, TIED", &all),
        ("*SHELL TO SOLID COUPLING, CONSTRAINT NAME=C\nSTOP,FOOT\n", "*SHELL TO SOLID COUPLING", &all),
        ("*FASTENER, INTERACTION NAME=F\n", "*FASTENER", &[]),
        ("*PRE-TENSION SECTION, SURFACE=NONE, NODE=9\n", "*PRE-TENSION SECTION", &[]),
        ("*TIE, NAME=T, MULTISTAGE\nFOOT,STOP\n", "*TIE with MULTISTAGE", &all),
        ("*TIE, NAME=T, CYCLIC SYMMETRY\nFOOT,STOP\n", "*TIE with CYCLIC SYMMETRY", &all),
        ("*MPC\nSLIDER,5,6,7\n", "*MPC of type SLIDER", &roof[..3]),
    ] {
        let model = brick(Abaqus, &format!("{foot}{cards}"));
        let left: Vec<_> = model.left_out().map(|warning| warning.text.as_str()).collect();
        assert!(left.len() == 1 && left[0].starts_with(&format!("{name} constrains")), "{cards}: {left:?}");
        assert_eq!(claimed(&model), nodes, "{cards}");
        assert!(model.left_out_claims().is_sorted_by_key(|(dof, _)| *dof));
    }
    // A keyword with one wrong letter, and half a coupling.
    for (cards, part) in [
        ("*EQUATON\n2\n1,1,1.,2,1,-1.\n", "*EQUATON is no keyword; if *EQUATION is meant"),
        ("*BOUNDRAY\n1,1,3\n", "if *BOUNDARY is meant"),
        ("*COUPLING, REF NODE=1, SURFACE=FOOT, CONSTRAINT NAME=C\n", "*COUPLING needs a *KINEMATIC or *DISTRIBUTING"),
    ] {
        let model = brick(Abaqus, &format!("{foot}{cards}"));
        let left: Vec<_> = model.left_out().map(|warning| warning.text.as_str()).collect();
        assert!(left.len() == 1 && left[0].contains(part), "{cards}: {left:?}");
    }
    let plain = brick(Abaqus, &format!("{foot}*BOUNDARYF\n*CONTACT PAIR, INTERACTION=I\nFOOT,STOP\n"));
    assert_eq!((plain.left_out().count(), plain.left_out_claims().len()), (0, 0));
}

#[test]
fn a_mean_rotation_is_that_of_the_whole() {
    let nodes = "*NODE\n20,0.,0.,7.\n*MPC\nMEANROT,5,5,5,6,6,6,7,7,7,8,8,8,20\n";
    let model = brick(Ccx, nodes);
    assert_eq!(model.equations(), 1);
    let equation = model.equation(0).expect("an equation");
    // Any rotation w about the axis and any translation t: u = t + w e x x, and w at the last node.
    for (shift, w) in [([0.0, 0.0, 0.0], 1.0), ([3.0, -1.0, 2.0], 0.0), ([1.0, 2.0, 3.0], -0.5)] {
        let value = |j: u32| {
            let dof = model.dofs()[j as usize];
            let x = match dof.node {
                5 => [0.0, 0.0],
                6 => [1.0, 0.0],
                7 => [1.0, 1.0],
                _ => [0.0, 1.0],
            };
            let moved = [shift[0] - w * x[1], shift[1] + w * x[0], shift[2]];
            if dof.node == 20 { w } else { moved[usize::from(dof.component) - 1] }
        };
        let sum: f64 = equation.columns.iter().zip(equation.coefficients).map(|(&j, a)| a * value(j)).sum();
        assert!(sum.abs() < 1e-13, "{sum}");
    }
    assert!(equations(&model)[0].contains("20:1"));
}

#[test]
fn a_bound_of_a_distance_holds_once_it_is_reached() {
    let deck =
        |most: &str| brick(Ccx, &format!("*NODE\n20,{most},0.,0.\n*BOUNDARY\n20,1\n*MPC\nDIST,5,5,5,6,6,6,20\n"));
    let free = deck("1.5");
    assert_eq!((free.equations(), free.left_out().count()), (0, 0));
    assert!(warnings(&free).contains("*MPC DIST is inactive while"));
    assert_eq!(equations(&deck("1.")), ["1 5:1 -1 6:1 0.5 20:1"]);
}

/// A quarter of a ring, with nodes 1 to 4 on its first side and 5 to 8 on the second. The sides are nodes or faces.
fn sector(tie: &str, model: &str) -> String {
    format!(
        "*NODE\n1,1.,0.,0.\n2,2.,0.,0.\n3,2.,0.,1.\n4,1.,0.,1.\n5,0.,1.,0.\n6,0.,2.,0.\n7,0.,2.,1.\n8,0.,1.,1.
*ELEMENT, TYPE=C3D8, ELSET=E\n1,1,2,6,5,4,3,7,8
*SURFACE, NAME=FIRST\nE,S3\n*SURFACE, NAME=SECOND\nE,S5\n*SURFACE, NAME=NODES, TYPE=NODE\n1,\n2,\n3,\n4,
*TIE, NAME=T, CYCLIC SYMMETRY{tie}\n*CYCLIC SYMMETRY MODEL, N=4, NGRAPH=4, TIE=T{model}\n0.,0.,0.,0.,0.,1.\n"
    )
}

#[test]
fn a_sector_repeats_itself_around_its_axis() {
    for slaves in ["NODES", "FIRST"] {
        let model = super::from_text::model(Ccx, &sector(&format!("\n{slaves},SECOND"), ""));
        let expected = ["1 1:1 -1 5:2", "1 1:2 1 5:1", "1 1:3 -1 5:3"];
        assert_eq!(model.left_out().count(), 0);
        let wide = super::from_text::model(Ccx, &sector(&format!(", POSITION TOLERANCE=1.5\n{slaves},SECOND"), ""));
        assert_eq!(equations(&wide), equations(&model), "the nearest is the partner");
        assert_eq!((equations(&model)[..3].to_vec(), model.equations()), (expected.map(str::to_owned).to_vec(), 12));
    }
}

#[test]
fn a_slave_without_a_partner_follows_the_face_opposite() {
    // Its image is at (0, 1.5, 0.5), in the middle of the second side.
    let moved = sector("\nNODES,SECOND", "").replacen("\n1,1.,0.,0.", "\n9,1.5,0.,.5\n1,1.,0.,0.", 1);
    let model = super::from_text::model(Ccx, &moved.replace("TYPE=NODE\n1,", "TYPE=NODE\n9,"));
    assert_eq!(equations(&model)[9], "1 9:1 -0.25 6:2 -0.25 7:2 -0.25 8:2 -0.25 5:2");
}

#[test]
fn what_a_sector_cannot_be_read_for_is_left_out_with_its_claims() {
    let on_axis = sector("\nNODES,SECOND", "").replacen("\n1,1.,0.,0.", "\n1,0.,0.,0.", 1);
    let equation = "*EQUATION\n2\n1,3,1.,8,3,-1.\n*STEP\n*FREQUENCY\n2\n*SELECT CYCLIC SYMMETRY MODES, NMIN=0, NMAX=2\n*END STEP\n";
    let several = sector("\nNODES,SECOND", "") + equation;
    let value = "*STEP\n*MODAL DYNAMIC\n*BOUNDARY\n5,1,1,.1\n*END STEP\n";
    let value = several.replace("*EQUATION\n2\n1,3,1.,8,3,-1.\n", value);
    let in_static = super::from_text::model(Ccx, &value.replace("*MODAL DYNAMIC", "*STATIC"));
    assert_eq!((in_static.equations(), in_static.left_out().count()), (12, 0));
    for (text, rows) in [(on_axis, 0), (several.clone(), 1), (value, 0)] {
        let model = super::from_text::model(Ccx, &text);
        assert_eq!((model.equations(), model.left_out().count()), (rows, 1), "{text}");
        assert_eq!(claimed(&model).len(), 8);
    }
    // The equations of nodal diameter 0 stand for all where the sides have no others.
    let alone = several.replace("*EQUATION\n2\n1,3,1.,8,3,-1.\n", "*BOUNDARY\n1,1,3\n5,1,3\n");
    let model = super::from_text::model(Ccx, &alone);
    assert_eq!((model.equations(), model.left_out().count()), (12, 0));
    assert!(warnings(&model).contains("those of nodal diameter 0"));
    let message = super::from_text::refused(Ccx, &sector("\nNODES,SECOND", "").replace(", N=4", ""));
    assert!(message.contains("the parameter N is missing"), "{message}");
}

#[test]
fn cards_that_cannot_be_so_are_refused_in_words() {
    for (cards, expected) in [
        ("*MPC\nMEANROT,5,5,5\n", "expected nodes three times each, and then one more, found `3`"),
        ("*MPC\nMEANROT,5,5,5,1\n", "node 1 gives no axis of rotation"),
        ("*MPC\nDIST,5\n", "7 nodes are promised"),
        ("*NODE\n4294967295,0.,0.,0.\n*RIGID BODY, NSET=TOP\n", "the largest number of a node exceeds the limit"),
    ] {
        let message = super::from_text::refused(Ccx, &format!("{}{cards}", super::from_text::BRICK));
        assert!(message.contains(expected), "{message}");
    }
    for (from, to, expected) in [
        ("N=4,", "N=0,", "expected at least one sector, found `0`"),
        ("SYMMETRY\n", "SYMMETRY, POSITION TOLERANCE=nan\n", "`nan` is no usable number"),
        ("0.,0.,0.,0.,0.,1.\n", "0.,0.,0.,0.,0.,0.\n", "the two points define no axis"),
    ] {
        let message = super::from_text::refused(Ccx, &sector("\nNODES,SECOND", "").replacen(from, to, 1));
        assert!(message.contains(expected), "{message}");
    }
}
