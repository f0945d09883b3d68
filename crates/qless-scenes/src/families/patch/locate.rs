//! Finds the face at a point by a table of square buckets, in constant time on even meshes.

use super::PatchFace;

/// Faces that cover the square `[0, 1]^2`, with the coordinates of their corners.
pub(in super::super) struct Locator {
    faces: Vec<(PatchFace, [[f64; 2]; 4])>,
    /// For each bucket, the faces whose bounding box touches it.
    buckets: Vec<Vec<u32>>,
    /// Number of buckets along each side of the square.
    side: usize,
}

impl Locator {
    pub(in super::super) fn new(faces: &[PatchFace], at: impl Fn(usize) -> [f64; 2]) -> Self {
        let side = faces.len().isqrt().max(1);
        let mut locator = Self { faces: Vec::with_capacity(faces.len()), buckets: vec![Vec::new(); side * side], side };
        for (number, face) in faces.iter().enumerate() {
            let mut corners = [[0.0; 2]; 4];
            corners.iter_mut().zip(face.nodes()).for_each(|(corner, &node)| *corner = at(node));
            let [columns, rows] = [0, 1].map(|axis| locator.range(&corners[..face.nodes().len()], axis));
            for bucket in rows.flat_map(|row| columns.clone().map(move |column| column + side * row)) {
                locator.buckets[bucket].push(number as u32);
            }
            locator.faces.push((*face, corners));
        }
        locator
    }

    /// Range of buckets that the corners span along an axis.
    fn range(&self, corners: &[[f64; 2]], axis: usize) -> std::ops::RangeInclusive<usize> {
        let along = || corners.iter().map(|corner| corner[axis]);
        self.bucket(along().fold(1.0, f64::min))..=self.bucket(along().fold(0.0, f64::max))
    }

    fn bucket(&self, along: f64) -> usize {
        ((along * self.side as f64) as usize).min(self.side - 1)
    }

    /// The face that contains a point at the greatest [`PatchFace::depth`], and the values of its functions there.
    pub(in super::super) fn at(&self, point: [f64; 2]) -> (&PatchFace, [f64; 4]) {
        let [column, row] = point.map(|along| self.bucket(along));
        let within = |&number: &u32| {
            let (face, corners) = &self.faces[number as usize];
            let at = face.parameters(corners, point)?;
            Some((face, at, face.depth(at)))
        };
        let found = self.buckets[column + self.side * row].iter().filter_map(within).max_by(|a, b| a.2.total_cmp(&b.2));
        let (face, at, _) = found.expect("the faces cover the square");
        (face, face.functions(at).map(|function| function[0]))
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Faces, Grid};
    use super::*;
    use crate::Rng;

    /// The values of the functions are weights of a convex combination of the corners that equals the point.
    #[test]
    fn every_point_lies_in_the_face_that_is_found() {
        let mut rng = Rng::new(3);
        for (faces, cells) in [(Faces::Quads, [90, 70]), (Faces::Triangles, [70, 90]), (Faces::Quads, [1, 1])] {
            let grid = Grid::jittered(cells, faces, &mut rng);
            let locator = Locator::new(&grid.faces, |node| grid.nodes[node]);
            for k in 0..20_000 {
                let mut point = [0; 2].map(|_| rng.real().abs());
                point[k % 2] = if k % 5 == 0 { (k % 3).min(1) as f64 } else { point[k % 2] };
                let (face, values) = locator.at(point);
                assert!(values.iter().all(|&value| value > -1e-14), "{point:?}: {values:?}");
                for axis in 0..2 {
                    let terms = face.nodes().iter().zip(values).map(|(&node, value)| value * grid.nodes[node][axis]);
                    assert!((terms.sum::<f64>() - point[axis]).abs() < 1e-14, "{point:?}");
                }
            }
        }
    }
}
