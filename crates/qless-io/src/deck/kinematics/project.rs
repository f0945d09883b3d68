//! Finds the point of a set of faces nearest to a given point x: `min over xi of abs(x - sum N_i(xi) x_i)`, by Gauss-Newton steps. N_i are
//! the shape functions of a face with parameters xi, and x_i the positions of its nodes.

use rustc_hash::FxHashMap;

use crate::deck::Problem;
use crate::deck::kinematics::vector::{Vector, cross, dot, length, minus, plus, scaled};
use crate::fault::quote;

/// Values of shape functions below this are rounding errors.
const ROUNDING: f64 = 1e-12;

/// A face of the master surface. `nodes` holds its corners in order, then the middle nodes of its edges.
pub struct MasterFace {
    pub nodes: Vec<u32>,
    points: Vec<Vector>,
    shape: shape::FaceShape,
}

/// The point of a face that is nearest to a given point.
pub struct NearestPoint {
    pub face: usize,
    pub distance: f64,
    /// The values of the shape functions at the nearest point, one for each node of the face.
    pub weights: Vec<f64>,
}

impl MasterFace {
    /// Makes the faces of a surface. `is_line` is true if they are edges of plane elements.
    pub fn all(
        faces: Vec<Vec<u32>>,
        is_line: bool,
        position: impl Fn(u32) -> Result<Vector, Problem>,
    ) -> Result<Vec<Self>, Problem> {
        faces.into_iter().map(|nodes| Self::new(nodes, is_line, &position)).collect()
    }

    /// Mean size of some faces; 0 if there are none.
    pub fn mean_size(faces: &[Self]) -> f64 {
        faces.iter().map(Self::size).sum::<f64>() / faces.len().max(1) as f64
    }

    /// Makes a face of its nodes: the corners in order, then the middle nodes of the edges.
    pub fn new(
        nodes: Vec<u32>,
        is_line: bool,
        position: impl Fn(u32) -> Result<Vector, Problem>,
    ) -> Result<Self, Problem> {
        let points = nodes.iter().map(|&node| position(node)).collect::<Result<_, _>>()?;
        let shape = shape::FaceShape::with_nodes(nodes.len(), is_line).ok_or_else(|| Problem::Expected {
            expected: "a master face with 2, 3, 4, 6 or 8 nodes",
            found: quote(nodes.len().to_string().as_bytes()),
        })?;
        Ok(Self { nodes, points, shape })
    }

    /// The shorter diagonal of a quadrilateral, or the shorter side at the last corner of a triangle.
    pub fn least_diagonal(&self) -> f64 {
        let corner = |k: usize| self.points[k.min(self.points.len() - 1)];
        length(minus(corner(0), corner(2))).min(length(minus(corner(1), corner(3))))
    }

    /// The longer diagonal of a quadrilateral, or the longest side of a triangle.
    pub fn longest_diagonal(&self) -> f64 {
        let corner = |k: usize| self.points[k.min(self.points.len() - 1)];
        let pairs = [(0, 2), (1, 3), (0, 1)].into_iter().filter(|pair| self.points.len() == 3 || *pair != (0, 1));
        pairs.map(|(a, b)| length(minus(corner(a), corner(b)))).fold(0.0, f64::max)
    }

    /// The normal at the centre of the face, by the right-hand rule about its corners. Its length is not 1.
    pub fn normal(&self) -> Vector {
        self.normal_at(self.shape.centre())
    }

    /// The normal at the middle of the edge from corner `k` to the next one.
    pub fn normal_at_edge(&self, k: usize) -> Vector {
        self.normal_at(self.shape.middle(k))
    }

    fn normal_at(&self, xi: [f64; 2]) -> Vector {
        let [s, t] = self.shape.at(xi).1.map(|slope| self.sum(&slope));
        cross(s, t)
    }

    /// The longest side of the bounding box of the face.
    fn size(&self) -> f64 {
        let (low, high) = self.bounds();
        (0..3).fold(0.0, |size: f64, k| size.max(high[k] - low[k]))
    }

    fn bounds(&self) -> (Vector, Vector) {
        let low = |a: Vector, b: &Vector| std::array::from_fn(|k| a[k].min(b[k]));
        let high = |a: Vector, b: &Vector| std::array::from_fn(|k| a[k].max(b[k]));
        (self.points.iter().fold([f64::INFINITY; 3], low), self.points.iter().fold([f64::NEG_INFINITY; 3], high))
    }

    /// The values of the shape functions at the point of the face that is nearest to `x`, and the distance from it.
    fn project(&self, x: Vector) -> (Vec<f64>, f64) {
        let mut xi = self.shape.centre();
        for _ in 0..30 {
            let before = xi;
            let (_, slopes) = self.shape.at(xi);
            let [s, t] = slopes.map(|slope| self.sum(&slope));
            let off = minus(x, self.point(xi));
            let (a, b, d) = (dot(s, s), dot(s, t), dot(t, t));
            let (p, q) = (dot(s, off), dot(t, off));
            let determinant = a * d - b * b;
            let step = if determinant > 1e-14 * a * d {
                [(d * p - b * q) / determinant, (a * q - b * p) / determinant]
            } else {
                [p / a.max(f64::MIN_POSITIVE), 0.0]
            };
            xi = self.shape.inside([xi[0] + step[0], xi[1] + step[1]]);
            // The parameters were clamped to the face before. So a step that leads off the face counts only with its part along the edge.
            if (xi[0] - before[0]).abs() + (xi[1] - before[1]).abs() < 1e-14 {
                break;
            }
        }
        let weights = self.shape.at(xi).0;
        (weights.iter().map(|w| if w.abs() < ROUNDING { 0.0 } else { *w }).collect(), length(minus(x, self.point(xi))))
    }

    fn point(&self, xi: [f64; 2]) -> Vector {
        self.sum(&self.shape.at(xi).0)
    }

    fn sum(&self, factors: &[f64]) -> Vector {
        self.points.iter().zip(factors).fold([0.0; 3], |sum, (point, factor)| plus(sum, scaled(*point, *factor)))
    }
}

/// Sorts faces into the cells of a spatial grid, so that only faces near a point are compared.
pub struct FaceGrid {
    cell: f64,
    cells: FxHashMap<[i64; 3], Vec<usize>>,
}

impl FaceGrid {
    pub fn new(faces: &[MasterFace], tolerance: f64) -> Self {
        let largest = faces.iter().map(MasterFace::size).fold(tolerance, f64::max);
        let mut grid = Self { cell: largest.max(f64::MIN_POSITIVE), cells: FxHashMap::default() };
        for (number, face) in faces.iter().enumerate() {
            let (low, high) = face.bounds();
            let (low, high) = (grid.cell(low.map(|x| x - tolerance)), grid.cell(high.map(|x| x + tolerance)));
            for i in low[0]..=high[0] {
                for j in low[1]..=high[1] {
                    (low[2]..=high[2]).for_each(|k| grid.cells.entry([i, j, k]).or_default().push(number));
                }
            }
        }
        grid
    }

    fn cell(&self, x: Vector) -> [i64; 3] {
        x.map(|x| (x / self.cell).floor() as i64)
    }

    /// The nearest point on the faces in the cell of x. If faces are equally near, the first one is taken. `None` if the cell has no faces.
    pub fn nearest(&self, faces: &[MasterFace], x: Vector) -> Option<NearestPoint> {
        let mut best: Option<NearestPoint> = None;
        for &face in self.cells.get(&self.cell(x))? {
            let (weights, distance) = faces[face].project(x);
            if best.as_ref().is_none_or(|best| distance < best.distance * (1.0 - 1e-9)) {
                best = Some(NearestPoint { face, distance, weights });
            }
        }
        best
    }
}

/// Shape functions of faces. The corners come first, then the middle nodes of the edges.
mod shape {
    /// The shape of a face and its number of nodes.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum FaceShape {
        Line2,
        Line3,
        Triangle3,
        Triangle6,
        Quadrilateral4,
        Quadrilateral8,
    }

    impl FaceShape {
        /// The shape of a face with this number of nodes.
        pub fn with_nodes(nodes: usize, is_line: bool) -> Option<Self> {
            match (nodes, is_line) {
                (2, _) => Some(Self::Line2),
                (3, true) => Some(Self::Line3),
                (3, false) => Some(Self::Triangle3),
                (6, _) => Some(Self::Triangle6),
                (4, _) => Some(Self::Quadrilateral4),
                (8, _) => Some(Self::Quadrilateral8),
                _ => None,
            }
        }

        pub fn centre(self) -> [f64; 2] {
            if matches!(self, Self::Triangle3 | Self::Triangle6) { [1.0 / 3.0; 2] } else { [0.0; 2] }
        }

        /// The parameters of the middle of the edge from corner `k` to the next one.
        pub fn middle(self, k: usize) -> [f64; 2] {
            let is_triangle = matches!(self, Self::Triangle3 | Self::Triangle6);
            let corners: &[[f64; 2]] = if is_triangle { &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]] } else { &CORNERS };
            let [a, b] = [k, k + 1].map(|k| corners[k % corners.len()]);
            [0, 1].map(|axis| f64::midpoint(a[axis], b[axis]))
        }

        /// The parameters s and t, clamped to the face.
        pub fn inside(self, [s, t]: [f64; 2]) -> [f64; 2] {
            match self {
                Self::Line2 | Self::Line3 => [s.clamp(-1.0, 1.0), 0.0],
                Self::Quadrilateral4 | Self::Quadrilateral8 => [s.clamp(-1.0, 1.0), t.clamp(-1.0, 1.0)],
                Self::Triangle3 | Self::Triangle6 => {
                    let (s, t) = (s.max(0.0), t.max(0.0));
                    let sum = (s + t).max(1.0);
                    [s / sum, t / sum]
                }
            }
        }

        /// The shape functions at the parameters s and t, and their derivatives by s and t.
        pub fn at(self, [s, t]: [f64; 2]) -> (Vec<f64>, [Vec<f64>; 2]) {
            match self {
                Self::Line2 => (vec![0.5 - s / 2.0, 0.5 + s / 2.0], [vec![-0.5, 0.5], vec![0.0; 2]]),
                Self::Line3 => {
                    let n = vec![s * (s - 1.0) / 2.0, s * (s + 1.0) / 2.0, 1.0 - s * s];
                    (n, [vec![s - 0.5, s + 0.5, -2.0 * s], vec![0.0; 3]])
                }
                Self::Triangle3 => (vec![1.0 - s - t, s, t], [vec![-1.0, 1.0, 0.0], vec![-1.0, 0.0, 1.0]]),
                Self::Triangle6 => triangle6(s, t),
                Self::Quadrilateral4 => quadrilateral4(s, t),
                Self::Quadrilateral8 => quadrilateral8(s, t),
            }
        }
    }

    fn triangle6(s: f64, t: f64) -> (Vec<f64>, [Vec<f64>; 2]) {
        let r = 1.0 - s - t;
        let n =
            vec![r * (2.0 * r - 1.0), s * (2.0 * s - 1.0), t * (2.0 * t - 1.0), 4.0 * r * s, 4.0 * s * t, 4.0 * t * r];
        let by_s = vec![1.0 - 4.0 * r, 4.0 * s - 1.0, 0.0, 4.0 * (r - s), 4.0 * t, -4.0 * t];
        let by_t = vec![1.0 - 4.0 * r, 0.0, 4.0 * t - 1.0, -4.0 * s, 4.0 * s, 4.0 * (r - t)];
        (n, [by_s, by_t])
    }

    const CORNERS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

    fn quadrilateral4(s: f64, t: f64) -> (Vec<f64>, [Vec<f64>; 2]) {
        let each = |f: &dyn Fn(f64, f64) -> f64| CORNERS.iter().map(|[a, b]| f(*a, *b)).collect();
        let n = each(&|a, b| (1.0 + a * s) * (1.0 + b * t) / 4.0);
        (n, [each(&|a, b| a * (1.0 + b * t) / 4.0), each(&|a, b| b * (1.0 + a * s) / 4.0)])
    }

    fn quadrilateral8(s: f64, t: f64) -> (Vec<f64>, [Vec<f64>; 2]) {
        let corner = |f: &dyn Fn(f64, f64) -> f64| CORNERS.iter().map(|[a, b]| f(*a, *b)).collect::<Vec<f64>>();
        let mut n = corner(&|a, b| (1.0 + a * s) * (1.0 + b * t) * (a * s + b * t - 1.0) / 4.0);
        let mut by_s = corner(&|a, b| a * (1.0 + b * t) * (2.0 * a * s + b * t) / 4.0);
        let mut by_t = corner(&|a, b| b * (1.0 + a * s) * (a * s + 2.0 * b * t) / 4.0);
        let (p, q) = (1.0 - s * s, 1.0 - t * t);
        n.extend([p * (1.0 - t) / 2.0, q * (1.0 + s) / 2.0, p * (1.0 + t) / 2.0, q * (1.0 - s) / 2.0]);
        by_s.extend([-s * (1.0 - t), q / 2.0, -s * (1.0 + t), -q / 2.0]);
        by_t.extend([-p / 2.0, -t * (1.0 + s), p / 2.0, -t * (1.0 - s)]);
        (n, [by_s, by_t])
    }

    #[cfg(test)]
    mod tests {
        use super::FaceShape;

        #[test]
        fn shape_functions_sum_to_one_and_slopes_are_their_differences() {
            let h = 1e-6;
            for (nodes, is_line) in [(2, true), (3, true), (3, false), (4, false), (6, false), (8, false)] {
                let xi = [0.3, 0.2];
                let shape = FaceShape::with_nodes(nodes, is_line).expect("a shape");
                let (n, slopes) = shape.at(xi);
                assert!((n.iter().sum::<f64>() - 1.0).abs() < 1e-14);
                for (axis, slope) in slopes.iter().enumerate() {
                    let moved = |d: f64| shape.at(if axis == 0 { [xi[0] + d, xi[1]] } else { [xi[0], xi[1] + d] }).0;
                    for ((a, b), slope) in moved(h).iter().zip(moved(-h)).zip(slope) {
                        assert!(((a - b) / (2.0 * h) - slope).abs() < 1e-8, "{nodes} nodes");
                    }
                }
            }
        }
    }
}
