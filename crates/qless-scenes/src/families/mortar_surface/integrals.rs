//! `D_ij = int N_i N_j dA`, `M_ik = int N_i P_k dA` and `n_i = int N_i n dA` by nine Gauss points per slave face.

use super::frame::{cross, length};
use crate::families::mortar::gauss;
use crate::families::patch::{Locator, PatchFace};

/// Integrals of the functions of a slave node.
#[derive(Clone, Default)]
pub(super) struct IntegralsRow {
    /// With those of slave nodes: `(node, integral)`.
    pub(super) slave: Vec<(usize, f64)>,
    /// With those of master nodes.
    pub(super) master: Vec<(usize, f64)>,
    /// The area of the node times its normal.
    pub(super) normal: [f64; 3],
}

/// One side: faces, places of nodes in the square, and in space.
pub(super) struct Side {
    pub(super) faces: Vec<PatchFace>,
    pub(super) square: Vec<[f64; 2]>,
    pub(super) space: Vec<[f64; 3]>,
}

/// Each point of a slave face sees the master face over the same `(s, t)`. Both integrals take the same points, so that
/// rows of D and of M have the same sum.
pub(super) fn rows(slave: &Side, master: &Side) -> Vec<IntegralsRow> {
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
    slave: &Side,
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

/// Rows are short.
fn add(row: &mut Vec<(usize, f64)>, column: usize, part: f64) {
    match row.iter_mut().find(|entry| entry.0 == column) {
        Some(entry) => entry.1 += part,
        None => row.push((column, part)),
    }
}

/// Parameters and weights; those of a triangle are the square's with one side drawn together to a point.
fn points(face: &PatchFace) -> impl Iterator<Item = ([f64; 2], f64)> {
    let triangle = matches!(face, PatchFace::Triangle(_));
    let all = gauss().into_iter().flat_map(|(x, v)| gauss().map(|(y, w)| ([x, y], v * w)));
    all.map(move |([x, y], w)| if triangle { ([x * (1.0 - y), y], w * (1.0 - y)) } else { ([x, y], w) })
}
