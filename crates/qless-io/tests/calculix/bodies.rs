//! `*RIGID BODY` and `*COUPLING`, in each solver's meaning.

use qless_io::deck::Solver::{Abaqus, Ccx};

use qless_io::deck::clean;

use super::from_text::{BRICK, brick, equations, parsed, refused, warnings};

const DISTRIBUTING: &str = "*COUPLING, REF NODE=9, SURFACE=STOP, CONSTRAINT NAME=C\n*DISTRIBUTING\n1,3\n";

#[test]
fn a_distributing_coupling_constrains_in_abaqus_and_only_distributes_forces_in_ccx() {
    assert_eq!(equations(&brick(Abaqus, DISTRIBUTING))[2], "1 9:3 -0.25 5:3 -0.25 6:3 -0.25 7:3 -0.25 8:3");
    let ccx = brick(Ccx, DISTRIBUTING);
    assert_eq!((ccx.equations(), warnings(&ccx).as_str()), (0, ""));
}

#[test]
fn a_motion_prescribed_where_ccx_only_distributes_forces_is_said_to_have_no_effect() {
    let cards = format!("{DISTRIBUTING}*BOUNDARY\n9,3,3,.1\n");
    let expected = "*DISTRIBUTING only distributes forces in ccx: the value that line 24 *BOUNDARY prescribes at its reference 9 has no effect on the surface";
    assert_eq!(warnings(&brick(Ccx, &cards)), expected);
    assert!(!warnings(&brick(Abaqus, &cards)).contains("no effect"));
    // Prescribed in a step only; and no warning if another node is prescribed.
    let in_step = format!("{DISTRIBUTING}*STEP\n*STATIC\n*BOUNDARY\n9,1\n*END STEP\n");
    assert!(warnings(&brick(Ccx, &in_step)).contains("no effect"));
    assert_eq!(warnings(&brick(Ccx, &format!("{DISTRIBUTING}*BOUNDARY\n10,1\n"))), "");
}

#[test]
fn an_old_distributing_coupling_is_a_mean_of_displacements_in_ccx_and_a_mean_motion_in_abaqus() {
    let cards = "*ELEMENT, TYPE=DCOUP3D, ELSET=EREF\n4,9\n*DISTRIBUTING COUPLING, ELSET=EREF\nTOP,1.\n";
    assert_eq!(equations(&brick(Ccx, cards))[0], "1 5:1 1 6:1 1 7:1 1 8:1 -4 9:1");
    let abaqus = equations(&brick(Abaqus, cards));
    assert_eq!(abaqus.len(), 6);
    assert!(abaqus[5].starts_with("1 9:6 "), "{}", abaqus[5]);
}

#[test]
fn a_set_of_one_node_is_a_reference() {
    for (card, plain) in [
        ("*COUPLING, REF NODE=REF, SURFACE=STOP, CONSTRAINT NAME=C\n*KINEMATIC\n1,3\n", 12),
        ("*RIGID BODY, NSET=TOP, REF NODE=REF\n", 12),
        ("*KINEMATIC COUPLING, REF NODE=REF\nTOP,1,3\n", 12),
    ] {
        for solver in [Abaqus, Ccx] {
            let named = brick(solver, card);
            assert_eq!(named.equations(), plain, "{card}");
            assert_eq!(equations(&named), equations(&brick(solver, &card.replace("=REF", "=9"))), "{card}");
        }
        let several = card.replace("=REF", "=TOP");
        assert!(
            refused(Abaqus, &format!("{BRICK}{several}"))
                .contains("expected a node, or a set of one node, found `TOP with 4 nodes`"),
            "{several}"
        );
    }
    assert!(warnings(&brick(Ccx, "*RIGID BODY, NSET=TOP, REF NODE=REF\n")).contains("ccx refuses the set REF"));
}

#[test]
fn a_rigid_body_has_sets_that_are_pinned_or_tied() {
    let beam = "*ELEMENT, TYPE=B31, ELSET=BEAM\n2,5,6\n";
    let body = |parameters: &str| brick(Abaqus, &format!("{beam}*RIGID BODY, REF NODE=9, {parameters}\n")).equations();
    // Nodes 5 and 6 have rotations.
    assert_eq!(body("PIN NSET=TOP"), 12);
    assert_eq!(body("TIE NSET=TOP"), 18);
    assert_eq!(body("ELSET=BEAM"), 12);
    assert_eq!(body("ELSET=E, PIN NSET=TOP"), 24);
    assert_eq!(body("ELSET=BEAM, TIE NSET=TOP"), 18);
    assert_eq!(body("ANALYTICAL SURFACE=STOP"), 0);
    let message = refused(Abaqus, &format!("{BRICK}*RIGID BODY, TIE NSET=TOP\n"));
    assert!(message.ends_with("*RIGID BODY: the parameter REF NODE is missing; add `REF NODE=...`"), "{message}");
}

#[test]
fn ccx_passes_over_what_it_does_not_know_of_a_rigid_body() {
    for (parameter, shown) in [("TIE NSET=TOP", "TIE NSET"), ("ANALYTICAL SURFACE=STOP", "ANALYTICAL SURFACE")] {
        let model = brick(Ccx, &format!("*RIGID BODY, REF NODE=9, {parameter}\n"));
        let expected =
            format!("*RIGID BODY with {shown}: ccx does not know it and ignores the card, so that nothing is rigid");
        assert_eq!((model.equations(), warnings(&model)), (0, expected));
    }
    assert_eq!(brick(Ccx, "*RIGID BODY, REF NODE=9, PIN NSET=TOP\n").equations(), 12);
}

#[test]
fn ccx_makes_a_reference_at_the_origin_where_none_is_given() {
    let model = brick(Ccx, "*RIGID BODY, NSET=TOP\n");
    // Node 5 is at (0, 0, 1): its first component depends on the reference's and on the second rotation that ccx makes.
    let name = "reference of line 20";
    let expected = format!("1 5:1 -1 {name}:1 -1 {name}:22");
    assert_eq!(equations(&model)[0], expected);
}

#[test]
fn a_kinematic_coupling_without_degrees_of_freedom_couples_all_in_abaqus_and_nothing_in_ccx() {
    let cards = "*COUPLING, REF NODE=9, SURFACE=STOP, CONSTRAINT NAME=C\n*KINEMATIC\n";
    assert_eq!(brick(Abaqus, cards).equations(), 12);
    let ccx = brick(Ccx, cards);
    assert_eq!(
        (ccx.equations(), warnings(&ccx).as_str()),
        (0, "*KINEMATIC without degrees of freedom: ccx couples nothing")
    );
}

#[test]
fn only_nodes_within_the_radius_of_influence_are_coupled() {
    let near = "*NODE\n20,0.,0.,1.2\n*COUPLING, REF NODE=20, SURFACE=STOP, INFLUENCE RADIUS=1.1, CONSTRAINT NAME=C\n*KINEMATIC\n1,3\n";
    // Distances: node 5 0.2, nodes 6 and 8 1.02, node 7 1.43.
    assert_eq!(brick(Abaqus, near).equations(), 9);
    assert_eq!(brick(Abaqus, &near.replace("1.1,", "WORLD,")).equations(), 12);
}

#[test]
fn weights_fall_with_the_distance_from_the_reference() {
    let weighted = |method: &str| {
        let cards = format!(
            "*NODE\n20,0.,0.,1.\n*COUPLING, REF NODE=20, SURFACE=STOP, CONSTRAINT NAME=C\n*DISTRIBUTING, WEIGHTING METHOD={method}\n1\n"
        );
        let model = brick(Abaqus, &cards);
        let equation = model.equation(0).expect("an equation");
        let of = |node| {
            let at = |&j: &u32| model.dofs()[j as usize].node == node && model.dofs()[j as usize].component == 1;
            equation.columns.iter().position(at).map_or(0.0, |k| equation.coefficients[k])
        };
        [of(5), of(6), of(7), of(8)]
    };
    // The farthest node has weight zero, unless all are at the same distance; the weights of a mean add up to one.
    for method in ["LINEAR", "QUADRATIC", "CUBIC"] {
        let [near, right, far, left] = weighted(method);
        assert!(far == 0.0 && (near + right + left + 1.0).abs() < 1e-12, "{method}: {near} {right} {left}");
    }
    assert!(weighted("UNIFORM")[2] != 0.0);
    let wrong = "*COUPLING, REF NODE=9, SURFACE=STOP, CONSTRAINT NAME=C\n*DISTRIBUTING, WEIGHTING METHOD=SOME\n";
    assert!(
        refused(Abaqus, &format!("{BRICK}{wrong}"))
            .contains("expected UNIFORM, LINEAR, QUADRATIC or CUBIC, found `SOME`")
    );
}

#[test]
fn an_mpc_makes_every_step_nonlinear_in_ccx_so_that_bodies_stay_as_they_are() {
    let fixed = |solver, mpc: &str| {
        let model = brick(solver, &format!("*RIGID BODY, NSET=TOP, REF NODE=9\n{mpc}"));
        model.cards().get(0).expect("a card").is_fixed
    };
    let mpc = "*MPC\nPLANE,1,2,3,4\n";
    assert_eq!([fixed(Ccx, ""), fixed(Ccx, mpc), fixed(Abaqus, mpc)], [false, true, false]);
}

#[test]
fn a_tie_that_moves_its_nodes_stays_a_tie() {
    let clean = |height: &str, adjust: &str| {
        let cards = format!(
            "*NODE, NSET=OVER\n20,.5,.5,{height}\n21,.25,.25,{height}\n*SURFACE, NAME=SOVER, TYPE=NODE\n20\n21\n*TIE, NAME=T, POSITION TOLERANCE=.1{adjust}\nSOVER,STOP\n*BOUNDARY\n20,1\n"
        );
        let deck = parsed(Abaqus, &format!("{BRICK}{cards}")).expect("read");
        clean::plan(&deck, &qless::Options::default()).map(|plan| plan.written.len()).map_err(|error| error.to_string())
    };
    for (height, adjust) in [("1.", ""), ("1.0000000001", ", ADJUST=YES"), ("1.01", ", ADJUST=NO")] {
        assert!(clean(height, adjust).expect("cleaned") > 0, "{height}{adjust}");
    }
    for adjust in ["", ", ADJUST=YES"] {
        let message = clean("1.01", adjust).expect_err("fixed");
        let why = "its slave nodes are moved onto the master: write ADJUST=NO or close the gap";
        assert!(message.contains("*TIE cannot be replaced by equations") && message.contains(why), "{message}");
    }
}

#[test]
fn values_and_loads_on_the_rotation_of_a_reference_have_no_effect_in_ccx() {
    let told = |solver, body: &str, cards: &str| {
        warnings(&brick(solver, &format!("*RIGID BODY, NSET=TOP, REF NODE=9{body}\n{cards}")))
    };
    for cards in ["*BOUNDARY\n9,6,6,.1\n", "*STEP\n*STATIC\n*CLOAD\n9,6,1.\n*END STEP\n"] {
        let without = "9:6 has no effect: no card can name the rotation of a *RIGID BODY without ROT NODE";
        assert!(told(Ccx, "", cards).contains(without), "{cards}");
        let with = "9:6 has no effect: the rotation of a *RIGID BODY with ROT NODE is components 1 to 3 of node 10";
        assert!(told(Ccx, ", ROT NODE=10", cards).contains(with), "{cards}");
        assert!(!told(Abaqus, "", cards).contains("no effect"));
        // The reference is a node of a beam and has its rotations.
        let beam = "*ELEMENT, TYPE=B31, ELSET=BEAM\n2,9,10\n";
        assert!(!told(Ccx, ", ROT NODE=10", &format!("{beam}{cards}")).contains("no effect"));
    }
}
