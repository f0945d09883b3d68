use std::array::from_fn;

use qless_constraints::types::{Face, Point, Section, Shape, Surface};

pub const SECTIONS: [Section; 3] = [Section::Rigid, Section::Plane, Section::Mean];

/// Nodes with three DOFs each from `dof` on.
pub fn points(dof: usize, at: &[[f64; 3]]) -> Vec<Point> {
    (0..at.len()).map(|i| Point::new(from_fn(|k| dof + 3 * i + k), at[i])).collect()
}

/// A unit square at a height.
pub fn square(height: usize, dof: usize) -> Surface<3> {
    let z = height as f64;
    let corners = [[0.0, 0.0, z], [1.0, 0.0, z], [1.0, 1.0, z], [0.0, 1.0, z]];
    Surface { nodes: points(dof, &corners), faces: vec![Face::new(Shape::Quad4, [0, 1, 2, 3])] }
}

/// The rectangle 3 x 2 in faces of one shape, four of them or eight, with inner nodes off the middle where edges stay straight
/// lines and faces parallelograms (or triangles); then moved.
pub fn rectangle(shape: Shape, dof: usize, moved: impl Fn([f64; 3]) -> [f64; 3]) -> Surface<3> {
    let (xs, ys) = ([0.0, 0.45, 0.9, 1.95, 3.0], [0.0, 0.25, 0.5, 1.25, 2.0]);
    let quads = [[0, 0], [2, 0], [0, 2], [2, 2]];
    let of = |[i, j]: [usize; 2]| 5 * j + i;
    let around = |[i, j]: [usize; 2]| -> Vec<usize> {
        [[0, 0], [2, 0], [2, 2], [0, 2], [1, 0], [2, 1], [1, 2], [0, 1], [1, 1]]
            .map(|[a, b]| of([i + a, j + b]))
            .to_vec()
    };
    let faces = quads.into_iter().flat_map(|quad| {
        let n = around(quad);
        match shape {
            Shape::Quad4 | Shape::Quad8 | Shape::Quad9 => vec![Face::new(shape, &n[..shape.nodes()])],
            Shape::Tri3 => vec![Face::new(shape, [n[0], n[1], n[2]]), Face::new(shape, [n[0], n[2], n[3]])],
            _ => vec![
                Face::new(shape, [n[0], n[1], n[2], n[4], n[5], n[8]]),
                Face::new(shape, [n[0], n[2], n[3], n[8], n[6], n[7]]),
            ],
        }
    });
    let at: Vec<[f64; 3]> = (0..25).map(|i| moved([xs[i % 5], ys[i / 5], 0.0])).collect();
    Surface { faces: faces.collect(), nodes: points(dof, &at) }
}

/// Nodes that faces name.
pub fn used(surface: &Surface<3>) -> Vec<usize> {
    let mut used: Vec<usize> = surface.faces.iter().flat_map(|face| face.nodes.iter().copied()).collect();
    used.sort_unstable();
    used.dedup();
    used
}
