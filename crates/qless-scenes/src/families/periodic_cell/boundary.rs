//! The surface of the cube `[0, 1]^3`: corners, then edges, then the interior of the faces, each with a mesh of its own.

use super::{Edges, PeriodicCell};
use crate::Rng;
use crate::families::patch::{Faces, Grid, PatchFace, zip};

/// Largest random displacement of the nodes of edges, relative to the length of an element.
const MOVE: f64 = 0.3;

/// Nodes of the surface, and the meshes of its sides.
pub(super) struct Boundary {
    pub(super) nodes: Vec<[f64; 3]>,
    /// For each axis, the faces of the mesh on the side with coordinate 0 along this axis.
    pub(super) near: [Vec<PatchFace>; 3],
    /// For each axis, the nodes on the side with coordinate 1 along this axis.
    pub(super) far: [Vec<usize>; 3],
}

/// Nodes of an edge including its corners, ascending.
type Edge = Vec<usize>;

impl Boundary {
    pub(super) fn new(cell: &PeriodicCell, rng: &mut Rng) -> Self {
        let corners = (0..8).map(|corner| [0, 1, 2].map(|axis| f64::from(corner >> axis & 1))).collect();
        let mut boundary = Self { nodes: corners, near: [const { Vec::new() }; 3], far: [const { Vec::new() }; 3] };
        let edges: Vec<Edge> = (0..3).flat_map(|axis| boundary.add_edges(cell, axis, rng)).collect();
        for axis in 0..3 {
            let grid = Grid::jittered([cell.near - 2; 2], cell.near_faces, rng);
            let numbers = boundary.add_inside(&grid, [axis, 0], cell.near);
            let inside = grid.faces.iter().map(|face| face.renumbered(|k| numbers[k]));
            boundary.near[axis] = inside.chain(boundary.strips(&edges, axis, &numbers)).collect();
            // The equations need only the nodes of the far mesh.
            boundary.add_inside(&Grid::jittered([cell.far - 2; 2], Faces::Quads, rng), [axis, 1], cell.far);
        }
        for axis in 0..3 {
            boundary.far[axis] = (0..boundary.nodes.len()).filter(|&k| boundary.nodes[k][axis] == 1.0).collect();
        }
        boundary
    }

    /// The four edges along an axis, numbered by bits for their positions along the two other axes.
    fn add_edges(&mut self, cell: &PeriodicCell, axis: usize, rng: &mut Rng) -> Vec<Edge> {
        let mut places = Vec::new();
        let mut edges = Vec::new();
        for bits in 0..4 {
            let elements = if bits == 0 { cell.near } else { cell.far };
            if bits == 0 || cell.edges == Edges::Own {
                places = (1..elements).map(|k| (k as f64 + MOVE * rng.real()) / elements as f64).collect();
            }
            let at = |along: f64| in_space(axis, [along, f64::from(bits & 1), f64::from(bits >> 1)]);
            let inner = self.add(places.iter().map(|&along| at(along)));
            edges.push([vec![corner(at(0.0))], inner, vec![corner(at(1.0))]].concat());
        }
        edges
    }

    /// Nodes in the interior of a side, one element away from its edges.
    fn add_inside(&mut self, grid: &Grid, [axis, side]: [usize; 2], cells: usize) -> Vec<usize> {
        let inset = |along: f64| (1.0 + along * (cells - 2) as f64) / cells as f64;
        self.add(grid.nodes.iter().map(|place| in_space(axis, [side as f64, inset(place[0]), inset(place[1])])))
    }

    /// Triangles between the four edges of a near side and the square grid of its interior nodes, which run along the next axis first.
    fn strips(&self, edges: &[Edge], axis: usize, numbers: &[usize]) -> Vec<PatchFace> {
        let width = numbers.len().isqrt();
        let strip = |[along, end]: [usize; 2]| {
            let (step, first) = [(1, end * width * (width - 1)), (width, end * (width - 1))][along];
            let direction = (axis + 1 + along) % 3;
            // An edge is numbered by two bits: its positions along the two axes after its own. The axis of the near side is one of the two,
            // with the bit 0.
            let bits = [end, 2 * end][along];
            let placed = |node: usize| (node, self.nodes[node][direction]);
            let outer: Vec<_> = edges[4 * direction + bits].iter().map(|&node| placed(node)).collect();
            let inner: Vec<_> = (0..width).map(|k| placed(numbers[first + k * step])).collect();
            zip(&outer, &inner)
        };
        [[0, 0], [0, 1], [1, 0], [1, 1]].into_iter().flat_map(strip).collect()
    }

    fn add(&mut self, places: impl Iterator<Item = [f64; 3]>) -> Vec<usize> {
        let first = self.nodes.len();
        self.nodes.extend(places);
        (first..self.nodes.len()).collect()
    }
}

/// x, y and z from coordinates along an axis and the two axes after it.
fn in_space(axis: usize, coordinates: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| coordinates[(k + 3 - axis) % 3])
}

fn corner([x, y, z]: [f64; 3]) -> usize {
    (x + 2.0 * y + 4.0 * z) as usize
}
