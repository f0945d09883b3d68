//! A cell [0, 1]^3 of two blocks of hexahedra, one on the other, whose meshes do not match. Nodes are numbered by x, so that a range
//! of numbers is a slab. The mesh is given by formulas, so no rank stores it.

use std::ops::Range;

/// DOFs of a node: translations.
pub const AXES: usize = 3;
/// DOFs of the rigid inclusion, numbered after those of the nodes: translations and rotations.
pub const RIGID: usize = 6;

/// One block of the cell.
#[derive(Clone, Copy)]
pub struct Block {
    /// Along x, y and z.
    pub cells: [usize; 3],
    pub young: f64,
}

/// The lower block and the upper one.
#[derive(Clone, Copy)]
pub struct Cell {
    pub blocks: [Block; 2],
    /// The corners of the inclusion, if there is one; they lie on faces of hexahedra of both blocks.
    pub inclusion: Option<[[f64; 3]; 2]>,
}

/// A node: its block and its place in the grid.
#[derive(Clone, Copy)]
pub struct Node {
    pub block: usize,
    pub place: [usize; 3],
}

impl Block {
    /// Nodes with the same x.
    fn plane(&self) -> usize {
        (self.cells[1] + 1) * (self.cells[2] + 1)
    }

    /// Edges of a hexahedron.
    pub fn edges(&self) -> [f64; 3] {
        let [x, y, z] = self.cells.map(|count| 1.0 / count as f64);
        [x, y, z / 2.0]
    }
}

impl Cell {
    pub fn nodes(&self) -> usize {
        self.blocks.iter().map(|block| (block.cells[0] + 1) * block.plane()).sum()
    }

    pub fn dofs(&self) -> usize {
        AXES * self.nodes() + if self.inclusion.is_some() { RIGID } else { 0 }
    }

    /// The nodes that a rank owns.
    pub fn owned(&self, rank: usize, ranks: usize) -> Range<usize> {
        self.nodes() * rank / ranks..self.nodes() * (rank + 1) / ranks
    }

    /// The DOFs that a rank owns; the last rank also owns those of the inclusion.
    pub fn owned_dofs(&self, rank: usize, ranks: usize) -> Range<u64> {
        let Range { start, end } = self.owned(rank, ranks);
        let end = if rank + 1 == ranks { self.dofs() } else { AXES * end };
        (AXES * start) as u64..end as u64
    }

    /// Planes of both blocks in turn, by x; at the same x the lower one comes first.
    fn first_of_plane(&self, block: usize, i: usize) -> usize {
        let [lower, upper] = self.blocks.map(|block| block.cells[0]);
        let other = if block == 0 { (i * upper).div_ceil(lower) } else { i * lower / upper + 1 };
        i * self.blocks[block].plane() + other * self.blocks[1 - block].plane()
    }

    pub fn number(&self, node: Node) -> usize {
        let [i, j, k] = node.place;
        self.first_of_plane(node.block, i) + j * (self.blocks[node.block].cells[2] + 1) + k
    }

    pub fn at(&self, node: Node) -> [f64; 3] {
        let along = |axis: usize| node.place[axis] as f64 / self.blocks[node.block].cells[axis] as f64;
        [along(0), along(1), (along(2) + node.block as f64) / 2.0]
    }

    pub fn is_rigid(&self, node: Node) -> bool {
        let (at, off) = (self.at(node), 1e-9);
        let inside = |[low, high]: [[f64; 3]; 2]| (0..3).all(|k| low[k] - off < at[k] && at[k] < high[k] + off);
        self.inclusion.is_some_and(inside)
    }

    /// The nodes with these numbers.
    pub fn nodes_in(&self, numbers: Range<usize>) -> impl Iterator<Item = Node> + '_ {
        (0..2).flat_map(move |block| {
            let own = numbers.clone();
            let Block { cells: [x, y, z], .. } = self.blocks[block];
            let first = move |&i: &usize| self.first_of_plane(block, i);
            let slab = self.blocks[block].plane();
            let planes = (0..=x).filter(move |i| first(i) < numbers.end && numbers.start < first(i) + slab);
            let places = planes.flat_map(move |i| (0..=y).flat_map(move |j| (0..=z).map(move |k| [i, j, k])));
            places.map(move |place| Node { block, place }).filter(move |&node| own.contains(&self.number(node)))
        })
    }

    /// The corners of the hexahedra whose first corner has one of these numbers; x runs first, then y, then z.
    pub fn hexahedra_in(&self, numbers: Range<usize>) -> impl Iterator<Item = [Node; 8]> + '_ {
        let firsts = self.nodes_in(numbers);
        let inner = firsts.filter(|node| (0..3).all(|axis| node.place[axis] < self.blocks[node.block].cells[axis]));
        inner.map(|first| {
            std::array::from_fn(|corner| {
                let place = std::array::from_fn(|axis| first.place[axis] + (corner >> axis & 1));
                Node { place, ..first }
            })
        })
    }

    /// The number of redundant equations of this cell, counted by hand.
    ///
    /// Upright edges: two pairs in x and two in y go around four nodes, one pair for nothing. At the bottom and the top of the upper block
    /// every pair says for tied nodes what the lower block has said before. A tied node within the inclusion is rigid already.
    pub fn redundant(&self) -> usize {
        let [lower, upper] = self.blocks.map(|block| block.cells);
        let edges = (lower[2] + 1) + (upper[2] - 1);
        let tied_pairs = 2 * (upper[0] + 1 + upper[1] + 1);
        let tied = self.nodes_in(0..self.nodes()).filter(|node| node.block == 1 && node.place[2] == 0);
        AXES * (edges + tied_pairs + tied.filter(|&node| self.is_rigid(node)).count())
    }
}
