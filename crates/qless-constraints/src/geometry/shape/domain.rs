//! Parameters of the nodes, and the domain of the parameters of each shape.

use super::Shape;

/// Parameters `xi, eta, zeta`; unused ones are zero.
pub(crate) type ShapeParameters = [f64; 3];

const LINE: [ShapeParameters; 3] = [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0; 3]];
const TETRAHEDRON: [ShapeParameters; 10] = [
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, 0.0, 1.0],
    [0.5, 0.0, 0.0],
    [0.5, 0.5, 0.0],
    [0.0, 0.5, 0.0],
    [0.0, 0.0, 0.5],
    [0.5, 0.0, 0.5],
    [0.0, 0.5, 0.5],
];
const TRIANGLE: [ShapeParameters; 6] =
    [TETRAHEDRON[0], TETRAHEDRON[1], TETRAHEDRON[2], TETRAHEDRON[4], TETRAHEDRON[5], TETRAHEDRON[6]];
const QUADRILATERAL: [ShapeParameters; 9] = [
    [-1.0, -1.0, 0.0],
    [1.0, -1.0, 0.0],
    [1.0, 1.0, 0.0],
    [-1.0, 1.0, 0.0],
    [0.0, -1.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [-1.0, 0.0, 0.0],
    [0.0, 0.0, 0.0],
];
const PYRAMID: [ShapeParameters; 13] = [
    QUADRILATERAL[0],
    QUADRILATERAL[1],
    QUADRILATERAL[2],
    QUADRILATERAL[3],
    [0.0, 0.0, 1.0],
    QUADRILATERAL[4],
    QUADRILATERAL[5],
    QUADRILATERAL[6],
    QUADRILATERAL[7],
    [-0.5, -0.5, 0.5],
    [0.5, -0.5, 0.5],
    [0.5, 0.5, 0.5],
    [-0.5, 0.5, 0.5],
];
const WEDGE: [ShapeParameters; 15] = [
    [0.0, 0.0, -1.0],
    [1.0, 0.0, -1.0],
    [0.0, 1.0, -1.0],
    [0.0, 0.0, 1.0],
    [1.0, 0.0, 1.0],
    [0.0, 1.0, 1.0],
    [0.5, 0.0, -1.0],
    [0.5, 0.5, -1.0],
    [0.0, 0.5, -1.0],
    [0.5, 0.0, 1.0],
    [0.5, 0.5, 1.0],
    [0.0, 0.5, 1.0],
    [0.0, 0.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
];
const HEXAHEDRON: [ShapeParameters; 27] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
    [0.0, -1.0, -1.0],
    [1.0, 0.0, -1.0],
    [0.0, 1.0, -1.0],
    [-1.0, 0.0, -1.0],
    [0.0, -1.0, 1.0],
    [1.0, 0.0, 1.0],
    [0.0, 1.0, 1.0],
    [-1.0, 0.0, 1.0],
    [-1.0, -1.0, 0.0],
    [1.0, -1.0, 0.0],
    [1.0, 1.0, 0.0],
    [-1.0, 1.0, 0.0],
    [0.0, 0.0, -1.0],
    [0.0, 0.0, 1.0],
    [0.0, -1.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [-1.0, 0.0, 0.0],
    [0.0, 0.0, 0.0],
];

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
