use std::array::from_fn;

use qless_constraints::ConstraintSet;
use qless_constraints::types::{Face, FaceSearch, Node, NodeTieError, Shape, Surface, SurfaceError};

use super::{Place, corners, inside, off, source, straight, tie, turned, weights};
use crate::common::Outcome;

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
