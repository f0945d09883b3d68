//! Sets of a million constraints, of one kind or mixed.

#![allow(dead_code, reason = "each benchmark uses some")]

use qless_constraints::types::{
    Body, Distance, Equal, LinearEquation, Node6, NodeTie, OnSphere, Point, RigidBody, Shape, SmallRigidBody, Spherical,
};
use qless_constraints::{ConstraintSet, SetBuilder};

/// A node; DOFs follow the order of a mesh, so that neighbours are close in memory but not adjacent.
pub fn point(node: usize) -> Point {
    let line = 100;
    let at = [(node % line) as f64, (node / line % line) as f64, (node / line / line) as f64];
    Point::new([3 * node, 3 * node + 1, 3 * node + 2], at)
}

/// The node as a body, whose rotation follows the displacements of all nodes.
fn body(node: usize, nodes: usize) -> Body {
    let Point { dofs, at } = point(node);
    Body::with_vector(dofs, at, dofs.map(|dof| 3 * nodes + dof))
}

/// A function that adds constraint i.
pub type Add = fn(&mut SetBuilder, usize, usize);

pub fn one_linear(i: usize, nodes: usize) -> LinearEquation {
    let dof = |k: usize| 3 * ((i + 7 * k) % nodes) + k % 3;
    LinearEquation { terms: (0..5).map(|k| (dof(k), 1.0 + k as f64)).collect(), rhs: 1.0 }
}

pub fn linear(builder: &mut SetBuilder, i: usize, nodes: usize) {
    builder.add("", one_linear(i, nodes)).expect("valid");
}

pub fn one_rod(i: usize, nodes: usize) -> Distance<Point> {
    let other = (i + [1, 100, 101, 99][i % 4]) % nodes;
    Distance { length: Some(1.0), ..Distance::new(point(i), point(other)) }
}

pub fn rod(builder: &mut SetBuilder, i: usize, nodes: usize) {
    builder.add("", one_rod(i, nodes)).expect("valid");
}

pub fn sphere(builder: &mut SetBuilder, i: usize, _: usize) {
    builder.add("", OnSphere { point: point(i), centre: [-1.0; 3], radius: Some(2.0) }).expect("valid");
}

pub fn one_equal(i: usize, nodes: usize) -> Equal {
    Equal::new([3 * i + 1, 3 * ((i + 1) % nodes) + 1])
}

pub fn equal(builder: &mut SetBuilder, i: usize, nodes: usize) {
    builder.add("", one_equal(i, nodes)).expect("valid");
}

pub fn tie(builder: &mut SetBuilder, i: usize, nodes: usize) {
    let near = [1, 2, 102, 101].map(|step| (i + step) % nodes);
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let face = near.iter().zip(corners).map(|(&node, at)| Point { at, ..point(node) }).collect();
    let node = Point { at: [0.3, 0.4, 0.0], ..point(i) };
    builder.add("", NodeTie { node, shape: Shape::Quad4, face, tolerance: 0.1 }).expect("valid");
}

pub fn small(builder: &mut SetBuilder, i: usize, nodes: usize) {
    let rotations = point((i + 3) % nodes).dofs;
    let lead = point((i + 2) % nodes);
    let body = SmallRigidBody { reference: Node6::new(lead.dofs, rotations, lead.at), nodes: vec![point(i).into()] };
    builder.add("", body).expect("valid");
}

pub fn finite(builder: &mut SetBuilder, i: usize, nodes: usize) {
    let body = body((i + 1) % nodes, nodes);
    builder.add("", RigidBody { body, nodes: vec![point(i).into()] }).expect("valid");
}

pub fn joint(builder: &mut SetBuilder, i: usize, nodes: usize) {
    let (a, b) = (body(i % nodes, nodes), body((i + 2) % nodes, nodes));
    builder.add("", Spherical { a, b, at: point(i + 2).at }).expect("valid");
}

/// In 100 constraints: 30 linear equations, 25 equal DOFs, 20 rods, 12 ties, 6 spheres, 5 small rigid links, 1 finite one, 1 joint.
pub fn mixed(constraints: usize) -> ConstraintSet {
    let shares: [(usize, Add); 8] =
        [(30, linear), (25, equal), (20, rod), (12, tie), (6, sphere), (5, small), (1, finite), (1, joint)];
    let nodes = constraints / 2 + 200;
    let mut builder = ConstraintSet::builder(6 * nodes);
    for i in 0..constraints {
        let mut lot = i * 37 % 100;
        for (share, add) in shares {
            if lot < share {
                add(&mut builder, i / 2, nodes);
                break;
            }
            lot -= share;
        }
    }
    builder.build().expect("few DOFs")
}

/// Constraints of one kind.
pub fn of_one_kind(constraints: usize, add: Add) -> ConstraintSet {
    let nodes = constraints / 2 + 200;
    let mut builder = ConstraintSet::builder(6 * nodes);
    (0..constraints).for_each(|i| add(&mut builder, i / 2, nodes));
    builder.build().expect("few DOFs")
}
