//! `CERIG` and `RBE3`: equations made of where nodes are.

use qless_io::deck::Deck;
use qless_io::deck::clean;

use crate::parse::{deck, equations, refused, try_deck, warnings};

const NODES: &str = "N,1,0,0,0\nN,2,2,0,0\nN,3,0,3,1\n";

fn left_out(deck: &Deck) -> Vec<String> {
    deck.model().left_out().map(|warning| format!("{}: {}", warning.line, warning.text)).collect()
}

#[test]
fn a_rigid_region_in_space() {
    let all = deck(&format!("{NODES}CE,7,0,2,TEMP,1,3,TEMP,-1\nCERIG,1,2,ALL\n"));
    assert_eq!(
        equations(&all)[1..],
        [
            "2:1 1, 1:1 -1 = 0",
            "2:2 1, 1:2 -1, 1:6 -2 = 0",
            "2:3 1, 1:3 -1, 1:5 2 = 0",
            "2:4 1, 1:4 -1 = 0",
            "2:5 1, 1:5 -1 = 0",
            "2:6 1, 1:6 -1 = 0"
        ]
    );
    assert_eq!(all.model().label(1).as_deref(), Some("line 5 CERIG 1 2:1"));
    let of = |fields: &str| equations(&deck(&format!("{NODES}CERIG,{fields}\n")));
    assert_eq!(of("1,2"), equations(&all)[1..]);
    assert_eq!(of("1,2,UXYZ"), equations(&all)[1..4]);
    assert_eq!(of("1,2,RXYZ"), equations(&all)[4..]);
    assert_eq!(of("1,2,UY,ROTX"), [all_at(&all, 2), all_at(&all, 4)]);
    assert_eq!(of("1,3,UX"), ["3:1 1, 1:1 -1, 1:5 -1, 1:6 3 = 0"]);
    assert_eq!(of("1,ALL,ROTX"), ["2:4 1, 1:4 -1 = 0", "3:4 1, 1:4 -1 = 0"]);
}

fn all_at(deck: &Deck, i: usize) -> String {
    equations(deck)[i].clone()
}

#[test]
fn a_rigid_region_in_a_plane() {
    let text = format!("ET,1,PLANE182\nET,2,MASS21\n{NODES}CERIG,1,2,ALL\n");
    let plane = ["2:1 1, 1:1 -1 = 0", "2:2 1, 1:2 -1, 1:6 -2 = 0", "2:6 1, 1:6 -1 = 0"];
    assert_eq!(equations(&deck(&text)), plane);
    assert_eq!(equations(&deck(&text.replace("ALL", "UXYZ"))), plane[..2]);
    assert_eq!(equations(&deck(&text.replace("MASS21", "SOLID185"))).len(), 6);
}

#[test]
fn selected_nodes_and_groups() {
    let of = |commands: &str| deck(&format!("{NODES}N,4,1,1,1\n{commands}\n"));
    let slaves = |commands: &str| -> Vec<String> {
        equations(&of(commands)).iter().map(|text| text.split(':').next().unwrap_or_default().to_owned()).collect()
    };
    assert_eq!(slaves("NSEL,S,NODE,,2,4,2\nCERIG,1,ALL,UX"), ["2", "4"]);
    assert_eq!(slaves("NSEL,S,NODE,,2\nNSEL,A,NODE,,4\nCERIG,1,ALL,UX\nALLSEL\nCERIG,1,ALL,UY").len(), 5);
    assert_eq!(slaves("CMBLOCK,E,NODE,1\n(8i10)\n         3\nCMSEL,S,E\nCERIG,1,ALL,UX"), ["3"]);
    assert_eq!(slaves("NSEL,S,NODE,,2,3\nCM,E,NODE\nALLS\nCP,1,UX,E"), ["3"]);
    assert_eq!(slaves("NSEL,S,NODE,,2,3\nCP,1,UX,ALL"), ["3"]);
    let unknown = of("NSEL,S,LOC,X,0\nCERIG,1,ALL,UX");
    assert_eq!(left_out(&unknown), ["6: CERIG names ALL, which this reader does not know: left out"]);
}

/// A rigid motion fulfils the equations whatever the axes of the nodes are.
#[test]
fn axes_of_nodes_count() {
    let text = "N,1,0,0,0,90\nN,2,2,0,0\nN,3,0,0,0,,90\nCERIG,1,2,UXYZ\nCERIG,2,3,UX,ROTY\n";
    assert_eq!(
        equations(&deck(text)),
        // The x of node 1 is y, its y is -x.
        [
            "2:1 1, 1:2 1 = 0",
            "2:2 1, 1:1 -1, 1:6 -2 = 0",
            "2:3 1, 1:3 -1, 1:4 2 = 0",
            "3:1 1, 2:1 -1 = 0",
            "3:5 1, 2:6 -1 = 0"
        ]
    );
    let turned = deck(&format!("{NODES}NROTAT,2\nCERIG,1,2,ALL\n"));
    assert!(equations(&turned).is_empty() && left_out(&turned).len() == 1);
}

#[test]
fn means_with_weights() {
    let nodes = "N,1,1,1,0\nN,2,-1,1,0\nN,3,-1,-1,0\nN,4,1,-1,0\nN,9\n";
    let slaves = "*DIM,S,ARRAY,5\nS(1)=1,2,3,4\n";
    let of = |dof: &str| equations(&deck(&format!("{nodes}{slaves}RBE3,9,{dof},S(1)\n")));
    assert_eq!(of("UX"), ["9:1 1, 1:1 -0.25, 2:1 -0.25, 3:1 -0.25, 4:1 -0.25 = 0"]);
    assert_eq!((of("UXYZ").len(), of("RXYZ").len(), of("ALL").len()), (3, 3, 6));
    assert!(of("ROTZ")[0].starts_with("9:6 1, 1:1 0.125, 1:2 -0.125, 2:1 0.125"));
    let weights = format!("{nodes}{slaves}*DIM,W,ARRAY,4\nW(1)=1,1,3,3\nRBE3,9,UZ,S,W(1)\n");
    // The centre of the weights is at y = -1/2, which a turn about x moves.
    assert_eq!(
        equations(&deck(&weights.replace("UZ", "ROTX"))).len() + equations(&deck(&weights)).len(),
        2,
        "{:?}",
        warnings(&deck(&weights))
    );
    let line = deck(&format!("{NODES}*DIM,S,,2\nS(1)=1,2\nRBE3,3,ALL,S(1)\n"));
    assert!(
        equations(&line).is_empty() && left_out(&line).is_empty() && warnings(&line)[0].contains("RBE3 is ignored")
    );
    for text in ["RBE3,9,ALL,Q(1)\n", "RBE3,9,ALL,S(1),Q(1)\n", "*VGET,S(1),NODE,1,LOC,X\nRBE3,9,UX,S(1)\n"] {
        let unknown = deck(&format!("{nodes}{slaves}{text}"));
        assert!(equations(&unknown).is_empty() && left_out(&unknown).len() == 1, "{text}");
    }
}

#[test]
fn regions_are_numbered_from_the_highest_on() {
    let text = format!("{NODES}CE,7,0,2,TEMP,1,3,TEMP,-1\nCERIG,1,2,UXYZ\nCE,NEXT,0,3,VOLT,1\n");
    let numbers = |deck: &Deck, i| deck.model().label(i).unwrap_or_default();
    assert_eq!(numbers(&deck(&text), 4), "line 6 CE 11 3:9");
    assert_eq!(equations(&deck(&format!("{text}CEDELE,8,10\n"))).len(), 2);
    let changed = deck(&format!("{text}CE,9,,3,UX,1\n"));
    assert!(left_out(&changed)[0].starts_with("7: CE 9 is generated by CERIG or RBE3"), "{:?}", left_out(&changed));
}

#[test]
fn what_is_wrong_with_regions() {
    for (text, message) in [
        ("CERIG\n", "1: CERIG, field 1: expected the number of a node, found nothing"),
        ("CERIG,1,2,UW\n", "1: CERIG, field 3: expected ALL, UXYZ, RXYZ, or one of UX"),
        ("ET,1,PLANE182\nCERIG,1,2,UZ\n", "2: CERIG, field 3: expected ALL, UXYZ, RXYZ, or one of UX"),
        ("RBE3,1,FX,ALL\n", "1: RBE3, field 2: expected ALL, UXYZ"),
    ] {
        let error = try_deck(text).expect_err(text).to_string();
        assert!(error.starts_with(&format!("deck.cdb:{message}")), "{text:?}: {error}");
    }
    let placeless = deck("CERIG,1,2,ALL\nCSYS,1\nN,3,1,2\nCERIG,3,4\n");
    assert_eq!(left_out(&placeless).len(), 2, "{:?}", warnings(&placeless));
}

fn cleaned(text: &str) -> String {
    let before = deck(text);
    let plan = clean::plan(&before, &qless::Options::default()).expect("a plan");
    let result = String::from_utf8(clean::write(&before, &plan).expect("written")).expect("text");
    let after = deck(&result);
    assert!(refused(&after).is_empty(), "{result}");
    assert!(clean::plan(&after, &qless::Options::default()).expect("a plan").is_empty(), "{result}");
    result
}

#[test]
fn a_region_with_a_prescribed_slave_stays_because_ansys_eliminates_another_dof() {
    let text = format!("{NODES}CERIG,1,2,UXYZ\nD,2,UY,0.5\n");
    assert_eq!(cleaned(&text), text);
}

#[test]
fn new_equations_take_no_number_that_somebody_else_may_take() {
    let text = "CEINTF,0.1\nCE,1,0,1,UX,1,2,UX,-1,3,UX,1\nCE,1,,4,UX,1\nCE,2,0,1,UX,1\nD,1,UX\nCP,7,UX,2,3,4\n";
    let result = cleaned(text);
    assert!(result.contains("CE,NEXT,") && result.contains("! qless: CE 1 written anew"), "{result}");
    let text =
        "*GET,N,NODE,,NUM,MAX\n*IF,N,GT,3,THEN\nCE,8,0,3,UY,1\n*ENDIF\nCE,1,0,1,UX,1,2,UX,-1\nD,1,UX\nCP,7,UX,2,3\n";
    assert!(cleaned(text).contains("CE,9,"), "{}", cleaned(text));
}

#[test]
fn arms_beyond_rounding_make_no_equations() {
    let far = deck("N,1,0,0,0\nN,2,1,0,0\nN,3,0,24,1e300,1,1\nCERIG,1,ALL,UXYZ\n");
    assert!(equations(&far).is_empty());
    assert_eq!(left_out(&far), ["4: nodes of the region about node 1 are too far apart for 64-bit numbers: left out"]);
}
