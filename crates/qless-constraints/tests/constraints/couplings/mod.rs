/// Averages against dense least squares and exact cases.
mod averages;
/// Beams on solids: motions, resultants, stress.
mod beams;
/// Rigid bodies: component lists, planar frames, finite rotations.
mod bodies;
/// Faces of solids to couple with.
mod faces;
/// Walls of fluids.
mod fluid;
/// Components along local axes.
mod local;
/// Couplings that say things twice.
mod overlaps;
/// Shells on solids: motions, resultants, stress.
mod shells;
/// Nodes and DOFs that are named twice.
mod twice;
/// What the nodes of an average do not see.
mod undetermined;

use std::array::from_fn;

use faer::Mat;
use qless_constraints::types::{Component, Node6};
use qless_constraints::{Constraint, ConstraintSet};

use crate::common::{Outcome, random, rank};

/// A set of one constraint.
fn only<C: Constraint>(dofs: usize, constraint: C) -> ConstraintSet {
    let mut builder = ConstraintSet::builder(dofs);
    builder.add("it", constraint).unwrap_or_else(|error| panic!("{error}"));
    builder.build().expect("few DOFs")
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    from_fn(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
}

/// A rotation matrix by rows, from random Euler parameters.
fn frame(seed: usize) -> [[f64; 3]; 3] {
    let p: [f64; 4] = from_fn(|k| random(977 * seed + k + 5000));
    let size = p.iter().map(|x| x * x).sum::<f64>().sqrt();
    let [w, x, y, z] = p.map(|x| x / size);
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
}

fn turned(r: [[f64; 3]; 3], x: [f64; 3]) -> [f64; 3] {
    from_fn(|i| (0..3).map(|k| r[i][k] * x[k]).sum())
}

/// A coupling has this many independent equations, rigid motions pass, and its forces have no resultant.
fn assert_joined(
    name: &str,
    set: &ConstraintSet,
    equations: usize,
    nodes: &[Node6],
    [scale, far]: [f64; 2],
) -> Outcome {
    let rest = vec![0.0; set.dofs()];
    assert_eq!((set.equations(), svd_rank(set), rank(set, &rest)?), (equations, equations, equations), "{name}");
    let u = rigid(set.dofs(), nodes, [scale, -scale, 2.0 * scale], [0.3, -0.2, 0.5]);
    let tolerance = 1e-13 * (1.0 + far / 100.0);
    assert!(relative_residual(set, &u) < tolerance, "{name}");
    assert_balanced(set, nodes, tolerance);
    Ok(())
}

/// A node whose six DOFs start at `6 i`.
fn node(i: usize, at: [f64; 3]) -> Node6 {
    Node6::new(from_fn(|k| 6 * i + k), from_fn(|k| 6 * i + 3 + k), at)
}

/// The node with the components of a bit mask.
fn masked(node: Node6, mask: usize) -> Node6 {
    node.only(
        Component::ALL.into_iter().enumerate().filter(|(k, _)| mask >> k & 1 == 1).map(|(_, component)| component),
    )
}

/// The displacements of a rigid motion about the origin, of nodes that have the DOFs.
fn rigid(dofs: usize, nodes: &[Node6], shift: [f64; 3], theta: [f64; 3]) -> Vec<f64> {
    let mut u = vec![0.0; dofs];
    for node in nodes {
        let turn = cross(theta, node.at);
        for k in 0..3 {
            node.dofs[k].into_iter().for_each(|dof| u[dof] = shift[k] + turn[k]);
            node.dofs[3 + k].into_iter().for_each(|dof| u[dof] = theta[k]);
        }
    }
    u
}

fn values(set: &ConstraintSet, u: &[f64]) -> Vec<f64> {
    let mut evaluation = set.allocate();
    set.evaluate(u, &mut evaluation).expect("of this set");
    evaluation.c().to_vec()
}

/// The largest `|c_r|` over what its terms add up to in size.
fn relative_residual(set: &ConstraintSet, u: &[f64]) -> f64 {
    let g = set.allocate().g().clone();
    let size = |row: usize| g.row(row).map(|(dof, a)| (a * u[dof]).abs()).sum::<f64>();
    let c = values(set, u);
    (0..c.len()).map(|row| c[row].abs() / size(row).max(f64::MIN_POSITIVE)).fold(0.0, f64::max)
}

fn dense(set: &ConstraintSet) -> Mat<f64> {
    let g = set.allocate().g().clone();
    let mut dense = Mat::zeros(set.equations(), set.dofs());
    (0..set.equations()).for_each(|row| g.row(row).for_each(|(dof, value)| dense[(row, dof)] = value));
    dense
}

/// By a dense SVD, columns and then rows of length one, whatever their units; there must be a clear gap.
fn svd_rank(set: &ConstraintSet) -> usize {
    let mut g = dense(set);
    for column in 0..g.ncols() {
        let size = (0..g.nrows()).map(|k| g[(k, column)].powi(2)).sum::<f64>().sqrt().max(1e-100);
        (0..g.nrows()).for_each(|k| g[(k, column)] /= size);
    }
    for row in 0..g.nrows() {
        let size = (0..g.ncols()).map(|k| g[(row, k)].powi(2)).sum::<f64>().sqrt();
        (0..g.ncols()).for_each(|k| g[(row, k)] /= size);
    }
    let values = g.as_ref().singular_values().expect("finite");
    let rank = values.iter().filter(|&&s| s > 1e-6).count();
    assert!(values.iter().all(|&s| !(1e-12..=1e-6).contains(&s)), "no gap: {values:?}");
    rank
}

/// Forces `G^T lambda` of random multipliers have no resultant: moments about the origin, relative to what adds up.
fn assert_balanced(set: &ConstraintSet, nodes: &[Node6], tolerance: f64) {
    let lambda: Vec<f64> = (0..set.equations()).map(|row| random(row + 77)).collect();
    let (g, mut forces) = (dense(set), vec![0.0; set.dofs()]);
    (0..set.dofs()).for_each(|k| forces[k] = (0..set.equations()).map(|row| g[(row, k)] * lambda[row]).sum());
    let (mut force, mut moment, mut sizes) = ([0.0; 3], [0.0; 3], [0.0, 0.0]);
    for node in nodes {
        let of = |k: usize| node.dofs[k].map_or(0.0, |dof| forces[dof]);
        let (f, m): ([f64; 3], [f64; 3]) = (from_fn(of), from_fn(|k| of(3 + k)));
        let lever = cross(node.at, f);
        for k in 0..3 {
            force[k] += f[k];
            moment[k] += lever[k] + m[k];
            let arm = node.at.iter().map(|x| x.abs()).sum::<f64>();
            sizes = [sizes[0] + f[k].abs(), sizes[1] + arm * f[k].abs() + m[k].abs()];
        }
    }
    assert!(force.iter().all(|f| f.abs() <= tolerance * sizes[0]), "{force:?} of {}", sizes[0]);
    assert!(moment.iter().all(|m| m.abs() <= tolerance * sizes[1]), "{moment:?} of {}", sizes[1]);
    assert!(sizes[0] > 0.0);
}

/// What of a node is seen of a motion `(v, theta)` about the reference.
fn row(component: usize, r: [f64; 3]) -> [f64; 6] {
    from_fn(|j| {
        let unit: [f64; 3] = from_fn(|k| f64::from(u8::from(k == j % 3)));
        let motion = if j < 3 { unit } else { cross(unit, r) };
        if component < 3 { motion[component] } else { f64::from(u8::from(j == component)) }
    })
}

fn cloud(seed: usize, count: usize, scale: f64, centre: [f64; 3]) -> Vec<Node6> {
    let at = |i: usize| from_fn(|k| centre[k] + scale * random(100 * seed + 3 * i + k));
    (0..count).map(|i| node(i, at(i))).collect()
}
