//! A set with every nonlinear type, both parametrisations of rotations, and DOFs in ascending and other orders.

use std::array::from_fn;

use crate::types::{
    Body, Component, Cylindrical, Distance, Fixed, Line, Node6, OnLine, OnPlane, OnSphere, Parallel, Perpendicular,
    Planar, PlanarPoint, Plane, Point, Prismatic, Revolute, RigidBody, RotationMotor, SmallRigidBody, Spherical,
    TranslationMotor, Universal, Volume,
};
use crate::{ConstraintSet, SetBuilder};

pub const DOFS: usize = 100;

/// A pseudorandom number in [-0.5, 0.5].
pub fn random(seed: u64) -> f64 {
    let z = (seed + 7).wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(31).wrapping_mul(0xD6E8_FEB8_6659_FD93);
    f64::from((z ^ (z >> 32)) as u32) / f64::from(u32::MAX) - 0.5
}

/// DOFs that are rotations; the others are lengths.
pub const ROTATIONS: [std::ops::RangeInclusive<usize>; 3] = [33..=35, 39..=42, 46..=52];

/// The unit of length, and the distance of the model from the origin in that unit.
#[derive(Clone, Copy, Debug)]
pub struct UnitAndShift {
    pub unit: f64,
    pub shift: f64,
}

impl UnitAndShift {
    fn at<const D: usize>(self, x: [f64; D]) -> [f64; D] {
        x.map(|x| self.unit * (self.shift + x))
    }

    fn point(self, node: usize) -> Point {
        Point::new(from_fn(|k| 3 * node + k), self.at(from_fn(|k| 3.0 * random((31 * node + k) as u64))))
    }

    /// A node whose DOFs descend.
    fn reversed(self, node: usize) -> Point {
        Point::new(from_fn(|k| 3 * node + 2 - k), self.at(from_fn(|k| 3.0 * random((31 * node + 2 - k) as u64))))
    }
}

pub fn set() -> Result<ConstraintSet, Box<dyn std::error::Error>> {
    set_at(UnitAndShift { unit: 1.0, shift: 0.0 })
}

pub fn set_at(place: UnitAndShift) -> Result<ConstraintSet, Box<dyn std::error::Error>> {
    let mut builder = ConstraintSet::builder(DOFS);
    points(&mut builder, place)?;
    let vector = Body::with_vector([30, 31, 32], place.at([0.4, 0.1, -0.3]), [33, 34, 35]);
    let euler = Body::with_euler([36, 37, 38], place.at([-0.2, 0.5, 0.3]), [39, 40, 41, 42]);
    let other = Body::with_euler([43, 44, 45], place.at([0.3, -0.6, 0.1]), [49, 48, 47, 46]);
    builder.add("rigid", RigidBody { body: euler, nodes: vec![place.point(1).into(), place.reversed(2).into()] })?;
    builder.add("link", RigidBody { body: vector, nodes: vec![place.point(0).into()] })?;
    let some = [Component::Z, Component::X];
    let part = |node: Point| Node6::from(node).only(some);
    builder.add("guides", RigidBody { body: vector, nodes: vec![part(place.point(1)), part(place.reversed(2))] })?;
    builder.add("guide", RigidBody { body: euler, nodes: vec![part(place.reversed(4))] })?;
    let shell = Node6::new(place.point(7).dofs, [52, 50, 51], place.point(7).at);
    builder.add("clamp", RigidBody { body: euler, nodes: vec![shell] })?;
    builder.add("clamps", RigidBody { body: vector, nodes: vec![shell, part(place.point(2))] })?;
    for (a, b) in [(vector, euler), (euler, other), (Body::ground(), vector), (other, Body::ground())] {
        joints(&mut builder, place, a, b)?;
    }
    builder.add("hook", Spherical { a: Body::node(place.point(4)), b: euler, at: place.at([0.1, 0.2, 0.3]) })?;
    Ok(builder.build().expect("few DOFs"))
}

fn points(builder: &mut SetBuilder, place: UnitAndShift) -> Result<(), Box<dyn std::error::Error>> {
    let (point, reversed) = (|node| place.point(node), |node| place.reversed(node));
    builder.add("rod", Distance::new(point(0), point(1)))?;
    builder.add("long rod", Distance { a: reversed(5), b: point(2), length: Some(4.0 * place.unit) })?;
    let planar = |node: usize| PlanarPoint::new([80 + 2 * node, 81 + 2 * node], place.at([random(node as u64), 1.0]));
    builder.add("planar rod", Distance::new(planar(3), planar(9)))?;
    builder.add(
        "ball",
        OnSphere { point: reversed(3), centre: place.at([0.1, 0.2, 0.3]), radius: Some(2.0 * place.unit) },
    )?;
    builder.add("circle", OnSphere { point: planar(3), centre: place.at([0.0; 2]), radius: None })?;
    builder.add("line", OnLine { point: point(6), line: Line::Nodes(reversed(1), point(4)) })?;
    builder.add("plane", OnPlane { point: point(7), plane: Plane::Nodes(point(8), reversed(2), point(5)) })?;
    let corner = |k: usize| Point { at: place.at(from_fn(|axis| f64::from(k as u32 >> axis & 1))), ..point(18 + k) };
    let nodes = vec![corner(0), corner(1), corner(2), corner(4), corner(7)];
    builder.add("volume", Volume { nodes, tetrahedra: vec![[0, 1, 2, 3], [1, 4, 2, 3]] })?;
    let single = [0, 1, 2, 4].map(|k| Point { at: corner(k).at, ..point(18 + k) }).to_vec();
    builder.add("cell", Volume { nodes: single, tetrahedra: vec![[0, 1, 2, 3]] })?;
    let reference = Node6::new(point(0).dofs, [50, 51, 52], point(0).at);
    builder.add("small", SmallRigidBody { reference, nodes: vec![point(2).into()] })?;
    Ok(())
}

fn joints(builder: &mut SetBuilder, place: UnitAndShift, a: Body, b: Body) -> Result<(), Box<dyn std::error::Error>> {
    let (at, axis) = (place.at([0.2, 0.3, -0.1]), [1.0, 2.0, -1.0]);
    builder.add("ball joint", Spherical { a, b, at })?;
    builder.add("hinge", Revolute { a, b, at, axis })?;
    builder.add("slider", Prismatic { a, b, at, axis })?;
    builder.add("cardan", Universal { a, b, at, axis_a: axis, axis_b: [1.0, 0.0, 1.0] })?;
    builder.add("weld", Fixed { a, b, at })?;
    builder.add("sleeve", Cylindrical { a, b, at, axis })?;
    builder.add("plate", Planar { a, b, at, normal: axis })?;
    builder.add("parallel", Parallel { a, b, axis })?;
    builder.add("motor", RotationMotor::new(a, b, axis, |_| 4.0))?;
    builder.add("ram", TranslationMotor::new(a, b, at, axis, |_| 0.3))?;
    builder.add("square", Perpendicular { a, b, axis_a: axis, axis_b: [2.0, 0.0, 2.0] })?;
    Ok(())
}
