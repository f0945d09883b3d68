//! Parameters of the nodes, and the domain of the parameters of each shape.

use super::Shape;

/// Parameters `xi, eta, zeta`; unused ones are zero.
pub(crate) type ShapeParameters = [f64; 3];

/// Parameters of the corners and of the middles of the edges; those of other nodes are zero.
const fn with_middles<const N: usize>(corners: &[ShapeParameters], shape: Shape) -> [ShapeParameters; N] {
    let (mut all, mut k) = ([[0.0; 3]; N], 0);
    while k < corners.len() {
        all[k] = corners[k];
        k += 1;
    }
    let edges = shape.edges();
    k = 0;
    while k < edges.len() {
        let [middle, a, b] = edges[k];
        let (a, b) = (all[a], all[b]);
        all[middle] = [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 0.5 * (a[2] + b[2])];
        k += 1;
    }
    all
}

const LINE: [ShapeParameters; 3] = with_middles(&[[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0]], Shape::Line3);
const TRIANGLE: [ShapeParameters; 6] = with_middles(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], Shape::Tri6);
const TETRAHEDRON: [ShapeParameters; 10] =
    with_middles(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], Shape::Tet10);
const SQUARE: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];

/// Parameters of corner k of the square [-1, 1] x [-1, 1], at the height zeta.
const fn corner(k: usize, zeta: f64) -> ShapeParameters {
    [SQUARE[k][0], SQUARE[k][1], zeta]
}

const QUADRILATERAL: [ShapeParameters; 9] =
    with_middles(&[corner(0, 0.0), corner(1, 0.0), corner(2, 0.0), corner(3, 0.0)], Shape::Quad9);
const PYRAMID: [ShapeParameters; 13] =
    with_middles(&[corner(0, 0.0), corner(1, 0.0), corner(2, 0.0), corner(3, 0.0), [0.0, 0.0, 1.0]], Shape::Pyramid13);
const WEDGE: [ShapeParameters; 15] = with_middles(
    &[[0.0, 0.0, -1.0], [1.0, 0.0, -1.0], [0.0, 1.0, -1.0], [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]],
    Shape::Wedge15,
);
const HEXAHEDRON: [ShapeParameters; 27] = {
    let below = [corner(0, -1.0), corner(1, -1.0), corner(2, -1.0), corner(3, -1.0)];
    let above = [corner(0, 1.0), corner(1, 1.0), corner(2, 1.0), corner(3, 1.0)];
    let [a, b, c, d] = below;
    let [e, f, g, h] = above;
    let mut all: [ShapeParameters; 27] = with_middles(&[a, b, c, d, e, f, g, h], Shape::Hex27);
    // Nodes 20 to 25 are the middles of the faces: one parameter is -1 or 1, the others stay zero.
    (all[20][2], all[21][2], all[22][1], all[23][0], all[24][1], all[25][0]) = (-1.0, 1.0, -1.0, 1.0, 1.0, -1.0);
    all
};

impl Shape {
    /// Parameters of the nodes.
    pub(crate) fn places(self) -> &'static [ShapeParameters] {
        match self {
            Self::Line2 => &LINE[..2],
            Self::Line3 => &LINE,
            Self::Tri3 => &TRIANGLE[..3],
            Self::Tri6 => &TRIANGLE,
            Self::Quad4 => &QUADRILATERAL[..4],
            Self::Quad8 => &QUADRILATERAL[..8],
            Self::Quad9 => &QUADRILATERAL,
            Self::Tet4 => &TETRAHEDRON[..4],
            Self::Tet10 => &TETRAHEDRON,
            Self::Pyramid5 => &PYRAMID[..5],
            Self::Pyramid13 => &PYRAMID,
            Self::Wedge6 => &WEDGE[..6],
            Self::Wedge15 => &WEDGE,
            Self::Hex8 => &HEXAHEDRON[..8],
            Self::Hex20 => &HEXAHEDRON[..20],
            Self::Hex27 => &HEXAHEDRON,
        }
    }

    /// Parameters of an inner point, away from the boundary.
    pub(crate) fn centre(self) -> ShapeParameters {
        match self {
            Self::Tri3 | Self::Tri6 | Self::Wedge6 | Self::Wedge15 => [1.0 / 3.0, 1.0 / 3.0, 0.0],
            Self::Tet4 | Self::Tet10 => [0.25; 3],
            Self::Pyramid5 | Self::Pyramid13 => [0.0, 0.0, 0.25],
            _ => [0.0; 3],
        }
    }

    /// The nearest parameters inside the shape, approximately; parameters inside are unchanged.
    pub(crate) fn clamp(self, [xi, eta, zeta]: ShapeParameters) -> ShapeParameters {
        let unit = |x: f64| x.clamp(-1.0, 1.0);
        match self {
            Self::Line2 | Self::Line3 => [unit(xi), 0.0, 0.0],
            Self::Quad4 | Self::Quad8 | Self::Quad9 => [unit(xi), unit(eta), 0.0],
            Self::Hex8 | Self::Hex20 | Self::Hex27 => [unit(xi), unit(eta), unit(zeta)],
            Self::Tri3 | Self::Tri6 => {
                let [xi, eta] = in_triangle(xi, eta);
                [xi, eta, 0.0]
            }
            Self::Wedge6 | Self::Wedge15 => {
                let [xi, eta] = in_triangle(xi, eta);
                [xi, eta, unit(zeta)]
            }
            Self::Tet4 | Self::Tet10 => in_tetrahedron([xi, eta, zeta]),
            Self::Pyramid5 | Self::Pyramid13 => {
                let zeta = zeta.clamp(0.0, 1.0);
                [xi.clamp(zeta - 1.0, 1.0 - zeta), eta.clamp(zeta - 1.0, 1.0 - zeta), zeta]
            }
        }
    }
}

fn in_triangle(xi: f64, eta: f64) -> [f64; 2] {
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

fn in_tetrahedron(xi: ShapeParameters) -> ShapeParameters {
    let positive = xi.map(|x| x.max(0.0));
    let sum: f64 = positive.iter().sum();
    if sum > 1.0 { positive.map(|x| x / sum) } else { positive }
}
