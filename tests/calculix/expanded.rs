//! Elements that ccx expands into solids: which constraints keep their meaning, and what is said of the others.

use std::fmt::Write;

use qless_io::deck::clean::{self, Finding};
use qless_io::deck::{Model, Outcome, Solver};

use super::loss::Printed;
use super::solver::{cleaned, is_there, parse};

/// A mesh of one kind of elements: nodes 1 to 8, elements 1 and 2, and nodes 101 to 103 for references.
struct Mesh {
    kind: &'static str,
    elements: &'static str,
    section: &'static str,
    /// How far the nodes move off the axes.
    slope: f64,
    /// Supports without rotations.
    held: &'static str,
}

const LINE: &str = "1,1,2\n2,2,3\n";
const FACES: &str = "1,1,2,5,4\n2,2,3,6,5\n";
const BAR: &str = "*BEAM SECTION, ELSET=E, MATERIAL=M, SECTION=RECT\n.12,.25\n-.3,.7,-.1\n";
pub const SHELL: &str = "*SHELL SECTION, ELSET=E, MATERIAL=M\n.1\n";
const SOLID: &str = "*SOLID SECTION, ELSET=E, MATERIAL=M\n.1\n";

const MESHES: [Mesh; 11] = [
    // A beam of the plane, which ccx takes as one in space.
    Mesh { kind: "B21", elements: LINE, section: BAR, slope: 0.4, held: "1,1,3\n3,1,3\n" },
    Mesh { kind: "B31", elements: LINE, section: BAR, slope: 0.4, held: "1,1,3\n3,1,3\n" },
    Mesh { kind: "B31R", elements: LINE, section: BAR, slope: 0.0, held: "1,1,3\n3,1,3\n" },
    Mesh { kind: "B32", elements: "1,1,2,3\n", section: BAR, slope: 0.4, held: "1,1,3\n3,1,3\n" },
    Mesh { kind: "S4", elements: FACES, section: SHELL, slope: 0.3, held: "1,1,3\n4,1,3\n3,3\n" },
    Mesh { kind: "S4R", elements: FACES, section: SHELL, slope: 0.0, held: "1,1,3\n4,1,3\n3,3\n" },
    Mesh {
        kind: "M3D4",
        elements: FACES,
        section: "*MEMBRANE SECTION, ELSET=E, MATERIAL=M\n.1\n",
        slope: 0.0,
        held: "1,1,3\n4,1,3\n3,3\n",
    },
    Mesh { kind: "CPS4", elements: FACES, section: SOLID, slope: 0.0, held: "1,1,2\n4,1,2\n" },
    Mesh { kind: "CPE4", elements: FACES, section: SOLID, slope: 0.0, held: "1,1,2\n4,1,2\n" },
    Mesh { kind: "CAX4", elements: FACES, section: SOLID, slope: 0.0, held: "1,1,2\n4,1,2\n" },
    Mesh {
        kind: "CPS3",
        elements: "1,1,2,4\n2,2,5,4\n3,2,3,5\n4,3,6,5\n",
        section: SOLID,
        slope: 0.0,
        held: "1,1,2\n4,1,2\n",
    },
];

impl Mesh {
    fn deck(&self, cards: &str) -> String {
        let mut text = "*NODE, NSET=NALL\n".to_owned();
        for (node, (x, y)) in (1..).zip([(1.0, 0.0), (2.0, 0.0), (3.0, 0.0), (1.0, 1.0), (2.0, 1.0), (3.0, 1.0)]) {
            let (rise, side) = (self.slope * (x + y), if self.elements.len() < 15 { self.slope * x } else { 0.0 });
            writeln!(text, "{node},{x},{},{rise}", y + side).expect("text");
        }
        let Self { kind, elements, section, held, .. } = self;
        format!(
            "{text}101,2.5,.5,0.\n102,2.5,.5,0.\n103,4.,1.,0.\n*ELEMENT, TYPE={kind}, ELSET=E\n{elements}*MATERIAL, NAME=M\n*ELASTIC\n\
             1000.,.3\n{section}*BOUNDARY\n{held}{cards}*STEP\n*STATIC\n*CLOAD\n2,1,1e-3\n2,2,2e-3\n*NODE PRINT, NSET=NALL\nU\n*END STEP\n"
        )
    }

    fn is_bar(&self) -> bool {
        self.section == BAR
    }

    fn is_shell(&self) -> bool {
        self.section == SHELL
    }

    fn is_plane(&self) -> bool {
        self.section == SOLID
    }
}

fn model(text: &str) -> Model {
    parse(text.as_bytes()).model().clone()
}

/// The first warning about a constraint that was left out.
pub fn left_out(text: &str) -> Option<String> {
    model(text).left_out().next().map(|warning| format!("line {}: {}", warning.line, warning.text))
}

#[test]
fn translations_keep_their_meaning() {
    if !is_there() {
        return;
    }
    for mesh in &MESHES {
        // Printed radial displacements are means over the thickness of a sector.
        let most = if mesh.kind == "CAX4" { 1e-3 } else { 1e-5 };
        let last = if mesh.is_plane() { 2 } else { 3 };
        let other = if mesh.is_bar() { 103 } else { 5 };
        let mut decks = vec![format!(
            "*NSET, NSET=R\n2\n{}\n*RIGID BODY, NSET=R, REF NODE=101, ROT NODE=102\n*BOUNDARY\n101,1,3,.01\n102,1,3\n",
            if mesh.is_bar() { 2 } else { 6 }
        )];
        for c in 1..=last {
            decks.push(format!("*BOUNDARY\n{other},{c},{c},.01\n*EQUATION\n2\n2,{c},1.,{other},{c},-2.\n"));
            decks.push(format!("*BOUNDARY\n2,{c},{c},.01\n*EQUATION\n2\n103,{c},1.,2,{c},-1.\n"));
            decks.push(format!("*SURFACE, NAME=K, TYPE=NODE\n2\n*COUPLING, REF NODE=103, SURFACE=K, CONSTRAINT NAME=C\n*KINEMATIC\n{c},{last}\n*BOUNDARY\n103,1,3,.01\n103,4,6\n"));
        }
        for text in decks.iter().map(|cards| mesh.deck(cards)) {
            assert_eq!(left_out(&text), None, "{text}");
            let (model, printed) = (model(&text), Printed::run(&text).unwrap_or_else(|| panic!("ccx stops: {text}")));
            assert!(model.equations() > 0 && (0..model.equations()).all(|i| printed.off(&model, i) < most), "{text}");
        }
    }
}

#[test]
fn rotations_and_nonlinear_cards_leave_the_deck_incomplete() {
    for mesh in &MESHES {
        // Of shells and of beams along an axis, `expanded_rotations`.
        let is_turned = mesh.is_shell() || mesh.is_bar() && mesh.slope == 0.0;
        let axes = if is_turned { "*TRANSFORM, NSET=NALL\n1,1,0,-1,1,0\n" } else { "" };
        let prescribed = format!("{axes}*BOUNDARY\n2,4,6\n");
        let cards = [&prescribed, "*EQUATION\n2\n2,5,1.,3,5,-1.\n", "*MPC\nBEAM,2,103\n*BOUNDARY\n103,1,3\n"];
        for text in cards.map(|cards| mesh.deck(cards)) {
            let said = left_out(&text).unwrap_or_else(|| panic!("{text}"));
            assert!(said.contains(" at 2:") && said.contains("ccx expands the elements there into solids"), "{said}");
        }
    }
    let third = MESHES
        .iter()
        .find(|mesh| mesh.kind == "CPS4")
        .expect("there")
        .deck("*EQUATION\n2\n6,3,1.,103,3,-1.\n*BOUNDARY\n103,1,3,.01\n");
    assert!(left_out(&third).is_some_and(|said| said.contains("*EQUATION at 6:3") && said.contains("stays zero")));
    if is_there() {
        assert!(!Printed::run(&third).expect("solved").holds(&model(&third), 0));
    }
}

#[test]
fn a_clamped_beam_off_the_axes_is_incomplete_and_stops_ccx() {
    let text = "*NODE, NSET=NALL\n1,0,0,0\n2,.9,1.1,-1.7\n*ELEMENT, TYPE=B31, ELSET=E\n1,1,2\n*MATERIAL, NAME=M\n*ELASTIC\n2.1e11,.3
*BEAM SECTION, ELSET=E, MATERIAL=M, SECTION=RECT\n.12,.25\n-.774,.633,0\n*BOUNDARY\n1,1,6\n*STEP\n*STATIC\n*CLOAD\n2,3,10.\n*END STEP\n";
    let said = left_out(text).expect("incomplete");
    assert!(
        said.starts_with("line 13: *BOUNDARY at 1:4 and 2 more: ccx expands the elements there into solids"),
        "{said}"
    );
    assert!(!is_there() || Printed::run(text).is_none());
}

#[test]
fn a_coupling_of_the_third_component_of_plane_elements_stops_ccx() {
    for mesh in MESHES.iter().filter(|mesh| mesh.is_plane()) {
        for (range, stops) in [("1,2", false), ("2,3", true), ("3,3", true), ("1,3", true)] {
            let text = mesh.deck(&format!("*SURFACE, NAME=K, TYPE=NODE\n6\n5\n*COUPLING, REF NODE=103, SURFACE=K, CONSTRAINT NAME=C\n*KINEMATIC\n{range}\n*BOUNDARY\n103,4,6\n"));
            assert_eq!(!model(&text).refusals().is_empty(), stops, "{text}");
            assert!(!is_there() || Printed::run(&text).is_none() == stops, "{text}");
        }
    }
}

/// Two patches of a kind of elements, of which the second is tied to the first by a slave surface.
fn patches(kind: &str, slave: &str) -> String {
    let is_second_order = kind.contains('8');
    let (mut first, mut second) = ("1,1,2,3,4".to_owned(), "2,11,12,13,14".to_owned());
    let mut nodes = "1,1.,0.\n2,2.,0.\n3,2.,1.\n4,1.,1.\n11,2.,0.\n12,3.,0.\n13,3.,1.\n14,2.,1.\n".to_owned();
    if is_second_order {
        first += ",5,6,7,8";
        second += ",15,16,17,18";
        nodes += "5,1.5,0.\n6,2.,.5\n7,1.5,1.\n8,1.,.5\n15,2.5,0.\n16,3.,.5\n17,2.5,1.\n18,2.,.5\n";
    }
    format!(
        "*NODE, NSET=NALL\n{nodes}*ELEMENT, TYPE={kind}, ELSET=E\n{first}\n{second}\n*SURFACE, NAME=SS{slave}*SURFACE, NAME=SM\n1,S2\n\
         *MATERIAL, NAME=M\n*ELASTIC\n1000.,.3\n{SOLID}*TIE, NAME=T, POSITION TOLERANCE=.1, ADJUST=NO\nSS,SM\n*BOUNDARY\n1,1,2\n4,1,2\n\
         *STEP\n*STATIC\n*CLOAD\n12,1,.01\n13,2,.013\n*NODE PRINT, NSET=NALL\nU\n*END STEP\n"
    )
}

#[test]
fn ties_of_edges_of_plane_elements_are_lost_but_at_corners_of_second_order() {
    if !is_there() {
        return;
    }
    for kind in ["CPS4", "CPS4R", "CPE4", "CAX4", "CPS8", "CPS8R", "CPE8", "CAX8"] {
        for slave in ["\n2,S4\n", ", TYPE=NODE\n11\n14\n"] {
            let text = patches(kind, slave);
            let deck = parse(text.as_bytes());
            let findings = clean::findings(deck.model(), &deck.model().cases()[0], Solver::Ccx);
            // Slaves are in the order of their numbers: the middle of an edge is the last.
            let is_lost = !slave.contains("TYPE");
            let expected = if !is_lost {
                0..0
            } else if kind.contains('4') {
                0..4
            } else {
                4..6
            };
            assert_eq!(
                findings.iter().filter_map(Finding::dropped).collect::<Vec<_>>(),
                expected.clone().collect::<Vec<_>>(),
                "{kind}{slave}"
            );
            assert!(findings.iter().all(|finding| finding.outcome == Outcome::IgnoresFirst));
            let printed = Printed::run(&text).expect("solved");
            let holds = |i: usize| printed.off(deck.model(), i) < 1e-3;
            assert!((0..deck.model().equations()).all(|i| expected.contains(&i) || holds(i)), "{kind}{slave}");
            assert_eq!(expected.clone().all(holds), !is_lost, "{kind}{slave}");
            if is_lost {
                let mended = String::from_utf8(cleaned(&deck).expect("cleaned")).expect("text");
                let (model, printed) = (model(&mended), Printed::run(&mended).expect("solved"));
                assert!((0..model.equations()).all(|i| printed.off(&model, i) < 1e-3), "{mended}");
            }
        }
    }
}

#[test]
fn ties_of_shell_faces_are_left_out_and_those_of_their_nodes_are_not() {
    let shells = |slave| patches("S4", slave).replace("*SOLID SECTION", "*SHELL SECTION");
    assert!(
        left_out(&shells("\n2,SPOS\n").replace("1,S2", "1,SNEG"))
            .is_some_and(|said| said.contains("*TIE with faces of shells"))
    );
    let bricks = "*NODE, NSET=NALL\n21,2.,0.,-1.\n22,3.,0.,-1.\n23,3.,1.,-1.\n24,2.,1.,-1.\n25,2.,0.,0.\n26,3.,0.,0.\n27,3.,1.,0.\n28,2.,1.,0.\n\
                  *ELEMENT, TYPE=C3D8, ELSET=B\n9,21,22,23,24,25,26,27,28\n*SOLID SECTION, ELSET=B, MATERIAL=M\n*BOUNDARY\n21,1,3\n22,1,3\n23,1,3\n24,1,3\n*TIE";
    let nodes = shells(", TYPE=NODE\n11\n12\n13\n14\n")
        .replace("1,S2", "9,S2")
        .replacen("*TIE", bricks, 1)
        .replace("\n1,1,2\n4,1,2", "\n1,1,3\n4,1,3");
    assert_eq!(left_out(&nodes), None);
    if is_there() {
        let (model, printed) = (model(&nodes), Printed::run(&nodes).expect("solved"));
        assert!(model.equations() == 12 && (0..12).all(|i| printed.holds(&model, i)));
    }
}
