//! `*PRE-TENSION SECTION`: ccx solves the deck as it solves the deck that has the equations of the model instead.

use std::fmt::Write;

use qless_io::deck::clean::{self, Finding};
use qless_io::deck::{Outcome, Solver};
use qless_scenes::Rng;

use super::loss::{Printed, bars};
use super::solver::{difference, is_there, parse, solve};

type Point = [f64; 3];

/// A kind of elements with regular corners.
struct Kind {
    name: &'static str,
    corners: &'static [Point],
    /// The corners at the ends of each edge, in the order of the middle nodes; none if the elements have no middle nodes.
    edges: &'static [(usize, usize)],
    /// The corners of each face, and its name.
    faces: &'static [(&'static str, &'static [usize])],
    section: &'static str,
}

const H: f64 = 0.866_025_403_784_438_6;
const CUBE: [Point; 8] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [1.0, 1.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [1.0, 1.0, 1.0],
    [0.0, 1.0, 1.0],
];
const TETRAHEDRON: [Point; 4] =
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, H, 0.0], [0.5, H / 3.0, 0.816_496_580_927_726]];
const PRISM: [Point; 6] =
    [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, H, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.5, H, 1.0]];
const SQUARE: [Point; 4] = [CUBE[0], CUBE[1], CUBE[2], CUBE[3]];
const TRIANGLE: [Point; 3] = [PRISM[0], PRISM[1], PRISM[2]];
const CUBE_EDGES: [(usize, usize); 12] =
    [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)];
const CUBE_FACES: [(&str, &[usize]); 6] = [
    ("S1", &[0, 1, 2, 3]),
    ("S2", &[4, 5, 6, 7]),
    ("S3", &[0, 1, 5, 4]),
    ("S4", &[1, 2, 6, 5]),
    ("S5", &[2, 3, 7, 6]),
    ("S6", &[3, 0, 4, 7]),
];
const TETRAHEDRON_EDGES: [(usize, usize); 6] = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)];
const TETRAHEDRON_FACES: [(&str, &[usize]); 4] =
    [("S1", &[0, 1, 2]), ("S2", &[0, 1, 3]), ("S3", &[1, 2, 3]), ("S4", &[0, 2, 3])];
const PRISM_EDGES: [(usize, usize); 9] = [(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)];
const PRISM_FACES: [(&str, &[usize]); 5] =
    [("S1", &[0, 1, 2]), ("S2", &[3, 4, 5]), ("S3", &[0, 1, 4, 3]), ("S4", &[1, 2, 5, 4]), ("S5", &[2, 0, 3, 5])];
const SQUARE_EDGES: [(usize, usize); 4] = [(0, 1), (1, 2), (2, 3), (3, 0)];
const TRIANGLE_EDGES: [(usize, usize); 3] = [(0, 1), (1, 2), (2, 0)];
const PLANE: [(&str, &[usize]); 4] = [("S1", &[0, 1]), ("S2", &[1, 2]), ("S3", &[2, 3]), ("S4", &[3, 0])];
const PLANE3: [(&str, &[usize]); 3] = [("S1", &[0, 1]), ("S2", &[1, 2]), ("S3", &[2, 0])];
const EDGES: [(&str, &[usize]); 4] = [("S3", &[0, 1]), ("S4", &[1, 2]), ("S5", &[2, 3]), ("S6", &[3, 0])];
const EDGES3: [(&str, &[usize]); 3] = [("S3", &[0, 1]), ("S4", &[1, 2]), ("S5", &[2, 0])];
const SOLID: &str = "*SOLID SECTION, ELSET=E, MATERIAL=M\n";
const FLAT: &str = "*SOLID SECTION, ELSET=E, MATERIAL=M\n.1\n";
const SHELL: &str = "*SHELL SECTION, ELSET=E, MATERIAL=M\n.1\n";

const fn kind(
    name: &'static str,
    corners: &'static [Point],
    edges: &'static [(usize, usize)],
    faces: &'static [(&'static str, &'static [usize])],
    section: &'static str,
) -> Kind {
    Kind { name, corners, edges, faces, section }
}

const KINDS: [Kind; 18] = [
    kind("C3D8", &CUBE, &[], &CUBE_FACES, SOLID),
    kind("C3D8I", &CUBE, &[], &CUBE_FACES, SOLID),
    kind("C3D20", &CUBE, &CUBE_EDGES, &CUBE_FACES, SOLID),
    kind("C3D20R", &CUBE, &CUBE_EDGES, &CUBE_FACES, SOLID),
    kind("C3D4", &TETRAHEDRON, &[], &TETRAHEDRON_FACES, SOLID),
    kind("C3D10", &TETRAHEDRON, &TETRAHEDRON_EDGES, &TETRAHEDRON_FACES, SOLID),
    kind("C3D6", &PRISM, &[], &PRISM_FACES, SOLID),
    kind("C3D15", &PRISM, &PRISM_EDGES, &PRISM_FACES, SOLID),
    kind("CPS4", &SQUARE, &[], &PLANE, FLAT),
    kind("CPE8", &SQUARE, &SQUARE_EDGES, &PLANE, FLAT),
    kind("CAX8R", &SQUARE, &SQUARE_EDGES, &PLANE, FLAT),
    kind("CAX4", &SQUARE, &[], &PLANE, FLAT),
    kind("CPS3", &TRIANGLE, &[], &PLANE3, FLAT),
    kind("CPE6", &TRIANGLE, &TRIANGLE_EDGES, &PLANE3, FLAT),
    kind("S4", &SQUARE, &[], &EDGES, SHELL),
    kind("S8R", &SQUARE, &SQUARE_EDGES, &EDGES, SHELL),
    kind("S3", &TRIANGLE, &[], &EDGES3, SHELL),
    kind("S6", &TRIANGLE, &TRIANGLE_EDGES, &EDGES3, SHELL),
];

fn mean(points: &[Point]) -> Point {
    [0, 1, 2].map(|k| points.iter().map(|x| x[k]).sum::<f64>() / points.len() as f64)
}

/// Two elements with a face in common.
struct Pair<'a> {
    kind: &'a Kind,
    /// The face of both elements.
    face: usize,
    nodes: Vec<Point>,
    elements: [Vec<usize>; 2],
}

impl<'a> Pair<'a> {
    /// The second element is the first one, turned by 180 degrees about a line of symmetry of the face.
    fn new(kind: &'a Kind, face: usize) -> Self {
        let middle = |&(a, b): &(usize, usize)| mean(&[kind.corners[a], kind.corners[b]]);
        let nodes: Vec<Point> = kind.corners.iter().copied().chain(kind.edges.iter().map(middle)).collect();
        let corners: Vec<Point> = kind.faces[face].1.iter().map(|&k| nodes[k]).collect();
        let centre = mean(&corners);
        let to = match corners.len() {
            2 => [centre[0], centre[1], 1.0],
            3 => corners[0],
            _ => mean(&corners[..2]),
        };
        let axis = [0, 1, 2].map(|k| to[k] - centre[k]);
        let square: f64 = axis.iter().map(|x| x * x).sum();
        let turned = |x: &Point| {
            let arm = [0, 1, 2].map(|k| x[k] - centre[k]);
            let along = (0..3).map(|k| arm[k] * axis[k]).sum::<f64>() / square;
            [0, 1, 2].map(|k| centre[k] + 2.0 * along * axis[k] - arm[k])
        };
        let first = (0..nodes.len()).collect();
        let mut pair = Self { kind, face, nodes: nodes.clone(), elements: [first, Vec::new()] };
        for point in nodes.iter().map(turned) {
            let is_there = |other: &Point| (0..3).all(|k| (other[k] - point[k]).abs() < 1e-9);
            let at = pair.nodes.iter().position(is_there).unwrap_or(pair.nodes.len());
            if at == pair.nodes.len() {
                pair.nodes.push(point);
            }
            pair.elements[1].push(at);
        }
        pair
    }

    fn is_plane(&self) -> bool {
        self.kind.section == FLAT
    }

    /// Moves all nodes by the same random linear map, which keeps planes and orientations.
    fn shear(&mut self, rng: &mut Rng) {
        let part = |size: f64, rng: &mut Rng| size * rng.real();
        let (a, b, c, d) = (part(0.4, rng), part(0.4, rng), part(0.4, rng), part(0.4, rng));
        let is_plane = self.is_plane();
        let angle = if is_plane { 0.0 } else { 3.0 * rng.real() };
        for x in &mut self.nodes {
            let [p, q, r] = [x[0] + a * x[1], x[1] + b * x[0], x[2]];
            let r = if is_plane { r } else { r + c * p + d * q };
            *x = [p * angle.cos() - r * angle.sin() + 9.0, q, p * angle.sin() + r * angle.cos()];
        }
    }

    /// The deck with these nodes of the elements, numbers from 1. Node 90 is the reference.
    fn deck(&self, elements: &[Vec<usize>; 2], cards: &str, end: &str) -> String {
        let mut text = "*NODE, NSET=NALL\n90,0.,0.,0.\n".to_owned();
        for (k, [x, y, z]) in self.nodes.iter().enumerate() {
            writeln!(text, "{},{x},{y},{z}", k + 1).expect("text");
        }
        writeln!(text, "{cards}*ELEMENT, TYPE={}, ELSET=E", self.kind.name).expect("text");
        for (nodes, number) in elements.iter().zip(1..) {
            let nodes: Vec<String> = nodes.iter().map(|node| (node + 1).to_string()).collect();
            let (head, tail) = nodes.split_at(nodes.len().min(10));
            let tail = if tail.is_empty() { String::new() } else { format!(",\n{}", tail.join(",")) };
            writeln!(text, "{number},{}{tail}", head.join(",")).expect("text");
        }
        format!("{text}*MATERIAL, NAME=M\n*ELASTIC\n1000.,.3\n{}{end}", self.kind.section)
    }

    /// The nodes of the common face.
    fn common(&self) -> Vec<usize> {
        self.elements[0].iter().filter(|node| self.elements[1].contains(node)).copied().collect()
    }

    /// Holds a node of the face and all others, and loads the face.
    fn end(&self, reference: &str, rng: &mut Rng) -> String {
        let (common, last) = (self.common(), if self.kind.section == SHELL { 6 } else { 3 });
        let mut text = format!("*BOUNDARY\n{},1,{}\n", common[0] + 1, if self.is_plane() { 2 } else { 3 });
        for node in (0..self.nodes.len()).filter(|node| !common.contains(node)) {
            writeln!(text, "{},1,{}", node + 1, if self.is_plane() { 2 } else { last }).expect("text");
        }
        text += "*STEP\n*STATIC\n*CLOAD\n";
        for node in &common[1..] {
            (1..=2).for_each(|k| writeln!(text, "{},{k},{}", node + 1, rng.real()).expect("text"));
        }
        format!("{text}{reference}*NODE PRINT, NSET=NALL\nU\n*END STEP\n")
    }
}

/// The deck with a section, and the deck with the equations of the model in its place.
fn decks(pair: &Pair, side: usize, normal: &str, reference: &str, rng: &mut Rng) -> [String; 2] {
    let end = pair.end(reference, rng);
    let name = pair.kind.faces[pair.face].0;
    let section =
        format!("*SURFACE, NAME=CUT\n{},{name}\n*PRE-TENSION SECTION, SURFACE=CUT, NODE=90\n{normal}", side + 1);
    let text = pair.deck(&pair.elements, "", &format!("{section}{end}"));
    let deck = parse(text.as_bytes());
    let model = deck.model();
    assert_eq!((model.left_out().count(), model.refusals().len()), (0, 0), "{:?}", model.warnings());
    let (mut nodes, mut equations, mut elements) = ("*NODE\n".to_owned(), String::new(), pair.elements.clone());
    for node in 91..91 + pair.common().len() as u32 {
        let name = model.node_name(node);
        let own: usize = name.split(' ').next().and_then(|own| own.parse().ok()).expect("a number");
        let [x, y, z] = pair.nodes[own - 1];
        writeln!(nodes, "{node},{x},{y},{z}").expect("text");
        elements[side].iter_mut().filter(|other| **other == own - 1).for_each(|other| *other = node as usize - 1);
    }
    for i in 0..model.equations() {
        let equation = model.equation(i).expect("an equation");
        write!(equations, "*EQUATION\n{}", equation.columns.len()).expect("text");
        for (&j, a) in equation.columns.iter().zip(equation.coefficients) {
            let dof = model.dofs()[j as usize];
            write!(equations, "\n{},{},{a}", dof.node, dof.component).expect("text");
        }
        equations += "\n";
    }
    [text, pair.deck(&elements, &nodes, &format!("{equations}{end}"))]
}

#[test]
fn a_cut_opens_along_its_normal_by_the_motion_of_its_reference() {
    if !is_there() {
        return;
    }
    let mut rng = Rng::new(1);
    for k in 0..144 {
        let kind = &KINDS[k % KINDS.len()];
        let mut pair = Pair::new(kind, rng.below(kind.faces.len()));
        pair.shear(&mut rng);
        let [x, y, z] = [0, 1, 2].map(|_| rng.real());
        // ccx computes wrong normals of tetrahedra.
        let is_given = k % 2 == 1 || kind.corners.len() == 4 && kind.section == SOLID;
        let normal =
            if is_given { format!("{x},{y},{}\n", if pair.is_plane() { 0.0 } else { z }) } else { String::new() };
        let reference = if rng.below(2) == 0 { "90,1,2.\n" } else { "*BOUNDARY\n90,1,1,.01\n" };
        let [text, explicit] = decks(&pair, rng.below(2), &normal, reference, &mut rng);
        let [own, other] =
            [&text, &explicit].map(|text| solve(text.as_bytes()).unwrap_or_else(|| panic!("ccx stops:\n{text}")));
        let off = difference(&own, &other);
        assert!(off < 1e-6, "{} {off:e}\n{text}\n{explicit}", kind.name);
    }
}

/// Two bars with a beam between nodes 5 and 106, whose section is read after `before` and followed by `after`.
fn with_beam(before: &str, normal: &str, after: &str) -> String {
    let beam =
        "*ELEMENT, TYPE=B31, ELSET=EB\n9,5,106\n*BEAM SECTION, ELSET=EB, MATERIAL=M, SECTION=RECT\n.1,.1\n0.,1.,0.\n";
    let held = "*BOUNDARY\n207,1,3,1e-3\n208,1,1,2e-3\n208,2,3\n";
    bars(&format!("{beam}{before}*PRE-TENSION SECTION, ELEMENT=9, NODE=208\n{normal}{after}{held}"), "")
}

/// Whether ccx stops: as said, and in a run. If it runs, all equations must hold.
fn stops(text: &str) -> [bool; 2] {
    let deck = parse(text.as_bytes());
    let model = deck.model();
    assert_eq!(model.left_out().count(), 0, "{:?}", model.warnings());
    let findings = clean::findings(model, &model.cases()[0], Solver::Ccx);
    let said = !model.refusals().is_empty() || findings.iter().any(|finding| finding.outcome == Outcome::Refused);
    let Some(printed) = Printed::run(text) else { return [said, true] };
    assert!(findings.iter().find_map(Finding::dropped).is_none(), "{text}");
    for i in 0..model.equations() {
        assert!(printed.holds(model, i), "{}\n{text}", model.label(i).unwrap_or_default());
    }
    [said, false]
}

#[test]
fn a_beam_takes_the_slave_that_ccx_chooses() {
    if !is_there() {
        return;
    }
    let mut rng = Rng::new(2);
    let normals = [
        "",
        "1.,1.,1.",
        "0.,1.,1.",
        "1.,0.,1.",
        "1.,1.,0.",
        "1.,2.,2.",
        "2.,1.,2.",
        "2.,2.,1.",
        "1.,1.,2.",
        "1.,2.,1.",
        "2.,1.,1.",
        "0.,0.,-1.",
        ".3,-.7,.2",
    ];
    let (mut stopped, mut solved) = (0, 0);
    for k in 0..260 {
        let mut dofs: Vec<(u32, u32)> = (0..6).map(|k| ([5, 106][k / 3], k as u32 % 3 + 1)).collect();
        (0..6).for_each(|i| dofs.swap(i, rng.below(6)));
        let equation = |&(node, c): &(u32, u32)| format!("*EQUATION\n2\n{node},{c},1.,207,{c},-1.\n");
        let (early, late) = dofs.split_at(rng.below(7));
        let early: String = early.iter().map(equation).collect();
        let late = match late.first() {
            Some(dof) if k % 3 == 0 => equation(dof),
            Some((node, c)) if k % 3 == 1 => format!("*BOUNDARY\n{node},{c}\n"),
            _ => String::new(),
        };
        let normal = normals[k % normals.len()];
        let normal = if normal.is_empty() { String::new() } else { format!("{normal}\n") };
        let text = with_beam(&early, &normal, &late);
        let [said, found] = stops(&text);
        assert_eq!(said, found, "{text}");
        (stopped, solved) = (stopped + usize::from(found), solved + usize::from(!found));
    }
    assert!(stopped > 50 && solved > 50, "{stopped} {solved}");
}
