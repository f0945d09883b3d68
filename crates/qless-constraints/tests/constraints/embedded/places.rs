use std::array::from_fn;

use qless_constraints::ConstraintSet;
use qless_constraints::types::{Face, FaceSearch, Node, NodeTieError, SearchError, Shape, Surface};

use super::{Place, affine, corners, off, solids, source, straight, tie, turned, weights};
use crate::common::{Outcome, random};

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
