//! Every card that constrains: its equations or values, the rank and status of the system, and line numbers.

use qless::Kind;
use qless_io::deck::{Format, Outcome, Solver, clean};

use super::from_text::{CUBE, analysis, cube, equations, first_line, left_out, parsed, prescribed, stops};

/// `/RBODY/7` with a main node, a group and ICoG.
fn body(main: u32, group: u32, centre: u32) -> String {
    format!("/RBODY/7\n'a body\n{main} 0 0 0 =0. {group} 0 {centre} 0\n=0. =0. =0.\n=0. =0. =0.\n")
}

#[test]
fn a_rigid_body_moves_its_nodes() {
    let model = cube(&body(22, 3, 4));
    // Nodes of solids have no rotations. The main node is at (0, 0, 3), node 5 at (0, 0, 1) and node 6 at (1, 0, 1).
    let own = ["1 5:1 -1 22:1 2 22:5", "1 5:2 -1 22:2 -2 22:4", "1 5:3 -1 22:3"];
    let other = ["1 6:1 -1 22:1 2 22:5", "1 6:2 -1 22:2 -2 22:4 -1 22:6", "1 6:3 -1 22:3 1 22:5"];
    assert_eq!(equations(&model)[..6], [own, other].concat());
    assert_eq!(model.label(0), Some(format!("line {} /RBODY/7 5:1", first_line() + 2)));
    assert_eq!((analysis(&model).rank(), left_out(&model).len()), (12, 0));
    // Shells rotate, and a main node in its own group follows nothing.
    let plate = cube(&format!("/GRNOD/GRNOD/9\n'both\n4 10\n/GRNOD/NODE/10\n'main\n22\n{}", body(22, 9, 4)));
    assert_eq!((plate.equations(), analysis(&plate).rank()), (24, 24));
    // The same nodes in a second body: of 12 more equations, 6 are those of the second main node.
    let twice = cube(&format!("{}{}", body(22, 3, 4), body(21, 3, 4).replace("/7", "/8")));
    assert_eq!((twice.equations(), analysis(&twice).rank()), (24, 18));
}

#[test]
fn what_switches_bodies_off_is_left_out() {
    let sensor = cube(&body(22, 3, 4).replace("22 0 0", "22 5 0"));
    let why = "/RBODY/7 holds only while its sensor is active: left out";
    assert_eq!((sensor.equations(), left_out(&sensor)), (0, vec![format!("line {}: {why}", first_line() + 2)]));
    let fails = cube(&(body(22, 3, 4) + "0 0 1\n=1. =1. =2. =2.\n"));
    assert_eq!((fails.equations(), left_out(&fails).len()), (0, 1));
    assert_eq!(cube(&(body(22, 3, 4) + "0 0 0\n")).equations(), 12);
    let without = cube(&body(22, 0, 4));
    assert_eq!((without.equations(), left_out(&without).len()), (0, 0));
}

/// By default, Radioss moves the main node to the centre of mass.
#[test]
fn the_centre_of_mass_matters_if_the_body_turns_and_others_use_it() {
    let held = |components: &str| format!("/GRNOD/NODE/9\n'main\n22\n/BCS/1\n'held\n{components} 0 9\n");
    let slave = "/GRNOD/NODE/10\n'a slave\n5\n/BCS/2\n'slave\n100/000 0 10\n";
    let read = |cards: &str, centre: u32| {
        let model = cube(&format!("{cards}{}", body(22, 3, centre)));
        (prescribed(&model).len(), left_out(&model).len())
    };
    assert_eq!(read(&held("111/000"), 0), (3, 0));
    assert_eq!(read(&(held("111/111") + slave), 1), (7, 0));
    assert_eq!(read(&(held("000/110") + slave), 1), (3, 0));
    assert_eq!(read(&(held("110/110") + slave), 3), (5, 0));
    for centre in [0, 1, 2] {
        assert_eq!(read(&(held("110/110") + slave), centre), (3, 2));
    }
    let model = cube(&format!("{}{slave}{}", held("110/000"), body(22, 3, 0)));
    let line = first_line() + 5;
    let why = "/BCS/1 holds a main node that Radioss moves to an unknown centre of mass: left out";
    assert!(left_out(&model).contains(&format!("line {line}: {why}")), "{:?}", left_out(&model));
    assert!(model.warnings().iter().any(|warning| warning.text.contains("count at the positions that the deck gives")));
}

#[test]
fn rbe2_follows_in_some_components_and_in_a_frame() {
    let rbe2 = |fields: &str| cube(&format!("/RBE2/3\n'a link\n22 {fields}\n"));
    assert_eq!(equations(&rbe2("100/001 0 4 0"))[..2], ["1 11:1 -1 22:1 2 22:5 0.25 22:6", "1 11:6 -1 22:6"]);
    assert_eq!(rbe2("000/000 0 4 1").equations(), 24);
    assert_eq!(rbe2("000/000 0 4 1").label(0), Some(format!("line {} /RBE2/3 11:1", first_line() + 2)));
    assert_eq!(left_out(&rbe2("100/000 0 4 1")).len(), 1);
    // Axes along y, -x and z: the second axis is -x.
    let turned = "/SKEW/FIX/5\n'turned\n=0. =0. =0.\n=-1. =0. =0.\n=0. =0. =1.\n";
    let model = cube(&format!("{turned}/RBE2/3\n'a link\n22 010/100 5 4 0\n"));
    assert_eq!(equations(&model)[..2], ["-1 11:1 1 22:1 -2 22:5 -0.25 22:6", "1 11:5 -1 22:5"]);
    // All three directions of a frame are those of space.
    let all = cube(&format!("{turned}/RBE2/3\n'a link\n22 111/000 5 4 0\n"));
    assert_eq!(equations(&all), equations(&rbe2("111/000 0 4 0")));
}

/// The mean rotation of the corners of a unit square about its middle: `sum (r x u) / sum r . r`, with `r . r = 1/2` at each.
const TURN: &str = "1 22:6 -0.25 5:1 0.25 5:2 -0.25 6:1 -0.25 6:2 0.25 7:1 -0.25 7:2 0.25 8:1 0.25 8:2";

#[test]
fn rbe3_is_a_weighted_mean() {
    let rbe3 = |first: &str, sets: &str| cube(&format!("/RBE3/4\n'a mean\n22 {first}\n{sets}"));
    let mean = rbe3("100/001 1 0", "=1. 111/000 0 3\n");
    let square = ["1 22:1 -0.25 5:1 -0.25 6:1 -0.25 7:1 -0.25 8:1", TURN];
    assert_eq!(equations(&mean)[1], TURN);
    assert_eq!((mean.equations(), analysis(&mean).rank()), (2, 2));
    assert_eq!(mean.label(0), Some(format!("line {} /RBE3/4 22:1", first_line() + 2)));
    // Blank components are all of the reference, and the translations of the others.
    assert_eq!(
        (rbe3("_ 1 0", "=0. _ 0 3\n").equations(), equations(&rbe3("_ 1 0", "=0. _ 0 3\n"))[5].as_str()),
        (6, square[1])
    );
    // Weights of x are divided by their sum, unless I_modif is 2.
    let both = "/GRNOD/NODE/9\n'a\n20\n/GRNOD/NODE/10\n'b\n21\n";
    let two = |kind: &str| {
        let sets = "=1. 111/000 0 3\n=3. 100/000 0 9\n=1. 000/111 0 10\n";
        equations(&rbe3(&format!("100/000 3 {kind}"), &format!("{sets}{both}")))
    };
    assert!(two("0") != two("2") && two("0") == two("1"), "{:?}", two("0"));
    assert_eq!(left_out(&rbe3("_ 1 0 3", "=1. _ 0 3\n")).len(), 1);
}

#[test]
fn means_that_may_become_springs_are_named() {
    let warnings = |form: u32, others: &str| {
        let model = cube(&format!("/RBE3/4\n'a mean\n22 _ 1 0 {form}\n=1. _ 0 3\n{others}"));
        let all = model.warnings().iter().filter(|warning| warning.line > 0);
        all.map(|warning| format!("{}: {}", model.place_of(warning), warning.text)).collect::<Vec<_>>()
    };
    let link = "/RBE2/3\n'a link\n20 _ 0 3 0\n";
    let held = "/GRNOD/NODE/9\n'one\n22\n/BCS/1\n'held\n001/000 0 9\n";
    let what = "so that Radioss may replace it by springs (Iform)";
    let line = first_line() + 2;
    for (others, why) in [
        (link.to_owned(), "averages slaves of an /RBE2 or /INTER/TYPE2"),
        (body(22, 4, 4), "moves the main node of an /RBODY"),
        (held.to_owned(), "moves a node that a /BCS holds"),
    ] {
        assert_eq!(warnings(0, &others), [format!("line {line}: /RBE3/4 {why}, {what}")]);
        assert_eq!(warnings(2, &others), [""; 0]);
    }
    assert_eq!(warnings(1, ""), [""; 0]);
}

#[test]
fn linear_equations_have_no_slave() {
    let mpc = "/MPC/4\n'equal\n1 1 0 =2.\n2 3 0 =-1.\n\n6 1 0 =0.\n";
    let model = cube(mpc);
    assert_eq!(equations(&model), ["2 1:1 -1 2:3 1 6:1"]);
    assert_eq!(model.label(0), Some(format!("line {} /MPC/4 1:1", first_line() + 2)));
    assert!(!model.has_slave(0));
    // An empty card marks no other one.
    let next = cube(&format!("/MPC/3\n'nothing\n\n{}", body(22, 3, 4)));
    assert!(next.has_slave(0));
    let turned = "/SKEW/MOV/5\n'along the diagonal\n1 3 2\n/MPC/4\n'in the frame\n20 1 5 =2.\n20 4 5 =1.\n";
    let row = "1.414213562373095 20:1 1.414213562373095 20:2 0.7071067811865475 20:4 0.7071067811865475 20:5";
    assert_eq!(equations(&cube(turned)), [row]);
    let twice = cube(&format!("{mpc}{}", mpc.replace("=2.", "=4.").replace("=-1.", "=-2.").replace("=0.", "=2.")));
    let analysis = analysis(&twice);
    assert_eq!((analysis.rank(), analysis.dependent()[0].kind), (1, Kind::Redundant));
}

fn tie(fields: &str) -> String {
    format!("/INTER/TYPE2/6\n'a tie\n{fields}\n")
}

#[test]
fn ties_follow_the_nearest_point_of_a_face() {
    let model = cube(&tie("4 5 0 0 0 0 0 0 =0."));
    // The master is a solid without rotations; so the rotations of the plate are not known.
    assert_eq!(equations(&model)[0], "1 11:1 -0.5625 5:1 -0.1875 6:1 -0.0625 7:1 -0.1875 8:1");
    assert_eq!((model.equations(), left_out(&model).len()), (12, 1));
    let free = cube(&tie("4 5 0 4 0 0 0 0 =0."));
    assert_eq!((equations(&free), left_out(&free).len()), (equations(&model), 0));
    assert_eq!(free.label(0), Some(format!("line {} /INTER/TYPE2/6 11:1", first_line() + 2)));
    // On a surface without elements, the rotations follow too, and turn the arm of a node above the surface.
    let nodes = "/NODE\n31 =0. =0. =5.\n32 =1. =0. =5.\n33 =0. =1. =5.\n34 =.25 =.25 =5.5\n/GRNOD/NODE/9\n'above\n34\n/SURF/SEG/8\n's\n1 31 32 33\n";
    let arm = equations(&cube(&format!("{nodes}{}", tie("9 8 0 0 0 0 0 0 =0."))));
    assert_eq!(arm[0], "1 34:1 -0.5 31:1 -0.25 32:1 -0.25 33:1 -0.25 31:5 -0.125 32:5 -0.125 33:5");
    assert_eq!(arm[3], "1 34:4 -0.5 31:4 -0.25 32:4 -0.25 33:4");
    assert_eq!(arm.len(), 6);
}

#[test]
fn spotwelds_follow_the_mean_motion_of_a_face() {
    let node = "/NODE\n30 =.5 =.5 =1.5\n/GRNOD/NODE/9\n'above\n30\n";
    let model = cube(&format!("{node}{}", tie("9 5 0 1 0 0 0 0 =0.")));
    assert_eq!(equations(&model)[5], TURN.replace("22:6", "30:6"));
    assert_eq!((model.equations(), analysis(&model).rank()), (6, 6));
}

#[test]
fn nodes_apart_from_the_surface() {
    let far = |ignore: u32, search: &str| {
        let model =
            cube(&format!("/GRNOD/NODE/9\n'apart\n5 22 12\n{}", tie(&format!("9 5 {ignore} 4 0 0 0 0 {search}"))));
        (model.equations(), left_out(&model).len(), model.warnings().len())
    };
    // Node 22 is 2 above the surface, whose edges are 1 long. Radioss stops unless Ignore is set.
    assert_eq!(far(0, "=0."), (3, 1, 1));
    assert_eq!(far(1, "=0."), (3, 0, 1));
    assert_eq!(far(1, "=2.5"), (6, 0, 0));
    // The thickness of shells, which is not read, may tie the node.
    assert_eq!((far(2, "=0."), far(3, "=.1")), ((3, 1, 1), (3, 0, 1)));
    // Beyond an edge, Radioss extrapolates; if Ignore is set, up to a quarter of the face.
    let beyond = |ignore: u32, x: &str| {
        let node = format!("/NODE\n30 ={x} =.5 =1.\n/GRNOD/NODE/9\n'beyond\n30\n");
        let model = cube(&format!("{node}{}", tie(&format!("9 5 {ignore} 4 0 0 0 0 =0."))));
        (equations(&model).first().cloned().unwrap_or_default(), left_out(&model).len() + model.warnings().len())
    };
    let row = "1 30:1 0.0625 5:1 -0.5625 6:1 -0.5625 7:1 0.0625 8:1";
    assert_eq!([beyond(0, "1.125"), beyond(1, "1.125")], [(row.into(), 0), (row.into(), 0)]);
    assert_eq!((beyond(0, "1.5").1, beyond(1, "1.5")), (0, (String::new(), 1)));
    for spotflag in [10, 20, 25, 27, 28, 30] {
        let other = cube(&tie(&format!("4 5 0 {spotflag} 0 0 0 0 =0.")));
        assert_eq!((other.equations(), left_out(&other).len()), (0, 1), "{spotflag}");
    }
}

#[test]
fn supports_hold_components_also_in_frames() {
    let held = |components: &str, skew: &str| {
        let turned =
            "/SKEW/FIX/5\n'turned\n=-1. =0. =0.\n=0. =0. =1.\n/SKEW/FIX/6\n'oblique\n=-.6 =.8 =0.\n=0. =0. =1.\n";
        let model = cube(&format!("{turned}/GRNOD/NODE/9\n'one\n20\n/BCS/1\n'held\n{components} {skew} 9\n"));
        (prescribed(&model).join(" "), equations(&model).join(", "))
    };
    let is = |values: &str, rows: &str| (values.to_owned(), rows.to_owned());
    assert_eq!(held("101/010", "0"), is("20:1=0 20:3=0 20:5=0", ""));
    assert_eq!(held("010/000", "5"), is("20:1=0", ""));
    assert_eq!(held("111/000", "6"), is("20:1=0 20:2=0 20:3=0", ""));
    assert_eq!(held("001/010", "6"), is("20:3=0", "0.8 20:5 -0.6 20:4"));
    let two = held("110/000", "6");
    assert_eq!(two.1, "0.8 20:1 0.6 20:2, 0.8 20:2 -0.6 20:1");
    let single = cube("/NBCS/2\n'nodes\n100/000 0 20\n010/001 0 21\n");
    assert_eq!(prescribed(&single), ["20:1=0", "21:2=0", "21:6=0"]);
    let twice = cube("/BCS/1\n'a\n100/000 0 3\n/SKEW/FIX/5\n't\n=-1. =0. =0.\n=0. =0. =1.\n/BCS/2\n'b\n010/000 5 3\n");
    let line = first_line() + 9;
    let why = "/BCS/2 holds node 5, which another /BCS holds in another skew frame";
    assert_eq!(stops(&twice), [format!("line {line}: Radioss stops: {why}")]);
}

#[test]
fn motions_follow_functions() {
    let motion = |kind: &str, first: &str, second: &str| {
        let group = "/GRNOD/NODE/9\n'one\n20\n/SKEW/FIX/5\n'turned\n=-1. =0. =0.\n=0. =0. =1.\n/SKEW/FIX/6\n'oblique\n=-.6 =.8 =0.\n=0. =0. =1.\n";
        let model = cube(&format!("{group}/{kind}/2\n'moved\n{first}\n{second}\n"));
        (prescribed(&model), left_out(&model).len())
    };
    let is = |value: &str| (vec![value.to_owned()], 0);
    assert_eq!(motion("IMPVEL", "3 X 0 0 9 0 0", "=0. =-2.5 =0. =0."), is("20:1=-2.5 velocity function 3"));
    assert_eq!(motion("IMPDISP", "3 ZZ 0 0 9", ""), is("20:6=1 displacement function 3"));
    assert_eq!(motion("IMPACC", "3 Y 0 0 9", "=2. =0. =0. =1e30"), is("20:2=1 acceleration function 3 (times 2)"));
    assert_eq!(motion("IMPVEL", "3 Y 5 0 9", "=0. =2. =0. =0."), is("20:1=-2 velocity function 3"));
    assert_eq!(motion("IMPVEL", "3 Y 5 0 0", "=0. =2. =0. =0."), (vec![], 0));
    for (first, second) in [
        ("3 X 6 0 9", ""),
        ("3 X 0 7 9", ""),
        ("3 X 0 0 9 1", ""),
        ("3 X 0 0 9 0 1", ""),
        ("3 X 0 0 9", "=0. =1. =0.5"),
        ("3 X 0 0 9", "=0. =1. =0. =3."),
    ] {
        assert_eq!(motion("IMPVEL", first, second), (vec![], 1), "{first} {second}");
    }
    // The same motion twice agrees; one by another function is another value.
    let clashes = |function: u32| {
        let model = cube(&format!("/IMPVEL/1\n'a\n3 X 0 0 3\n/IMPVEL/2\n'b\n{function} X 0 0 3\n"));
        model.cases()[0].clashes.iter().map(|given| model.place(given.origin)).collect::<Vec<_>>()
    };
    let line = first_line() + 5;
    assert_eq!((clashes(3), clashes(4)), (vec![], vec![format!("line {line} /IMPVEL/2"); 4]));
}

#[test]
fn main_nodes_that_follow_stop_the_solver() {
    let link = |main: u32, group: u32| format!("/RBE2/3\n'a link\n{main} _ 0 {group} 0\n");
    let line = first_line() + 2;
    let model = cube(&format!("{}{}", body(5, 4, 4), link(22, 3)));
    assert_eq!(
        stops(&model),
        [format!("line {line}: Radioss stops: /RBODY/7 has the main node 5, a slave of an /RBE2")]
    );
    let both = cube(&format!("{}{}", link(22, 3), body(22, 4, 4)));
    assert_eq!(
        stops(&both),
        [format!("line {line}: Radioss stops: /RBE2/3 has the main node 22, also that of an /RBODY")]
    );
    let near = cube(&format!("/GRNOD/NODE/9\n'others\n20 21\n{}{}", link(11, 9), tie("4 5 0 4 0 0 0 0 =0.")));
    assert_eq!(stops(&near).len(), 1, "{:?}", stops(&near));
    assert_eq!(stops(&cube(&format!("{}{}", body(21, 4, 4), link(22, 3)))), [""; 0]);
}

#[test]
fn other_cards_are_named_or_ignored() {
    for card in [
        "GJOINT/GEAR/3",
        "CYL_JOINT/3",
        "RLINK/3",
        "RBODY/LAGMUL/3",
        "BCS/CYCLIC/3",
        "IMPVEL/FGEO/3",
        "IMPDISP/FGEO/3",
        "INTER/TYPE1/3",
        "INTER/LAGMUL/TYPE2/3",
        "TRANSFORM/TRA/3",
        "MERGE/RBODY/3",
        "CNODE",
        "FXBODY/3",
        "MAT/LAW13/3",
        "SPHBCS/SLIDE/3",
        "RIVET/3",
    ] {
        let found = left_out(&cube(&format!("/{card}\n'a card\n1 2 3\n")));
        assert!(
            found.len() == 1 && found[0].starts_with(&format!("line {}: /{card} ", first_line())),
            "{card}: {found:?}"
        );
    }
    for card in [
        "RWALL/PLANE/3",
        "MONVOL/AIRBAG1/3",
        "INTER/TYPE7/3",
        "CLOAD/3",
        "ALE/BCS/3",
        "BCS/WALL/3",
        "INTER/TYPE25/3",
        "RANDOM",
    ] {
        assert_eq!(left_out(&cube(&format!("/{card}\n'a card\n1 2 3\n"))), [""; 0], "{card}");
    }
}

#[test]
fn the_deck_is_read_only_and_claims_are_modest() {
    let text = format!("{CUBE}/BCS/1\n'held\n100/000 0 3\n{}", body(22, 3, 4));
    let deck = parsed(&text).expect("a deck");
    assert_eq!((deck.format(), deck.solver()), (Format::Radioss, Solver::Radioss));
    let error = clean::clean(&deck, &qless::Options::default()).expect_err("read only").to_string();
    assert!(error.starts_with("decks of Radioss are read, but not written"), "{error}");
    let found = clean::findings(deck.model(), &deck.model().cases()[0], Solver::Radioss);
    assert_eq!(found.iter().map(|finding| finding.outcome).collect::<Vec<_>>(), [Outcome::Unsound; 4]);
    assert_eq!((deck.node_set("3"), deck.positions()[&22]), (Some(vec![5, 6, 7, 8]), [0.0, 0.0, 3.0]));
}
