//! Faces of solids, edges of faces, and mid-edge nodes.

use Shape::{Line2, Line3, Quad4, Quad8, Quad9, Tri3, Tri6};

use super::Shape;

/// A side of an element: its shape, and the indices of its nodes in the element.
type BoundarySide = (Shape, &'static [usize]);

impl Shape {
    /// The faces of a solid, or the edges of a face in cyclic order; empty for lines.
    pub(crate) fn boundary(self) -> &'static [BoundarySide] {
        match self {
            Self::Line2 | Self::Line3 => &[],
            Self::Tri3 => &[(Line2, &[0, 1]), (Line2, &[1, 2]), (Line2, &[2, 0])],
            Self::Quad4 => &[(Line2, &[0, 1]), (Line2, &[1, 2]), (Line2, &[2, 3]), (Line2, &[3, 0])],
            Self::Tri6 => &[(Line3, &[0, 1, 3]), (Line3, &[1, 2, 4]), (Line3, &[2, 0, 5])],
            Self::Quad8 | Self::Quad9 => {
                &[(Line3, &[0, 1, 4]), (Line3, &[1, 2, 5]), (Line3, &[2, 3, 6]), (Line3, &[3, 0, 7])]
            }
            Self::Tet4 => &[(Tri3, &[0, 1, 2]), (Tri3, &[0, 1, 3]), (Tri3, &[1, 2, 3]), (Tri3, &[2, 0, 3])],
            Self::Tet10 => &[
                (Tri6, &[0, 1, 2, 4, 5, 6]),
                (Tri6, &[0, 1, 3, 4, 8, 7]),
                (Tri6, &[1, 2, 3, 5, 9, 8]),
                (Tri6, &[2, 0, 3, 6, 7, 9]),
            ],
            Self::Pyramid5 => &[
                (Quad4, &[0, 1, 2, 3]),
                (Tri3, &[0, 1, 4]),
                (Tri3, &[1, 2, 4]),
                (Tri3, &[2, 3, 4]),
                (Tri3, &[3, 0, 4]),
            ],
            Self::Pyramid13 => &[
                (Quad8, &[0, 1, 2, 3, 5, 6, 7, 8]),
                (Tri6, &[0, 1, 4, 5, 10, 9]),
                (Tri6, &[1, 2, 4, 6, 11, 10]),
                (Tri6, &[2, 3, 4, 7, 12, 11]),
                (Tri6, &[3, 0, 4, 8, 9, 12]),
            ],
            Self::Wedge6 => &[
                (Tri3, &[0, 1, 2]),
                (Tri3, &[3, 4, 5]),
                (Quad4, &[0, 1, 4, 3]),
                (Quad4, &[1, 2, 5, 4]),
                (Quad4, &[2, 0, 3, 5]),
            ],
            Self::Wedge15 => &[
                (Tri6, &[0, 1, 2, 6, 7, 8]),
                (Tri6, &[3, 4, 5, 9, 10, 11]),
                (Quad8, &[0, 1, 4, 3, 6, 13, 9, 12]),
                (Quad8, &[1, 2, 5, 4, 7, 14, 10, 13]),
                (Quad8, &[2, 0, 3, 5, 8, 12, 11, 14]),
            ],
            Self::Hex8 => &[
                (Quad4, &[0, 1, 2, 3]),
                (Quad4, &[4, 5, 6, 7]),
                (Quad4, &[0, 1, 5, 4]),
                (Quad4, &[1, 2, 6, 5]),
                (Quad4, &[2, 3, 7, 6]),
                (Quad4, &[3, 0, 4, 7]),
            ],
            Self::Hex20 => &[
                (Quad8, &[0, 1, 2, 3, 8, 9, 10, 11]),
                (Quad8, &[4, 5, 6, 7, 12, 13, 14, 15]),
                (Quad8, &[0, 1, 5, 4, 8, 17, 12, 16]),
                (Quad8, &[1, 2, 6, 5, 9, 18, 13, 17]),
                (Quad8, &[2, 3, 7, 6, 10, 19, 14, 18]),
                (Quad8, &[3, 0, 4, 7, 11, 16, 15, 19]),
            ],
            Self::Hex27 => &[
                (Quad9, &[0, 1, 2, 3, 8, 9, 10, 11, 20]),
                (Quad9, &[4, 5, 6, 7, 12, 13, 14, 15, 21]),
                (Quad9, &[0, 1, 5, 4, 8, 17, 12, 16, 22]),
                (Quad9, &[1, 2, 6, 5, 9, 18, 13, 17, 23]),
                (Quad9, &[2, 3, 7, 6, 10, 19, 14, 18, 24]),
                (Quad9, &[3, 0, 4, 7, 11, 16, 15, 19, 25]),
            ],
        }
    }

    /// `[middle, end, end]` of each edge with a middle node, in the order of the middle nodes.
    pub(crate) const fn edges(self) -> &'static [[usize; 3]] {
        match self {
            Self::Line3 => &[[2, 0, 1]],
            Self::Tri6 => &[[3, 0, 1], [4, 1, 2], [5, 2, 0]],
            Self::Quad8 | Self::Quad9 => &[[4, 0, 1], [5, 1, 2], [6, 2, 3], [7, 3, 0]],
            Self::Tet10 => &[[4, 0, 1], [5, 1, 2], [6, 2, 0], [7, 0, 3], [8, 1, 3], [9, 2, 3]],
            Self::Pyramid13 => {
                &[[5, 0, 1], [6, 1, 2], [7, 2, 3], [8, 3, 0], [9, 0, 4], [10, 1, 4], [11, 2, 4], [12, 3, 4]]
            }
            Self::Wedge15 => &[
                [6, 0, 1],
                [7, 1, 2],
                [8, 2, 0],
                [9, 3, 4],
                [10, 4, 5],
                [11, 5, 3],
                [12, 0, 3],
                [13, 1, 4],
                [14, 2, 5],
            ],
            Self::Hex20 | Self::Hex27 => &[
                [8, 0, 1],
                [9, 1, 2],
                [10, 2, 3],
                [11, 3, 0],
                [12, 4, 5],
                [13, 5, 6],
                [14, 6, 7],
                [15, 7, 4],
                [16, 0, 4],
                [17, 1, 5],
                [18, 2, 6],
                [19, 3, 7],
            ],
            _ => &[],
        }
    }
}

#[cfg(test)]
mod tests {
    use std::array::from_fn;

    use super::super::Shape;

    /// Every middle node lies halfway between the ends of its edge, and the shape functions on a side are those of the side's shape.
    #[test]
    fn sides_are_parts_of_the_whole() {
        let middles = [[0, -1, 1], [1, 0, 1], [0, 1, 1], [-1, 0, 1], [-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]];
        assert_eq!(Shape::Hex27.places()[12..20], middles.map(|place| place.map(f64::from)));
        for shape in Shape::ALL {
            let places = shape.places();
            for &[middle, a, b] in shape.edges() {
                assert_eq!(places[middle], from_fn(|k| f64::midpoint(places[a][k], places[b][k])), "{shape:?}");
            }
            for (side, nodes) in shape.boundary() {
                assert_eq!((side.nodes(), side.dimensions() + 1), (nodes.len(), shape.dimensions()));
                let at = side.centre();
                let inner: [f64; 3] =
                    from_fn(|k| side.weights(at).iter().zip(*nodes).map(|(n, &i)| n * places[i][k]).sum());
                let whole = shape.weights(inner);
                for (k, n) in whole.iter().enumerate() {
                    let own = nodes.iter().position(|&i| i == k).map_or(0.0, |own| side.weights(at)[own]);
                    assert!((own - n).abs() < 1e-14, "{shape:?}, {side:?}, node {k}: {own}, {n}");
                }
            }
        }
    }
}
