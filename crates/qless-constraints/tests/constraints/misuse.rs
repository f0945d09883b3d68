//! Numbers and meshes that are refused, and noise that must not become an equation.

use qless_constraints::types::{
    Body, Cyclic, CyclicHarmonic, Cylindrical, Distance, Face, Fixed, Line, MortarTie, Multipliers, Node, OnLine,
    OnPlane, OnSphere, Planar, Plane, Point, Prismatic, Revolute, RotationMotor, Shape, Spherical, Surface,
    TranslationMotor, Turn, Turning, Universal, Volume,
};
use qless_constraints::{Constraint, ConstraintSet};

use crate::common::{point, random};

const O: [f64; 3] = [0.0; 3];
const X: [f64; 3] = [1.0, 0.0, 0.0];
const Y: [f64; 3] = [0.0, 1.0, 0.0];
const Z: [f64; 3] = [0.0, 0.0, 1.0];

/// The error of a constraint, if there is one.
fn refusal<C: Constraint>(constraint: C) -> Option<String> {
    ConstraintSet::builder(40).add("it", constraint).err().map(|error| error.to_string())
}

fn assert_not_finite<C: Constraint>(constraint: C) {
    let said = refusal(constraint).unwrap_or_else(|| panic!("{} is accepted", C::NAME));
    assert!(said.contains("every number must be finite"), "{said}");
}

#[test]
fn coordinates_that_are_no_numbers_are_refused() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for k in 0..3 {
            let mut place = Z;
            place[k] = bad;
            joints_at(place, Body::with_vector([6, 7, 8], O, [9, 10, 11]));
            joints_at(Z, Body::with_vector([6, 7, 8], place, [9, 10, 11]));
            joints_at(Z, Body::with_euler([6, 7, 8], place, [9, 10, 11, 12]));
            points_at(place);
        }
    }
}

fn joints_at(at: [f64; 3], b: Body) {
    for a in [Body::ground(), Body::with_vector([0, 1, 2], X, [3, 4, 5])] {
        assert_not_finite(Fixed { a, b, at });
        assert_not_finite(Revolute { a, b, at, axis: X });
        assert_not_finite(Prismatic { a, b, at, axis: X });
        assert_not_finite(Cylindrical { a, b, at, axis: X });
        assert_not_finite(Planar { a, b, at, normal: X });
        assert_not_finite(Universal { a, b, at, axis_a: X, axis_b: Y });
        assert_not_finite(Spherical { a, b, at });
        assert_not_finite(TranslationMotor::new(a, b, at, X, |t| t));
    }
}

fn points_at(bad: [f64; 3]) {
    assert_not_finite(Distance { a: point(0, bad), b: point(1, X), length: Some(1.0) });
    assert_not_finite(OnSphere { point: point(0, bad), centre: O, radius: Some(1.0) });
    assert_not_finite(OnSphere { point: point(0, X), centre: bad, radius: Some(1.0) });
    assert_not_finite(OnPlane { point: point(0, bad), plane: Plane::Nodes(point(1, O), point(2, X), point(3, Y)) });
    assert_not_finite(OnLine { point: point(0, bad), line: Line::Nodes(point(1, O), point(2, X)) });
}

#[test]
fn motors_without_a_number_to_start_from_are_refused() {
    let (a, b) = (Body::ground(), Body::with_vector([0, 1, 2], O, [3, 4, 5]));
    assert_not_finite(RotationMotor::new(a, b, Z, |_| f64::NAN));
    assert_not_finite(TranslationMotor::new(a, b, O, Z, |t| 1.0 / t));
}

/// Duplicate or nested tetrahedra have no closed surface. Regression: a panic, and an equation that a translation violates.
#[test]
fn tetrahedra_on_one_side_of_a_face_are_refused() {
    let nodes: Vec<Point> = [O, X, Y, Z, [0.1, 0.1, 2.0]].into_iter().enumerate().map(|(i, at)| point(i, at)).collect();
    for second in [[0, 1, 2, 3], [1, 2, 0, 3], [0, 1, 2, 4]] {
        let patch = Volume { nodes: nodes.clone(), tetrahedra: vec![[0, 1, 2, 3], second] };
        let said = refusal(patch).expect("they overlap");
        assert!(said.contains("tetrahedra 1 and 2, from 1, lie on the same side"), "{said}");
    }
    // One on each side of the face 0 1 2.
    let mut nodes = nodes;
    nodes[4].at = [0.1, 0.1, -2.0];
    assert_eq!(refusal(Volume { nodes, tetrahedra: vec![[0, 1, 2, 3], [0, 2, 1, 4]] }), None);
}

/// `dc/du` of a patch sums to zero over its nodes: a translation changes no volume.
#[test]
fn volumes_do_not_feel_translations() {
    let corners: Vec<[f64; 3]> = (0_u32..8).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(f64::from)).collect();
    let place = |i: usize| std::array::from_fn(|k| corners[i][k] + 0.2 * random(3 * i + k));
    let nodes = (0..8).map(|i| point(i, place(i))).collect();
    // Kuhn's six tetrahedra around the diagonal from 0 to 7.
    let tetrahedra = vec![[0, 1, 3, 7], [0, 3, 2, 7], [0, 2, 6, 7], [0, 6, 4, 7], [0, 4, 5, 7], [0, 5, 1, 7]];
    let mut builder = ConstraintSet::builder(24);
    builder.add("cube", Volume { nodes, tetrahedra }).unwrap_or_else(|error| panic!("{error}"));
    let (set, mut u) = (builder.build().expect("few DOFs"), vec![0.0; 24]);
    u.iter_mut().enumerate().for_each(|(k, u)| *u = 0.1 * random(500 + k));
    let mut evaluation = set.allocate();
    set.evaluate(&u, &mut evaluation).expect("of this set");
    for axis in 0..3 {
        let along = evaluation.g().row(0).filter(|(dof, _)| dof % 3 == axis);
        let (sum, size) = along.fold((0.0, 0.0), |(sum, size), (_, g)| (sum + g, size + g.abs()));
        assert!(sum.abs() < 1e-14 * size, "{sum} of {size}");
    }
}

/// Flat tetrahedra and collinear nodes far from the origin are refused: their volumes and areas are rounding, in any order of the corners.
#[test]
fn what_is_flat_to_the_rounding_of_its_coordinates_is_refused() {
    let far = |x: [f64; 3]| [0.1 * x[0] + 1e5, 0.1 * x[1] + 1e5, 0.1 * x[2]];
    let flat = [O, [1.0, 0.3, 0.1], [0.2, 1.0, 0.7], [1.2, 1.3, 0.8]].map(far);
    for tetrahedron in [[0, 1, 2, 3], [1, 0, 2, 3], [2, 3, 0, 1], [3, 2, 0, 1]] {
        let nodes = flat.iter().enumerate().map(|(i, &at)| point(i, at)).collect();
        let said = refusal(Volume { nodes, tetrahedra: vec![tetrahedron] }).expect("flat");
        assert!(said.contains("more than the rounding of its coordinates"), "{said}");
    }
    let line = [0.1, 0.2, 0.3].map(|x| [1e5 + x, x, 0.0]);
    let plane = Plane::Nodes(point(1, line[0]), point(2, line[1]), point(3, line[2]));
    let said = refusal(OnPlane { point: point(0, Z), plane }).expect("in a line");
    assert!(said.contains("to the rounding of their coordinates"), "{said}");
    // As far away, but valid: a thousandth of the size is not rounding.
    let nodes = [O, X, Y, [0.3, 0.3, 1e-3]].map(far).iter().enumerate().map(|(i, &at)| point(i, at)).collect();
    assert_eq!(refusal(Volume { nodes, tetrahedra: vec![[0, 1, 2, 3]] }), None);
    let plane = Plane::Nodes(point(1, far(O)), point(2, far(X)), point(3, far([1.0, 1e-3, 0.0])));
    assert_eq!(refusal(OnPlane { point: point(0, Z), plane }), None);
}

/// `sin` and `cos` of quarter and whole turns are exact: a node that is its own image after a whole turn is not constrained.
#[test]
fn turns_by_quarters_leave_no_noise() {
    for quarters in 0..9 {
        let angle = f64::from(quarters) * std::f64::consts::FRAC_PI_2;
        let turn = Turn::about(O, Z, angle).unwrap_or_else(|error| panic!("{error}"));
        let whole = [X, Y, [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]][quarters as usize % 4];
        let cyclic = Cyclic { a: point(0, X), b: point(1, whole), turn, fields: Turning::Vectors, tolerance: 1e-12 };
        assert!(entries(cyclic).iter().all(|&a| (a.abs() - 1.0).abs() < 1e-14), "{quarters}");
        let harmonic = CyclicHarmonic { real: cyclic, imaginary_a: [6, 7, 8], imaginary_b: [9, 10, 11], harmonic: 3 };
        assert!(entries(harmonic).iter().all(|&a| (a.abs() - 1.0).abs() < 1e-14), "{quarters}");
        let own = Cyclic { b: cyclic.a, ..cyclic };
        if quarters % 4 == 0 {
            assert!(entries(own).is_empty(), "{quarters}");
        }
    }
}

/// Nonzero entries of G.
fn entries<C: Constraint>(constraint: C) -> Vec<f64> {
    let mut builder = ConstraintSet::builder(12);
    builder.add("it", constraint).unwrap_or_else(|error| panic!("{error}"));
    let g = builder.build().expect("few DOFs").allocate().g().clone();
    g.values().iter().copied().filter(|&a| a != 0.0).collect()
}

/// A square of faces; corners inside are off the grid by up to a fifth of an element.
fn square(first: usize, n: usize, seed: usize, quads: bool) -> Surface<3, 1> {
    let off = |i: usize, k: usize| {
        let inside = [i % (n + 1), i / (n + 1)].map(|k| k > 0 && k < n);
        if inside[k] { 0.2 * random(seed + 2 * i + k) } else { 0.0 }
    };
    let at =
        |i: usize| [((i % (n + 1)) as f64 + off(i, 0)) / n as f64, ((i / (n + 1)) as f64 + off(i, 1)) / n as f64, 0.0];
    let nodes = (0..(n + 1) * (n + 1)).map(|i| Node::of_field(first + i, at(i))).collect();
    let corners = |e: usize| {
        let low = e / n * (n + 1) + e % n;
        [low, low + 1, low + n + 2, low + n + 1]
    };
    let split = |e: usize| {
        let [a, b, c, d] = corners(e);
        if quads {
            vec![Face::new(Shape::Quad4, [a, b, c, d])]
        } else {
            vec![Face::new(Shape::Tri3, [a, b, c]), Face::new(Shape::Tri3, [a, c, d])]
        }
    };
    Surface { nodes, faces: (0..n * n).flat_map(split).collect() }
}

fn mapped(surface: &Surface<3, 1>, map: impl Fn([f64; 3]) -> [f64; 3]) -> Surface<3, 1> {
    let nodes = surface.nodes.iter().map(|node| Node { at: map(node.at), ..*node }).collect();
    Surface { nodes, faces: surface.faces.clone() }
}

fn tied(slave: Surface<3, 1>, master: Surface<3, 1>, multipliers: Multipliers, tolerance: f64) -> Vec<Vec<f64>> {
    let dofs = slave.nodes.len() + master.nodes.len();
    let mut builder = ConstraintSet::builder(dofs);
    let tie = MortarTie { slave, master, multipliers, tolerance };
    builder.add("tie", tie).unwrap_or_else(|error| panic!("{error}"));
    let set = builder.build().expect("few DOFs");
    let (g, mut dense) = (set.allocate().g().clone(), vec![vec![0.0; dofs]; set.equations()]);
    (0..set.equations()).for_each(|row| g.row(row).for_each(|(dof, a)| dense[row][dof] = a));
    dense
}

/// G of a tie of quadrilaterals that are not parallelograms depends neither on the orientation of the model nor on its unit. The integration
/// rule is not exact there, but its error must not depend on the first corner of a piece.
#[test]
fn mortar_ties_turn_with_the_model() {
    for (seed, multipliers, quads) in
        (0..6).flat_map(|s| [(s, Multipliers::Standard, s % 2 == 0), (s, Multipliers::Dual, s % 3 == 0)])
    {
        let (slave, master) = (square(0, 3, 100 * seed, true), square(16, 4, 100 * seed + 50, quads));
        let straight = tied(slave.clone(), master.clone(), multipliers, 1e-9);
        for k in 0..8 {
            let (angle, unit) = (0.1 + k as f64, [1.0, 1e-6, 1e6][k % 3]);
            let (sin, cos) = angle.sin_cos();
            // About z, then about x by as much.
            let map = |[x, y, z]: [f64; 3]| {
                let [x, y] = [cos * x - sin * y, sin * x + cos * y];
                [x, cos * y - sin * z, sin * y + cos * z].map(|x| unit * x)
            };
            let turned = tied(mapped(&slave, map), mapped(&master, map), multipliers, 1e-9 * unit);
            for (a, b) in straight.iter().zip(&turned) {
                let most = a.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
                let worst = a.iter().zip(b).map(|(a, b)| (a - b / (unit * unit)).abs()).fold(0.0, f64::max);
                assert!(worst < 1e-11 * most, "seed {seed}, {multipliers:?}, turned by {angle}: {worst} of {most}");
            }
        }
    }
}

/// Sides that touch up to rounding of their coordinates need no tolerance, near the origin and far from it.
#[test]
fn mortar_ties_need_no_tolerance_for_rounding() {
    let (sin, cos) = 0.7_f64.sin_cos();
    for far in [0.0, 1e5] {
        let map = |[x, y, _]: [f64; 3]| [far + x, far + cos * y, sin * y - far];
        let tie =
            tied(mapped(&square(0, 2, 1, false), map), mapped(&square(9, 3, 2, false), map), Multipliers::Dual, 0.0);
        assert_eq!(tie.len(), 9);
    }
}

/// A duplicate facet would count twice in the integrals.
#[test]
fn facets_that_are_there_twice_are_refused() {
    let (slave, master) = (square(0, 2, 1, true), square(9, 3, 2, true));
    for (doubled, side) in [(0, "slave"), (1, "master")] {
        let mut sides = [slave.clone(), master.clone()];
        let mut again = sides[doubled].faces[1].clone();
        again.nodes.rotate_left(1);
        sides[doubled].faces.push(again);
        let count = sides[doubled].faces.len();
        let [slave, master] = sides;
        let said = refusal(MortarTie { slave, master, multipliers: Multipliers::Standard, tolerance: 1e-9 });
        let said = said.expect("a facet is there twice");
        assert!(said.contains(&format!("{side} side: faces 2 and {count}, from 1, have the same nodes")), "{said}");
    }
}
