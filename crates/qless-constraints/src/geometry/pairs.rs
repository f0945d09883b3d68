//! Pairs of nodes on opposite faces: `X_b = X_a + step`.

use rstar::RTree;
use rstar::primitives::GeomWithData;

use super::node::{Node, separation, within};

/// Why nodes cannot be paired.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PairError {
    /// The sides have different numbers of nodes.
    #[error("one side has {from} nodes, the other {to}; give each node of one side one image on the other")]
    Counts {
        /// Number of nodes of one side.
        from: usize,
        /// Number of nodes of the other side.
        to: usize,
    },
    /// A node has no image.
    #[error(
        "node {node}, from 1, has no image: the nearest node of the other side is {distance} away from where it should \
         be, more than the tolerance {tolerance}; correct the nodes or the step, or raise the tolerance"
    )]
    NoImage {
        /// Number of the node, counted from 1.
        node: usize,
        /// Distance of the nearest node; infinite if the coordinates are not finite or too large.
        distance: f64,
        /// Largest allowed distance.
        tolerance: f64,
    },
    /// Two nodes have the same image.
    #[error(
        "nodes {first} and {second}, from 1, have the same image: they are at the same place, or the tolerance is too large"
    )]
    Shared {
        /// Number of one node, counted from 1.
        first: usize,
        /// Number of the other node, counted from 1.
        second: usize,
    },
}

/// Pairs each node with its image on the opposite side, the node at `X + step`, for
/// [`Periodic`](crate::types::Periodic) and [`Cyclic`](crate::types::Cyclic). The pairs are in the order of the first
/// side; the order of the other side does not matter.
///
/// ```
/// use qless_constraints::types::{PlanarPoint, pairs};
/// let at = |i: usize, x: f64, y: f64| PlanarPoint::new([2 * i, 2 * i + 1], [x, y]);
/// let (left, right) = ([at(0, 0.0, 0.0), at(1, 0.0, 1.0)], [at(2, 3.0, 1.0), at(3, 3.0, 0.0)]);
/// let found = pairs(&left, &right, [3.0, 0.0], 1e-9)?;
/// assert_eq!(found, [(left[0], right[1]), (left[1], right[0])]);
/// # Ok::<(), qless_constraints::types::PairError>(())
/// ```
///
/// # Errors
/// [`PairError`]: the counts differ, or a node has no image within the tolerance (a length), or two nodes have the
/// same image.
pub fn pairs<const D: usize, const F: usize>(
    from: &[Node<D, F>],
    to: &[Node<D, F>],
    step: [f64; D],
    tolerance: f64,
) -> Result<Vec<(Node<D, F>, Node<D, F>)>, PairError> {
    const { assert!(D > 1, "a search needs two dimensions") };
    if from.len() != to.len() {
        return Err(PairError::Counts { from: from.len(), to: to.len() });
    }
    // The tree compares squares of distances, which must not overflow.
    let sound = |at: &[f64; D]| at.iter().all(|x| x.abs() < 1e150);
    let places = to.iter().enumerate().filter(|(_, node)| sound(&node.at));
    let tree = RTree::bulk_load(places.map(|(k, node)| GeomWithData::new(node.at, k)).collect());
    let mut taken = vec![None; to.len()];
    let pair = |(i, &a): (usize, &Node<D, F>)| {
        let place = std::array::from_fn(|k| a.at[k] + step[k]);
        let nearest = if sound(&place) { tree.nearest_neighbor(place) } else { None };
        let distance = nearest.map_or(f64::INFINITY, |found| separation(found.geom(), &place));
        let Some(found) = nearest.filter(|_| within(distance, tolerance)) else {
            return Err(PairError::NoImage { node: i + 1, distance, tolerance });
        };
        if let Some(first) = taken[found.data].replace(i) {
            return Err(PairError::Shared { first: first + 1, second: i + 1 });
        }
        Ok((a, to[found.data]))
    };
    from.iter().enumerate().map(pair).collect()
}
