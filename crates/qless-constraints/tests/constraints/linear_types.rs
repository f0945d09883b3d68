use std::array::from_fn;

use qless_constraints::ConstraintSet;
use qless_constraints::types::{
    Average, Cyclic, CyclicHarmonic, FluidNormal, Line, LineTie, MortarTie, Multipliers, Node6, NodeTie, OnLine,
    OnPlane, PlanarPoint, Plane, Point, Shape, SmallRigidBody, Surface, Turn, Turning,
};

use crate::common::{Outcome, random};

fn point(node: usize, at: [f64; 3]) -> Point {
    Point::new(from_fn(|k| 3 * node + k), at)
}

fn residual(set: &ConstraintSet, u: &[f64]) -> f64 {
    let mut evaluation = set.allocate();
    set.evaluate(u, &mut evaluation).expect("of this set");
    evaluation.c().iter().fold(0.0, |most: f64, c| most.max(c.abs()))
}

/// Any displacement that is linear in the coordinates.
fn field(x: [f64; 3]) -> [f64; 3] {
    let a = [[0.3, -0.2, 0.5], [0.1, 0.4, -0.6], [-0.7, 0.2, 0.9]];
    from_fn(|i| 0.1 * i as f64 + (0..3).map(|k| a[i][k] * x[k]).sum::<f64>())
}

fn displaced(nodes: &[[f64; 3]]) -> Vec<f64> {
    nodes.iter().flat_map(|&x| field(x)).collect()
}

/// Corners, and middles that are not straight for quadratic shapes.
fn face(shape: Shape) -> Vec<[f64; 3]> {
    let triangle = [[0.0, 0.0], [2.0, 0.3], [0.4, 1.5], [1.0, 0.1], [1.25, 0.95], [0.15, 0.75]];
    let edges = [[0.0, 0.0], [2.0, 0.2], [2.2, 1.6], [-0.1, 1.4], [1.0, 0.0], [2.15, 0.9], [1.05, 1.55], [-0.1, 0.7]];
    let quad = [&edges[..], &[[1.1, 0.75]]].concat();
    let flat = match shape {
        Shape::Quad4 | Shape::Quad8 | Shape::Quad9 => &quad[..shape.nodes()],
        _ => &triangle[..shape.nodes()],
    };
    // On the inclined plane z = 0.5 x - 0.25 y.
    flat.iter().map(|&[x, y]| [x, y, 0.5 * x - 0.25 * y]).collect()
}

/// A tie lets every linear field through, and its weights sum to one, at a node inside and on a corner.
#[test]
fn ties_pass_linear_fields() -> Outcome {
    for shape in [Shape::Line2, Shape::Tri3, Shape::Quad4, Shape::Tri6, Shape::Quad8, Shape::Quad9] {
        let face = face(shape);
        let middle = face[..2].iter().fold([0.0; 3], |sum, x| from_fn(|k| sum[k] + x[k] / 2.0));
        let inside = from_fn(|k| 0.6 * middle[k] + 0.4 * face[face.len().min(3) - 1][k]);
        let inside = if shape == Shape::Line2 { middle } else { inside };
        for node in [inside, face[1]] {
            let nodes: Vec<[f64; 3]> = [vec![node], face.clone()].concat();
            let masters = (1..nodes.len()).map(|i| point(i, nodes[i])).collect();
            let mut builder = ConstraintSet::builder(3 * nodes.len());
            builder.add("tie", NodeTie { node: point(0, node), shape, face: masters, tolerance: 1e-10 })?;
            assert!(residual(&builder.build().expect("few DOFs"), &displaced(&nodes)) < 1e-13, "{shape:?}");
        }
    }
    Ok(())
}

#[test]
fn lines_and_mortar_pass_linear_fields() -> Outcome {
    let on = |s: f64| [s, 2.0 * s, -s];
    let (slave, master) = ([0.0, 0.31, 0.8, 1.0], [0.0, 0.2, 0.45, 0.6, 1.0]);
    let nodes: Vec<[f64; 3]> = slave.iter().chain(&master).map(|&s| on(s)).collect();
    let points: Vec<Point> = nodes.iter().enumerate().map(|(i, &at)| point(i, at)).collect();
    let (slave, master) = (points[..4].to_vec(), points[4..].to_vec());
    let mut builder = ConstraintSet::builder(27);
    builder.add("line", LineTie { slave: slave.clone(), master: master.clone(), tolerance: 1e-12 })?;
    let [slave, master] = [slave, master].map(Surface::polyline);
    builder.add("mortar", MortarTie { slave, master, multipliers: Multipliers::Standard, tolerance: 1e-12 })?;
    let set = builder.build().expect("few DOFs");
    assert_eq!(set.equations(), 24);
    assert!(residual(&set, &displaced(&nodes)) < 1e-14);
    // Sums of rows of D and of M over all nodes are the length of the interface.
    let sum = |sign: f64| -> f64 {
        (12..24)
            .flat_map(|row| set.allocate().g().row(row).collect::<Vec<_>>())
            .map(|(_, v)| v)
            .filter(|v| v * sign > 0.0)
            .sum()
    };
    let length = 3.0 * 6.0_f64.sqrt();
    assert!((sum(1.0) - length).abs() < 1e-14 * length && (sum(-1.0) + length).abs() < 1e-14 * length);
    Ok(())
}

/// The mortar integrals are those of a fine rule.
#[test]
fn mortar_integrals_are_exact() -> Outcome {
    let (slave, master) = ([0.0, 0.4, 1.0], [0.0, 0.55, 1.0]);
    let at = |i: usize, x: f64| PlanarPoint::new([2 * i, 2 * i + 1], [x, 0.0]);
    let tie = MortarTie {
        slave: Surface::polyline((0..3).map(|i| at(i, slave[i])).collect()),
        master: Surface::polyline((0..3).map(|i| at(i + 3, master[i])).collect()),
        multipliers: Multipliers::Standard,
        tolerance: 1e-12,
    };
    let mut builder = ConstraintSet::builder(12);
    builder.add("mortar", tie)?;
    let g = builder.build().expect("few DOFs").allocate().g().clone();
    let hat = |nodes: &[f64; 3], i: usize, x: f64| {
        let rise = if i > 0 { (x - nodes[i - 1]) / (nodes[i] - nodes[i - 1]) } else { 1.0 };
        let fall = if i < 2 { (nodes[i + 1] - x) / (nodes[i + 1] - nodes[i]) } else { 1.0 };
        rise.min(fall).max(0.0)
    };
    let steps = 20_000;
    for i in 0..3 {
        for k in 0..3 {
            let sum = (0..steps).map(|s| (f64::from(s) + 0.5) / f64::from(steps));
            let truth = sum.map(|x| hat(&slave, i, x) * hat(&master, k, x)).sum::<f64>() / f64::from(steps);
            let found = g.row(2 * i).find(|&(col, _)| col == 2 * (k + 3)).map_or(0.0, |(_, v)| -v);
            assert!((found - truth).abs() < 1e-8, "M({i}, {k}): {found}, {truth}");
        }
    }
    Ok(())
}

/// Rigid motions pass through rigid bodies, averages and cyclic pairs.
#[test]
fn rigid_motions_pass() -> Outcome {
    let (shift, theta) = ([0.1, -0.3, 0.2], [0.4, 0.5, -0.6]);
    let nodes: Vec<[f64; 3]> = (0..6).map(|i| from_fn(|k| 4.0 * random(3 * i + k))).collect();
    let moved = |x: [f64; 3]| -> [f64; 3] {
        from_fn(|k| shift[k] + theta[(k + 1) % 3] * x[(k + 2) % 3] - theta[(k + 2) % 3] * x[(k + 1) % 3])
    };
    let mut u: Vec<f64> = nodes.iter().flat_map(|&x| moved(x)).collect();
    u.extend(theta);
    let points: Vec<Point> = nodes.iter().enumerate().map(|(i, &at)| point(i, at)).collect();
    let mut builder = ConstraintSet::builder(21);
    let reference = Node6::new(points[0].dofs, [18, 19, 20], points[0].at);
    let nodes: Vec<Node6> = points[1..].iter().map(|&p| p.into()).collect();
    builder.add("rigid", SmallRigidBody { reference, nodes: nodes.clone() })?;
    let weighted = nodes.into_iter().zip([1.0, 2.0, 0.5, 3.0, 1.5]).collect();
    builder.add("average", Average { reference, nodes: weighted })?;
    assert!(residual(&builder.build().expect("few DOFs"), &u) < 1e-14);
    Ok(())
}

/// The average is the least-squares motion: the error that is left is orthogonal to every rigid motion.
#[test]
fn average_is_the_least_squares_motion() -> Outcome {
    let weights = [1.0, 2.0, 0.5, 3.0];
    let points: Vec<Point> = (0..5).map(|i| point(i, from_fn(|k| 3.0 * random(3 * i + k + 90)))).collect();
    let nodes = points[1..].iter().map(|&p| p.into()).zip(weights).collect();
    let mut builder = ConstraintSet::builder(18);
    let reference = Node6::new(points[0].dofs, [15, 16, 17], points[0].at);
    builder.add("average", Average { reference, nodes })?;
    let set = builder.build().expect("few DOFs");
    let mut u: Vec<f64> = (0..18).map(random).collect();
    let own = [0, 1, 2, 15, 16, 17];
    own.iter().for_each(|&dof| u[dof] = 0.0);
    let mut evaluation = set.allocate();
    set.evaluate(&u, &mut evaluation).expect("of this set");
    // Where the reference is at zero, c is minus its motion; there the gradient of sum w |e|^2 vanishes, by differences of the sum.
    own.iter().zip(evaluation.c()).for_each(|(&dof, c)| u[dof] = -c);
    let sum = |u: &[f64]| -> f64 {
        (1..5)
            .map(|i| {
                let r: [f64; 3] = from_fn(|k| points[i].at[k] - points[0].at[k]);
                let e = |k: usize| {
                    u[3 * i + k] - u[k] - u[15 + (k + 1) % 3] * r[(k + 2) % 3] + u[15 + (k + 2) % 3] * r[(k + 1) % 3]
                };
                weights[i - 1] * (0..3).map(|k| e(k).powi(2)).sum::<f64>()
            })
            .sum()
    };
    for dof in own {
        let (mut more, mut less) = (u.clone(), u.clone());
        more[dof] += 1e-3;
        less[dof] -= 1e-3;
        let gradient = (sum(&more) - sum(&less)) / 2e-3;
        assert!(gradient.abs() < 1e-10, "{dof}: {gradient}");
    }
    Ok(())
}

/// A wave `u = R(phi) v e^(i k phi)` around the axis satisfies the equations of harmonic k.
#[test]
fn harmonics_pass_cyclic_pairs() -> Outcome {
    let (alpha, k) = (0.7_f64, 3_u32);
    let turn = |phi: f64, x: [f64; 3]| [phi.cos() * x[0] - phi.sin() * x[1], phi.sin() * x[0] + phi.cos() * x[1], x[2]];
    let (x, v, w) = ([1.0, 0.5, 2.0], [0.3, -0.4, 0.5], [0.1, 0.7, -0.2]);
    let (a, b) = (point(0, x), point(1, turn(alpha, x)));
    let turn_of_sector = Turn::about([0.0; 3], [0.0, 0.0, 2.0], alpha)?;
    let real = Cyclic { a, b, turn: turn_of_sector, fields: Turning::Vectors, tolerance: 1e-12 };
    let pair = CyclicHarmonic { real, imaginary_a: [6, 7, 8], imaginary_b: [9, 10, 11], harmonic: k };
    let (sin, cos) = (f64::from(k) * alpha).sin_cos();
    let (rv, rw) = (turn(alpha, v), turn(alpha, w));
    let at_b = [from_fn(|i| cos * rv[i] - sin * rw[i]), from_fn(|i| sin * rv[i] + cos * rw[i])];
    let u = [v, at_b[0], w, at_b[1]].concat();
    let mut builder = ConstraintSet::builder(12);
    builder.add("wave", pair)?;
    assert!(residual(&builder.build().expect("few DOFs"), &u) < 1e-15);
    let mut builder = ConstraintSet::builder(6);
    builder.add("alike", real)?;
    assert!(residual(&builder.build().expect("few DOFs"), &[v, rv].concat()) < 1e-15);
    Ok(())
}

/// Sliding is free, and what separates is the normal part.
#[test]
fn sliding_is_free() -> Outcome {
    let mut builder = ConstraintSet::builder(6);
    builder.add("wall", FluidNormal { structure: [0, 1, 2], fluid: [3, 4, 5], normal: [0.0, 0.0, 5.0] })?;
    builder.add(
        "plane",
        OnPlane {
            point: point(0, [1.0, 2.0, 3.0]),
            plane: Plane::Fixed { through: [0.0, 0.0, 3.0], normal: [0.0, 0.0, -1.0] },
        },
    )?;
    builder.add(
        "line",
        OnLine {
            point: point(1, [1.0, 2.0, 3.0]),
            line: Line::Fixed { through: [1.0, 2.0, 0.0], direction: [0.0, 0.0, 1.0] },
        },
    )?;
    let set = builder.build().expect("few DOFs");
    assert!(residual(&set, &[0.7, -0.2, 0.0, 0.0, 0.0, 0.0]) < 1e-16);
    assert!((residual(&set, &[0.0, 0.0, 0.0, 0.0, 0.0, 0.25]) - 0.25).abs() < 1e-16);
    Ok(())
}
