use std::array::from_fn;

use qless_constraints::ConstraintSet;
use qless_constraints::types::{
    Face, FaceSearch, Node, NodeTie, NodeTieError, SearchError, Shape, Surface, SurfaceError,
};

use crate::linkages::{Outcome, random};

type Place = [f64; 3];

fn solids() -> impl Iterator<Item = Shape> {
    Shape::ALL.into_iter().filter(|shape| shape.dimensions() == 3)
}

/// Corners of a straight element, and which are joined by edges with a node in the middle.
fn straight(shape: Shape) -> Vec<Place> {
    let corners: Vec<Place> = match shape {
        Shape::Tet4 | Shape::Tet10 => vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        Shape::Pyramid5 | Shape::Pyramid13 => {
            vec![[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [0.3, 0.6, 1.0]]
        }
        Shape::Wedge6 | Shape::Wedge15 => {
            let triangle = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
            [0.0, 1.0].into_iter().flat_map(|z| triangle.map(|[x, y]| [x, y, z])).collect()
        }
        _ => {
            let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
            [0.0, 1.0].into_iter().flat_map(|z| square.map(|[x, y]| [x, y, z])).collect()
        }
    };
    let edges: &[[usize; 2]] = match shape {
        Shape::Tet10 => &[[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]],
        Shape::Wedge15 => &[[0, 1], [1, 2], [2, 0], [3, 4], [4, 5], [5, 3], [0, 3], [1, 4], [2, 5]],
        Shape::Pyramid13 => &[[0, 1], [1, 2], [2, 3], [3, 0], [0, 4], [1, 4], [2, 4], [3, 4]],
        Shape::Hex20 | Shape::Hex27 => {
            &[[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]]
        }
        _ => &[],
    };
    let faces: &[&[usize]] = match shape {
        Shape::Hex27 => &[
            &[0, 1, 2, 3],
            &[4, 5, 6, 7],
            &[0, 1, 5, 4],
            &[1, 2, 6, 5],
            &[2, 3, 7, 6],
            &[3, 0, 4, 7],
            &[0, 1, 2, 3, 4, 5, 6, 7],
        ],
        _ => &[],
    };
    let mean = |of: &[usize]| from_fn(|k| of.iter().map(|&i| corners[i][k]).sum::<f64>() / of.len() as f64);
    let middles = edges.iter().map(|edge| mean(edge)).chain(faces.iter().map(|face| mean(face)));
    let middles: Vec<Place> = middles.collect();
    [corners, middles].concat()
}

fn corners(shape: Shape) -> usize {
    match shape {
        Shape::Tet4 | Shape::Tet10 => 4,
        Shape::Pyramid5 | Shape::Pyramid13 => 5,
        Shape::Wedge6 | Shape::Wedge15 => 6,
        _ => 8,
    }
}

/// Some affine map of space, with the determinant well off zero.
fn affine(seed: usize, x: Place) -> Place {
    let a = |i: usize, k: usize| f64::from(u8::from(i == k)) + 0.8 * random(seed + 3 * i + k);
    from_fn(|i| random(seed + 20 + i) + (0..3).map(|k| a(i, k) * x[k]).sum::<f64>())
}

/// A rotation by Rodrigues' formula.
fn turned(seed: usize, x: Place) -> Place {
    let axis: Place = from_fn(|k| random(seed + k));
    let length = axis.iter().map(|a| a * a).sum::<f64>().sqrt();
    let a = axis.map(|x| x / length);
    let (sin, cos) = (6.0 * random(seed + 5)).sin_cos();
    let along: f64 = (0..3).map(|k| a[k] * x[k]).sum();
    let cross: Place = from_fn(|k| a[(k + 1) % 3] * x[(k + 2) % 3] - a[(k + 2) % 3] * x[(k + 1) % 3]);
    from_fn(|k| cos * x[k] + sin * cross[k] + (1.0 - cos) * along * a[k])
}

/// A point well inside, as a mean of the corners.
fn inside(seed: usize, corners: &[Place]) -> Place {
    let weights: Vec<f64> = (0..corners.len()).map(|k| 0.6 + random(seed + 40 + k)).collect();
    let sum: f64 = weights.iter().sum();
    from_fn(|d| corners.iter().zip(&weights).map(|(x, w)| w / sum * x[d]).sum())
}

fn tie(shape: Shape, node: Place, nodes: &[Place], tolerance: f64) -> NodeTie<3, 1> {
    let face = nodes.iter().enumerate().map(|(k, &at)| Node::of_field(k + 1, at)).collect();
    NodeTie { node: Node::of_field(0, node), shape, face, tolerance }
}

/// `N_k`, from the equation.
fn weights(tie: NodeTie<3, 1>) -> Result<Vec<f64>, String> {
    let count = tie.face.len();
    let mut builder = ConstraintSet::builder(count + 1);
    builder.add("it", tie).map_err(|error| error.to_string())?;
    let mut weights = vec![0.0; count];
    let g = builder.build().expect("few DOFs").allocate().g().clone();
    g.row(0).filter(|&(dof, _)| dof > 0).for_each(|(dof, v)| weights[dof - 1] = -v);
    Ok(weights)
}

/// Largest `|sum N_k x_k - p|`, by the size of the element.
fn off(weights: &[f64], nodes: &[Place], p: Place, size: f64) -> f64 {
    let gap = |d: usize| nodes.iter().zip(weights).map(|(x, n)| n * (x[d] - p[d])).sum::<f64>().abs();
    (0..3).map(gap).fold(0.0, f64::max) / size
}

/// Distorted, curved and turned elements, in every unit and far from the origin: the weights give the node back, so that linear fields
/// pass, and are the same.
#[test]
fn distorted_elements_pass_linear_fields() -> Outcome {
    for (shape, seed) in solids().flat_map(|shape| (0..40).map(move |k| (shape, 100 * k))) {
        let most = if shape.nodes() > corners(shape) { 0.1 } else { 0.25 };
        let off_straight = |k: usize, d: usize| most * random(seed + 60 + 3 * k + d);
        let moved = |(k, x): (usize, Place)| turned(seed, affine(seed, from_fn(|d| x[d] + off_straight(k, d))));
        let distorted: Vec<Place> = straight(shape).into_iter().enumerate().map(moved).collect();
        let node = inside(seed, &distorted[..corners(shape)]);
        let truth = weights(tie(shape, node, &distorted, 1e-14))?;
        assert!(
            off(&truth, &distorted, node, 1.0) < 1e-14,
            "{shape:?}, {seed}: {}",
            off(&truth, &distorted, node, 1.0)
        );
        for (unit, shift) in [(1e-6, 0.0), (1e6, 0.0), (1.0, 4096.0), (1e-6, 1e-3), (1e6, -1e8)] {
            let place = |x: Place| x.map(|x| unit * x + shift);
            let (nodes, node): (Vec<_>, _) = (distorted.iter().map(|&x| place(x)).collect(), place(node));
            let found = weights(tie(shape, node, &nodes, 0.0))?;
            let rounding = 1e-15 * (1.0 + shift.abs() / unit);
            let back = off(&found, &nodes, node, unit);
            assert!(back < 20.0 * rounding, "{shape:?}, {seed}, unit {unit}, {shift} from the origin: {back}");
            let far = found.iter().zip(&truth).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
            assert!(far < 1000.0 * rounding, "{shape:?}, {seed}, unit {unit}, {shift} from the origin: {far}");
        }
    }
    Ok(())
}

/// Straight elements under any affine map: weights are barycentric coordinates and their products, to rounding.
#[test]
fn affine_elements_have_the_weights_of_the_formula() -> Outcome {
    for seed in (0..50).map(|k| 77 * k) {
        let x: Place = from_fn(|k| 0.3 + 0.5 * random(seed + k));
        let [a, b, c] = x.map(|x| 0.6 * x);
        let place = |x: Place| turned(seed, affine(seed, x));
        let of = |shape: Shape, p: Place| {
            let nodes: Vec<Place> = straight(shape).into_iter().map(place).collect();
            weights(tie(shape, place(p), &nodes, 1e-12))
        };
        let close = |found: &[f64], truth: &[f64]| {
            found.len() == truth.len() && found.iter().zip(truth).all(|(f, t)| (f - t).abs() < 2e-14)
        };
        let l = [1.0 - a - b - c, a, b, c];
        assert!(close(&of(Shape::Tet4, [a, b, c])?, &l));
        let corners = l.map(|l| l * (2.0 * l - 1.0));
        let edges = [[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]].map(|[i, j]| 4.0 * l[i] * l[j]);
        assert!(close(&of(Shape::Tet10, [a, b, c])?, &[&corners[..], &edges].concat()));
        let wedge = [1.0 - c, c].into_iter().flat_map(|z| [1.0 - a - b, a, b].map(|l| l * z));
        assert!(close(&of(Shape::Wedge6, [a, b, c])?, &wedge.collect::<Vec<_>>()));
        let square = |[x, y]: [f64; 2]| [(1.0 - x) * (1.0 - y), x * (1.0 - y), x * y, (1.0 - x) * y];
        let hex = [1.0 - x[2], x[2]].into_iter().flat_map(|z| square([x[0], x[1]]).map(|n| n * z));
        assert!(close(&of(Shape::Hex8, x)?, &hex.collect::<Vec<_>>()));
        // At height z a pyramid is a square of side 1 - z from the point that lies on the line to its tip.
        let q = 1.0 - x[2];
        let at = [0.3 * x[2] + q * x[0], 0.6 * x[2] + q * x[1], x[2]];
        let pyramid = [square([x[0], x[1]]).map(|n| n * q).to_vec(), vec![x[2]]].concat();
        assert!(close(&of(Shape::Pyramid5, at)?, &pyramid), "{:?}, {pyramid:?}", of(Shape::Pyramid5, at));
    }
    Ok(())
}

/// Quadratic fields pass straight quadratic elements.
#[test]
fn quadratic_elements_pass_quadratic_fields() -> Outcome {
    let quadratic = solids().filter(|&shape| shape.nodes() > corners(shape));
    for (shape, seed) in quadratic.flat_map(|shape| (0..20).map(move |k| (shape, 31 * k))) {
        let nodes: Vec<Place> = straight(shape).into_iter().map(|x| turned(seed, affine(seed, x))).collect();
        let node = inside(seed, &nodes[..corners(shape)]);
        let n = weights(tie(shape, node, &nodes, 1e-12))?;
        let field = |[x, y, z]: Place| 1.0 + x - y + x * x - 0.5 * y * z + 0.7 * z * z - x * y;
        let sum: f64 = n.iter().zip(&nodes).map(|(n, &x)| n * field(x)).sum();
        assert!((sum - field(node)).abs() < 2e-14, "{shape:?}: {sum}, {}", field(node));
    }
    Ok(())
}

/// Beyond a face, an edge and a corner of a box the distance is that of geometry, in every unit; it is in the error, and within the
/// tolerance the node is tied to the nearest point.
#[test]
fn nodes_outside_are_refused_with_their_distance() -> Outcome {
    for (shape, unit) in
        [Shape::Hex8, Shape::Hex20, Shape::Hex27].into_iter().flat_map(|s| [1.0, 1e-6, 1e6].map(|unit| (s, unit)))
    {
        let place = |x: Place| turned(7, [2.0 * x[0], x[1], 0.5 * x[2]]).map(|x| unit * x);
        let nodes: Vec<Place> = straight(shape).into_iter().map(place).collect();
        for (at, distance) in [
            ([0.3, 0.6, 2.0], 0.5),
            ([0.3, 1.25, 0.4], 0.25),
            ([1.15, 1.4, 0.4], 0.5),
            ([-1.0, 3.0, 5.0], (4.0_f64 + 4.0 + 4.0).sqrt()),
        ] {
            let node = place(at);
            let mut builder = ConstraintSet::builder(28);
            let error = builder.add("it", tie(shape, node, &nodes, 0.2 * unit)).expect_err("outside");
            let Some(NodeTieError::TooFar { distance: found, .. }) = source(&error) else { return Err(error.into()) };
            assert!((found - unit * distance).abs() < 1e-14 * unit * 4.0, "{found}, {distance}");
            let n = weights(tie(shape, node, &nodes, 4.0 * unit))?;
            let nearest = place(at.map(|x| x.clamp(0.0, 1.0)));
            assert!(off(&n, &nodes, nearest, unit) < 1e-14 * 4.0);
        }
    }
    Ok(())
}

fn source(error: &qless_constraints::AddError<NodeTieError>) -> Option<NodeTieError> {
    match error {
        qless_constraints::AddError::Input { source, .. } => Some(*source),
        _ => None,
    }
}

/// A block of n x n x n boxes.
fn block(n: usize) -> Surface<3> {
    let side = n + 1;
    let at = |i: usize| [i % side, i / side % side, i / (side * side)].map(|k| k as f64 / n as f64);
    let nodes = (0..side.pow(3)).map(|i| Node::new(from_fn(|k| 3 * i + k), at(i))).collect();
    let face = |c: usize| {
        let a = c % n + c / n % n * side + c / (n * n) * side * side;
        let lower = [a, a + 1, a + 1 + side, a + side];
        Face::new(Shape::Hex8, [lower, lower.map(|i| i + side * side)].concat())
    };
    Surface { nodes, faces: (0..n.pow(3)).map(face).collect() }
}

/// Nodes anywhere in a mesh find the element that holds them; on faces, edges and corners that elements share, the first one, with
/// weights that are exactly zero off them.
#[test]
fn embedded_nodes_find_their_elements() -> Outcome {
    let block = block(5);
    let search = FaceSearch::new(&block)?;
    for i in 0..300 {
        let at: Place = from_fn(|k| 0.5 + random(3 * i + k));
        let found = search.nearest(&at).ok_or("not finite")?;
        let cell = at.map(|x| (5.0 * x) as usize);
        assert_eq!(found.face, cell[0] + 5 * cell[1] + 25 * cell[2], "{at:?}");
        assert!(found.distance < 1e-15 && found.weights.iter().all(|&n| n > 0.0));
    }
    // On the lattice of half cells: as many weights as the corner, edge, face or cell has nodes.
    for i in 0..11_usize.pow(3) {
        let steps = [i % 11, i / 11 % 11, i / 121];
        let found = search.nearest(&steps.map(|k| k as f64 / 10.0)).ok_or("not finite")?;
        let shared = steps.iter().filter(|k| k.is_multiple_of(2)).count() as u32;
        assert_eq!(found.weights.iter().filter(|&&n| n != 0.0).count(), 8 >> shared, "{steps:?}: {:?}", found.weights);
        let first = steps.map(|k| if k.is_multiple_of(2) { (k / 2).saturating_sub(1) } else { k / 2 });
        assert_eq!(found.face, first[0] + 5 * first[1] + 25 * first[2], "{steps:?}");
    }
    let outside = search.within(&[[0.5; 3], [0.5, 0.5, 1.25]], 0.2);
    assert!(matches!(outside, Err(SearchError::TooFar { node: 2, distance, .. }) if (distance - 0.25).abs() < 1e-15));
    Ok(())
}

/// No weight is smaller than 8 units in the last place of the largest without being zero, and the sum is one to two units for each.
#[test]
fn weights_that_are_rounding_are_zero() -> Outcome {
    let mut zeros = 0;
    for (shape, seed) in solids().flat_map(|s| (0..60).map(move |k| (s, 13 * k))) {
        let nodes: Vec<Place> = straight(shape).into_iter().map(|x| turned(seed, affine(seed, x))).collect();
        // On an edge, a face, at a node, at random places of these.
        let [a, b, c] = [0, 1, 2].map(|k| nodes[k]);
        let [s, t] = [0, 1].map(|k| 0.3 + 0.4 * random(seed + k));
        for node in
            [a, from_fn(|k| a[k] + s * (b[k] - a[k])), from_fn(|k| a[k] + s * (b[k] - a[k]) + s * t * (c[k] - b[k]))]
        {
            let n = weights(tie(shape, node, &nodes, 1e-13))?;
            let largest = n.iter().fold(0.0, |most: f64, n| most.max(n.abs()));
            let unit = 2.0_f64.powi(largest.log2().floor() as i32 - 52);
            assert!(n.iter().all(|&n| n == 0.0 || n.abs() >= 8.0 * unit), "{shape:?}: {n:?}");
            let sum: f64 = n.iter().sum();
            assert!((sum - 1.0).abs() <= 2.0 * f64::EPSILON * n.len() as f64, "{sum}");
            zeros += n.iter().filter(|&&n| n == 0.0).count();
        }
    }
    assert!(zeros > 5000, "{zeros}");
    Ok(())
}

/// Middles at a quarter of their edges, as at the tip of a crack, where the map is singular, fold nothing.
#[test]
fn quarter_points_are_no_fault() -> Outcome {
    let mut nodes: Vec<Place> = straight(Shape::Hex20);
    for (middle, corner) in [(8, 0), (16, 0), (11, 0), (9, 1)] {
        nodes[middle] = from_fn(|k| 0.5 * (nodes[middle][k] + nodes[corner][k]));
    }
    for seed in 0..20 {
        let turned: Vec<Place> = nodes.iter().map(|&x| turned(seed, x)).collect();
        let node = inside(seed, &turned[..8]);
        let n = weights(tie(Shape::Hex20, node, &turned, 1e-12))?;
        assert!(off(&n, &turned, node, 1.0) < 1e-14);
        let tip = weights(tie(Shape::Hex20, turned[0], &turned, 1e-7))?;
        assert!(off(&tip, &turned, turned[0], 1.0) < 1e-7);
    }
    Ok(())
}

/// Corners, points of edges and points of faces of distorted elements lie on them, with a tolerance of zero, in every unit and far from the
/// origin; the tip of a pyramid is no exception.
#[test]
fn the_boundary_belongs_to_the_element() -> Outcome {
    for (shape, seed) in solids().flat_map(|shape| (0..20).map(move |k| (shape, 100 * k))) {
        let off_straight =
            |k: usize, d: usize| if shape.nodes() > corners(shape) { 0.0 } else { 0.25 * random(seed + 3 * k + d) };
        let moved = |(k, x): (usize, Place)| turned(seed, affine(seed, from_fn(|d| x[d] + off_straight(k, d))));
        let distorted: Vec<Place> = straight(shape).into_iter().enumerate().map(moved).collect();
        for (unit, shift) in [(1.0, 0.0), (1e-6, 0.0), (1e6, 0.0), (1.0, 1e5), (1e-6, 10.0)] {
            let nodes: Vec<Place> = distorted.iter().map(|x| x.map(|x| unit * x + shift)).collect();
            let last = corners(shape) - 1;
            let t = 0.5 + random(seed + 9);
            let along = |a: usize, b: usize| from_fn(|k| nodes[a][k] + t * (nodes[b][k] - nodes[a][k]));
            // 2 to the last corner is an edge of tetrahedra, of pyramids, and of wedges; not of hexahedra.
            let edge = if last == 7 { along(3, 7) } else { along(2, last) };
            for node in [nodes[0], nodes[last], along(0, 1), edge] {
                let n = weights(tie(shape, node, &nodes, 0.0))
                    .map_err(|words| format!("{shape:?}, {seed}, {unit}, {shift}: {words}"))?;
                let (back, allowed) = (off(&n, &nodes, node, unit), 1e-14 * (1.0 + shift / unit));
                assert!(back < allowed, "{shape:?}, {seed}, {unit}, {shift}: {back}");
            }
            if shift == 0.0 {
                let n = weights(tie(shape, nodes[last], &nodes, 0.0))?;
                assert!(n.iter().enumerate().all(|(k, &n)| n == f64::from(u8::from(k == last))), "{shape:?}, {n:?}");
            }
        }
    }
    Ok(())
}

/// Layers a million times thinner than they are long, and nodes a million sizes away.
#[test]
fn thin_elements_and_far_nodes() -> Outcome {
    for (shape, seed) in [Shape::Tet4, Shape::Pyramid13, Shape::Wedge6, Shape::Hex8, Shape::Hex20, Shape::Hex27]
        .into_iter()
        .flat_map(|s| (0..10).map(move |k| (s, 51 * k)))
    {
        let thin = |[x, y, z]: Place| turned(seed, [x, y, 1e-6 * z]);
        let nodes: Vec<Place> = straight(shape).into_iter().map(thin).collect();
        let node = inside(seed, &nodes[..corners(shape)]);
        let n = weights(tie(shape, node, &nodes, 0.0))?;
        assert!(off(&n, &nodes, node, 1.0) < 1e-15 * 4.0, "{shape:?}: {}", off(&n, &nodes, node, 1.0));
        let whole: Vec<Place> = straight(shape).into_iter().map(|x| turned(seed, x)).collect();
        let far = turned(seed, [-3e6, -4e6, 0.0]);
        let mut builder = ConstraintSet::builder(28);
        let error = builder.add("it", tie(shape, far, &whole, 0.5)).expect_err("far");
        let Some(NodeTieError::TooFar { distance, .. }) = source(&error) else { return Err(error.into()) };
        assert!((distance - 5e6).abs() < 1e-14 * 5e6, "{distance}");
    }
    Ok(())
}

#[test]
fn faults_of_solids_are_named() -> Outcome {
    let nodes = straight(Shape::Hex8);
    let mut folded = nodes.clone();
    folded.swap(5, 6);
    assert!(weights(tie(Shape::Hex8, [0.5; 3], &folded, 1.0)).is_err_and(|words| words.contains("folded")));
    assert!(weights(tie(Shape::Hex8, [0.5; 3], &nodes[..4], 1.0)).is_err_and(|words| words.contains("a Hex8 has 8")));
    let flat: Vec<Place> = nodes.iter().map(|&[x, y, _]| [x, y, 0.0]).collect();
    assert!(weights(tie(Shape::Hex8, [0.5, 0.5, 0.0], &flat, 1.0)).is_err_and(|words| words.contains("degenerate")));
    assert!(weights(tie(Shape::Hex8, [f64::NAN; 3], &nodes, 1.0)).is_err());
    // A solid has no place in the plane.
    let planar = Surface {
        nodes: nodes.iter().enumerate().map(|(i, &[x, y, z])| Node::of_field(i, [x + 0.1 * z, y])).collect(),
        faces: vec![Face::new(Shape::Hex8, [0, 1, 2, 3, 4, 5, 6, 7])],
    };
    assert_eq!(FaceSearch::new(&planar).err(), Some(SurfaceError::Degenerate { face: 1 }));
    // A hexahedron of which one side is an edge is a wedge.
    let collapsed: Vec<Place> = nodes.iter().map(|&[x, y, z]| [x, if x > 0.5 { 0.0 } else { y }, z]).collect();
    let n = weights(tie(Shape::Hex8, [0.5, 0.25, 0.5], &collapsed, 1e-12))?;
    assert!(off(&n, &collapsed, [0.5, 0.25, 0.5], 1.0) < 1e-15);
    Ok(())
}
