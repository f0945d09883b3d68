use std::fmt::Debug;

use qless_constraints::types::{
    Average, BeamToSolid, Body, Component, Cyclic, Distance, Equal, Face, FluidNormal, Line, LineTie, LinearEquation,
    MacroStrain, MortarTie, Multipliers, Node, Node6, NodeTie, OnLine, OnPlane, OnSphere, Periodic, PlanarPoint, Plane,
    Prescribed, Revolute, RigidBody, Section, Shape, ShellToSolid, SmallRigidBody, Spherical, Surface, ThicknessLine,
    Turn, Turning, Universal, Volume,
};
use qless_constraints::{Constraint, ConstraintSet};

use crate::common::point;

/// The error of a constraint that must be refused; nothing is stored.
#[track_caller]
fn assert_refused<C: Constraint>(constraint: C, words: &str)
where
    C::Error: Debug,
{
    let mut builder = ConstraintSet::builder(12);
    let message = match builder.add("it", constraint) {
        Ok(_) => "accepted".to_owned(),
        Err(error) => error.to_string(),
    };
    assert!(message.contains(words) && message.contains("\"it\""), "{message}");
    assert_eq!(builder.build().expect("few DOFs").equations(), 0);
}

fn at(node: usize, x: f64) -> PlanarPoint {
    PlanarPoint::new([2 * node, 2 * node + 1], [x, 0.0])
}

#[test]
fn faults_of_any_type() {
    assert_refused(Equal::new([0, 12]), "DOF 12, but there are 12 DOFs");
    assert_refused(LinearEquation { terms: vec![(0, f64::NAN)], rhs: 0.0 }, "NaN");
    assert_refused(Prescribed { values: vec![(0, f64::INFINITY)] }, "inf");
    assert_refused(Distance::new(at(0, 0.0), PlanarPoint::new([1, 2], [1.0, 0.0])), "DOF 1 twice");
    assert_refused(Distance::new(at(0, 0.0), at(7, 1.0)), "DOF 14");
}

#[test]
fn faults_of_linear_types() {
    assert_refused(LinearEquation { terms: vec![], rhs: 1.0 }, "no terms");
    assert_refused(Prescribed { values: vec![] }, "no DOF");
    assert_refused(Prescribed { values: vec![(3, 1.0), (3, 2.0)] }, "DOF 3 is prescribed as 1 and as 2");
    assert_refused(Equal::new([4]), "at least two");
    assert_refused(Equal::new([4, 5, 4]), "DOF 4 is in the list twice");
    let strain = MacroStrain::Given([[0.0; 2]; 2]);
    assert_refused(Periodic { a: at(0, 1.0), b: at(1, 1.0), strain }, "the two nodes coincide");
    assert_refused(FluidNormal { structure: [0, 1, 2], fluid: [3, 4, 5], normal: [0.0; 3] }, "no direction");
    let pair = Cyclic {
        a: point(0, [1.0, 0.0, 0.0]),
        b: point(1, [0.0, 2.0, 0.0]),
        turn: Turn::about([0.0; 3], [0.0, 0.0, 1.0], std::f64::consts::FRAC_PI_2).expect("an axis"),
        fields: Turning::Vectors,
        tolerance: 0.1,
    };
    assert_refused(pair, "1 away from its image");
    let axis = Turn::about([0.0; 3], [0.0; 3], 1.0).expect_err("no axis");
    assert!(axis.to_string().contains("no direction"));
    let [a, b] = [0, 4].map(|first| Node::new([0, 1, 2, 3].map(|k| first + k), [1.0, 0.0, 0.0]));
    let mixed = Cyclic { a, b, turn: pair.turn, fields: Turning::Vectors, tolerance: 9.0 };
    assert_refused(mixed, "4 fields are not vectors of 3 components each");
    let reference = Node6::new([0, 1, 2], [3, 4, 5], [0.0; 3]);
    assert_refused(SmallRigidBody { reference, nodes: vec![] }, "no nodes");
    let inline = [2, 3].map(|i| (point(i, [i as f64, 0.0, 0.0]).into(), 1.0)).to_vec();
    assert_refused(Average { reference, nodes: inline.clone() }, "not determine the rotation x");
    let negative = vec![(inline[0].0, -1.0)];
    assert_refused(Average { reference, nodes: negative }, "weight 1, from 1, is -1");
}

#[test]
fn faults_of_ties() {
    let (node, far) = (at(0, 0.5), PlanarPoint::new([0, 1], [0.5, 2.0]));
    let (shape, face) = (Shape::Line2, vec![at(1, 0.0), at(2, 1.0)]);
    assert_refused(NodeTie { node, shape, face: face[..1].to_vec(), tolerance: 1.0 }, "has 1 nodes; a Line2 has 2");
    assert_refused(NodeTie { node: far, shape, face: face.clone(), tolerance: 1.0 }, "2 away from the face");
    assert_refused(NodeTie { node, shape, face: face.clone(), tolerance: f64::NAN }, "more than the tolerance");
    assert_refused(NodeTie { node, shape, face: vec![at(1, 1.0), at(2, 1.0)], tolerance: 1.0 }, "degenerate");
    assert_refused(
        LineTie { slave: vec![far], master: face.clone(), tolerance: 1.0 },
        "node 1, from 1, is 2 away from the nearest face",
    );
    assert_refused(LineTie { slave: vec![node], master: vec![node], tolerance: 1.0 }, "a line of 1");
    let mortar = |slave: Vec<PlanarPoint>| {
        let [slave, master] = [slave, face.clone()].map(Surface::polyline);
        MortarTie { slave, master, multipliers: Multipliers::Dual, tolerance: 1e-9 }
    };
    assert_refused(mortar(vec![at(3, 0.0)]), "slave side: the surface has no faces");
    assert_refused(
        mortar(vec![at(3, 0.0), at(4, 2.0)]),
        "over 1 of the size 2 of slave facet 1, from 1; no master facet lies",
    );
    assert_refused(mortar(vec![at(3, 0.0), PlanarPoint::new([8, 9], [0.5, 1.0]), at(5, 1.0)]), "tolerance is 0.79");
}

/// A square of length 1 at a height, from `x`.
fn square(x: f64, height: f64) -> Surface<3> {
    let corners = [[x, 0.0, height], [x + 1.0, 0.0, height], [x + 1.0, 1.0, height], [x, 1.0, height]];
    let nodes = corners.iter().enumerate().map(|(i, &at)| point(i, at)).collect();
    Surface { nodes, faces: vec![Face::new(Shape::Quad4, [0, 1, 2, 3])] }
}

#[test]
fn faults_of_surface_mortar_ties() {
    let tie = |slave: Surface<3>, master: Surface<3>, tolerance: f64| MortarTie {
        slave,
        master,
        multipliers: Multipliers::Standard,
        tolerance,
    };
    let with = |faces: Vec<Face>| Surface { faces, ..square(0.0, 0.0) };
    let face = |shape: Shape, nodes: &[usize]| with(vec![Face::new(shape, nodes)]);
    let whole = || square(0.0, 0.0);
    assert_refused(tie(with(vec![]), whole(), 0.1), "slave side: the surface has no faces");
    assert_refused(tie(whole(), face(Shape::Quad4, &[0, 1, 2]), 0.1), "master side: face 1, from 1, has 3 nodes");
    assert_refused(tie(whole(), face(Shape::Tri3, &[0, 1, 4]), 0.1), "names node 4");
    assert_refused(tie(face(Shape::Tri3, &[0, 1, 1]), whole(), 0.1), "degenerate");
    assert_refused(tie(face(Shape::Line2, &[0, 1]), whole(), 0.1), "facet 1, from 1, of the master side is a Quad4");
    let mut dented = whole();
    dented.nodes[2].at = [0.3, 0.3, 0.0];
    assert_refused(tie(whole(), dented, 0.1), "face 1, from 1, is degenerate or folded");
    assert_refused(tie(whole(), square(0.0, 0.25), 0.1), "beyond the tolerance is 0.25");
    assert_refused(tie(whole(), whole(), f64::NAN), "within the tolerance NaN");
    assert_refused(
        tie(whole(), square(0.25, 0.0), 0.01),
        "of the size 1 of slave facet 1, from 1; no master facet lies opposite that part",
    );
    assert_refused(tie(whole(), square(7.0, 0.0), f64::INFINITY), "over 1 of the size 1 of slave facet 1");
    let twice = with(vec![Face::new(Shape::Quad4, [0, 1, 2, 3]), Face::new(Shape::Tri3, [0, 1, 2])]);
    assert_refused(tie(whole(), twice, 0.01), "cover 1.5, more than the size 1 of slave facet 1");
}

#[test]
fn faults_of_couplings() {
    let beam = Node6::from(point(0, [0.0; 3]));
    let end = |face: Surface<3>, section: Section| BeamToSolid { beam, face, section };
    let mut face = square(0.0, 0.0);
    assert_refused(end(face.clone(), Section::Mean), "DOF 0 of node 1");
    face.nodes.iter_mut().for_each(|node| node.dofs = node.dofs.map(|dof| dof + 3));
    assert_refused(end(face.clone(), Section::Rigid), "needs the rotation");
    assert_refused(
        end(Surface { faces: vec![], ..face.clone() }, Section::Mean),
        "face of the solid: the surface has no",
    );
    let line = Surface { faces: vec![Face::new(Shape::Line2, [0, 1])], ..face.clone() };
    assert_refused(end(line, Section::Mean), "have no mean normal");
    let both = vec![Face::new(Shape::Tri3, [0, 1, 2]), Face::new(Shape::Tri3, [0, 3, 2])];
    assert_refused(end(Surface { faces: both, ..face.clone() }, Section::Plane), "opposite normals");
    let shell = |nodes: &[&[usize]], at: [f64; 3]| {
        let lines = nodes.iter().map(|nodes| ThicknessLine { shell: Node6 { at, ..beam }, nodes: nodes.to_vec() });
        ShellToSolid { lines: lines.collect(), face: square(0.0, 0.0), section: Section::Mean }
    };
    assert_refused(shell(&[], [0.0; 3]), "no nodes");
    assert_refused(shell(&[&[0, 3]], [0.0; 3]), "node 1 (from 0) of the face belongs to no line");
    assert_refused(shell(&[&[0, 3], &[1][..]], [0.0; 3]), "line 2, from 1, does not have two nodes");
    assert_refused(shell(&[&[0, 3], &[1, 3]], [0.0; 3]), "line 2, from 1, names node 3");
    assert_refused(shell(&[&[0, 7]], [0.0; 3]), "names node 7");
    assert_refused(shell(&[&[0, 1, 2], &[3][..]], [0.0; 3]), "is not straight: node 1");
    assert_refused(shell(&[&[0, 3], &[1, 2]], [5.0, 0.0, 0.0]), "is 5 away from its shell node");
    assert_refused(shell(&[&[0, 3], &[1, 2]], [0.5; 3]), "line 1, from 1, has a shell node");
    let node = Node6::new([6, 7, 8], [9, 10, 11], [1.0; 3]);
    let vector = Body::with_vector([0, 1, 2], [0.0; 3], [3, 4, 5]);
    let part = Node6::new([12, 13, 14], [15, 16, 17], [1.0; 3]).only([Component::X, Component::TurnZ]);
    assert_refused(RigidBody { body: vector, nodes: vec![node, part] }, "only some rotations of node 2");
    assert_refused(RigidBody { body: vector, nodes: vec![node.only([])] }, "every DOF of node 1");
}

#[test]
fn faults_of_nonlinear_types() {
    assert_refused(Distance::new(at(0, 1.0), at(1, 1.0)), "length is 0");
    let ball = OnSphere { point: at(0, 1.0), centre: [0.0; 2], radius: Some(-1.0) };
    assert_refused(ball, "radius is -1");
    let (p, q) = (point(0, [0.0; 3]), point(1, [0.0; 3]));
    assert_refused(OnLine { point: point(2, [1.0; 3]), line: Line::Nodes(p, q) }, "no direction");
    let plane = Plane::Nodes(p, point(1, [1.0, 0.0, 0.0]), point(2, [2.0, 0.0, 0.0]));
    assert_refused(OnPlane { point: point(3, [0.0; 3]), plane }, "no normal");
    assert_refused(OnPlane { point: p, plane: Plane::Fixed { through: [0.0; 3], normal: [f64::NAN; 3] } }, "no normal");
    assert_refused(RigidBody { body: Body::ground(), nodes: vec![p.into()] }, "no rotations");
    assert_refused(RigidBody { body: Body::with_vector([0, 1, 2], [0.0; 3], [3, 4, 5]), nodes: vec![] }, "no nodes");
    let nodes = vec![p, point(1, [1.0, 0.0, 0.0]), point(2, [0.0, 1.0, 0.0]), point(3, [0.0, 0.0, -1.0])];
    assert_refused(Volume { nodes: nodes.clone(), tetrahedra: vec![] }, "no tetrahedra");
    assert_refused(Volume { nodes: nodes.clone(), tetrahedra: vec![[0, 1, 2, 3]] }, "must be positive");
    assert_refused(Volume { nodes, tetrahedra: vec![[0, 1, 2, 4]] }, "names node 4");
}

#[test]
fn faults_of_joints() {
    let (ground, at) = (Body::ground(), [0.0; 3]);
    let body = Body::with_vector([0, 1, 2], [0.0; 3], [3, 4, 5]);
    assert_refused(Spherical { a: ground, b: ground, at }, "both bodies are the ground");
    assert_refused(Spherical { a: body, b: body, at }, "twice");
    assert_refused(Revolute { a: ground, b: body, at, axis: [0.0; 3] }, "no direction");
    assert_refused(Revolute { a: Body::node(point(2, at)), b: body, at, axis: [1.0; 3] }, "without rotations");
    let slanted = Universal { a: ground, b: body, at, axis_a: [1.0, 0.0, 0.0], axis_b: [1.0, 1.0, 0.0] };
    assert_refused(slanted, "the cosine of their angle is 0.707");
}
