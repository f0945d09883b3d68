use std::array::from_fn;

use qless_constraints::ConstraintSet;
use qless_constraints::types::{
    Face, FaceSearch, Nearest, NodeTie, PairError, Point, SearchError, Shape, Surface, SurfaceError, pairs,
};

use crate::common::{Outcome, point, random};

/// Lines and faces.
fn flat() -> Vec<Shape> {
    Shape::ALL.into_iter().filter(|shape| shape.dimensions() < 3).collect()
}

/// Nodes of a shape in the plane, corners first.
const TRIANGLE: [[f64; 2]; 6] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.5]];
const QUAD: [[f64; 2]; 9] =
    [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.5, 0.0], [1.0, 0.5], [0.5, 1.0], [0.0, 0.5], [0.5, 0.5]];

/// Faces of all shapes anywhere in a cube, each with nodes of its own, a little warped and curved.
fn scattered(faces: usize) -> Surface<3> {
    let (mut surface, shapes) = (Surface { nodes: Vec::new(), faces: Vec::new() }, flat());
    for face in 0..faces {
        let shape = shapes[face % shapes.len()];
        let part = |k: usize| random(97 * face + k + 5);
        let origin: [f64; 3] = from_fn(|k| 10.0 * part(k));
        let axes: [[f64; 3]; 2] =
            from_fn(|a| from_fn(|k| f64::from(u8::from(k == (face + a) % 3)) + 0.3 * part(3 + 3 * a + k)));
        let first = surface.nodes.len();
        for i in 0..shape.nodes() {
            let [x, y] = match shape {
                Shape::Quad4 | Shape::Quad8 | Shape::Quad9 => QUAD[i],
                Shape::Line3 => [[0.0, 0.0], [1.0, 0.0], [0.5, 0.0]][i],
                _ => TRIANGLE[i],
            };
            let at = from_fn(|k| origin[k] + x * axes[0][k] + y * axes[1][k] + 0.05 * part(20 + 3 * i + k));
            surface.nodes.push(point(first + i, at));
        }
        surface.faces.push(Face::new(shape, (first..first + shape.nodes()).collect::<Vec<_>>()));
    }
    surface
}

/// `size` x `size` squares of length 1, the upper ones as two triangles, on z = 0.
fn grid(size: usize) -> Surface<3> {
    let nodes = (0..(size + 1) * (size + 1)).map(|i| point(i, [(i % (size + 1)) as f64, (i / (size + 1)) as f64, 0.0]));
    let mut faces = Vec::new();
    for (row, column) in (0..size).flat_map(|row| (0..size).map(move |column| (row, column))) {
        let a = row * (size + 1) + column;
        let (b, c, d) = (a + 1, a + size + 2, a + size + 1);
        if row < size / 2 {
            faces.push(Face::new(Shape::Quad4, [a, b, c, d]));
        } else {
            faces.extend([Face::new(Shape::Tri3, [a, b, c]), Face::new(Shape::Tri3, [a, c, d])]);
        }
    }
    Surface { nodes: nodes.collect(), faces }
}

/// Surfaces of one face each.
fn alone(surface: &Surface<3>) -> Vec<Surface<3>> {
    let one = |face: &Face| Surface { nodes: surface.nodes.clone(), faces: vec![face.clone()] };
    surface.faces.iter().map(one).collect()
}

/// Every face asked by itself, and the rule for equal distances.
fn brute_force(faces: &[FaceSearch<3>], at: [f64; 3]) -> Option<Nearest> {
    let one = |(face, search): (usize, &FaceSearch<3>)| Some(Nearest { face, ..search.nearest(&at)? });
    let all: Vec<_> = faces.iter().enumerate().filter_map(one).collect();
    let least = all.iter().map(|found| found.distance).fold(f64::INFINITY, f64::min);
    all.into_iter().find(|found| found.distance <= least + 1e-13)
}

#[test]
fn search_finds_what_brute_force_finds() -> Outcome {
    let surface = scattered(150);
    let points: Vec<[f64; 3]> = (0..300).map(|i| from_fn(|k| 14.0 * random(7000 + 3 * i + k))).collect();
    let alone = alone(&surface);
    let faces: Vec<_> = alone.iter().map(FaceSearch::new).collect::<Result<_, _>>()?;
    for (point, found) in points.iter().zip(FaceSearch::new(&surface)?.within(&points, 10.0)?) {
        assert_eq!(Some(&found), brute_force(&faces, *point).as_ref(), "{point:?}");
        assert!((found.weights.iter().sum::<f64>() - 1.0).abs() < 1e-14);
    }
    Ok(())
}

/// On edges, on corners and over them: the first of the faces that meet there, with both orders of the faces.
#[test]
fn shared_edges_and_corners_belong_to_the_first_face() -> Outcome {
    let mut surface = grid(6);
    let halves = (0..13 * 13).map(|i| [i % 13, i / 13].map(|i| f64::from(i) / 2.0));
    let points: Vec<[f64; 3]> = halves.flat_map(|[x, y]| [0.0, 0.3].map(|z| [x, y, z])).collect();
    for _ in 0..2 {
        let alone = alone(&surface);
        let faces: Vec<_> = alone.iter().map(FaceSearch::new).collect::<Result<_, _>>()?;
        for (point, found) in points.iter().zip(FaceSearch::new(&surface)?.within(&points, 0.31)?) {
            assert_eq!(Some(&found), brute_force(&faces, *point).as_ref(), "{point:?}");
            let touches = |face: &Face| {
                (0..2).all(|k| {
                    let of = face.nodes.iter().map(|&node| surface.nodes[node].at[k]);
                    of.clone().any(|x| x <= point[k]) && of.clone().any(|x| x >= point[k])
                })
            };
            // Boxes of the squares; of two triangles with one box both may be meant.
            let first = surface.faces.iter().position(touches).ok_or("outside")?;
            assert!(found.face >= first && (found.face == first || surface.faces[first].nodes.len() == 3));
        }
        surface.faces.reverse();
    }
    Ok(())
}

/// Ties of nodes on a surface let a field through that is linear in the coordinates.
#[test]
fn ties_to_a_surface_pass_linear_fields() -> Outcome {
    let surface = grid(5);
    let first = surface.nodes.len();
    let on = |i: usize| [2.5 + 5.0 * random(2 * i), 2.5 + 5.0 * random(2 * i + 1), 0.0];
    let nodes: Vec<Point> = (0..40).map(|i| point(first + i, on(i))).collect();
    let mut builder = ConstraintSet::builder(3 * (first + nodes.len()));
    for tie in NodeTie::to_surface(&nodes, &surface, 1e-9)? {
        builder.add("tie", tie)?;
    }
    let set = builder.build().expect("few DOFs");
    assert_eq!(set.equations(), 120);
    let field = |[x, y, _]: [f64; 3]| [0.3 * x - 0.7 * y, 0.1 + y, 2.0 * x - 1.0];
    let u: Vec<f64> = surface.nodes.iter().chain(&nodes).flat_map(|node| field(node.at)).collect();
    let mut evaluation = set.allocate();
    set.evaluate(&u, &mut evaluation).expect("of this set");
    assert!(evaluation.c().iter().all(|c| c.abs() < 1e-13));
    Ok(())
}

/// At nodes of faces, on straight edges and over them, near and far from the origin: no weight is below 8 units in the last place of the
/// largest without being zero, a node has one weight and an edge two, and the sum is one, to two units of rounding for each.
#[test]
fn weights_that_are_rounding_are_zero() -> Outcome {
    let mut surface = scattered(300);
    for shift in [0.0, 1024.0] {
        surface.nodes.iter_mut().flat_map(|node| &mut node.at).for_each(|x| *x += shift);
        for (i, one) in alone(&surface).iter().enumerate() {
            let (shape, nodes) = (one.faces[0].shape, &one.faces[0].nodes);
            let search = FaceSearch::new(one)?;
            let [a, b] = [0, 1].map(|k| one.nodes[nodes[k]].at);
            let t = 0.5 + 0.8 * random(i);
            let on_edge: [f64; 3] = from_fn(|k| a[k] + t * (b[k] - a[k]));
            let is_straight = matches!(shape, Shape::Line2 | Shape::Tri3 | Shape::Quad4);
            for (at, most) in [(a, 1), (b, 1), (on_edge, if is_straight && shift == 0.0 { 2 } else { shape.nodes() })] {
                let n = search.nearest(&at).ok_or("not finite")?.weights;
                let largest = n.iter().fold(0.0, |most: f64, n| most.max(n.abs()));
                let unit = 2.0_f64.powi(largest.log2().floor() as i32 - 52);
                assert!(n.iter().all(|&n| n == 0.0 || n.abs() >= 8.0 * unit), "{shape:?}: {n:?}");
                assert!(n.iter().filter(|&&n| n != 0.0).count() <= most, "{shape:?}, {i}: {n:?}");
                assert!((n.iter().sum::<f64>() - 1.0).abs() <= 2.0 * f64::EPSILON * n.len() as f64);
            }
        }
    }
    Ok(())
}

#[test]
fn faults_of_a_search_are_named() -> Outcome {
    let surface = grid(2);
    let search = FaceSearch::new(&surface)?;
    let far = [[0.5, 0.5, 0.0], [3.0, 1.5, 0.0]];
    let fault = search.within(&far, 0.5).map_err(|error| (error, error.to_string()));
    let (error, words) = fault.expect_err("too far");
    assert_eq!(error, SearchError::TooFar { node: 2, face: 5, distance: 1.0, tolerance: 0.5 });
    assert!(words.contains("node 2, from 1, is 1 away from the nearest face, 5, from 1") && words.contains("raise"));
    assert!(search.within(&far, f64::NAN).is_err() && search.within(&[], 0.0)?.is_empty());
    for coordinate in [f64::NAN, f64::INFINITY, 1e200] {
        assert_eq!(search.within(&[[0.0, coordinate, 0.0]], 1.0), Err(SearchError::NoPlace { node: 1 }));
    }
    let with = |face: Face| Surface { faces: vec![surface.faces[0].clone(), face], ..surface.clone() };
    let error = |surface: &Surface<3>| FaceSearch::new(surface).err();
    assert_eq!(error(&Surface { faces: vec![], ..surface.clone() }), Some(SurfaceError::Empty));
    let short = SurfaceError::Nodes { face: 2, shape: Shape::Tri6, found: 3 };
    assert_eq!(error(&with(Face::new(Shape::Tri6, [0, 1, 4]))), Some(short));
    let missing = SurfaceError::NoNode { face: 2, node: 9, nodes: 9 };
    assert_eq!(error(&with(Face::new(Shape::Tri3, [0, 1, 9]))), Some(missing));
    // In a line, and in the order of a bow tie.
    for face in [Face::new(Shape::Tri3, [0, 1, 2]), Face::new(Shape::Quad4, [0, 1, 3, 4])] {
        assert_eq!(error(&with(face)), Some(SurfaceError::Degenerate { face: 2 }));
    }
    Ok(())
}

#[test]
fn pairs_are_found_in_any_order() {
    let step = [0.3, -2.0, 1.0];
    let from: Vec<_> = (0..200).map(|i| point(i, from_fn(|k| random(3 * i + k)))).collect();
    let image = |i: usize| point(200 + i, from_fn(|k| from[i].at[k] + step[k] + 1e-7 * random(i + k)));
    let to: Vec<_> = (0..200).map(|i| image((i * 77) % 200)).collect();
    let found = pairs(&from, &to, step, 1e-5).expect("images");
    assert!(found.iter().enumerate().all(|(i, (a, b))| *a == from[i] && *b == image(i)));
    assert!(matches!(pairs(&from, &to[1..], step, 1e-5), Err(PairError::Counts { from: 200, to: 199 })));
    assert!(matches!(pairs(&from, &to, step, 1e-9), Err(PairError::NoImage { node: 1, .. })));
    let twice = vec![from[0]; 200];
    assert!(matches!(pairs(&twice, &to, step, 1e-5), Err(PairError::Shared { first: 1, second: 2 })));
    let nowhere = vec![point(0, [f64::NAN; 3]); 200];
    assert!(matches!(pairs(&from, &nowhere, step, 1e-5), Err(PairError::NoImage { .. })));
    assert!(matches!(pairs(&nowhere, &to, step, 1e-5), Err(PairError::NoImage { .. })));
    assert!(matches!(pairs(&from, &to, step, f64::NAN), Err(PairError::NoImage { .. })));
}
