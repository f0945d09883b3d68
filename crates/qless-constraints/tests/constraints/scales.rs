use std::array::from_fn;

use qless_constraints::types::{
    Average, BeamToSolid, Body, Component, Cylindrical, Distance, Face, Fixed, FluidNode, FluidWall, Line, LineTie,
    MortarTie, Multipliers, Node6, NodeTie, OnLine, OnPlane, OnSphere, Planar, Plane, Point, Prismatic, Revolute,
    RigidBody, Section, Shape, ShellToSolid, SmallRigidBody, Spherical, Surface, ThicknessLine, TranslationMotor,
    Universal, Volume,
};
use qless_constraints::{Constraint, ConstraintSet};

use crate::common::random;

const DOFS: usize = 48;

/// A model of one constraint; none if it is refused.
fn model<C: Constraint>(found: &mut Vec<(&'static str, Option<ConstraintSet>)>, constraint: C) {
    let mut builder = ConstraintSet::builder(DOFS);
    let taken = builder.add("it", constraint).is_ok();
    found.push((C::NAME, taken.then(|| builder.build().expect("few DOFs"))));
}

fn place(unit: f64, at: [f64; 3]) -> [f64; 3] {
    at.map(|x| unit * x)
}

fn point(i: usize, unit: f64) -> Point {
    Point::new(from_fn(|k| 6 * i + k), place(unit, from_fn(|k| 2.0 * random(7 * i + k + 3))))
}

fn node(i: usize, unit: f64) -> Node6 {
    Node6::new(point(i, unit).dofs, from_fn(|k| 6 * i + 3 + k), point(i, unit).at)
}

fn square(first: usize, unit: f64, height: f64) -> Surface<3> {
    let at = [[0.0, 0.0], [1.0, 0.0], [1.25, 1.0], [0.0, 1.0]];
    let corner = |k: usize| Point::new(from_fn(|d| 6 * (first + k) + d), place(unit, [at[k][0], at[k][1], height]));
    Surface { nodes: (0..4).map(corner).collect(), faces: vec![Face::new(Shape::Quad4, [0, 1, 2, 3])] }
}

fn points_and_joints(found: &mut Vec<(&'static str, Option<ConstraintSet>)>, unit: f64) {
    let (one, of, at) = (point(0, unit), |i| point(i, unit), place(unit, [0.25, 0.5, -0.125]));
    let (a, b) = (Body::with_vector(one.dofs, one.at, [3, 4, 5]), Body::with_vector(of(1).dofs, of(1).at, [9, 10, 11]));
    let axis = [1.0, 2.0, -1.0];
    model(found, Distance::new(one, of(1)));
    model(found, Distance { length: Some(0.75 * unit), ..Distance::new(one, of(1)) });
    model(found, OnSphere { point: one, centre: at, radius: None });
    model(found, OnPlane { point: one, plane: Plane::Nodes(of(1), of(2), of(3)) });
    model(found, OnPlane { point: one, plane: Plane::Fixed { through: at, normal: axis } });
    model(found, OnLine { point: one, line: Line::Nodes(of(1), of(2)) });
    let corner = |k: usize| Point {
        at: place(unit, [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.25, 0.0, 1.0]][k]),
        ..of(k)
    };
    model(found, Volume { nodes: (0..4).map(corner).collect(), tetrahedra: vec![[0, 1, 2, 3]] });
    model(found, Spherical { a, b, at });
    model(found, Fixed { a, b, at });
    model(found, Revolute { a, b, at, axis });
    model(found, Prismatic { a, b, at, axis });
    model(found, Cylindrical { a, b, at, axis });
    model(found, Planar { a, b, at, normal: axis });
    model(found, Universal { a, b, at, axis_a: axis, axis_b: [1.0, 0.0, 1.0] });
    model(found, TranslationMotor::new(a, b, at, axis, move |_| 0.25 * unit));
    model(found, RigidBody { body: a, nodes: vec![node(1, unit), node(2, unit)] });
    model(found, RigidBody { body: a, nodes: vec![node(1, unit).only([Component::X, Component::Z])] });
}

fn couplings_and_ties(found: &mut Vec<(&'static str, Option<ConstraintSet>)>, unit: f64) {
    let (reference, solid) = (node(0, unit), |i| Node6::from(point(i, unit)));
    model(found, SmallRigidBody { reference, nodes: vec![node(1, unit), solid(2)] });
    model(found, Average { reference, nodes: (1..5).map(|i| (solid(i), i as f64)).collect() });
    let beam = Node6 { at: place(unit, [0.5, 0.25, 0.125]), ..reference };
    let shell = |i: usize| Node6 { at: place(unit, [i as f64, 0.5, 0.0]), ..node(i, unit) };
    for section in [Section::Rigid, Section::Plane, Section::Mean] {
        model(found, BeamToSolid { beam, face: square(2, unit, 0.0), section });
        let lines =
            [(0, [0, 3]), (1, [1, 2])].map(|(i, nodes)| ThicknessLine { shell: shell(i), nodes: nodes.to_vec() });
        model(found, ShellToSolid { lines: lines.to_vec(), face: square(2, unit, 0.0), section });
    }
    let fluid = [[0.25, 0.25], [0.75, 0.25], [0.25, 0.75]].map(|[x, y]| place(unit, [x, y, 0.0]));
    let fluid = (0..3).map(|i| FluidNode { normal: i, at: fluid[i] }).collect();
    let faces = vec![Face::new(Shape::Tri3, [0, 1, 2])];
    model(found, FluidWall { structure: square(2, unit, 0.0), fluid, faces, tolerance: 0.125 * unit });
    let tied = Point { at: place(unit, [0.5, 0.25, 0.0]), ..point(0, unit) };
    let tolerance = 0.125 * unit;
    model(found, NodeTie { node: tied, shape: Shape::Quad4, face: square(2, unit, 0.0).nodes, tolerance });
    let master = square(2, unit, 0.0).nodes[..2].to_vec();
    let slave = vec![Point { at: place(unit, [0.5, 0.0, 0.0]), ..tied }];
    model(found, LineTie { slave, master, tolerance });
    for multipliers in [Multipliers::Standard, Multipliers::Dual] {
        let (slave, master) = (square(0, unit, 0.0), square(4, unit, 0.0625));
        model(found, MortarTie { slave, master, multipliers, tolerance });
    }
}

/// c, G and the sum of the Hessians, with translations in the unit of the model.
fn numbers(set: &ConstraintSet, unit: f64) -> [Vec<f64>; 3] {
    let u: Vec<f64> = (0..DOFS).map(|k| 0.5 * random(k + 900) * if k / 3 % 2 == 0 { unit } else { 1.0 }).collect();
    let mut evaluation = set.allocate();
    set.evaluate(&u, &mut evaluation).expect("of this set");
    // Lengths are in the unit and angles are not, so that sums in H have one unit.
    let is_length = |row: usize| evaluation.g().row(row).any(|(dof, a)| dof / 3 % 2 == 0 && a != 0.0);
    let weights: Vec<f64> = (0..set.equations()).map(|row| if is_length(row) { 1.0 / unit } else { 1.0 }).collect();
    set.effective_hessian(&u, &weights, &mut evaluation).expect("of this set");
    [evaluation.c().to_vec(), evaluation.g().values().to_vec(), evaluation.h().values().to_vec()]
}

/// In a unit that is a power of two, every value equals that of the unit one times a power of it, or the model is refused. No value becomes
/// infinite, NaN or zero. All units in practical use are accepted.
#[test]
fn units_do_not_matter_or_are_refused() {
    let all = |unit: f64| {
        let mut found = Vec::new();
        points_and_joints(&mut found, unit);
        couplings_and_ties(&mut found, unit);
        found
    };
    let truth = all(1.0);
    assert!(
        truth.len() > 28 && truth.iter().all(|(_, set)| set.is_some()),
        "{:?}",
        truth.iter().map(|t| t.0).collect::<Vec<_>>()
    );
    for exponent in [-1000, -660, -500, -340, -200, -100, -20, 20, 100, 200, 340, 500, 660, 1000] {
        let unit = 2.0_f64.powi(exponent);
        for ((name, set), (_, one)) in all(unit).iter().zip(&truth) {
            assert!(set.is_some() || exponent.abs() > 100, "{name} is refused in units of 2^{exponent}");
            let (Some(set), Some(one)) = (set, one) else { continue };
            for (what, (found, one)) in numbers(set, unit).iter().zip(&numbers(one, 1.0)).enumerate() {
                assert_eq!(found.len(), one.len(), "{name} has another pattern in units of 2^{exponent}");
                for (found, one) in found.iter().zip(one) {
                    let is = |power: i32| (found - one * unit.powi(power)).abs() <= 1e-9 * found.abs();
                    let known = (-2..=3).any(is) || (found.abs() < 1e-14 * unit.max(1.0) && one.abs() < 1e-14);
                    // An integral of a displacement over an area may be out of range in this unit; it is then refused.
                    let beyond = !found.is_finite() && !unit.powi(3).is_finite();
                    assert!(known || beyond, "{name}, {what}, 2^{exponent}: {found:e} for {one:e}");
                }
            }
        }
    }
}
