//! Spellings that are accepted: the same equation in every form.

use super::given::{equations, model, parsed, warnings};

const SMALL: &str = "MPC     5       1       3       1.      2       1       -.5
                3       2       2.5-1
";
const LARGE: &str = "MPC*                   5               1               3              1.
*                      2               1             -.5
*                                      3               2           2.5-1
*
";
const MIXED: &str = "MPC*                   5               1               3              1.*A
*A                     2               1             -.5                +B
+B              3       2       2.5D-1
";
const TABS: &str = "MPC\t5\t1\t3\t1.\t2\t1\t-.5\n\t\t3\t2\t.25\n";

#[test]
fn every_form_of_a_card_is_the_same() {
    let free = ["MPC,5,1,3,1.,2,1,-.5,,+\n+,,3,2,.25\n", "mpc , 5,1,3, 1.0 ,2,1,-5.-1\n,,3,2,+.25E0\n"];
    let free_large = "MPC*,5,1,3,1.\n*,2,1,-.5\n*,,3,2,.25\n*\n";
    let comments = "MPC     5       1       3       1.      2       1       -.5 $ why\n$ in between\n\n,,3,2,.25 $\n";
    for card in [SMALL, LARGE, MIXED, TABS, free[0], free[1], free_large, comments] {
        let text = format!(
            "SOL 101\nCEND\n MPC = 5\nbegin bulk\nGRID,1\nGRID,2\nGRID,3\n{card}ENDDATA\nMPC,5,1,1,1.,2,1,1.\n"
        );
        let model = model(&text);
        assert_eq!(equations(&model), ["1 1:3 -0.5 2:1 0.25 3:2"], "{card}");
        assert_eq!(warnings(&model), [""; 0], "{card}");
    }
}

#[test]
fn line_ends_and_byte_order_marks_do_not_matter() {
    let text = format!("\u{feff}CEND\nMPC=5\nBEGIN BULK\nGRID,1\nGRID,2\nGRID,3\n{SMALL}").replace('\n', "\r\n");
    assert_eq!(equations(&model(&text)), ["1 1:3 -0.5 2:1 0.25 3:2"]);
}

#[test]
fn includes_stand_where_they_are_named() {
    let text = "CEND\nINCLUDE 'control.inc'\nBEGIN BULK\ninclude \"mesh\n.inc\"\nINCLUDE rigid.inc\nENDDATA\n";
    let files = [
        ("control.inc", "MPC = 5"),
        ("mesh.inc", "GRID,1\nGRID,2,,1.\nGRID,3"),
        ("rigid.inc", "$ elements\nRBE2,7,1,12,2,3\nINCLUDE 'inner.inc'"),
        ("inner.inc", "MPC,5,1,3,1.,2,3,-1."),
    ];
    let model = parsed(text, &files).unwrap_or_else(|error| panic!("{error}")).model().clone();
    let labels: Vec<String> = (0..model.equations()).map(|i| model.label(i).expect("an equation")).collect();
    let rbe2 = ["rigid.inc:2 RBE2 7 2:1", "rigid.inc:2 RBE2 7 2:2", "rigid.inc:2 RBE2 7 3:1", "rigid.inc:2 RBE2 7 3:2"];
    assert_eq!(labels[..4], rbe2);
    assert_eq!(labels[4], "inner.inc:1 MPC 5 1:3");
}

#[test]
fn an_include_of_executive_control_may_be_missing() {
    let model = model("SOL 103\ninclude '/elsewhere/procedure.v9'\nCEND\nBEGIN BULK\n");
    assert_eq!(model.warnings().len(), 1);
    assert!(model.warnings()[0].text.contains("/elsewhere/procedure.v9"), "{}", model.warnings()[0].text);
}

#[test]
fn rigid_elements_in_every_form() {
    let grids = "GRID,1\nGRID,2,,1.\nGRID,3,,,2.\nGRID,4,,3.,4.\n";
    let dependents = |card: &str| {
        let model = model(&format!("{grids}{card}"));
        (0..model.equations())
            .map(|i| model.dofs()[model.equation(i).expect("an equation").columns[0] as usize].to_string())
            .collect::<Vec<_>>()
    };
    assert_eq!(dependents("RBE2,7,1,3,2,THRU,4"), ["2:3", "3:3", "4:3"]);
    assert_eq!(dependents("RBE2,7,1,3,2,4,0.0,20."), ["2:3", "4:3"]);
    assert_eq!(dependents("RBAR,7,1,2"), ["2:1", "2:2", "2:3", "2:4", "2:5", "2:6"]);
    assert_eq!(dependents("RBAR,7,1,2,,123456,13"), ["1:1", "1:3"]);
    assert_eq!(dependents("RBAR,7,1,2,1234,23"), ["1:5", "1:6", "2:1", "2:4", "2:5", "2:6"]);
    assert_eq!(dependents("RROD,7,1,2,,1"), ["2:1"]);
    assert_eq!(dependents("RROD,7,1,4,2"), ["1:2"]);
    assert_eq!(dependents("RBE1,7,1,123,3,13,2,3\n,UM,4,123,1,4"), ["4:1", "4:2", "4:3", "1:4"]);
    assert_eq!(dependents("RBE3,7,,4,123,1.,123,1,2\n,3"), ["4:1", "4:2", "4:3"]);
    assert_eq!(
        dependents("RBE3,7,,4,123,1.,123,1,2\n,3,2.5,123456,2\n,UM,1,2,2,1,4,3\n,ALPHA,0."),
        ["1:2", "2:1", "4:3"]
    );
}

#[test]
fn thermal_expansion_is_left_out_with_a_warning() {
    let model = model("GRID,1\nGRID,2\nRBE2,7,1,3,2,1.-5\n");
    assert_eq!(warnings(&model), ["line 3: RBE2 7: its thermal expansion ALPHA is left out"]);
}

#[test]
fn cards_that_are_not_understood_are_named() {
    let model =
        model("GRID,1\nRSPLINE,9,,1,2,123,3,123,4\nRBE2GS,8,1,2,3\nCQUAD4,1,1,1,2,3,4\nSUPORT,1,123,4,12\nCWELD,4\n");
    let expected = [
        "line 2: RSPLINE 9 is an interpolation element of grid points 1, 2, 3, 4; it is not understood and left out",
        "line 3: RBE2GS 8 is a rigid element that searches its grid points; it is not understood and left out",
        "line 5: SUPORT 1 names reference components of grid points 1, 4; it gives no equation, but a static solution without inertia relief holds them",
        "line 6: CWELD 4 joins its parts by equations; it is not understood and left out",
    ];
    assert_eq!(warnings(&model), expected);
}

#[test]
fn more_rigid_elements_are_read() {
    let grids = "GRID,1\nGRID,2,,1.\nGRID,3,,,2.\nGRID,4\n";
    let dependents = |card: &str| {
        let model = model(&format!("{grids}{card}"));
        assert_eq!(warnings(&model), [""; 0], "{card}");
        let slave = |i| model.dofs()[model.equation(i).expect("an equation").columns[0] as usize].to_string();
        (0..model.equations()).map(slave).collect::<Vec<_>>().join(" ")
    };
    assert_eq!(dependents("RBAR1,7,1,2,1 3"), "2:1 2:3");
    assert_eq!(dependents("RBAR1,7,1,2"), "2:1 2:2 2:3 2:4 2:5 2:6");
    assert_eq!(dependents("RJOINT,7,1,4,123"), "4:1 4:2 4:3");
    assert_eq!(dependents("RTRPLT,7,1,2,3,123456\n,,,12"), "3:1 3:2");
    assert_eq!(dependents("RTRPLT,7,1,2,3,1236,3,3"), "1:4 1:5 2:1 2:2 2:4 2:5 2:6 3:1 3:2 3:4 3:5 3:6");
    assert_eq!(dependents("RTRPLT1,7,1,2,3,12,3"), "2:1 2:2 3:3");
    assert_eq!(dependents("JOINTG,7,,BALL,1,,4"), "4:1 4:2 4:3");
    assert_eq!(dependents("JOINTG,7,,RBEAM,1,,2"), "2:1 2:2 2:3 2:4 2:5 2:6");
    assert_eq!(dependents("RBE3,7,,4,12 3,1.,123,1,THRU,3"), "4:1 4:2 4:3");
}

/// An arm of the plate moves as that of a bar does.
#[test]
fn elements_of_one_body_say_the_same() {
    let grids = "GRID,1\nGRID,2,,1.\nGRID,3,,,2.\n";
    let same = |a: &str, b: &str| {
        assert_eq!(equations(&model(&format!("{grids}{a}"))), equations(&model(&format!("{grids}{b}"))));
    };
    same("RBAR1,7,1,2,123", "RBE2,7,1,123,2");
    same("RTRPLT1,7,1,2,3", "RBE2,7,1,123456,2,3");
    same("RTRPLT,7,1,2,3,123456\n,,,3", "RBE2,7,1,3,3");
    same("RBE3,7,,3,123,1.,123456,1,2", "RBE3,7,,3,123,1.,123456,1,THRU,2");
    same("JOINTG,7,,RBEAM,1,,2", "RBAR,7,1,2,123456");
}

#[test]
fn what_constrains_and_is_not_read_leaves_the_model_incomplete() {
    let left_out = |card: &str| {
        let model = model(&format!("CEND\nBEGIN BULK\nGRID,1\nGRID,2\n{card}\n"));
        assert_eq!((model.warnings().len(), model.equations()), (1, 0), "{card}");
        model.left_out().count()
    };
    for card in [
        "RSPLINE,9,,1,2,123,1",
        "RSSCON,9,GRID,1,2",
        "TIE,1,2,3",
        "JOINTG,7,,HINGE,1,,2",
        "BEGIN SUPER=1\nRBE2,1,1,3,2",
        "SEBSET,1,1,123",
        "CSUPER,1,,1",
        "CWELD,7,1",
        "BCTABLE,1",
    ] {
        assert_eq!(left_out(card), 1, "{card}");
    }
    assert_eq!(left_out("BCTSET,1,2"), 0, "contact alone ties nothing");
    assert_eq!(left_out("SUPORT,1,123"), 0, "reference components are no equation");
    assert!(
        warnings(&model("GRID,1\nGRID,2\nJOINTG,7,,HINGE,1,,2\n"))[0]
            .contains("JOINTG 7 is a joint of type HINGE of grid points 1, 2")
    );
}

/// The manual that says so was not available: the predicted stops stay, and the warning says what they depend on.
#[test]
fn an_automatic_choice_of_dependent_components_is_said() {
    let said = |value: &str| warnings(&model(&format!("GRID,1\nPARAM,AUTOMPC,{value}\n")));
    assert_eq!(said("NO"), [""; 0]);
    let text = "lets Nastran choose dependent components and drop redundant equations: it may not stop where a stop is predicted";
    assert_eq!(said("yes"), [format!("line 2: PARAM,AUTOMPC,YES {text}")]);
}

/// Two grids at one point, of which one is typed in turned axes, with all digits that a field of 16 columns holds: no equation has an arm.
#[test]
fn rounding_of_coordinates_makes_no_arms() {
    for k in 1..200 {
        let (angle, size) = (f64::from(k) * 0.03, 10_f64.powi(k % 6));
        let (x, y) = (1.2345 * size * f64::from(k), 0.77 * size);
        let own = [x * angle.cos() + y * angle.sin(), y * angle.cos() - x * angle.sin()];
        let field = |value: f64| {
            let wide = |digits: usize| format!("{value:.digits$}");
            (0..16).rev().map(wide).find(|text| text.len() <= 16).expect("fits")
        };
        let frame = format!("CORD2R*,5,,0.,0.\n*,0.,0.,0.,1.\n*,{},{},0.\n", field(angle.cos()), field(angle.sin()));
        let deck = format!(
            "CEND\nBEGIN BULK\n{frame}GRID*,1,,{},{}\n*,12.3\nGRID*,2,5,{},{}\n*,12.3\nRBE2,9,1,123,2\n",
            field(x),
            field(y),
            field(own[0]),
            field(own[1])
        );
        let expected = ["1 2:1 -1 1:1", "1 2:2 -1 1:2", "1 2:3 -1 1:3"];
        assert_eq!(equations(&model(&deck)), expected, "{deck}");
    }
}

/// Bodies and means at site coordinates in millimetres: far from the origin as near it, the equations agree to rounding.
#[test]
fn coordinates_far_from_the_origin_leave_no_doubt() {
    for (k, offset) in [0.0, 12_345.7, 1_234_567.1, 987_654.3].into_iter().enumerate() {
        let corner =
            |i: usize, axis: usize| offset + [-50.0, 50.0][(i >> axis) & 1] + 0.1 * (i * (k + axis + 1)) as f64;
        let grid =
            |i: usize| format!("GRID*,{},,{:.1},{:.1}\n*,{:.1}\n", i + 1, corner(i, 0), corner(i, 1), corner(i, 2));
        let grids: String = (0..8).map(grid).collect();
        let place = format!("{offset:.1},{offset:.1}\n*,{offset:.1}\n");
        let centre = format!("GRID*,9,,{place}GRID*,10,,{place}");
        let cards =
            "RBE2,20,9,123456,1,2,3,4,5\n,6,7,8\nRBE3,21,,10,123456,1.,123,1,2\n,3,4,5,6,7,8\nRBE2,22,9,123456,10\n";
        let deck = format!("CEND\nBEGIN BULK\n{grids}{centre}{cards}");
        let model = model(&deck);
        let system = model.system(&model.cases()[0]).expect("a system");
        let analysis = qless::analyse(&system, &qless::Options::default()).expect("an analysis");
        assert_eq!(system.equations() - analysis.rank(), 6, "{deck}");
        assert!(!analysis.confidence().ambiguous, "{:?}\n{deck}", analysis.confidence());
    }
}
