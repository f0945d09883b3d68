//! Element shapes: lines, faces and solids with `x(xi) = sum_k N_k(xi) x_k`. Corners come first, then mid-edge nodes.

mod boundary;
mod domain;
mod functions;

pub(crate) use domain::ShapeParameters;

/// Shape of an element, a face or an edge: the number and the order of its nodes, and the functions of
/// `x(xi) = sum_k N_k(xi) x_k`.
///
/// Parameters: [-1, 1] for lines, quadrilaterals and hexahedra; `xi, eta, zeta >= 0` and `xi + eta + zeta <= 1` for
/// triangles and tetrahedra; a triangle in `xi, eta` times a line in `zeta` for wedges; `|xi|, |eta| <= 1 - zeta` and
/// `0 <= zeta <= 1` for pyramids. Quad8, Hex20 and Wedge15 are serendipity elements. Lines, triangles and tetrahedra use
/// complete polynomials; the other quadrilaterals, hexahedra and wedges use products of them. The functions of pyramids
/// are rational (Bedrosian, Int. J. Numer. Meth. Engng 35 (1992) 95): a pyramid on a parallelogram is affine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// Two ends.
    Line2,
    /// Two ends, then the middle.
    Line3,
    /// Three corners.
    Tri3,
    /// Four corners, in order around.
    Quad4,
    /// Three corners, then the middles of edges 12, 23, 31.
    Tri6,
    /// Four corners, then the middles of edges 12, 23, 34, 41.
    Quad8,
    /// As [`Shape::Quad8`], then the centre.
    Quad9,
    /// Four corners.
    Tet4,
    /// Four corners, then the middles of edges 12, 23, 31, 14, 24, 34.
    Tet10,
    /// Four corners of the base, in order around, then the tip.
    Pyramid5,
    /// Four corners of the base, in order around, the tip, then the middles of edges 12, 23, 34, 41, and of 15, 25, 35, 45.
    Pyramid13,
    /// Three corners, then the three over them.
    Wedge6,
    /// Three corners, the three over them, then the middles of edges 12, 23, 31, of 45, 56, 64, and of 14, 25, 36.
    Wedge15,
    /// Four corners in order around, then the four over them.
    Hex8,
    /// Four corners, the four over them, then the middles of edges 12, 23, 34, 41, of 56, 67, 78, 85, and of 15, 26, 37, 48.
    Hex20,
    /// As [`Shape::Hex20`], then the middles of faces 1234, 5678, 1265, 2376, 3487, 4158, then the centre.
    Hex27,
}

impl Shape {
    /// All shapes: lines, faces, then solids.
    pub const ALL: [Self; 16] = [
        Self::Line2,
        Self::Line3,
        Self::Tri3,
        Self::Quad4,
        Self::Tri6,
        Self::Quad8,
        Self::Quad9,
        Self::Tet4,
        Self::Tet10,
        Self::Pyramid5,
        Self::Pyramid13,
        Self::Wedge6,
        Self::Wedge15,
        Self::Hex8,
        Self::Hex20,
        Self::Hex27,
    ];

    /// Number of nodes.
    pub fn nodes(self) -> usize {
        self.places().len()
    }

    /// Number of parameters: 1 for lines, 2 for faces, 3 for solids.
    pub fn dimensions(self) -> usize {
        match self {
            Self::Line2 | Self::Line3 => 1,
            Self::Tri3 | Self::Quad4 | Self::Tri6 | Self::Quad8 | Self::Quad9 => 2,
            _ => 3,
        }
    }

    /// Parameters of the corners.
    pub(crate) fn corners(self) -> &'static [ShapeParameters] {
        let count = match self {
            Self::Line2 | Self::Line3 => 2,
            Self::Tri3 | Self::Tri6 => 3,
            Self::Quad4 | Self::Quad8 | Self::Quad9 | Self::Tet4 | Self::Tet10 => 4,
            Self::Pyramid5 | Self::Pyramid13 => 5,
            Self::Wedge6 | Self::Wedge15 => 6,
            Self::Hex8 | Self::Hex20 | Self::Hex27 => 8,
        };
        &self.places()[..count]
    }

    /// Whether `x(xi)` is affine for all positions of the nodes.
    pub(crate) fn is_affine(self) -> bool {
        matches!(self, Self::Line2 | Self::Tri3 | Self::Tet4)
    }
}

#[cfg(test)]
pub(in crate::geometry) mod tests {
    use super::{Shape, ShapeParameters};

    /// A pseudorandom number in [0, 1), the same on every machine.
    pub fn random(seed: usize) -> f64 {
        let z = (seed as u64 + 11).wrapping_mul(0x9E37_79B9_7F4A_7C15).rotate_left(29);
        f64::from((z.wrapping_mul(0xD6E8_FEB8_6659_FD93) >> 40) as u32) / f64::from(1_u32 << 24)
    }

    /// A pseudorandom point inside a shape, not on its boundary.
    pub fn inside(shape: Shape, seed: usize) -> ShapeParameters {
        let weights: Vec<f64> = shape.corners().iter().enumerate().map(|(k, _)| 0.1 + random(97 * seed + k)).collect();
        let sum: f64 = weights.iter().sum();
        let corners = shape.corners().iter().zip(&weights);
        corners.fold([0.0; 3], |at, (p, w)| std::array::from_fn(|k| at[k] + w / sum * p[k]))
    }
}
