//! Every card that constrains: its equations or values, the rank and status of the system, and line numbers.

use qless::Kind;
use qless_io::deck::{Format, Outcome, Solver, clean};

use super::from_text::{CUBE, analysis, cube, equations, first_line, left_out, model, parsed, prescribed};

#[test]
fn a_nodal_rigid_body_moves_its_nodes() {
    let body = "*SET_NODE_LIST_TITLE\ntop\n9\n2,6\n*CONSTRAINED_NODAL_RIGID_BODY_TITLE\na body\n7,0,9\n";
    let model = cube(body);
    // Nodes of solids have no rotations. The reference is the middle of the nodes, (1, 0, 0.5).
    let own = ["1 2:1 -1 body 7:1 0.5 body 7:5", "1 2:2 -1 body 7:2 -0.5 body 7:4", "1 2:3 -1 body 7:3"];
    let other = ["1 6:1 -1 body 7:1 -0.5 body 7:5", "1 6:2 -1 body 7:2 0.5 body 7:4", "1 6:3 -1 body 7:3"];
    assert_eq!(equations(&model), [own, other].concat());
    let line = first_line() + 6;
    assert_eq!(model.label(0), Some(format!("line {line} *CONSTRAINED_NODAL_RIGID_BODY_TITLE 7 2:1")));
    assert_eq!((analysis(&model).rank(), left_out(&model).len()), (6, 0));
    // The same body twice, under another number: 6 motions of the second reference come with 6 equations.
    let twice = cube(&format!("{body}*CONSTRAINED_NODAL_RIGID_BODY\n8,0,9\n"));
    assert_eq!((twice.equations(), analysis(&twice).rank()), (12, 11));
}

#[test]
fn shells_and_free_nodes_rotate_and_releases_are_left_out() {
    let model =
        cube("*CONSTRAINED_NODAL_RIGID_BODY\n4\n*SET_NODE\n8\n20,21\n*CONSTRAINED_NODAL_RIGID_BODY\n8,0,8,22\n");
    let of = |name: &str| (0..model.equations()).filter(|&i| model.label(i).expect("one").contains(name)).count();
    // Without NSID, the set has the number of the body. PNODE belongs to the body.
    assert_eq!((of("RIGID_BODY 4 "), of("RIGID_BODY 8 ")), (4 * 6, 3 * 6));
    let released = cube("*CONSTRAINED_NODAL_RIGID_BODY\n4,0,0,0,0,-1\n");
    assert_eq!((released.equations(), left_out(&released).len()), (0, 1));
}

#[test]
fn supports_of_the_centre_of_mass_need_the_centre() {
    let held =
        "*CONSTRAINED_NODAL_RIGID_BODY_SPC_INERTIA\n3\n1,7,0\n.5,.5,1.,2.\n1.,0.,0.,1.,0.,1.\n0.,0.,0.,0.,0.,0.\n";
    for cards in [held.to_owned(), held.replace("1.,2.\n", "1.,2.,1\n") + "1.5,0.,0.,0.,1.,0.\n"] {
        assert_eq!(prescribed(&cube(&cards)), ["body 3:1=0", "body 3:2=0", "body 3:3=0"]);
    }
    // Without the centre, translations are known only if the body cannot rotate.
    let fixed = cube("*CONSTRAINED_NODAL_RIGID_BODY_SPC\n3\n1,7,7\n");
    assert_eq!((prescribed(&fixed).len(), left_out(&fixed).len()), (6, 0));
    let turning = cube("*CONSTRAINED_NODAL_RIGID_BODY_SPC\n3\n1,4,5\n");
    assert_eq!(prescribed(&turning), ["body 3:5=0", "body 3:6=0"]);
    let line = first_line() + 2;
    let why = "holds a centre of mass that the deck does not give, of a body that can rotate: left out";
    assert_eq!(left_out(&turning), [format!("line {line}: *CONSTRAINED_NODAL_RIGID_BODY_SPC 3 {why}")]);
    let local = cube("*CONSTRAINED_NODAL_RIGID_BODY_SPC\n3\n-1,2,111000\n");
    assert_eq!((local.equations(), left_out(&local).len()), (12, 1));
}

const RIGID: &str = "*MAT_RIGID_TITLE\nsteel\n5,7.8,200.,.3\n1,0,7\n\n*PART\nplate\n2,1,5\n*PART_INERTIA\nblock\n1,1,5\n.5,.5,.5,1.\n1.,0.,0.,1.,0.,1.\n\n";

#[test]
fn parts_of_a_rigid_material_are_bodies() {
    let model = cube(RIGID);
    assert_eq!((model.equations(), left_out(&model).len()), (4 * 6 + 8 * 3, 0));
    let line = first_line() + 7;
    assert_eq!(model.label(0), Some(format!("line {line} *PART 2 11:1")));
    assert_eq!(equations(&model)[24], "1 1:1 -1 body 1:1 0.5 body 1:5 -0.5 body 1:6");
    let held: Vec<String> = [1, 2].iter().flat_map(|body| (4..7).map(move |k| format!("body {body}:{k}=0"))).collect();
    let mut found = prescribed(&model);
    found.sort();
    assert_eq!(found, held);
}

#[test]
fn bodies_take_nodes_and_other_bodies() {
    let cards = "*CONSTRAINED_EXTRA_NODES_NODE\n2,20\n1,22,1\n*CONSTRAINED_EXTRA_NODES_SET\n2,3\n*CONSTRAINED_RIGID_BODIES\n1,2\n";
    let model = cube(&format!("{RIGID}{cards}"));
    let lines = RIGID.lines().count() + first_line();
    let of = |line: usize| {
        (0..model.equations()).filter(|&i| model.label(i).expect("one").starts_with(&format!("line {line} "))).count()
    };
    assert_eq!([2, 3, 5, 7].map(|k| of(lines + k - 1)), [6, 6, 12, 6]);
    // The nodes of set 3 belong to both bodies, which are merged: their equations are redundant.
    let analysis = analysis(&model);
    assert_eq!((analysis.rank(), analysis.dependent().len()), (model.equations() - 12 - 3, 15));
    assert!(analysis.dependent().iter().all(|one| one.kind == Kind::Redundant));
}

/// The mean rotation of the corners of a unit square about its middle: `sum (r x u) / sum r . r`, with `r . r = 1/2` at each.
const TURN: &str = "1 22:6 -0.25 5:1 0.25 5:2 -0.25 6:1 -0.25 6:2 0.25 7:1 -0.25 7:2 0.25 8:1 0.25 8:2";

#[test]
fn an_interpolation_is_a_weighted_mean() {
    let model = cube("*CONSTRAINED_INTERPOLATION\n1,22,123,0,0\n5,123\n6,123\n7,123\n8,123,2.\n");
    assert_eq!(model.equations(), 3);
    assert_eq!(model.label(0), Some(format!("line {} *CONSTRAINED_INTERPOLATION 1 22:1", first_line() + 1)));
    // A rotation of set 3 about z through (0.5, 0.5, 1) moves node 22, which is above (0, 0), as a rigid body.
    let set = cube("*CONSTRAINED_INTERPOLATION\n1,22,0,0,1\n3\n");
    assert_eq!((set.equations(), analysis(&set).rank()), (6, 6));
    assert_eq!(equations(&set)[5], TURN);
    let few = "*CONSTRAINED_INTERPOLATION\n1,22,126,0,0\n5,123\n";
    assert!(super::from_text::refused(&format!("{CUBE}{few}")).contains("do not determine 22:1"));
}

#[test]
fn linear_equations_and_equal_translations() {
    let model = cube(
        "*CONSTRAINED_LINEAR_GLOBAL\n         4\n         1         1       2.0\n         2         3      -1.0\n",
    );
    assert_eq!(equations(&model), ["2 1:1 -1 2:3"]);
    let cards = "*CONSTRAINED_NODE_SET\n3,4\n*CONSTRAINED_LINEAR_GLOBAL\n1\n6,1,1.\n7,1,-1.\n";
    let equal = cube(cards);
    assert_eq!(equations(&equal)[..2], ["1 6:1 -1 5:1", "1 6:2 -1 5:2"]);
    let analysis = analysis(&equal);
    assert_eq!((analysis.rank(), analysis.dependent()[0].kind), (6, Kind::Redundant));
    assert_eq!(analysis.because(6).expect("a certificate").len(), 2);
}

#[test]
fn ties_follow_the_nearest_point_of_a_segment() {
    let cards = "*CONTACT_TIED_NODES_TO_SURFACE_ID\n1 a tie\n4,5,4,0\n0.\n1.,1.,-.01,-.01\n";
    let model = cube(cards);
    let line = first_line() + 2;
    assert_eq!(
        (model.equations(), model.label(0)),
        (12, Some(format!("line {line} *CONTACT_TIED_NODES_TO_SURFACE_ID 11:1")))
    );
    assert_eq!(equations(&model)[0], "1 11:1 -0.5625 5:1 -0.1875 6:1 -0.0625 7:1 -0.1875 8:1");
    // The outside of part 1 as the master, and part 2 as the slave: the same.
    let parts = cube("*CONTACT_TIED_SURFACE_TO_SURFACE\n2,1,3,3\n\n1.,1.,-.01,-.01\n");
    assert_eq!(equations(&parts), equations(&model));
    // Nodes farther than 5 % of the diagonal remain free, and so does a node of the segment itself.
    let far = cube("*SET_NODE\n7\n5,22,12\n*CONTACT_TIED_NODES_TO_SURFACE\n7,5,4,0\n\n0.,0.,.01,.01\n");
    assert_eq!((far.equations(), left_out(&far).len()), (3, 0));
    assert!(
        far.warnings()
            .iter()
            .any(|warning| warning.text.contains("leaves 1 nodes free") && warning.text.contains("22"))
    );
    // The thickness of shells, which is not read, may tie such a node.
    let unsure = cube("*SET_NODE\n7\n5,22,12\n*CONTACT_TIED_NODES_TO_SURFACE\n7,5,4,0\n");
    assert_eq!((unsure.equations(), left_out(&unsure).len()), (3, 1));
    let offset = cube("*CONTACT_TIED_NODES_TO_SURFACE_OFFSET\n4,5,4,0\n");
    let why = "*CONTACT_TIED_NODES_TO_SURFACE_OFFSET ties by springs, which are no equations: left out";
    assert_eq!(left_out(&offset), [format!("line {}: {why}", first_line())]);
}

#[test]
fn supports_and_motions() {
    let model = cube(
        "*BOUNDARY_SPC_NODE\n         1         0         1         0         1\n2,9,1,1,1\n\
         *BOUNDARY_SPC_SET_ID\n1 corner\n4,0,0,0,0,0,0,1\n*BOUNDARY_SPC_NODE_BIRTH_DEATH\n3,0,1\n0.,1e20\n\
         *BOUNDARY_PRESCRIBED_MOTION_NODE_ID\n8 pull\n20,3,2,17,2.5\n*BOUNDARY_PRESCRIBED_MOTION_SET\n3,1,0,17\n4,5,0,17,0.\n",
    );
    let expected = "1:1=0 1:3=0 2:1=0 2:2=0 2:3=0 3:1=0 5:1=1 6:1=1 7:1=1 8:1=1";
    let found = prescribed(&model).join(" ").replace(" velocity curve 17", "");
    assert!(found.starts_with(expected), "{found}");
    assert!(prescribed(&model).contains(&"20:3=2.5 displacement curve 17".to_owned()));
    assert!(found.contains("11:4=0 11:6=0"), "{found}");
    let body = cube(&format!("{RIGID}*BOUNDARY_PRESCRIBED_MOTION_RIGID\n1,2,2,3,0.1\n2,3,2,3,0.1,0,1.E+28\n"));
    let moved: Vec<String> = prescribed(&body).into_iter().filter(|given| given.contains("curve")).collect();
    assert_eq!(moved, ["body 1:2=0.1 displacement curve 3", "body 2:3=0.1 displacement curve 3"]);
    let other = cube("*BOUNDARY_PRESCRIBED_MOTION_NODE\n20,4,2,1,1.,2\n20,1,4,1\n\n*BOUNDARY_SPC_NODE\n20,3,1\n");
    assert_eq!((prescribed(&other).len(), left_out(&other).len()), (0, 2));
}

/// All cards hold at all times here, and in all cases.
#[test]
fn values_for_a_part_of_the_time_are_left_out() {
    for cards in [
        "*BOUNDARY_SPC_NODE_BIRTH_DEATH\n3,0,1\n0.,1.\n",
        "*BOUNDARY_SPC_SET_BIRTH_DEATH\n3,0,1\n1.\n",
        "*BOUNDARY_PRESCRIBED_MOTION_NODE\n20,3,2,17,2.5,0,9.\n",
        "*BOUNDARY_PRESCRIBED_MOTION_NODE\n20,3,2,17,0.,0,0.,1.\n",
    ] {
        let read = cube(cards);
        assert_eq!((prescribed(&read).len(), left_out(&read).len()), (0, 1), "{cards}");
        assert!(left_out(&read)[0].contains("holds only from time"), "{:?}", left_out(&read));
    }
    let cases = cube("*CASE\n1\n*CASE_BEGIN_1\n*BOUNDARY_SPC_NODE\n3,0,1\n*CASE_END_1\n*BOUNDARY_SPC_NODE\n3,0,0,1\n");
    assert_eq!(prescribed(&cases), ["3:2=0"]);
    let both = "*CASE_BEGIN_1\n*CASE_BEGIN_2\n*CASE_END_2\n*BOUNDARY_SPC_NODE\n3,0,1\n*CASE_END_1\n*CASE_END_1\n";
    assert_eq!((prescribed(&cube(both)).len(), left_out(&cube(both)).len()), (0, 1));
    assert_eq!(
        left_out(&cases),
        [format!(
            "line {}: *CASE_BEGIN_1 begins cards of one case, such as *BOUNDARY_SPC_NODE, which this reader does not follow: left out",
            first_line() + 2
        )]
    );
    // Cards that this reader does not need leave nothing out.
    let of_case = |cards: &str| left_out(&cube(&format!("*CASE_BEGIN_1\n{cards}*CASE_END_1\n"))).len();
    for harmless in ["*CONTROL_TERMINATION\n1.\n", "*LOAD_NODE_SET\n3,1,1\n", "*MAT_ELASTIC\n1,1.,1.\n", "*TITLE\na\n"]
    {
        assert_eq!(of_case(harmless), 0, "{harmless}");
    }
    for needed in ["*NODE\n30,0.,0.,0.\n", "*SET_NODE_LIST\n30\n1\n", "*PART\n\n9,1,1\n", "*DEFORMABLE_TO_RIGID\n1\n"] {
        assert_eq!(of_case(&format!("*CONTROL_TERMINATION\n1.\n{needed}")), 1, "{needed}");
    }
}

#[test]
fn local_directions_and_boxes_are_left_out() {
    let mean = |fields: &str| {
        left_out(&cube(&format!("*CONSTRAINED_INTERPOLATION\n1,22,{fields}\n5,123\n6,123\n7,123\n"))).len()
    };
    assert_eq!([mean("1,0"), mean("1,5"), mean("123,5"), mean("1236,5"), mean("123456,5")], [0, 1, 0, 1, 0]);
    let tied = |fields: &str| {
        let read = cube(&format!("*CONTACT_TIED_NODES_TO_SURFACE\n4,5,4,0{fields}\n\n\n"));
        (read.equations(), left_out(&read).len())
    };
    assert_eq!([tied(""), tied(",9"), tied(",0,9")], [(12, 0), (0, 1), (0, 1)]);
}

#[test]
fn options_of_parts() {
    let body = |part: &str| {
        let read = cube(&format!("*MAT_RIGID\n5,1.,1.,.3\n{part}"));
        (read.equations(), left_out(&read))
    };
    assert_eq!(body("*PART\n\n1,1,5\n"), (24, vec![]));
    assert_eq!(body("*PART_ATTACHMENT_NODES\n\n1,1,5\n3\n"), (24, vec![]));
    assert_eq!(body("*PART_COMPOSITE\n\n2,2,5\n"), (0, vec![]));
    // These cards name parts and define none.
    assert_eq!(body("*PART\n\n1,1,5\n*PART_SENSOR\n1,2,1\n*PART_ADAPTIVE_FAILURE\n1,.1\n"), (24, vec![]));
    let why = "*PART_FIELD may define rigid parts in a way that is not understood: left out";
    assert_eq!(body("*PART_FIELD\n\n1,1,5\n"), (0, vec![format!("line {}: {why}", first_line() + 2)]));
}

/// The conditions of the first body hold for both.
#[test]
fn conditions_of_merged_bodies_are_left_out() {
    let merged = cube(&format!(
        "{RIGID}*CONSTRAINED_RIGID_BODIES\n1,2\n*BOUNDARY_PRESCRIBED_MOTION_RIGID\n2,1,2,3,0.1\n1,2,2,3,0.1\n"
    ));
    let moved: Vec<String> = prescribed(&merged).into_iter().filter(|given| given.contains("curve")).collect();
    assert_eq!(moved, ["body 1:2=0.1 displacement curve 3"]);
    assert!(
        left_out(&merged).iter().any(|text| text.contains("holds a body that is merged into another")),
        "{:?}",
        left_out(&merged)
    );
}

#[test]
fn parameters_are_followed_or_said() {
    let with = |parameters: &str| {
        let read = cube(&format!("{parameters}*CONSTRAINED_LINEAR_GLOBAL\n1\n1,1,1.\n2,1,&A\n"));
        (equations(&read), left_out(&read).len(), read.warnings().len())
    };
    let is = |value: &str| (vec![format!("1 1:1 {value} 2:1")], 0, 0);
    let unknown = (vec![], 1, 1);
    assert_eq!(with("*PARAMETER\nR A       -1.\n"), is("-1"));
    // An expression takes the rest of the line.
    assert_eq!(with("*PARAMETER_EXPRESSION\nR A       -1.25000000000\n"), is("-1.25"));
    assert_eq!(with("*PARAMETER_EXPRESSION\nR A,-1.25000000000\n"), is("-1.25"));
    let expression =
        |text: &str| with(&format!("*PARAMETER\nR B       4.        I N       7\n*PARAMETER_EXPRESSION\n{text}"));
    assert_eq!(expression("R A       0.12345678*10\n"), is("1.2345678"));
    assert_eq!(expression("R A       max(2,3)\n"), is("3"));
    assert_eq!(expression("R A       -1.\n          *2.\n"), is("-2"));
    assert_eq!(expression("R A       -&B*sqrt(n+2.)\n          /cos(\n          0.)\n"), is("-12"));
    assert_eq!(expression("R C       B/8\nR A       C\n          +max(1.,\n          b,2.)\n"), is("4.5"));
    assert_eq!(expression("I A       N/2.\n"), unknown);
    // Of whole numbers, LS-DYNA may find 3 or 3.5.
    assert_eq!(expression("R A       N/2\n"), unknown);
    assert_eq!(expression("R A       2*somewhere\n"), unknown);
    // The third field says what the value names.
    assert_eq!(with("*PARAMETER_TYPE\nI B       3         CA\n*PARAMETER\nR A       -1.\n"), is("-1"));
    // The first of two definitions counts, unless the deck says otherwise.
    let twice = "*PARAMETER\nR A       -1.\n*PARAMETER\nR A       5.\n";
    assert_eq!(with(twice), (vec!["1 1:1 -1 2:1".into()], 0, 1));
    assert_eq!(with(&twice.replace("5.", "-1.")), is("-1"));
    for changed in [
        format!("*PARAMETER_DUPLICATION\n2\n{twice}"),
        twice.replace("*PARAMETER", "*PARAMETER_LOCAL"),
        twice.replacen("*PARAMETER", "*PARAMETER_MUTABLE", 1),
    ] {
        assert_eq!(with(&changed), unknown, "{changed}");
    }
    assert_eq!(with(&format!("*PARAMETER_DUPLICATION\n1\n{twice}")).0, is("-1").0);
    // Expressions of such parameters are not known either.
    assert_eq!(with("*PARAMETER_MUTABLE\nR B       -1.\n*PARAMETER_EXPRESSION\nR A       2*B\n"), unknown);
    // The lines below a second definition continue it, and not the first.
    let second = "*PARAMETER_EXPRESSION\nR A       -1.\n*PARAMETER_EXPRESSION\nR A       3.\n          *2.\n";
    assert_eq!(with(second), (is("-1").0, 0, 1));
}

#[test]
fn parameters_without_a_type_or_a_value_are_not_defined() {
    let warned = |parameters: &str| {
        let read =
            cube(&format!("{parameters}*PARAMETER\nR A       -1.\n*CONSTRAINED_LINEAR_GLOBAL\n1\n1,1,1.\n2,1,&A\n"));
        let texts: Vec<String> =
            read.warnings().iter().map(|warning| format!("{}: {}", warning.line, warning.text)).collect();
        (equations(&read), texts)
    };
    let line = first_line() + 1;
    for (name, card) in [
        ("`XA`", "*PARAMETER\nXA        5.\n"),
        ("`R A`", "*PARAMETER\nR A\n"),
        ("`R`", "*PARAMETER\nR         5.\n"),
        ("`R A`", "*PARAMETER_EXPRESSION\nR A\n"),
        ("nothing", "*PARAMETER\n          5.\n"),
    ] {
        let why = "has no value, or no type R, I or C before its name: it is not defined, as in LS-DYNA";
        assert_eq!(
            warned(card),
            (vec!["1 1:1 -1 2:1".to_owned()], vec![format!("{line}: the parameter {name} {why}")])
        );
    }
    let used = super::from_text::refused(&format!("{CUBE}*PARAMETER\nR B\n*CONSTRAINED_LINEAR_GLOBAL\n1\n1,1,&B\n"));
    assert!(used.contains("parameter B is not defined"), "{used}");
}

#[test]
fn nodes_hold_components_themselves() {
    let model = model("*KEYWORD\n*NODE\n1,0.,0.,0.,5,7\n2,1.,0.,0.\n*BOUNDARY_PRESCRIBED_MOTION_NODE\n1,2,0,1\n");
    assert_eq!(prescribed(&model), ["1:2=0", "1:3=0", "1:4=0", "1:5=0", "1:6=0"]);
    let clash = model.cases()[0].clashes[0];
    assert_eq!(model.place(clash.origin), "line 6 *BOUNDARY_PRESCRIBED_MOTION_NODE");
    assert_eq!(analysis(&model).dependent()[0].kind, Kind::Conflicting);
}

#[test]
fn other_cards_are_named_or_ignored() {
    for card in [
        "CONSTRAINED_JOINT_REVOLUTE",
        "CONSTRAINED_SPOTWELD",
        "CONSTRAINED_LINEAR_LOCAL",
        "CONTACT_TIED_SHELL_EDGE_TO_SURFACE",
        "CONTACT_AUTOMATIC_ONE_WAY_SURFACE_TO_SURFACE_TIEBREAK",
        "BOUNDARY_SPC_SYMMETRY_PLANE",
        "BOUNDARY_CYCLIC",
        "BOUNDARY_PRESCRIBED_MOTION_RIGID_LOCAL",
        "DEFORMABLE_TO_RIGID",
        "INCLUDE_TRANSFORM",
        "CONSTRAINED_NODAL_RIGID_BODY_OVERRIDE",
    ] {
        let line = first_line();
        let found = left_out(&cube(&format!("*{card}\n1,2,3\n")));
        assert!(found.len() == 1 && found[0].starts_with(&format!("line {line}: *{card} ")), "{card}: {found:?}");
    }
    for card in [
        "CONTACT_AUTOMATIC_SINGLE_SURFACE",
        "LOAD_NODE_SET",
        "BOUNDARY_TEMPERATURE_SET",
        "CONSTRAINED_JOINT_STIFFNESS_GENERALIZED",
    ] {
        assert_eq!(left_out(&cube(&format!("*{card}\n1,2,3\n"))), [""; 0], "{card}");
    }
    // A set that is not read, and elements that are not, leave out what needs them.
    let set = cube("*SET_NODE_GENERAL\n8\nPART,1\n*BOUNDARY_SPC_SET\n8,0,1\n");
    assert_eq!(
        left_out(&set),
        [format!(
            "line {}: *BOUNDARY_SPC_SET uses node set 8, which *SET_NODE_GENERAL defines: left out",
            first_line() + 4
        )]
    );
    let elements = cube(&format!("{RIGID}*ELEMENT_SHELL_COMPOSITE\n9,2,11,12,13,14\n1,.5,0.\n"));
    assert_eq!((elements.equations(), left_out(&elements).len()), (0, 2));
}

#[test]
fn the_deck_is_read_only_and_claims_are_modest() {
    let text = format!(
        "{CUBE}*CONSTRAINED_LINEAR_GLOBAL\n1\n1,1,1.\n2,1,-1.\n*CONSTRAINED_LINEAR_GLOBAL\n2\n1,1,1.\n2,1,-1.\n"
    );
    let deck = parsed(&text).expect("a deck");
    assert_eq!((deck.format(), deck.solver()), (Format::LsDyna, Solver::LsDyna));
    let error = clean::clean(&deck, &qless::Options::default()).expect_err("read only").to_string();
    assert!(error.starts_with("decks of LS-DYNA are read, but not written"), "{error}");
    let found = clean::findings(deck.model(), &deck.model().cases()[0], Solver::LsDyna);
    assert_eq!(found.iter().map(|finding| finding.outcome).collect::<Vec<_>>(), [Outcome::Unsound]);
    let held = cube("*CONSTRAINED_NODAL_RIGID_BODY\n3\n*BOUNDARY_SPC_NODE\n5,0,1\n");
    let found = clean::findings(&held, &held.cases()[0], Solver::LsDyna);
    assert_eq!(found.iter().map(|finding| finding.outcome).collect::<Vec<_>>(), [Outcome::Accepted]);
    assert_eq!((deck.node_set("3"), deck.positions()[&22]), (Some(vec![5, 6, 7, 8]), [0.0, 0.0, 3.0]));
}
