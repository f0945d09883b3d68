//! Which sets hold in which load case.

use super::given::{equations, model, parsed, prescribed, refusals, warnings};

const BULK: &str = "BEGIN BULK
GRDSET,,,,,,,6
GRID,1
GRID,2,,,,,,12
GRID,3
SPOINT,10,THRU,12
MPC,1,1,1,1.,2,1,-1.
MPC,2,3,1,1.,10,,-1.
MPCADD,9,1,2
SPC,1,1,3,.5
SPC1,2,3,1,THRU,3
SPC1,2,0,11
SPCADD,8,1,2
SPCD,4,1,3,2.0
LOAD,5,2.,3.,4
FORCE,4,3,,1.,0.,1.,0.
SPC,1,1,3,.7
ENDDATA
";

#[test]
fn each_subcase_has_its_own_sets() {
    let model = model(&format!("CEND\nSPC = 8\nSUBCASE 1\nMPC = 9\nSUBCASE 2\nSPC = 1\nMPC = 1\nLOAD = 5\n{BULK}"));
    let names: Vec<&str> = model.cases().iter().map(|case| case.name.as_str()).collect();
    assert_eq!(names, ["subcase 1", "subcase 2"]);
    assert_eq!(equations(&model), ["1 1:1 -1 2:1", "1 3:1 -1 10:0"]);
    let [first, second] = model.cases() else { panic!("two load cases") };
    assert_eq!(prescribed(first), ["1:3=0.5", "1:6=0", "2:1=0", "2:2=0", "2:3=0", "3:3=0", "3:6=0", "11:0=0"]);
    let clashes: Vec<f64> = first.clashes.iter().map(|clash| clash.value).collect();
    assert_eq!((clashes, first.removed.as_slice()), (vec![0.0, 0.7], &[][..]));
    assert_eq!(prescribed(second), ["1:3=12", "1:6=0", "2:1=0", "2:2=0", "3:6=0"]);
    assert_eq!((second.clashes.len(), second.removed.as_slice()), (0, &[1][..]));
    let loads: Vec<String> = second.loads.iter().map(|load| load.dof.to_string()).collect();
    assert_eq!(loads, ["3:2"]);
}

#[test]
fn what_is_not_selected_is_left_out_and_named() {
    let model = model(&format!("CEND\n{BULK}"));
    assert_eq!(model.equations(), 0);
    let expected = [
        "line 8: MPC sets that no subcase selects are left out: 1, 2 (2 entries)",
        "line 11: SPC sets that no subcase selects are left out: 1, 2 (4 entries)",
        "line 15: SPCD sets that no subcase selects are left out: 4 (1 entry)",
    ];
    assert_eq!(warnings(&model), expected);
}

#[test]
fn a_selected_set_without_cards_is_named() {
    let model = model("CEND\nMPC = 7\nSPC = 3\nBEGIN BULK\nGRID,1\nSPCADD,3,4\n");
    let expected = [
        "line 2: MPC = 7 selects set 7, which no MPC card defines: it constrains nothing",
        "line 3: SPC = 3 selects set 4, which no SPC card defines: it constrains nothing",
    ];
    assert_eq!(warnings(&model), expected);
}

#[test]
fn set_0_takes_back_what_was_selected_above() {
    let model = model(&format!("CEND\nSPC = 1\nMPC = 1\nSUBCASE 1\nSUBCASE 2\nSPC = 0\nMPC = 0\n{BULK}"));
    let [first, second] = model.cases() else { panic!("two load cases") };
    assert_eq!((first.removed.as_slice(), second.removed.as_slice()), (&[][..], &[0][..]));
    assert_eq!(prescribed(second), ["1:6=0", "2:1=0", "2:2=0", "3:6=0"]);
    assert!(!warnings(&model).iter().any(|warning| warning.contains("set 0")), "{:?}", warnings(&model));
}

#[test]
fn bulk_data_alone_have_their_only_sets() {
    let alone = model("GRID,1\nGRID,2\nMPC,3,1,1,1.,2,1,-1.\nSPC1,4,123,1\n");
    assert_eq!((alone.equations(), alone.cases()[0].prescribed.len()), (1, 3));
    assert_eq!(warnings(&alone)[0], "line 3: the deck has no case control: MPC set 3, the only one, is used");
    let several = model("GRID,1\nGRID,2\nMPC,3,1,1,1.,2,1,-1.\nMPC,4,1,2,1.,2,2,-1.\n");
    assert_eq!(several.equations(), 0);
    assert_eq!(warnings(&several), ["line 3: MPC sets that no subcase selects are left out: 3, 4 (2 entries)"]);
    let union = model("GRID,1\nGRID,2\nMPC,3,1,1,1.,2,1,-1.\nMPC,4,1,2,1.,2,2,-1.\nMPCADD,6,3,4\n");
    assert_eq!(union.equations(), 2);
    let said = "line 3: the deck has no case control: MPC set 6, which unites all others, is used";
    assert_eq!(warnings(&union), [said]);
}

/// By the manuals, a component with an enforced value must be on a selected `SPC` or `SPC1`, or be held by its `GRID`.
#[test]
fn enforced_values_need_a_support() {
    let with = |support: &str| {
        let text = format!(
            "CEND\nSPC = 1\nSUBCASE 1\nLOAD = 7\nSUBCASE 2\nLOAD = 7\nBEGIN BULK\nGRID,1,,0.,0.,0.,,{support}\nGRID,2\nSPCD,7,1,1,5.\n"
        );
        refusals(&model(&text))
    };
    let said = "line 11: SPCD 7 enforces 1:1, which no selected SPC or SPC1 card names: name it there";
    assert_eq!(with("\nSPC1,1,2,1"), [said]);
    assert_eq!((with("\nSPC1,1,12,1"), with("1")), (vec![], vec![]));
}

#[test]
fn superelements_are_left_out_and_named() {
    let model = model("CEND\nBEGIN BULK\nGRID,1\nGRID,2\nBEGIN SUPER=3\nRBE2,1,1,3,2\nENDDATA\n");
    assert_eq!(model.equations(), 0);
    assert_eq!(warnings(&model), ["line 5: BEGIN SUPER=3: this part of the deck is not understood and left out"]);
}

#[test]
fn points_without_definition_are_named() {
    let model = model("CEND\nMPC=1\nSPC=1\nBEGIN BULK\nGRID,1\nMPC,1,1,1,1.,7,,-1.\nSPC1,1,0,8,9\n");
    let expected = [
        "line 6: MPC 1: no GRID or SPOINT defines point 7; its components are used as they are",
        "line 7: SPC1 1: no GRID or SPOINT defines point 8 and 1 more; its components are used as they are",
    ];
    assert_eq!(warnings(&model), expected);
    assert_eq!(equations(&model), ["1 1:1 -1 7:0"]);
}

#[test]
fn executive_and_case_control_may_be_included() {
    let files = [
        ("exec.inc", "SOL 101\nCEND\n"),
        ("case.inc", "MPC = 1\nSUBCASE 1\n"),
        ("folder/bulk.inc", "GRID,1\nGRID,2\nMPC,1,1,1,1.,2,1,-1.\n"),
    ];
    let text = "INCLUDE 'exec.inc'\nINCLUDE 'case.inc'\nBEGIN BULK\nINCLUDE 'folder\\bulk.inc'\nENDDATA\n";
    let model = parsed(text, &files).unwrap_or_else(|error| panic!("{error}")).model().clone();
    assert_eq!((equations(&model).len(), model.warnings().len()), (1, 0));
    let bare = self::model("BEGIN BULK\nGRID,1\nGRID,2\nMPC,1,1,1,1.,2,1,-1.\nENDDATA\n");
    assert_eq!((bare.equations(), bare.warnings().len()), (1, 1));
}

/// `BEGIN BULK` in an included file ends case control as well as one in the main file does.
#[test]
fn landmarks_may_be_included() {
    let bulk = "GRID,1\nGRID,2\nMPC,1,1,1,1.,2,1,-1.\nMPC,2,1,2,1.,2,2,-1.\n";
    let begun = format!("BEGIN BULK\n{bulk}");
    let model = parsed("MPC = 2\nINCLUDE 'bulk.inc'\nENDDATA\n", &[("bulk.inc", &begun)]);
    let model = model.unwrap_or_else(|error| panic!("{error}")).model().clone();
    assert_eq!((equations(&model), model.warnings().len()), (vec!["1 1:2 -1 2:2".to_owned()], 1));
    let ended = format!("MPC = 1\nCEND\nMPC = 2\n{begun}");
    let model = parsed("SOL 101\nINCLUDE 'away.inc'\nINCLUDE 'rest.inc'\n", &[("rest.inc", &ended)]);
    let model = model.unwrap_or_else(|error| panic!("{error}")).model().clone();
    assert_eq!(equations(&model), ["1 1:2 -1 2:2"]);
}
