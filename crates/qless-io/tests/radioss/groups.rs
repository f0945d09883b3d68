//! What constraints refer to: node groups, surfaces, elements, included files, parameters and format versions.

use super::from_text::{
    CUBE, columns, cube, equations, first_line, left_out, model, parsed, parsed_bytes, prescribed, refused,
};

/// The nodes that a group 9 has.
fn members(cards: &str) -> Vec<u32> {
    let deck = parsed(&format!("{CUBE}{cards}")).unwrap_or_else(|error| panic!("{error}\n{cards}"));
    deck.node_set("9").unwrap_or_else(|| panic!("no group in {cards}"))
}

#[test]
fn groups_name_nodes_in_many_ways() {
    let corners: Vec<u32> = (1..=8).collect();
    for (group, expected) in [
        ("NODE/9\n'a\n5 6\n_ 7\n", vec![5, 6, 7]),
        ("NODENS/9\n'a\n8 5 8\n", vec![8, 5]),
        ("GRNOD/9\n'a\n4 3 4\n", vec![11, 12, 13, 14, 5, 6, 7, 8]),
        ("GRNOD/9\n'a\n3 -10\n/GRNOD/NODE/10\n'b\n6 7\n", vec![5, 8]),
        ("GENE/9\n'a\n7 12\n20 20\n", vec![7, 8, 11, 12, 20]),
        ("GEN_INCR/9\n'a\n1 8 3\n", vec![1, 4, 7]),
        ("PART/9\n'a\n1\n", corners.clone()),
        ("PROP/9\n'a\n17\n", vec![11, 12, 13, 14]),
        ("MAT/9\n'a\n8\n", corners.clone()),
        (
            "SUBSET/9\n'a\n40\n/SUBSET/40\n'all\n41 9\n/SUBSET/41\n'more\n19 40\n",
            [&corners[..], &[11, 12, 13, 14]].concat(),
        ),
        ("SURF/9\n'a\n5\n", vec![5, 6, 7, 8]),
    ] {
        assert_eq!(members(&format!("/GRNOD/{group}")), expected, "{group}");
    }
    let deck = parsed(CUBE).expect("a deck");
    let mut names = deck.node_set_names();
    names.sort();
    assert_eq!(names, ["3", "4"]);
}

#[test]
fn surfaces_are_segments_or_sides_of_parts() {
    let faces = |surface: &str| {
        let node = "/NODE\n30 =.5 =.5 =1.\n/GRNOD/NODE/9\n'one\n30\n";
        let model = cube(&format!("{node}/SURF/{surface}/INTER/TYPE2/6\n'a tie\n9 8 0 4 0 0 0 0 =.01\n"));
        equations(&model).first().cloned().unwrap_or_default()
    };
    let top = "1 30:1 -0.25 5:1 -0.25 6:1 -0.25 7:1 -0.25 8:1";
    let plate = "1 30:1 -0.25 11:1 -0.25 12:1 -0.25 13:1 -0.25 14:1";
    for (surface, row) in [
        ("SEG/8\n'a\n1 5 6 7 8\n", top),
        ("SEG/8\n'a\n1 5 6 7 7\n", "1 30:1 -0.5 5:1 -0.5 7:1"),
        ("SEG/8\n'a\n1 5 6 7\n", "1 30:1 -0.5 5:1 -0.5 7:1"),
        ("PART/EXT/8\n'a\n1\n", top),
        ("PART/ALL/8\n'a\n1\n", top),
        ("PART/8\n'a\n2\n", plate),
        ("SUBSET/8\n'a\n19\n", plate),
        ("SURF/8\n'a\n7 5\n/SURF/PART/7\n'b\n1\n", top),
        ("PART/8\n'a\n1\n", ""),
        ("PART/EXT/8\n'a\n1 2 -1\n", plate),
    ] {
        let words = |text: &str| {
            let mut words: Vec<String> = text.split(' ').map(str::to_owned).collect();
            words.sort();
            words
        };
        assert_eq!(words(&faces(surface)), words(row), "{surface}");
    }
}

#[test]
fn every_element_gives_its_nodes() {
    for (element, expected) in [
        ("SHELL/9\n1 1 2 3 4 _ _ =1.\n", vec![1, 2, 3, 4]),
        ("SH3N/9\n1 1 2 3\n", vec![1, 2, 3]),
        ("TETRA4/9\n1 1 2 3 4\n", vec![1, 2, 3, 4]),
        ("TETRA10/9\n1\n1 2 3 4 5 6 7 8 11 12\n", vec![1, 2, 3, 4, 5, 6, 7, 8, 11, 12]),
        ("PENTA6/9\n1 1 2 3 4 5 6\n", vec![1, 2, 3, 4, 5, 6]),
        (
            "BRIC20/9\n1 1 2 3 4 5 6 7 8\n11 12 13 14 20 21 22\n",
            vec![1, 2, 3, 4, 5, 6, 7, 8, 11, 12, 13, 14, 20, 21, 22],
        ),
        ("BEAM/9\n1 1 2 3\n", vec![1, 2]),
        ("TRUSS/9\n1 1 2\n2 5 6\n", vec![1, 2, 5, 6]),
        ("SPRING/9\n1 1 2\n", vec![1, 2]),
        ("QUAD/9\n1 1 2 3 4\n", vec![1, 2, 3, 4]),
    ] {
        assert_eq!(members(&format!("/{element}/GRNOD/PART/9\n'a\n9\n")), expected, "{element}");
    }
    // Elements that are not read, and groups that are not, leave out what needs them.
    let held = |cards: &str| left_out(&cube(&format!("{cards}/BCS/1\n'held\n100/000 0 9\n")));
    let why = "/BCS/1 needs the nodes of a part, and /SPHCEL is not read: left out";
    assert_eq!(held("/SPHCEL/7\n1 0\n/GRNOD/PART/9\n'a\n7\n"), [format!("line {}: {why}", first_line() + 7)]);
    let boxed = held("/GRNOD/BOX/9\n'a\n5\n");
    assert_eq!(
        boxed,
        [format!("line {}: /BCS/1 uses node group 9, which /GRNOD/BOX defines: left out", first_line() + 5)]
    );
    assert_eq!(held("/SET/GENERAL/9\n'a\nNODE 1 2\n").len(), 1);
}

#[test]
fn included_files_continue_cards() {
    let nodes = CUBE.find("/NODE").expect("nodes");
    let (head, tail) = CUBE.split_at(nodes);
    let after = tail.find("/PART").expect("parts");
    let (nodes, tail) = tail["/NODE\n".len()..].split_at(after - "/NODE\n".len());
    let half = nodes.match_indices('\n').nth(5).expect("lines").0 + 1;
    let rest = format!("{tail}/BCS/1\n'held\n100/000 0 3\n/END\n/BCS/2\n'not read\n010/000 0 3\n");
    let deck = |middle: &str, included: &str| {
        let text = format!("{head}/NODE\n{middle}#include part.inc\n{rest}");
        parsed_bytes(columns(&text).into_bytes(), &[("part.inc", included)]).expect("a deck").model().clone()
    };
    let held = ["5:1=0", "6:1=0", "7:1=0", "8:1=0"];
    assert_eq!(prescribed(&deck(nodes, "/FUNCT/1\n'f\n=0. =0.\n")), held);
    assert_eq!(prescribed(&deck(nodes, "'Remarks of an author\n/FUNCT/1\n'f\n=0. =0.\n")), held);
    assert_eq!(prescribed(&deck(&nodes[..half], &nodes[half..])), held);
    assert_eq!(prescribed(&deck(&nodes[half..], &format!("# first\n{}/FUNCT/1\n'f\n", &nodes[..half]))), held);
    // A constraint that goes on in another file is left out there.
    let split = parsed_bytes(
        columns(&format!("{CUBE}/NBCS/1\n'n\n100/000 0 20\n#include a.inc\n")).into_bytes(),
        &[("a.inc", "100/000 0 21\n")],
    );
    let split = split.expect("a deck");
    assert_eq!(
        (prescribed(split.model()), left_out(split.model())),
        (vec!["20:1=0".to_owned()], vec!["a.inc:0: /NBCS/1 goes on in another file: left out".to_owned()])
    );
}

#[test]
fn parameters_versions_and_submodels() {
    let mpc = "/MPC/4\n'equal\n1 1 0 =&A\n2 1 0 =-&A\n";
    assert_eq!(equations(&cube(&format!("/PARAMETER/GLOBAL/REAL/1\n'a\nA =2.5\n{mpc}"))), ["2.5 1:1 -2.5 2:1"]);
    for version in ["51", "100", "2026"] {
        assert_eq!(model(&CUBE.replace("2019", version)).equations(), 0, "{version}");
    }
    let old = refused(&CUBE.replace("2019", "44"));
    assert_eq!(old, "deck_0000.rad:4: /BEGIN, field 1: expected a format version from 51 on, found `44`; correct it");
    let submodel = |offsets: &str| {
        let cards =
            format!("//SUBMODEL/1\n'sub\n{offsets}\n/NODE\n50 =0. =0. =0.\n/GRNOD/NODE/9\n'one\n50\n//ENDSUB\n");
        let model = cube(&format!("{cards}/BCS/1\n'held\n100/000 0 9\n"));
        (prescribed(&model), left_out(&model))
    };
    assert_eq!(submodel(""), (vec!["50:1=0".to_owned()], vec![]));
    assert_eq!(submodel("0 0 0"), (vec!["50:1=0".to_owned()], vec![]));
    let line = first_line();
    let texts = [
        "//SUBMODEL/1 has numbers with offsets, which this reader does not follow: left out",
        "/BCS/1 names node group 9, which //SUBMODEL/1 may define: left out",
    ];
    assert_eq!(
        submodel("0 1000 0"),
        (vec![], vec![format!("line {line}: {}", texts[0]), format!("line {}: {}", line + 11, texts[1])])
    );
}
