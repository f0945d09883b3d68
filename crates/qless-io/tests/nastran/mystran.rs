//! What MYSTRAN refuses, ignores, and reads otherwise than Nastran; `tests/mystran.rs` of the whole runs it.

use qless_io::deck::{Model, Solver};

use super::given::{equations, model, model_for, prescribed, refusals, warnings};

const CONTROL: &str = "CEND\nSPC=1\nMPC=2\nBEGIN BULK\n";
const GRIDS: &str =
    "GRID,1\nGRID,2,,1.\nGRID,3,,2.\nGRID,4,,2.,1.\nGRID,5,,3.\nSPC1,1,123456,1\nMPC,2,5,6,1.,2,6,-1.\n";

fn mystran(cards: &str) -> Model {
    model_for(Solver::Mystran, &format!("{CONTROL}{GRIDS}{cards}"))
}

#[test]
fn cards_that_it_does_not_know_constrain_nothing() {
    let ignored =
        ["RROD,51,2,3,,1", "RJOINT,51,3,4,1", "RTRPLT,51,2,3,4,123456", "RTRPLT1,51,2,3,4,1,1", "SPCD,51,2,3,.1"];
    for card in ignored {
        let model = mystran(card);
        let name = card.split(',').next().expect("a name");
        assert_eq!(warnings(&model), [format!("line 12: MYSTRAN ignores {name} 51: it constrains nothing")]);
        assert_eq!((model.equations(), refusals(&model).len()), (1, 0), "{card}");
    }
    assert_eq!(model(&format!("{CONTROL}{GRIDS}RROD,51,2,3,,1\n")).equations(), 2);
}

#[test]
fn it_stops_at_cards() {
    for (card, why) in [
        ("RBAR,51,2,3,123456", "RBAR 51: MYSTRAN stops at this element"),
        ("RBAR1,51,2,3,123456", "RBAR1 51: MYSTRAN stops at this element"),
        ("RBE1,51,2,123456\n,UM,3,3", "RBE1 51: MYSTRAN stops at this element"),
        ("RBE2,51,2,3,3,THRU,4", "RBE2 51: MYSTRAN stops at THRU"),
        ("RBE2,51,2,3,3,4,0.", "RBE2 51: MYSTRAN stops at ALPHA"),
        ("RBE3,51,,3,3,1.,123,2,4\n,5\n,UM,2,3", "RBE3 51: MYSTRAN stops at UM"),
        ("MPC,7,3,3,1,2,3,-1.", "MPC 7: MYSTRAN stops at a coefficient"),
        ("MPC     7       3       3       1       2       3       -1.", "MPC 7: MYSTRAN stops at a coefficient"),
        ("SPC,7,3,3,1", "SPC 7: MYSTRAN stops at a value"),
        ("GRID,4,,2.,1.", "GRID 4 repeats the card of deck.bdf:8, where MYSTRAN stops"),
        ("MPCADD,9,2,2", "MPCADD 9 names set 2 twice"),
        ("SPC1,1,1,9", "SPC1 1 prescribes point 9, which is not defined"),
        ("SPC,1,9,1", "SPC 1 prescribes point 9, which is not defined"),
        ("SPC1,1,1,2,THRU,9", "SPC1 1 prescribes point 9, which is not defined"),
        ("RBE2,51,2,3,3\n=,*1,=,=,4", "MYSTRAN stops at this line of copies"),
    ] {
        let model = mystran(card);
        let found = refusals(&model);
        assert!(found.len() == 1 && found[0].contains(why), "{card}: {found:?}");
    }
    for card in ["SPC1,8,1,9", "MPC,7,3,3,,2,3,-1.", "RBE2,51,2,3,3,4", "RBE3,51,,3,3,1.,123,2,4"] {
        assert_eq!(refusals(&mystran(card)), [""; 0], "{card}");
    }
}

#[test]
fn it_makes_no_copies() {
    let model = mystran("RBE2    51      2       3       3\n=       *1      =       =       4\n");
    assert_eq!(model.equations(), 2);
    assert_eq!(warnings(&model), ["line 13: MYSTRAN ignores this line of copies; write the cards out"]);
}

#[test]
fn it_stops_at_selections() {
    let of = |control: &str| {
        refusals(&model_for(Solver::Mystran, &format!("CEND\n{control}BEGIN BULK\n{GRIDS}MPC,4,5,5,1.,2,5,-1.\n")))
    };
    for (control, why) in [
        ("SPC=1\nMPC=0\n", "line 3: MYSTRAN stops at a selection of set 0"),
        ("SPC=1\nMPC=7\n", "line 3: MPC = 7 selects set 7, which no MPC card defines, where MYSTRAN stops"),
        ("SPC=7\nMPC=2\n", "line 2: SPC = 7 selects set 7, which no SPC card defines, where MYSTRAN stops"),
        ("SUBCASE 1\nMPC=2\nSUBCASE 2\nMPC=4\n", "line 5: MPC = 4: MYSTRAN allows one MPC set per run"),
        ("SUBCASE 1\nSUBCASE 2\nMPC=4\n", "line 4: MPC = 4: MYSTRAN allows one MPC set per run"),
    ] {
        let found = of(control);
        assert!(found.len() == 1 && found[0].starts_with(why), "{control}: {found:?}");
    }
    assert_eq!(of("SPC=1\nSUBCASE 1\nMPC=2\nSUBCASE 2\nLOAD=1\nSUBCASE 3\nMPC=2\n"), [""; 0]);
}

#[test]
fn a_subcase_goes_on_with_the_set_before() {
    let text = format!("CEND\nSUBCASE 1\nMPC=2\nSPC=1\nSUBCASE 2\nLOAD=3\nBEGIN BULK\n{GRIDS}");
    let held = |model: &Model| {
        model.cases().iter().map(|case| (case.prescribed.len(), case.removed.len())).collect::<Vec<_>>()
    };
    assert_eq!(held(&model_for(Solver::Mystran, &text)), [(6, 0), (6, 0)]);
    assert_eq!(held(&model(&text)), [(6, 0), (0, 1)]);
}

#[test]
fn it_stops_at_cases_of_valid_cards() {
    let alone =
        |cards: &str| refusals(&model_for(Solver::Mystran, &format!("CEND\nSPC=1\nMPC=4\nBEGIN BULK\n{GRIDS}{cards}")));
    let found = alone("MPC,4,3,2,2.,5,2,1.\nMPC,4,5,2,2.,3,2,1.\n");
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].starts_with("line 12: no equation has an independent DOF"), "{found:?}");
    assert_eq!(alone("MPC,4,3,2,2.,5,2,1.\nMPC,4,5,2,2.,3,2,1.,,\n,,2,2,1.\n"), [""; 0]);
    let found = alone("MPC,4,3,2,2.,5,2,1.\nSPC,1,2,1,.5\nSPC,1,4,1,.5,2,1,.5\n");
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].starts_with("line 14: SPC 1 enforces 2:1, which line 13 SPC 1 enforces already"), "{found:?}");
    assert_eq!(alone("MPC,4,3,2,2.,5,2,1.\nSPC,1,2,1,0.\nSPC,1,2,1,0.\n"), [""; 0]);
    let found = alone("MPC,4,3,2,2.,5,2,1.\nRBE3,51,,3,123456,1.,123,2\n");
    assert!(found.len() == 1 && found[0].contains("RBE3 51: MYSTRAN stops"), "{found:?}");
}

/// MYSTRAN prints these rows with `PARAM,PRTRMG,1`.
#[test]
fn rows_of_rotations_of_rbe3_ignore_axes_and_need_their_components() {
    let model = mystran("RBE3,51,,3,6,1.,123,2,4");
    assert_eq!((model.equations(), model.left_out().count()), (1, 1));
    assert!(warnings(&model)[0].contains("MYSTRAN drops terms of the equation of 3:6, which needs 3:1"));
    assert_eq!(refusals(&model), [""; 0]);
    assert_eq!(equations(&mystran("RBE3,51,,3,126,1.,123,2,4"))[3].split(' ').count(), 10);
    let turned = |cd: &str| {
        let grids = GRIDS.replace("GRID,4,,2.,1.", &format!("GRID,4,,2.,1.,,{cd}"));
        let frame = "CORD2R,7,,0.,0.,0.,0.,0.,1.\n,0.,1.,0.\n";
        equations(&model_for(Solver::Mystran, &format!("{CONTROL}{grids}{frame}RBE3,51,,3,126,1.,123,2,4\n")))
    };
    let [plain, axes] = [turned(""), turned("7")];
    let has = |equations: &[String], i: usize, word: &str| equations[i].split(' ').any(|found| found == word);
    assert!(has(&plain, 1, "4:1") && has(&axes, 1, "4:2"));
    assert_ne!(plain[3], axes[3]);
}

/// Nodes 2 and 4 about node 3: MYSTRAN's own results show means without lever arms, but for rotations that the reference has.
#[test]
fn rbe3_moves_in_the_components_of_its_reference_alone() {
    assert_eq!(
        equations(&mystran("RBE3,51,,5,12,1.,123456,2,4"))[1..],
        ["1 5:1 -0.5 2:1 -0.5 4:1", "1 5:2 -0.5 2:2 -0.5 4:2"]
    );
    // Without what rounding leaves in the last digits.
    let rounded = |text: &String| -> Vec<String> {
        let word = |word: &str| word.parse().map_or(word.to_owned(), |x: f64| ((x * 1e9).round() / 1e9).to_string());
        text.split(' ').map(word).collect()
    };
    let found = equations(&mystran("RBE3,51,,3,26,1.,123,2,1"));
    let found: Vec<String> = found[1..].iter().map(|text| rounded(text).join(" ")).collect();
    assert_eq!(found, ["1 3:2 1 1:2 -2 2:2", "1 3:6 1 1:2 -1 2:2"]);
    let all = |ci: &str| equations(&mystran(&format!("RBE3,51,,5,123456,1.,{ci},2,3\n,4")));
    assert_eq!(all("123456"), all("123"));
}

#[test]
fn a_dependent_dof_named_again_has_its_last_coefficient() {
    let cards = "MPC,2,3,2,1.,2,2,-1.\n,,3,2,3.,2,2,-.5\n";
    assert_eq!(equations(&mystran(cards))[1], "3 3:2 -1 2:2 -0.5 2:2");
    assert_eq!(equations(&model(&format!("{CONTROL}{GRIDS}{cards}")))[1], "1 3:2 -1 2:2 3 3:2 -0.5 2:2");
}

#[test]
fn it_runs_what_others_refuse() {
    for card in ["RBE2,51,2,3,2,3", "RBE2,,2,3,3", "RBE2,-4,2,3,3", "RBE2,0,2,3,3\nRBE2,0,2,1,3"] {
        assert!(mystran(card).equations() > 1, "{card}");
    }
    let held = |card: &str| prescribed(&mystran(card).cases()[0])[6..].to_vec();
    assert_eq!(held("SPC1,1,2,2,THRU,4,BY,2"), ["2:2=0", "3:2=0", "4:2=0"]);
    for card in ["SPC,1,2,0,0.", "SPC,1,2,,0.", "SPC1,1,0,2", "SPC1,1,,2"] {
        assert_eq!(held(card), [""; 0], "{card}");
        assert_eq!(warnings(&mystran(card)).len(), 1, "{card}");
    }
}

#[test]
fn mpc_set_0_holds_where_none_is_selected() {
    for (control, count) in [("SPC=1\n", 1), (CONTROL.trim_start_matches("CEND\n").trim_end_matches("BEGIN BULK\n"), 1)]
    {
        let text = format!("CEND\n{control}BEGIN BULK\n{GRIDS}MPC,0,3,2,1.,2,2,-1.\n");
        let model = model_for(Solver::Mystran, &text);
        assert_eq!(model.equations(), count);
        let slave = if control == "SPC=1\n" { "1 3:2 -1 2:2" } else { "1 5:6 -1 2:6" };
        assert_eq!(equations(&model), [slave]);
    }
}
