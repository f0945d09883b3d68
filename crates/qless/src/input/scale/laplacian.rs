//! `L p = f` on a connected weighted graph, by conjugate gradients with a heaviest spanning tree as preconditioner.
//!
//! ```text
//! L = sum_e w_e (delta_a - delta_b) (delta_a - delta_b)^T      e = (a, b), unit vectors delta
//! ```
//!
//! A tree is solved in O(n), from its leaves to the root and back. Ties between weights are broken at random: the ends of most edges are
//! near each other in a random tree, but a breadth-first tree leaves long paths between neighbours.

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

/// A spanning tree as (node, parent, edge between them), in the order from the root to the leaves.
struct Tree(Vec<(u32, u32, u32)>);

impl Tree {
    /// The heaviest spanning tree of a connected graph.
    fn heaviest(nodes: usize, edges: &[Edge]) -> Self {
        let mut random = SplitMix64::new(nodes as u64);
        // The exponent distinguishes heavy from light edges well enough; chance orders edges of equal exponents.
        let key = |edge: &Edge| std::cmp::Reverse(edge.weight.to_bits() >> 52);
        let mut order: Vec<(std::cmp::Reverse<u64>, u64, u32)> =
            edges.iter().zip(0..).map(|(edge, e)| (key(edge), random.next(), e)).collect();
        order.sort_unstable();
        let mut sets = DisjointSets::new(nodes);
        let mut neighbours = vec![Vec::new(); nodes];
        for (_, _, e) in order {
            let [a, b] = edges[e as usize].ends;
            if sets.root(a as usize) != sets.root(b as usize) {
                sets.join(a as usize, b as usize);
                neighbours[a as usize].push((b, e));
                neighbours[b as usize].push((a, e));
            }
        }
        let mut found = vec![(0, 0, u32::MAX)];
        let mut at = 0;
        while let Some(&(node, parent, _)) = found.get(at) {
            let children = neighbours[node as usize].iter().filter(|&&(child, _)| child != parent);
            found.extend(children.map(|&(child, e)| (child, node, e)));
            at += 1;
        }
        Self(found)
    }

    /// The solution p of `L_T p = f`, zero at the root. `L_T` is the Laplacian of the tree alone.
    fn solve(&self, edges: &[Edge], f: &[f64]) -> Vec<f64> {
        let mut flow = f.to_vec();
        for &(node, parent, _) in self.0[1..].iter().rev() {
            flow[parent as usize] += flow[node as usize];
        }
        let mut p = vec![0.0; f.len()];
        for &(node, parent, e) in &self.0[1..] {
            p[node as usize] = p[parent as usize] + flow[node as usize] / edges[e as usize].weight;
        }
        p
    }
}

/// The solution p of `L p = f` with the Laplacian L, apart from a constant; f sums to zero.
pub fn solve(edges: &[Edge], f: &[f64]) -> Vec<f64> {
    let tree = Tree::heaviest(f.len(), edges);
    let mut p = tree.solve(edges, f);
    let mut rest = f.to_vec();
    subtract(1.0, &product(edges, &p), &mut rest);
    let mut step = tree.solve(edges, &rest);
    let mut direction = step.clone();
    let mut size = dot(&rest, &step);
    let enough = LEFT * LEFT * dot(f, &tree.solve(edges, f));
    for _ in 0..MOST_STEPS {
        if size.is_nan() || size <= enough {
            break;
        }
        let image = product(edges, &direction);
        let length = size / dot(&direction, &image);
        subtract(-length, &direction, &mut p);
        subtract(length, &image, &mut rest);
        step = tree.solve(edges, &rest);
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
