//! A body of each kind of element that springs hold, so that no set of constraints makes its stiffness singular.

use std::fmt::Write;

/// The kinds of elements of which the body consists.
pub const KINDS: [&str; 9] = ["CBAR", "CROD", "CQUAD4", "CTRIA3", "CHEXA", "CTETRA", "CPENTA", "CELAS2", "CBUSH"];

/// The grid points: 1 to 8 are the corners of a cube, the others lie apart.
pub const POINTS: [[f64; 3]; 12] = [
    [0., 0., 0.],
    [1., 0., 0.],
    [1., 1., 0.],
    [0., 1., 0.],
    [0., 0., 1.],
    [1., 0., 1.],
    [1., 1., 1.],
    [0., 1., 1.],
    [0.5, 0.25, 0.5],
    [2., 0.5, 0.25],
    [-0.5, 1.5, 0.75],
    [0.5, 0.5, 2.],
];

/// The grid point to which all springs lead; its card fixes it.
pub const GROUND: &str = "GRID,99,,0.,0.,-1.,,123456\n";

/// Coordinate systems 11 to 13, of which 13 needs basic axes at the grid points 1, 2 and 4.
pub const FRAMES: &str = "\
CORD2R,11,,.1,.2,.3,.4,.8,1.5\n,2.,.3,.1\n\
CORD2C,12,,.3,-1.,.2,.4,-.8,1.5\n,2.,.3,.1\n\
CORD1R,13,1,2,4\n";

const EDGES: [[u32; 2]; 12] =
    [[1, 2], [2, 3], [3, 4], [4, 1], [5, 6], [6, 7], [7, 8], [8, 5], [1, 5], [2, 6], [3, 7], [4, 8]];
const FACES: [[u32; 4]; 6] = [[1, 2, 3, 4], [5, 6, 7, 8], [1, 2, 6, 5], [2, 3, 7, 6], [3, 4, 8, 7], [4, 1, 5, 8]];
const TETRAHEDRA: [[u32; 4]; 5] = [[1, 2, 3, 6], [1, 3, 4, 8], [1, 6, 8, 5], [3, 8, 6, 7], [1, 3, 8, 6]];

/// The elements of a kind, with their property and material.
pub fn elements(kind: &str) -> String {
    let edges = |rest: &str| listed(kind, EDGES.map(|edge| edge.to_vec()), rest);
    let (elements, property) = match kind {
        "CBAR" => (edges(",.3,.5,.7"), "PBAR,1,1,.1,.01,.02,.015\n"),
        "CROD" => (edges(""), "PROD,1,1,.1,.01\n"),
        "CBUSH" => (edges(",,,,0"), "PBUSH,1,K,10.,20.,30.,4.,5.,6.\n"),
        "CQUAD4" => (listed(kind, FACES.map(|face| face.to_vec()), ""), "PSHELL,1,1,.1,1,,1\n"),
        "CTRIA3" => (
            listed(kind, FACES.into_iter().flat_map(|[a, b, c, d]| [vec![a, b, c], vec![a, c, d]]), ""),
            "PSHELL,1,1,.1,1,,1\n",
        ),
        "CHEXA" => ("CHEXA,101,1,1,2,3,4,5,6\n,7,8\n".to_owned(), "PSOLID,1,1,,2,,FULL\n"),
        "CPENTA" => (listed(kind, [vec![1, 2, 3, 5, 6, 7], vec![1, 3, 4, 5, 7, 8]], ""), "PSOLID,1,1,,2,,FULL\n"),
        "CTETRA" => (listed(kind, TETRAHEDRA.map(|corners| corners.to_vec()), ""), "PSOLID,1,1,,2,,FULL\n"),
        _ => (springs_on_edges(), ""),
    };
    format!("{elements}{property}MAT1,1,1000.,385.,.3\n")
}

fn listed(kind: &str, elements: impl IntoIterator<Item = Vec<u32>>, rest: &str) -> String {
    elements.into_iter().zip(101..).fold(String::new(), |text, (corners, number)| {
        let corners: Vec<String> = corners.iter().map(u32::to_string).collect();
        text + &format!("{kind},{number},1,{}{rest}\n", corners.join(","))
    })
}

fn springs_on_edges() -> String {
    EDGES.into_iter().zip(0..).fold(String::new(), |text, ([a, b], k)| {
        let component = k % 6 + 1;
        text + &format!("CELAS2,{},{}.,{a},{component},{b},{component}\n", 101 + k, 10 + k)
    })
}

/// A spring to the ground for each component of each grid point, all of different stiffness.
pub fn ground_springs() -> String {
    let mut text = String::new();
    for (number, (node, c)) in (1001..).zip((1..=POINTS.len()).flat_map(|node| (1..=6).map(move |c| (node, c)))) {
        let stiffness = 1.0 + f64::from(number * 7 % 13) / 4.0;
        writeln!(text, "CELAS2,{number},{stiffness:?},{node},{c},99,{c}").expect("text");
    }
    text
}

/// Forces and moments, different at each grid point.
pub fn loads() -> String {
    (1..=POINTS.len()).fold(String::new(), |text, node| {
        let card = if node % 2 == 0 { "MOMENT" } else { "FORCE" };
        let [x, y, z] = [node % 3, node % 5, node % 7].map(|x| 0.7 - x as f64 / 4.0);
        text + &format!("{card},3,{node},,1.,{x:.2},{y:.2},{z:.2}\n")
    })
}
