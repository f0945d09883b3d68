/// Thin, folded and collapsed elements.
mod extremes;
/// Weights: linear and quadratic fields, formulas, exact zeros.
mod fields;
/// The element of a node, on boundaries and outside.
mod places;

use std::array::from_fn;

use qless_constraints::ConstraintSet;
use qless_constraints::types::{Node, NodeTie, NodeTieError, Shape};

use crate::common::random;

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

fn source(error: &qless_constraints::AddError<NodeTieError>) -> Option<NodeTieError> {
    match error {
        qless_constraints::AddError::Input { source, .. } => Some(*source),
        _ => None,
    }
}
