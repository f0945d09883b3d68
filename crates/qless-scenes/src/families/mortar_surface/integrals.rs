//! Integrals `D_ij = int N_i N_j dA`, `M_ik = int N_i P_k dA` and `n_i = int N_i n dA` with nine Gauss points per slave face.

use crate::families::mortar::gauss;
use crate::families::patch::{Locator, PatchFace};

/// Integrals of the function of a slave node.
#[derive(Clone, Default)]
pub(super) struct IntegralsRow {
    /// Row i of D: pairs `(slave node j, int N_i N_j dA)`.
    pub(super) slave: Vec<(usize, f64)>,
    /// Row i of M: pairs `(master node k, int N_i P_k dA)`.
    pub(super) master: Vec<(usize, f64)>,
    /// Integral of the normal, weighted with the function of the node: `int N_i n dA`.
    pub(super) normal: [f64; 3],
}

/// The mesh of one side: faces, and positions of nodes in the square and in space.
pub(super) struct SurfaceMesh {
    pub(super) faces: Vec<PatchFace>,
    pub(super) square: Vec<[f64; 2]>,
    pub(super) space: Vec<[f64; 3]>,
}

/// Integrates the functions of each slave node. A Gauss point of a slave face belongs to the master face at the same `(s, t)`. D and M use
/// the same points, so that their row sums are equal.
pub(super) fn rows(slave: &SurfaceMesh, master: &SurfaceMesh) -> Vec<IntegralsRow> {
    let locator = Locator::new(&master.faces, |node| master.square[node]);
    let mut rows = vec![IntegralsRow::default(); slave.space.len()];
    for face in &slave.faces {
        for (at, weight) in points(face) {
            add_point(&mut rows, slave, &locator, face, (at, weight));
        }
    }
    rows
}

fn add_point(
    rows: &mut [IntegralsRow],
    slave: &SurfaceMesh,
    locator: &Locator,
    face: &PatchFace,
    (at, weight): ([f64; 2], f64),
) {
    let functions = face.functions(at);
    let sum = |what: usize, place: &dyn Fn(usize) -> f64| {
        face.nodes().iter().zip(&functions).map(|(&node, function)| function[what] * place(node)).sum::<f64>()
    };
    let slope = |what: usize| std::array::from_fn(|axis| sum(what, &|node| slave.space[node][axis]));
    let normal = cross(slope(1), slope(2));
    let area = weight * length(normal);
    let (over, values) = locator.at([0, 1].map(|axis| sum(0, &|node| slave.square[node][axis])));
    for (&i, own) in face.nodes().iter().zip(&functions) {
        let row = &mut rows[i];
        (0..3).for_each(|axis| row.normal[axis] += weight * own[0] * normal[axis]);
        face.nodes().iter().zip(&functions).for_each(|(&j, other)| add(&mut row.slave, j, area * own[0] * other[0]));
        over.nodes().iter().zip(values).for_each(|(&k, value)| add(&mut row.master, k, area * own[0] * value));
    }
}

/// Adds a part to an entry of a row. Rows are short, so a linear search is fast enough.
fn add(row: &mut Vec<(usize, f64)>, column: usize, part: f64) {
    match row.iter_mut().find(|entry| entry.0 == column) {
        Some(entry) => entry.1 += part,
        None => row.push((column, part)),
    }
}

/// Gauss points and weights; for a triangle, those of the square with one side collapsed to a point.
fn points(face: &PatchFace) -> impl Iterator<Item = ([f64; 2], f64)> {
    let triangle = matches!(face, PatchFace::Triangle(_));
    let all = gauss().into_iter().flat_map(|(x, v)| gauss().map(|(y, w)| ([x, y], v * w)));
    all.map(move |([x, y], w)| if triangle { ([x * (1.0 - y), y], w * (1.0 - y)) } else { ([x, y], w) })
}

/// The unit normal, and two unit tangents that are not parallel to x, y or z.
pub(super) fn frame(normal: [f64; 3]) -> [[f64; 3]; 3] {
    let n = unit(normal);
    // The axis with the smallest component of the normal.
    let least = (1..3).fold(0, |least, k| if n[k].abs() < n[least].abs() { k } else { least });
    let first = unit(cross(n, std::array::from_fn(|k| if k == least { 1.0 } else { 0.0 })));
    let second = cross(n, first);
    let turned = |a: f64, b: f64| std::array::from_fn(|k| a * first[k] + b * second[k]);
    [n, turned(0.6, 0.8), turned(-0.8, 0.6)]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
}

fn length(a: [f64; 3]) -> f64 {
    a.iter().map(|x| x * x).sum::<f64>().sqrt()
}

fn unit(a: [f64; 3]) -> [f64; 3] {
    let length = length(a);
    a.map(|x| x / length)
}
