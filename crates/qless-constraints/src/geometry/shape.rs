//! `x(xi) = sum_k N_k(xi) x_k`: shape functions of faces and lines, numbered corners first, then middles of edges.

/// A face or a line of an element. Lines and quadrilaterals: xi in [-1, 1]; triangles: xi, eta >= 0, xi + eta <= 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// Two nodes.
    Line2,
    /// Three corners.
    Tri3,
    /// Four corners, in order around.
    Quad4,
    /// Three corners, then the middles of edges 12, 23, 31.
    Tri6,
    /// Four corners, then the middles of edges 12, 23, 34, 41.
    Quad8,
}

const TRIANGLE: [[f64; 2]; 3] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
const CORNERS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
const MIDDLES: [[f64; 2]; 4] = [[0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]];

impl Shape {
    /// Number of nodes.
    pub fn nodes(self) -> usize {
        match self {
            Self::Line2 => 2,
            Self::Tri3 => 3,
            Self::Quad4 => 4,
            Self::Tri6 => 6,
            Self::Quad8 => 8,
        }
    }

    fn is_triangle(self) -> bool {
        matches!(self, Self::Tri3 | Self::Tri6)
    }

    pub(crate) fn dimensions(self) -> usize {
        if self == Self::Line2 { 1 } else { 2 }
    }

    pub(crate) fn centre(self) -> [f64; 2] {
        if self.is_triangle() { [1.0 / 3.0; 2] } else { [0.0; 2] }
    }

    /// Parameters of the corners, in order around; a line has no edges, and none.
    pub(crate) fn corners(self) -> &'static [[f64; 2]] {
        match self {
            Self::Line2 => &[],
            Self::Tri3 | Self::Tri6 => &TRIANGLE,
            Self::Quad4 | Self::Quad8 => &CORNERS,
        }
    }

    /// The nearest parameters inside, coordinate by coordinate.
    pub(crate) fn clamp(self, [xi, eta]: [f64; 2]) -> [f64; 2] {
        if !self.is_triangle() {
            return [xi.clamp(-1.0, 1.0), eta.clamp(-1.0, 1.0)];
        }
        let beyond = ((xi + eta - 1.0) / 2.0).max(0.0);
        let (xi, eta) = (xi - beyond, eta - beyond);
        if xi < 0.0 {
            [0.0, eta.clamp(0.0, 1.0)]
        } else if eta < 0.0 {
            [xi.clamp(0.0, 1.0), 0.0]
        } else {
            [xi, eta]
        }
    }

    /// `[N_k, dN_k / dxi, dN_k / deta]` for each node.
    pub(crate) fn functions(self, [xi, eta]: [f64; 2]) -> Vec<[f64; 3]> {
        match self {
            Self::Line2 => vec![[(1.0 - xi) / 2.0, -0.5, 0.0], [f64::midpoint(1.0, xi), 0.5, 0.0]],
            Self::Tri3 => vec![[1.0 - xi - eta, -1.0, -1.0], [xi, 1.0, 0.0], [eta, 0.0, 1.0]],
            Self::Quad4 => CORNERS.map(|corner| bilinear(corner, xi, eta)).to_vec(),
            Self::Tri6 => quadratic_triangle(xi, eta),
            Self::Quad8 => serendipity(xi, eta),
        }
    }
}

/// `(1 + a xi)(1 + b eta) / 4`.
fn bilinear([a, b]: [f64; 2], xi: f64, eta: f64) -> [f64; 3] {
    let (p, q) = (1.0 + a * xi, 1.0 + b * eta);
    [p * q / 4.0, a * q / 4.0, b * p / 4.0]
}

/// Corners `l (2 l - 1)`, edges `4 l_i l_j`, in area coordinates.
fn quadratic_triangle(xi: f64, eta: f64) -> Vec<[f64; 3]> {
    let l = [[1.0 - xi - eta, -1.0, -1.0], [xi, 1.0, 0.0], [eta, 0.0, 1.0]];
    let corner = |[l, x, y]: [f64; 3]| [l * (2.0 * l - 1.0), (4.0 * l - 1.0) * x, (4.0 * l - 1.0) * y];
    let edge = |i: usize, j: usize| {
        let slope = |k: usize| 4.0 * (l[i][0] * l[j][k] + l[i][k] * l[j][0]);
        [4.0 * l[i][0] * l[j][0], slope(1), slope(2)]
    };
    vec![corner(l[0]), corner(l[1]), corner(l[2]), edge(0, 1), edge(1, 2), edge(2, 0)]
}

/// Corners `(1 + a xi)(1 + b eta)(a xi + b eta - 1) / 4`, edges `(1 - xi^2)(1 + b eta) / 2` and likewise.
fn serendipity(xi: f64, eta: f64) -> Vec<[f64; 3]> {
    let corner = |[a, b]: [f64; 2]| {
        let ([n, x, y], r) = (bilinear([a, b], xi, eta), a * xi + b * eta - 1.0);
        [n * r, x * r + n * a, y * r + n * b]
    };
    let edge = |[a, b]: [f64; 2]| {
        if a == 0.0 {
            let (p, q) = (1.0 - xi * xi, 1.0 + b * eta);
            [p * q / 2.0, -xi * q, p * b / 2.0]
        } else {
            let (p, q) = (1.0 - eta * eta, 1.0 + a * xi);
            [p * q / 2.0, p * a / 2.0, -eta * q]
        }
    };
    CORNERS.map(corner).into_iter().chain(MIDDLES.map(edge)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Shape; 5] = [Shape::Line2, Shape::Tri3, Shape::Quad4, Shape::Tri6, Shape::Quad8];

    #[test]
    fn functions_sum_to_one_and_slopes_are_differences() {
        for shape in ALL {
            let at = [0.3, if shape == Shape::Line2 { 0.0 } else { 0.2 }];
            let n = shape.functions(at);
            assert_eq!(n.len(), shape.nodes());
            assert!((n.iter().map(|n| n[0]).sum::<f64>() - 1.0).abs() < 1e-15);
            for direction in 0..shape.dimensions() {
                let moved = |step: f64| {
                    let mut at = at;
                    at[direction] += step;
                    shape.functions(at)
                };
                for (k, (more, less)) in moved(1e-5).iter().zip(moved(-1e-5)).enumerate() {
                    assert!(((more[0] - less[0]) / 2e-5 - n[k][1 + direction]).abs() < 1e-9, "{shape:?} {k}");
                }
            }
        }
    }

    /// N_k is 1 at node k and 0 at the others.
    #[test]
    fn functions_interpolate() {
        let quad = [CORNERS, MIDDLES].concat();
        for (k, &at) in quad.iter().enumerate() {
            for (l, n) in Shape::Quad8.functions(at).iter().enumerate() {
                assert_eq!(n[0], f64::from(u8::from(k == l)));
            }
        }
        let triangle = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.0], [0.5, 0.5], [0.0, 0.5]];
        for (k, &at) in triangle.iter().enumerate() {
            for (l, n) in Shape::Tri6.functions(at).iter().enumerate() {
                assert_eq!(n[0], f64::from(u8::from(k == l)));
            }
        }
    }
}
