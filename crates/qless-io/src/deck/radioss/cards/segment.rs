//! The point of a master face below a node, as Radioss finds it (starter, `i2dst3.F`). It divides a quadrilateral into four triangles about its
//! middle m. In the triangle of m and the corners a and b, the node is above `m + l (a - m) + k (b - m)`. Then the point has the parameters
//! `(s, t) = l (s_a, t_a) + k (s_b, t_b)`, where those of the corners are 1 or -1, and the weights `(1 + s s_i) (1 + t t_i) / 4`. Beyond an edge
//! a parameter is larger than 1.

use crate::deck::kinematics::vector::{Vector, dot, minus, plus, scaled};

/// Weights below this are rounding errors.
const ROUNDING: f64 = 1e-12;

const CORNERS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

/// A point of a face.
#[derive(Clone, Debug, PartialEq)]
pub struct FacePoint {
    pub position: Vector,
    /// The weight of each corner.
    pub weights: Vec<f64>,
    parameters: [f64; 2],
}

impl FacePoint {
    fn new(corners: &[Vector], weights: Vec<f64>, parameters: [f64; 2]) -> Self {
        let weights: Vec<f64> = weights.into_iter().map(|w| if w.abs() < ROUNDING { 0.0 } else { w }).collect();
        let terms = corners.iter().zip(&weights).map(|(corner, weight)| scaled(*corner, *weight));
        Self { position: terms.fold([0.0; 3], plus), weights, parameters }
    }

    /// The larger of both parameters, without their signs.
    pub fn largest(&self) -> f64 {
        self.parameters[0].abs().max(self.parameters[1].abs())
    }
}

/// The point of a face with three or four corners below a node. `None` if the face has no area.
pub fn face_point(at: Vector, corners: &[Vector]) -> Option<FacePoint> {
    if let &[a, b, c] = corners {
        let [l, k] = coordinates(at, c, a, b)?;
        let s = if l + k > ROUNDING { (k - l) / (k + l) } else { 0.0 };
        return Some(FacePoint::new(corners, vec![l, k, 1.0 - l - k], [s, 1.0 - 2.0 * (l + k)]));
    }
    let middle = scaled(corners.iter().copied().fold([0.0; 3], plus), 0.25);
    let sector =
        |i: usize| coordinates(at, middle, *corners.get(i)?, *corners.get((i + 1) % 4)?).map(|found| (i, found));
    // The node is above the triangle in which neither coordinate is negative.
    let inside = |[l, k]: [f64; 2]| l.min(k);
    let (i, [l, k]) = (0..4).filter_map(sector).max_by(|a, b| inside(a.1).total_cmp(&inside(b.1)))?;
    let [s, t] = [0, 1].map(|axis| l * CORNERS[i][axis] + k * CORNERS[(i + 1) % 4][axis]);
    Some(FacePoint::new(corners, CORNERS.map(|[a, b]| (1.0 + a * s) * (1.0 + b * t) / 4.0).to_vec(), [s, t]))
}

/// The coordinates l and k of the point below `at` in the plane `o + l (a - o) + k (b - o)`. `None` if o, a and b are on a line.
fn coordinates(at: Vector, o: Vector, a: Vector, b: Vector) -> Option<[f64; 2]> {
    let (u, v, d) = (minus(a, o), minus(b, o), minus(at, o));
    let (uu, uv, vv, du, dv) = (dot(u, u), dot(u, v), dot(v, v), dot(d, u), dot(d, v));
    let determinant = uu * vv - uv * uv;
    let is_regular = determinant > ROUNDING * uu * vv;
    is_regular.then(|| [(du * vv - dv * uv) / determinant, (dv * uu - du * uv) / determinant])
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: [Vector; 4] = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]];

    #[test]
    fn points_below_nodes() {
        let point = face_point([0.5, 1.0, 3.0], &SQUARE).expect("a point");
        assert_eq!(
            (point.weights.as_slice(), point.position),
            ([0.375, 0.125, 0.125, 0.375].as_slice(), [0.5, 1.0, 0.0])
        );
        assert_eq!(point.largest(), 0.5);
        let triangle = face_point([0.5, 0.5, 1.0], &SQUARE[..3]).expect("a point");
        assert_eq!((triangle.weights.as_slice(), triangle.position), ([0.75, 0.0, 0.25].as_slice(), [0.5, 0.5, 0.0]));
        let beyond = face_point([2.5, 1.0, 0.0], &SQUARE).expect("a point");
        assert_eq!((beyond.weights.as_slice(), beyond.largest()), ([-0.125, 0.625, 0.625, -0.125].as_slice(), 1.5));
        assert_eq!(face_point([0.0; 3], &[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]), None);
        assert_eq!(face_point([0.0; 3], &[[1.0; 3]; 4]), None);
    }

    /// Weights sum to 1, and a corner has its own weight alone.
    #[test]
    fn corners_have_their_own_weight() {
        let trapezoid = [[0.0, 0.0, 0.0], [3.0, 0.0, 0.1], [2.0, 1.0, 0.0], [0.5, 1.0, 0.0]];
        for (k, corner) in trapezoid.into_iter().enumerate() {
            let weights = face_point(corner, &trapezoid).expect("a point").weights;
            (0..4).for_each(|i| assert!((weights[i] - f64::from(u8::from(i == k))).abs() < 1e-12, "{k}: {weights:?}"));
        }
        let weights = face_point([1.1, 0.4, 2.0], &trapezoid).expect("a point").weights;
        assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-14);
    }
}
