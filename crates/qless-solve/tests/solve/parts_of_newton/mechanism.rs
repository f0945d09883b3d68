//! Mechanisms as lists of constraints on their own DOFs, alone or side by side in one set.

use qless_constraints::types::{
    Body, Distance, Driven, Equal, Fixed, Line, LinearEquation, OnLine, OnSphere, PlanarPoint, Point, Revolute,
    RotationMotor,
};
use qless_constraints::{ConstraintSet, SetBuilder};

use crate::dead_centres::SliderCrank;
use crate::linkages::Outcome;
use crate::poses::Vector;

/// A node in the plane or in space: its first DOF and its position.
pub type Planar = (usize, [f64; 2]);
pub type Spatial = (usize, Vector);

/// Constraints, in the order in which their types enter a set.
#[derive(Clone, Debug)]
pub enum Item {
    Linear(Vec<(usize, f64)>, f64),
    Equal([usize; 2]),
    Arm(Planar, [f64; 2], Option<f64>),
    Rod([Planar; 2], Option<f64>),
    Ball(Spatial, Vector, f64),
    Crank([usize; 2], [f64; 2]),
    Bead([Spatial; 3]),
    Weld(Spatial),
    Hinge(Spatial, Vector),
    Motor(Spatial, Vector, f64),
    /// `u_j = v t`.
    Drive(usize, f64),
}

#[derive(Clone, Debug, Default)]
pub struct Mechanism {
    pub items: Vec<Item>,
    pub start: Vec<f64>,
    pub held: Vec<(usize, f64)>,
}

impl Mechanism {
    /// Makes the first DOF follow a new last one, which is prescribed. If no node has it as a coordinate, it is the last one itself.
    pub fn driven(mut self, value: f64, itself: bool) -> Self {
        let (drive, follows) = (self.start.len(), self.held.remove(0).1);
        self.start.push(value);
        self.held.push((drive, value));
        for item in self.items.iter_mut().filter(|_| itself) {
            if let Item::Crank(dofs, _) = item {
                dofs.iter_mut().filter(|j| **j == 0).for_each(|j| *j = drive);
            }
        }
        self.items.insert(0, Item::Linear(vec![(0, 1.0), (drive, -follows / value)], 0.0));
        self
    }
}

/// The DOFs of a mechanism in a set.
pub type Map = Vec<usize>;

impl Item {
    fn kind(&self) -> usize {
        match self {
            Self::Linear(..) => 0,
            Self::Equal(_) => 1,
            Self::Arm(..) => 2,
            Self::Rod(..) => 3,
            Self::Ball(..) => 4,
            Self::Crank(..) => 5,
            Self::Bead(_) => 6,
            Self::Weld(_) => 7,
            Self::Hinge(..) => 8,
            Self::Motor(..) => 9,
            Self::Drive(..) => 10,
        }
    }

    fn add(&self, builder: &mut SetBuilder, label: String, map: &Map) -> Outcome {
        let planar = |(j, at): Planar| PlanarPoint::new([map[j], map[j + 1]], at);
        let spatial = |(j, at): Spatial| Point::new(std::array::from_fn(|k| map[j + k]), at);
        let position = |j: usize| std::array::from_fn(|k| map[j + k]);
        let body = |(j, at): Spatial| Body::with_vector(position(j), at, position(j + 3));
        match self.clone() {
            Self::Linear(terms, rhs) => {
                let terms = terms.into_iter().map(|(j, v)| (map[j], v)).collect();
                builder.add(label, LinearEquation { terms, rhs })?
            }
            Self::Equal(dofs) => builder.add(label, Equal::new(dofs.map(|j| map[j])))?,
            Self::Arm(node, centre, radius) => builder.add(label, OnSphere { point: planar(node), centre, radius })?,
            Self::Rod([a, b], length) => builder.add(label, Distance { a: planar(a), b: planar(b), length })?,
            Self::Ball(node, centre, radius) => {
                builder.add(label, OnSphere { point: spatial(node), centre, radius: Some(radius) })?
            }
            Self::Crank(dofs, [crank, rod]) => {
                builder.add(label, SliderCrank { dofs: dofs.map(|j| map[j]), crank, rod })?
            }
            Self::Bead([p, a, b]) => {
                let line = Line::Nodes(spatial(a), spatial(b));
                builder.add(label, OnLine { point: spatial(p), line })?
            }
            Self::Weld(node) => builder.add(label, Fixed { a: Body::ground(), b: body(node), at: node.1 })?,
            Self::Hinge(node, axis) => {
                builder.add(label, Revolute { a: Body::ground(), b: body(node), at: node.1, axis })?
            }
            Self::Motor(node, axis, angle) => {
                builder.add(label, RotationMotor::new(Body::ground(), body(node), axis, move |_| angle))?
            }
            Self::Drive(dof, value) => builder.add(label, Driven::new([(map[dof], 1.0)], move |t| value * t))?,
        };
        Ok(())
    }
}

/// All mechanisms in one set. The rows of one type are mixed by `seed`; those of one mechanism keep their order.
///
/// Labels name the mechanism by `names`.
pub fn set(dofs: usize, all: &[(&Mechanism, &Map)], names: &[usize], seed: usize) -> Outcome<ConstraintSet> {
    let mut items: Vec<(usize, usize)> = Vec::new();
    for (m, (mechanism, _)) in all.iter().enumerate() {
        items.extend((0..mechanism.items.len()).map(|i| (m, i)));
    }
    // Along a mechanism the position grows by its own increment.
    let place = |(m, i): (usize, usize)| i * (1 + (seed + 3 * m) % 5) + (seed + m) % 3;
    let item = |(m, i): (usize, usize)| &all[m].0.items[i];
    items.sort_by_key(|&at| (item(at).kind(), place(at)));
    let mut builder = ConstraintSet::builder(dofs);
    for at in items {
        item(at).add(&mut builder, format!("{}: {}", names[at.0], at.1), all[at.0].1)?;
    }
    Ok(builder.build()?)
}
