//! Abaqus parts, instances and assemblies, as Abaqus/CAE writes them.

use qless_io::deck::Solver::{self, Abaqus, Ccx};
use qless_io::deck::clean;

use super::from_text::{equations, model, parsed, prescribed, refused};

/// Two instances of a brick: the second one is above the first, rotated by 90 degrees about the third axis.
fn deck(assembly: &str, after: &str) -> String {
    let part = "*HEADING\ntwo bricks\n*PART, NAME=Brick
*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n3,1.,1.,0.\n4,0.,1.,0.\n5,0.,0.,1.\n6,1.,0.,1.\n7,1.,1.,1.\n8,0.,1.,1.
*ELEMENT, TYPE=C3D8\n1,1,2,3,4,5,6,7,8
*NSET, NSET=Bottom, GENERATE\n1,4,1\n*NSET, NSET=Top\n5,6,7,8\n*ELSET, ELSET=All\n1
*SURFACE, TYPE=ELEMENT, NAME=Roof\nAll,S2\n*END PART
";
    let instances = "*ASSEMBLY, NAME=Assembly\n*INSTANCE, NAME=Brick-1, PART=Brick\n*END INSTANCE
*INSTANCE, NAME=Brick-2, PART=Brick\n0.,0.,1.\n0.,0.,1.,0.,0.,2.,90.\n*END INSTANCE
*NODE\n1,5.,5.,5.\n";
    format!("{part}{instances}{assembly}*END ASSEMBLY\n{after}")
}

fn read(assembly: &str, after: &str) -> qless_io::deck::Model {
    model(Abaqus, &deck(assembly, after))
}

#[test]
fn nodes_of_instances_have_names() {
    let model = read("*EQUATION\n3\nBrick-1.5,3,1.,Brick-2.1,3,-1.,1,3,.5\n", "");
    assert_eq!(equations(&model), ["1 Brick-1.5:3 -1 Brick-2.1:3 0.5 1:3"]);
    assert!(model.label(0).expect("an equation").ends_with("*EQUATION Brick-1.5:3"));
    let system = model.system(&model.cases()[0]).expect("a system");
    assert_eq!(system.dof_label(0), "Brick-1.5:3");
}

#[test]
fn sets_of_the_assembly_name_nodes_of_instances() {
    let sets = "*NSET, NSET=Held, INSTANCE=Brick-1\n1,2\n*NSET, NSET=Held, INSTANCE=BRICK-2, GENERATE\n7,9,1\n*NSET, NSET=Ref\n1\n";
    let after = "*BOUNDARY\nHeld,1\nRef,2\nBrick-2.Top,3,3,.1\nAssembly.Brick-1.8,1\n";
    let model = read(sets, after);
    let expected = [
        "1:2=0",
        "Brick-1.1:1=0",
        "Brick-1.2:1=0",
        "Brick-1.8:1=0",
        "Brick-2.5:3=0.1",
        "Brick-2.6:3=0.1",
        "Brick-2.7:1=0",
        "Brick-2.7:3=0.1",
        "Brick-2.8:1=0",
        "Brick-2.8:3=0.1",
    ];
    assert_eq!(prescribed(&model, &model.cases()[0]), expected);
}

#[test]
fn surfaces_of_instances_and_of_the_assembly_are_tied_where_the_instances_stand() {
    // The second brick is rotated to x < 0, so that only its edge x = 0 touches the top of the first one.
    let sets =
        "*ELSET, ELSET=_foot_S1, INTERNAL, INSTANCE=Brick-2\n1\n*SURFACE, TYPE=ELEMENT, NAME=foot\n_foot_S1,S1\n";
    let tie = "*TIE, NAME=T, POSITION TOLERANCE=.01\nfoot, Brick-1.Roof\n";
    let model = read(&format!("{sets}{tie}"), "");
    let expected = ["1 Brick-2.1:1 -1 Brick-1.5:1", "1 Brick-2.2:1 -1 Brick-1.8:1"];
    let first: Vec<_> = equations(&model).into_iter().step_by(3).collect();
    assert_eq!(first, expected);
}

#[test]
fn cards_of_a_part_hold_for_each_of_its_instances() {
    let with_equation = deck("", "").replace("*END PART", "*EQUATION\n2\nTop,3,1.,1,3,-1.\n*END PART");
    let model = model(Abaqus, &with_equation);
    assert_eq!(model.equations(), 8);
    assert_eq!(equations(&model)[5], "1 Brick-2.6:3 -1 Brick-2.1:3");
}

#[test]
fn a_constraint_of_a_node_set_holds_for_each_of_its_nodes() {
    let sets = "*NSET, NSET=RP\n1\n*NSET, NSET=B, INSTANCE=Brick-2\n1,2\n*NSET, NSET=C, INSTANCE=Brick-1\n5,6\n";
    let of = |line: &str| read(&format!("{sets}*MPC\n{line}\n"), "*BOUNDARY\nRP,1,6\n");
    let equal = ["1 Brick-2.1:1 -1 Brick-1.5:1", "1 Brick-2.2:1 -1 Brick-1.6:1"];
    let first = |line: &str| equations(&of(line)).into_iter().step_by(3).collect::<Vec<_>>();
    assert_eq!((first("TIE,B,C"), first("PIN,B,C")), (equal.map(String::from).into(), equal.map(String::from).into()));
    assert_eq!(first("TIE,B,Brick-1.5")[1], "1 Brick-2.2:1 -1 Brick-1.5:1");
    assert_eq!(of("LINK,B,RP").equations(), 2);
    // Beams take the translations of a node without rotations along: node 5 is at (0, 0, 1), the reference at (5, 5, 5).
    assert_eq!(first("BEAM,C,RP")[0], "1 Brick-1.5:1 -1 1:1 4 1:5 -5 1:6");
    assert_eq!(of("BEAM,C,RP").equations(), 6);
    let refused = refused(Abaqus, &deck("*NSET, NSET=B, INSTANCE=Brick-2\n1,2\n*MPC\nTIE,1,B\n", ""));
    assert!(
        refused.ends_with(
            "expected two nodes, a node set and a node, or two sets of one size, found `3 nodes`; correct it"
        )
    );
}

#[test]
fn clean_leaves_sound_beams_alone_and_says_why_it_cannot_replace_others() {
    let cleaned = |cards: &str| {
        let sets = "*NSET, NSET=RP\n1\n*NSET, NSET=C, INSTANCE=Brick-1\n5,6\n";
        let deck =
            parsed(Abaqus, &deck(&format!("{sets}*MPC\nBEAM,C,RP\n{cards}"), "*BOUNDARY\nRP,1,6\n")).expect("a deck");
        clean::plan(&deck, &qless::Options::default()).map(|plan| plan.is_empty()).map_err(|error| error.to_string())
    };
    assert_eq!(cleaned(""), Ok(true));
    let clash = cleaned("*EQUATION\n2\nBrick-1.5,1,1.,Brick-2.7,1,-1.\n").expect_err("a fault");
    assert!(clash.contains("*MPC cannot be replaced by equations: an equation that shares DOFs"), "{clash}");
}

#[test]
fn transforms_and_rigid_bodies_turn_with_their_instance() {
    let turned = deck("*RIGID BODY, REF NODE=1, PIN NSET=Brick-2.Top\n", "")
        .replace("*END PART", "*TRANSFORM, NSET=Top, TYPE=R\n1.,0.,0.,0.,1.,0.\n*END PART");
    let model = model(Abaqus, &turned);
    // The first axis of the Abaqus part is the second axis of the assembly.
    assert!(equations(&model)[0].starts_with("1 Brick-2.5:1 -1 1:2 "), "{}", equations(&model)[0]);
    // Rigid motions fulfil it: node 5 is at (0, 0, 2).
    assert_eq!(model.equations(), 12);
}

#[test]
fn a_deck_with_instances_is_read_as_abaqus_does_whatever_its_solver() {
    let text = deck("", "");
    assert_eq!(parsed(Ccx, &text).expect("a deck").solver(), Solver::Abaqus);
    assert!(parsed(Ccx, &text).expect("a deck").model().has_instances());
}

#[test]
fn a_flat_deck_may_name_an_instance_that_is_no_more() {
    let flat = "*NODE\n1,0.,0.,0.\n2,1.,0.,0.\n*NSET, NSET=S, INSTANCE=Part-1-1\n1,2\n*BOUNDARY\nS,1\n";
    let model = model(Ccx, flat);
    assert_eq!(prescribed(&model, &model.cases()[0]), ["1:1=0", "2:1=0"]);
}

#[test]
fn what_an_assembly_lacks_is_named() {
    for (assembly, expected) in [
        ("*INSTANCE, NAME=I, PART=None\n*END INSTANCE\n", "*INSTANCE: part NONE is not defined"),
        ("*INSTANCE, NAME=I\n*END INSTANCE\n", "*INSTANCE: the parameter PART is missing"),
        ("*INSTANCE, LIBRARY=old, NAME=I\n*END INSTANCE\n", "expected an instance of a part of this deck, found `old`"),
        ("*EQUATION\n2\nBrick-1.99,1,1.,Brick-1.1,1,1.\n", "Brick-1.99 is not defined"),
        ("*NSET, NSET=S, INSTANCE=No\n1\n*EQUATION\n2\nS,1,1.,1,1,1.\n", "instance NO is not defined"),
        ("*EQUATION\n2\n2,1,1.,1,1,1.\n", "node 2 is not defined"),
    ] {
        let message = refused(Abaqus, &deck(assembly, ""));
        assert!(message.contains(expected), "{message}");
    }
}

#[test]
fn redundant_equations_of_an_assembly_go_and_new_ones_stand_at_its_end() {
    let options = qless::Options::default();
    let twice = "*EQUATION\n2\nBrick-1.5,3,1.,Brick-2.1,3,-1.\n2\nBrick-2.1,3,2.,Brick-1.5,3,-2.\n";
    let redundant = parsed(Abaqus, &deck(twice, "")).expect("a deck");
    let plan = clean::plan(&redundant, &options).expect("a plan");
    assert_eq!((plan.removed.len(), plan.written.len()), (1, 0));
    let text = clean::write(&redundant, &plan).expect("written");
    let again = parsed(Abaqus, &String::from_utf8(text).expect("text")).expect("a deck");
    assert_eq!(equations(again.model()), ["1 Brick-1.5:3 -1 Brick-2.1:3"]);
    // The slave is prescribed, so that its equation would have to be rewritten.
    let held = "*EQUATION\n2\nBrick-1.5,3,1.,Brick-2.1,3,-1.\n";
    let prescribed = parsed(Abaqus, &deck(held, "*BOUNDARY\nBrick-1.5,3\n")).expect("a deck");
    let plan = clean::plan(&prescribed, &options).expect("a plan");
    let text = String::from_utf8(clean::write(&prescribed, &plan).expect("written")).expect("text");
    assert!(text.contains("*EQUATION\n2\nBrick-2.1,3,1.0,Brick-1.5,3,-1.0\n*END ASSEMBLY"), "{text}");
    let again = parsed(Abaqus, &text).expect("a deck");
    assert!(clean::plan(&again, &options).expect("a plan").is_empty());
}

#[test]
fn positions_are_those_of_the_assembly() {
    let deck = parsed(Abaqus, &deck("", "")).expect("a deck");
    let mut found: Vec<_> = deck.positions().into_iter().map(|(node, x)| (deck.model().node_name(node), x)).collect();
    found.sort_by(|a, b| a.0.cmp(&b.0));
    assert_eq!(found.len(), 17);
    assert_eq!(found[0], ("1".to_owned(), [5.0, 5.0, 5.0]));
    assert_eq!(found[10], ("Brick-2.2".to_owned(), [0.0, 1.0, 1.0]));
}
