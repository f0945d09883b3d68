//! Positions of nodes in decks of all formats, given along any axes.

use std::collections::HashMap;
use std::f64::consts::FRAC_1_SQRT_2;

use qless_io::deck::{self, Format};

fn positions(format: Format, text: &str) -> HashMap<u32, [f64; 3]> {
    let mut none = |_: &std::path::Path| Err(std::io::ErrorKind::NotFound.into());
    deck::parse(format, "deck".as_ref(), text.into(), &mut none).expect("a deck").positions()
}

fn are(found: &HashMap<u32, [f64; 3]>, expected: &[(u32, [f64; 3])]) {
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (node, at) in expected {
        let close = found[node].iter().zip(at).all(|(a, b)| (a - b).abs() < 1e-14);
        assert!(close, "node {node} at {:?}, not {at:?}", found[node]);
    }
}

#[test]
fn nastran_points_are_in_the_basic_system() {
    // A cylindrical system with its axis along z through (10, 0, 0); GRDSET gives the blank fields of GRID.
    let text = "BEGIN BULK
CORD2C,5,,10.,0.,0.,10.,0.,1.
+,11.,0.,0.
GRDSET,,5
GRID,1,0,1.,2.,3.
GRID,2,,2.,45.,-1.
GRID,3,,1.,180.
ENDDATA
";
    let side = 2.0 * FRAC_1_SQRT_2;
    let expected = [(1, [1.0, 2.0, 3.0]), (2, [10.0 + side, side, -1.0]), (3, [9.0, 0.0, 0.0])];
    are(&positions(Format::Nastran, text), &expected);
}

#[test]
fn ansys_nodes_are_those_of_blocks_and_commands() {
    let text = "/PREP7
NBLOCK,6,SOLID,3,3
(3i9,6e21.13e3)
        1        0        0 1.5000000000000E+000-2.0000000000000E+000
        2        0        0 0.0000000000000E+000 0.0000000000000E+000 4.0000000000000E+000 3.0000000000000E+001
N,R5.3,LOC,       -1,
N,R5.3,LOC,       7,       0,       0,  1.0,  2.0,  3.0
N,R5.3,ANG,       7,       0,       0,  30.0,  0.0,  0.0
N,8,0.5,,0.25
CSYS,1
N,9,2,90
CSYS,0
N,10,1
";
    let expected = [
        (1, [1.5, -2.0, 0.0]),
        (2, [0.0, 0.0, 4.0]),
        (7, [1.0, 2.0, 3.0]),
        (8, [0.5, 0.0, 0.25]),
        (10, [1.0, 0.0, 0.0]),
    ];
    are(&positions(Format::Ansys, text), &expected);
}

#[test]
fn calculix_nodes_are_as_they_stand() {
    are(&positions(Format::Calculix, "*NODE\n7,1.,2.,3.\n8,4.\n"), &[(7, [1.0, 2.0, 3.0]), (8, [4.0, 0.0, 0.0])]);
}
