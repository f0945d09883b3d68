//! Distances, lines, planes and spheres for points of bodies: they agree with nodes that are rigidly linked to the bodies.

use qless_constraints::types::{Body, BodyPoint, Distance, Line, OnLine, OnPlane, OnSphere, Plane, Point, RigidBody};
use qless_constraints::{AddError, Constraint, ConstraintSet, EquationError};

use crate::common::{Outcome, random};

const AT: [[f64; 3]; 4] = [[0.4, 0.1, 0.7], [1.3, -0.2, 0.1], [0.2, 1.1, -0.3], [-0.5, 0.3, 0.9]];

/// A body with a rotation vector, one with Euler parameters, a node, and the ground.
fn bodies() -> [Body; 4] {
    let euler = Body::with_euler([6, 7, 8], [0.9, 0.0, 0.2], [9, 10, 11, 12]);
    let node = Body::node(Point::new([13, 14, 15], AT[2]));
    [Body::with_vector([0, 1, 2], [0.1, 0.2, 0.3], [3, 4, 5]), euler, node, Body::ground()]
}

/// The place of a point of a body, from the equations of a rigid link to a node at rest.
fn place(point: usize, u: &[f64]) -> Outcome<Point> {
    let body = bodies()[point];
    let free = Point::new([16, 17, 18], AT[point]);
    let mut at = AT[point];
    if point < 2 {
        let mut builder = ConstraintSet::builder(19);
        let link = builder.add("link", RigidBody { body, nodes: vec![free.into()] })?;
        let set = builder.build()?;
        let mut evaluation = set.allocate();
        set.evaluate(u, &mut evaluation)?;
        // c = x_body - X, up to the sign that the types choose for sorted DOFs.
        let rows = set.rows_of(link)?;
        let sign = evaluation.g().row(rows[0]).find(|&(j, _)| j == 16).map_or(0.0, |(_, v)| -v);
        (0..3).for_each(|k| at[k] += sign * evaluation.c()[rows[k]]);
    } else if point == 2 {
        (0..3).for_each(|k| at[k] += u[13 + k]);
    }
    Ok(Point::new([3 * point, 3 * point + 1, 3 * point + 2], at))
}

fn values<C: Constraint>(constraint: C, u: &[f64]) -> Outcome<Vec<f64>> {
    let mut set = ConstraintSet::builder(u.len()).build()?;
    let id = set.add("it", constraint).map_err(|error| error.to_string())?;
    let mut evaluation = set.allocate();
    set.evaluate(u, &mut evaluation)?;
    Ok(set.values_of(id, &evaluation)?)
}

fn agree(bodies: &[f64], nodes: &[f64]) {
    let off = bodies.iter().zip(nodes).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(bodies.len() == nodes.len() && off < 1e-14, "{bodies:?}, {nodes:?}");
}

#[test]
fn points_of_bodies_are_where_their_bodies_take_them() -> Outcome {
    let points: [BodyPoint; 4] = std::array::from_fn(|k| bodies()[k].point(AT[k]));
    for case in 0..20 {
        let u: Vec<f64> = (0..19).map(|j| if j < 16 { random(19 * case + j) } else { 0.0 }).collect();
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| place(k, &u).expect("a link").at);
        let node = |k: usize, at: [f64; 3]| Point::new([3 * k, 3 * k + 1, 3 * k + 2], at);
        let rest = vec![0.0; 12];
        let length = Some(0.7);
        for (i, j) in [(0, 1), (0, 2), (1, 3), (2, 3)] {
            let there = [a, b, c, d];
            let rod = Distance { a: node(0, there[i]), b: node(1, there[j]), length };
            agree(&values(Distance { a: points[i], b: points[j], length }, &u)?, &values(rod, &rest)?);
        }
        let centre = [0.3, 0.2, -0.1];
        let ball = OnSphere { point: node(0, b), centre, radius: length };
        agree(&values(OnSphere { point: points[1], centre, radius: length }, &u)?, &values(ball, &rest)?);
        let fixed = (centre, [0.6, 0.0, 0.8]);
        let line = OnLine { point: node(0, a), line: Line::Fixed { through: fixed.0, direction: fixed.1 } };
        let of_body = OnLine { point: points[0], line: Line::Fixed { through: fixed.0, direction: fixed.1 } };
        agree(&values(of_body, &u)?, &values(line, &rest)?);
        let plane = OnPlane { point: node(0, b), plane: Plane::Fixed { through: fixed.0, normal: fixed.1 } };
        let of_body = OnPlane { point: points[1], plane: Plane::Fixed { through: fixed.0, normal: fixed.1 } };
        agree(&values(of_body, &u)?, &values(plane, &rest)?);
        // Moving lines and planes: frames start at u = 0, so that only distances can be compared.
        let moving = values(OnLine { point: points[2], line: Line::Nodes(points[0], points[1]) }, &u)?;
        let still = values(OnLine { point: node(2, c), line: Line::Nodes(node(0, a), node(1, b)) }, &rest)?;
        assert!((moving[0].hypot(moving[1]) - still[0].hypot(still[1])).abs() < 1e-14);
        let moving = OnPlane { point: points[3], plane: Plane::Nodes(points[0], points[1], points[2]) };
        let still = OnPlane { point: node(3, d), plane: Plane::Nodes(node(0, a), node(1, b), node(2, c)) };
        agree(&values(moving, &u)?, &values(still, &rest)?);
    }
    Ok(())
}

#[test]
fn what_cannot_be_joined_is_refused() {
    let [arm, .., ground] = bodies();
    let refused = |rod: Distance<BodyPoint>| match ConstraintSet::builder(19).add("rod", rod) {
        Err(AddError::Equation { source, .. }) => source,
        other => panic!("{other:?}"),
    };
    assert_eq!(refused(Distance::new(ground.point(AT[0]), ground.point(AT[1]))), EquationError::NothingMoves);
    let twice = refused(Distance::new(arm.point(AT[0]), arm.point(AT[1])));
    assert_eq!(twice, EquationError::RepeatedDof { dof: 0 });
}
