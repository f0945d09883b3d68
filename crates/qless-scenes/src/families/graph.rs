//! Incidence matrices of graphs, `u_a - u_b = 0` for each edge: rank = nodes - connected components.

use qless::SystemBuilder;

use super::MOST;
use crate::error::within;
use crate::{Rng, Scene, SceneError, Truth};

/// The edges x nodes incidence matrix: `u_a - u_b = step` for each `(a, b, step)`, a != b.
///
/// Conflicting if the steps around some cycle do not add up to 0. The comparison is exact, so steps should be whole numbers.
///
/// ```
/// use qless_scenes::families::incidence;
/// let triangle = incidence(4, &[(0, 1, 2.0), (1, 2, 3.0), (2, 0, -5.0)])?;
/// assert_eq!((triangle.truth.rank_free, triangle.truth.conflicting), (Some(2), false));
/// # Ok::<(), qless_scenes::SceneError>(())
/// ```
///
/// # Errors
/// [`SceneError::Size`] if a node of an edge is out of range.
pub fn incidence(nodes: usize, edges: &[(usize, usize, f64)]) -> Result<Scene, SceneError> {
    within("nodes", nodes, 1, MOST)?;
    let mut builder = SystemBuilder::new(nodes);
    let mut forest = GraphForest::new(nodes);
    let (mut rank, mut conflict) = (0, false);
    for &(a, b, step) in edges {
        within("an edge's node", a.max(b), 0, nodes - 1)?;
        builder.equation([(a, 1.0), (b, -1.0)], step);
        match forest.join(a, b, step) {
            None => rank += 1,
            Some(implied) => conflict |= implied != step,
        }
    }
    Scene::bare(builder, Truth::rank(edges.len(), rank).with_conflict(conflict))
}

/// `u_1 = u_2 = ... = u_nodes` as a chain: nodes - 1 independent equations.
///
/// # Errors
/// [`SceneError::Size`] for fewer than 2 nodes.
pub fn path(nodes: usize) -> Result<Scene, SceneError> {
    within("nodes", nodes, 2, MOST)?;
    incidence(nodes, &(1..nodes).map(|b| (b - 1, b, 0.0)).collect::<Vec<_>>())
}

/// [`path`] with the closing equation `u_nodes - u_1 = gap`: redundant for a gap of 0, otherwise conflicting.
///
/// # Errors
/// [`SceneError::Size`] for fewer than 3 nodes; [`SceneError::System`] for a gap that is not finite.
pub fn cycle(nodes: usize, gap: f64) -> Result<Scene, SceneError> {
    within("nodes", nodes, 3, MOST)?;
    let edges: Vec<_> = (1..nodes).map(|b| (b - 1, b, 0.0)).chain([(nodes - 1, 0, gap)]).collect();
    incidence(nodes, &edges)
}

/// All edges of an nx x ny grid of nodes: rank nx ny - 1, of nx (ny - 1) + ny (nx - 1) equations.
///
/// # Errors
/// [`SceneError::Size`] for a side without nodes.
pub fn grid_2d(nx: usize, ny: usize) -> Result<Scene, SceneError> {
    within("nx", nx, 1, 1 << 13)?;
    within("ny", ny, 1, 1 << 13)?;
    let at = |i: usize, j: usize| i + j * nx;
    let right = (0..ny).flat_map(|j| (1..nx).map(move |i| (at(i - 1, j), at(i, j), 0.0)));
    let up = (1..ny).flat_map(|j| (0..nx).map(move |i| (at(i, j - 1), at(i, j), 0.0)));
    incidence(nx * ny, &right.chain(up).collect::<Vec<_>>())
}

/// Random edges, possibly parallel. With about `nodes / 2` edges there are many components, with `2 nodes` edges there are few.
///
/// # Errors
/// [`SceneError::Size`] for fewer than 2 nodes.
pub fn random_graph(nodes: usize, edges: usize, seed: u64) -> Result<Scene, SceneError> {
    within("nodes", nodes, 2, MOST)?;
    within("edges", edges, 0, MOST)?;
    let mut rng = Rng::new(seed);
    let pairs = (0..edges).map(|_| {
        let (a, other) = (rng.below(nodes), rng.below(nodes - 1));
        (a, other + usize::from(other >= a), 0.0)
    });
    incidence(nodes, &pairs.collect::<Vec<_>>())
}

/// Union-find with offsets: `u_node = u_parent + offset`.
struct GraphForest {
    parent: Vec<usize>,
    offset: Vec<f64>,
}

impl GraphForest {
    fn new(nodes: usize) -> Self {
        Self { parent: (0..nodes).collect(), offset: vec![0.0; nodes] }
    }

    /// Root of a node and `u_node - u_root`; halves the path.
    fn root(&mut self, mut node: usize) -> (usize, f64) {
        let mut sum = 0.0;
        while self.parent[node] != node {
            let parent = self.parent[node];
            self.offset[node] += self.offset[parent];
            self.parent[node] = self.parent[parent];
            sum += self.offset[node];
            node = self.parent[node];
        }
        (node, sum)
    }

    /// Adds `u_a - u_b = step`, or returns the value of `u_a - u_b` that earlier equations imply.
    fn join(&mut self, a: usize, b: usize, step: f64) -> Option<f64> {
        let ((root_a, from_a), (root_b, from_b)) = (self.root(a), self.root(b));
        if root_a == root_b {
            return Some(from_a - from_b);
        }
        self.parent[root_a] = root_b;
        self.offset[root_a] = step + from_b - from_a;
        None
    }
}
