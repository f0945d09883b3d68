//! Random constraints that can be built for two sets.

use std::array::from_fn;

use qless_constraints::types::{
    Body, Distance, Driven, Equal, Fixed, Line, LinearEquation, OnLine, OnPlane, Plane, Point, Prescribed, RigidBody,
    Spherical,
};
use qless_constraints::{ConstraintId, ConstraintSet, SetBuilder};

use crate::common::Outcome;

/// Numbers that look random, the same in every run.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 33
    }

    pub fn below(&mut self, count: usize) -> usize {
        (self.next() % count as u64) as usize
    }

    /// A number in [-0.5, 0.5].
    pub fn number(&mut self) -> f64 {
        self.next() as f64 / f64::from(u32::MAX >> 1) - 0.5
    }
}

/// The data of a constraint, from which it can be built again.
#[derive(Clone, Copy)]
pub struct Recipe {
    pub kind: usize,
    pub node: usize,
    pub other: usize,
    pub number: f64,
}

pub const KINDS: usize = 9;
/// Translations and rotations of a node.
pub const DOFS: usize = 6;

pub fn point(node: usize) -> Point {
    // Some have DOFs that do not ascend.
    let dofs = from_fn(|k| DOFS * node + if node.is_multiple_of(5) { 2 - k } else { k });
    Point::new(dofs, [node as f64, (node * node % 7) as f64, (node % 3) as f64])
}

/// The node as a body.
fn body(node: usize) -> Body {
    let Point { dofs, at } = point(node);
    Body::with_vector(dofs, at, dofs.map(|dof| dof + 3))
}

impl Recipe {
    pub fn random(random: &mut Random, nodes: usize) -> Self {
        let node = random.below(nodes - 4);
        // Most use neighbouring nodes, some distant ones.
        let far = if random.below(8) == 0 { random.below(nodes - 4) } else { node + 1 + random.below(3) };
        let other = if far == node { node + 1 } else { far };
        Self { kind: random.below(KINDS), node, other, number: random.number() }
    }

    pub fn add(&self, label: &str, set: &mut impl Target) -> Outcome<ConstraintId> {
        let (a, b, number) = (point(self.node), point(self.other), self.number);
        let third = point(if self.other == self.node + 1 { self.node + 2 } else { self.node + 1 });
        match self.kind {
            0 => set.put(label, Distance { length: Some(2.0 + number), ..Distance::new(a, b) }),
            1 => set.put(label, LinearEquation { terms: vec![(a.dofs[0], 1.0), (b.dofs[1], number)], rhs: number }),
            2 => set.put(label, Equal::new([a.dofs[1], b.dofs[1], third.dofs[1]])),
            3 => set.put(label, Prescribed { values: vec![(a.dofs[0], number), (b.dofs[2], 2.0 * number)] }),
            4 => set.put(label, Driven::new([(a.dofs[2], 1.0)], move |t| number * t)),
            5 => set.put(label, OnLine { point: a, line: Line::Nodes(b, third) }),
            6 => set.put(
                label,
                OnPlane { point: a, plane: Plane::Fixed { through: [number; 3], normal: [1.0, 2.0, number] } },
            ),
            7 => set.put(label, RigidBody { body: body(self.node), nodes: vec![b.into()] }),
            _ => {
                let body = body(self.node);
                let joint = Spherical { a: body, b: Body::node(b), at: b.at };
                if number > 0.3 {
                    set.put(label, Fixed { a: body, b: Body::ground(), at: [number; 3] })
                } else {
                    set.put(label, joint)
                }
            }
        }
    }
}

/// A set or its builder, or a constraint to be replaced.
pub trait Target {
    fn put<C: qless_constraints::Constraint>(&mut self, label: &str, constraint: C) -> Outcome<ConstraintId>;
}

impl Target for SetBuilder {
    fn put<C: qless_constraints::Constraint>(&mut self, label: &str, constraint: C) -> Outcome<ConstraintId> {
        Ok(self.add(label, constraint)?)
    }
}

impl Target for ConstraintSet {
    fn put<C: qless_constraints::Constraint>(&mut self, label: &str, constraint: C) -> Outcome<ConstraintId> {
        Ok(self.add(label, constraint)?)
    }
}

impl Target for (&mut ConstraintSet, ConstraintId) {
    fn put<C: qless_constraints::Constraint>(&mut self, _: &str, constraint: C) -> Outcome<ConstraintId> {
        self.0.replace(self.1, constraint)?;
        Ok(self.1)
    }
}
