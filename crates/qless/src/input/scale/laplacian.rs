//! `L p = f` on a connected weighted graph, by conjugate gradients with the preconditioner M.
//!
//! ```text
//! L = sum_e w_e (delta_a - delta_b) (delta_a - delta_b)^T      e = (a, b), unit vectors delta
//! M = L_T + D / r^2                                            T is a heaviest spanning tree
//!                                                              D_a = sum of the weights of the edges of node a outside the tree
//! ```
//!
//! The tree alone is good for long graphs, and D alone for dense ones, in which every node is near every other. The vectors that change
//! least along the edges of a graph with r levels have an energy of about `1 / r^2` of that of the nodes, so D with this factor disturbs
//! the tree of a long graph little. M is solved in O(n), from the leaves to the root and back. Ties between weights are broken at random:
//! the ends of most edges are near each other in a random tree, but a breadth-first tree leaves long paths between neighbours.

use crate::common::{DisjointSets, SplitMix64};

/// Largest number of steps. An unconverged solution is usable too, because scaling by any powers of two is exact.
const MOST_STEPS: usize = 300;
/// Residual at convergence, relative to f in the norm of the preconditioner: units need only be right to a power of two.
const LEFT: f64 = 1e-5;

/// An edge between two nodes.
#[derive(Clone, Copy)]
pub struct Edge {
    pub ends: [u32; 2],
    pub weight: f64,
}

/// For each node its neighbours, with the edges to them.
type Neighbours = Vec<Vec<(u32, u32)>>;

/// Nodes as (node, parent, edge between them), in the order of a breadth-first search from node 0.
type Order = Vec<(u32, u32, u32)>;

/// The matrix M, factored: `L_T + D / r^2 = U^T U` along a spanning tree.
struct Preconditioner {
    order: Order,
    /// For each node, what elimination of its children leaves of `M_aa`, without the edge to its parent.
    pivot: Vec<f64>,
}

impl Preconditioner {
    fn new(nodes: usize, edges: &[Edge]) -> Self {
        let mut all: Neighbours = vec![Vec::new(); nodes];
        (0..edges.len() as u32).for_each(|e| connect(&mut all, edges, e));
        let (_, levels) = breadth_first(&all);
        let (order, _) = breadth_first(&heaviest_tree(nodes, edges));
        let mut outside = vec![true; edges.len()];
        order[1..].iter().for_each(|&(_, _, e)| outside[e as usize] = false);
        let mut pivot = vec![0.0; nodes];
        for (edge, _) in edges.iter().zip(outside).filter(|&(_, outside)| outside) {
            let [a, b] = edge.ends.map(|a| a as usize);
            pivot[a] += edge.weight / (levels * levels);
            pivot[b] += edge.weight / (levels * levels);
        }
        for &(node, parent, e) in order[1..].iter().rev() {
            let (own, weight) = (pivot[node as usize], edges[e as usize].weight);
            pivot[parent as usize] += weight * own / (weight + own);
        }
        Self { order, pivot }
    }

    /// The solution p of `M p = f`; zero at the root if M is the Laplacian of a tree.
    fn solve(&self, edges: &[Edge], f: &[f64]) -> Vec<f64> {
        let sum = |node: u32, e: u32| self.pivot[node as usize] + edges[e as usize].weight;
        let mut p = f.to_vec();
        for &(node, parent, e) in self.order[1..].iter().rev() {
            p[parent as usize] += p[node as usize] * edges[e as usize].weight / sum(node, e);
        }
        p[0] = if self.pivot[0] > 0.0 { p[0] / self.pivot[0] } else { 0.0 };
        for &(node, parent, e) in &self.order[1..] {
            p[node as usize] = (p[node as usize] + edges[e as usize].weight * p[parent as usize]) / sum(node, e);
        }
        p
    }
}

/// The heaviest spanning tree of a connected graph.
fn heaviest_tree(nodes: usize, edges: &[Edge]) -> Neighbours {
    let mut random = SplitMix64::new(nodes as u64);
    // The exponent distinguishes heavy from light edges well enough; chance orders edges of equal exponents.
    let key = |edge: &Edge| std::cmp::Reverse(edge.weight.to_bits() >> 52);
    let mut order: Vec<(std::cmp::Reverse<u64>, u64, u32)> =
        edges.iter().zip(0..).map(|(edge, e)| (key(edge), random.next(), e)).collect();
    order.sort_unstable();
    let mut sets = DisjointSets::new(nodes);
    let mut tree = vec![Vec::new(); nodes];
    for (_, _, e) in order {
        let [a, b] = edges[e as usize].ends.map(|a| a as usize);
        if sets.root(a) != sets.root(b) {
            sets.join(a, b);
            connect(&mut tree, edges, e);
        }
    }
    tree
}

fn connect(neighbours: &mut Neighbours, edges: &[Edge], e: u32) {
    let [a, b] = edges[e as usize].ends;
    neighbours[a as usize].push((b, e));
    neighbours[b as usize].push((a, e));
}

/// The order of a breadth-first search of a connected graph, and the number of its levels.
fn breadth_first(neighbours: &Neighbours) -> (Order, f64) {
    let mut level = vec![0.0; neighbours.len()];
    level[0] = 1.0;
    let mut order = vec![(0, 0, u32::MAX)];
    let mut at = 0;
    while let Some(&(node, _, _)) = order.get(at) {
        for &(next, e) in &neighbours[node as usize] {
            if level[next as usize] == 0.0 {
                level[next as usize] = level[node as usize] + 1.0;
                order.push((next, node, e));
            }
        }
        at += 1;
    }
    (order, level.into_iter().fold(1.0, f64::max))
}

/// The solution p of `L p = f` with the Laplacian L, apart from a constant; f sums to zero.
pub fn solve(edges: &[Edge], f: &[f64]) -> Vec<f64> {
    let near = Preconditioner::new(f.len(), edges);
    let mut p = near.solve(edges, f);
    let mut rest = f.to_vec();
    subtract(1.0, &product(edges, &p), &mut rest);
    let mut step = near.solve(edges, &rest);
    let mut direction = step.clone();
    let mut size = dot(&rest, &step);
    let enough = LEFT * LEFT * dot(f, &near.solve(edges, f));
    for _ in 0..MOST_STEPS {
        if size.is_nan() || size <= enough {
            break;
        }
        let image = product(edges, &direction);
        let length = size / dot(&direction, &image);
        subtract(-length, &direction, &mut p);
        subtract(length, &image, &mut rest);
        step = near.solve(edges, &rest);
        let next = dot(&rest, &step);
        direction.iter_mut().zip(&step).for_each(|(d, s)| *d = s + next / size * *d);
        size = next;
    }
    p
}

/// The product `L p` with the Laplacian L of the graph.
fn product(edges: &[Edge], p: &[f64]) -> Vec<f64> {
    let mut out = vec![0.0; p.len()];
    for &Edge { ends: [a, b], weight } in edges {
        let flow = weight * (p[a as usize] - p[b as usize]);
        out[a as usize] += flow;
        out[b as usize] -= flow;
    }
    out
}

/// `y <- y - a x`.
fn subtract(a: f64, x: &[f64], y: &mut [f64]) {
    y.iter_mut().zip(x).for_each(|(y, x)| *y -= a * x);
}

fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_is_solved() {
        let n = 12;
        let at = |i: u32, k: u32| i * n + k;
        let mut edges = Vec::new();
        for (i, k) in (0..n).flat_map(|i| (0..n).map(move |k| (i, k))) {
            let weight = 1.0 + f64::from((3 * i + k) % 5);
            edges.extend((i + 1 < n).then(|| Edge { ends: [at(i, k), at(i + 1, k)], weight }));
            edges.extend((k + 1 < n).then(|| Edge { ends: [at(i, k), at(i, k + 1)], weight }));
        }
        let wanted: Vec<f64> = (0..n * n).map(|k| f64::from(k * k % 17)).collect();
        let p = solve(&edges, &product(&edges, &wanted));
        let shift = wanted[0] - p[0];
        assert!(p.iter().zip(&wanted).all(|(p, wanted)| (p + shift - wanted).abs() < 1e-2));
    }
}
