//! Line to line: `u_p = sum_k N_k u_k` for every node of one line, each on the segment of the other that is nearest to it.

use crate::geometry::node::{AXES, Node, within};
use crate::geometry::project::project;
use crate::geometry::shape::Shape;
use crate::{Constraint, Store};

/// A line tied to another, node by node (collocation); both are polylines in D dimensions.
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{LineTie, PlanarPoint}};
/// let at = |node: usize, x: f64| PlanarPoint::new([2 * node, 2 * node + 1], [x, 0.0]);
/// let line = LineTie {
///     slave: vec![at(0, 0.0), at(1, 0.7), at(2, 2.0)],
///     master: vec![at(3, 0.0), at(4, 1.0), at(5, 2.0)],
///     tolerance: 1e-6,
/// };
/// let mut builder = ConstraintSet::builder(12);
/// builder.add("weld", line)?;
/// let set = builder.build()?;
/// assert_eq!((set.equations(), set.label(2)?), (6, "weld, node 2, x".to_owned()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct LineTie<const D: usize> {
    /// The nodes that are tied.
    pub slave: Vec<Node<D>>,
    /// The nodes of the line that they are tied to, in order along it.
    pub master: Vec<Node<D>>,
    /// Farthest that a node may be from the line, a length.
    pub tolerance: f64,
}

/// What can be wrong with a tie of lines.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LineTieError {
    /// A line needs two nodes, and something to be tied.
    #[error("{slave} nodes are tied to a line of {master}; give at least one and two")]
    TooFew {
        /// Nodes that are tied.
        slave: usize,
        /// Nodes of the line.
        master: usize,
    },
    /// A segment has no length.
    #[error("segment {segment} of the line, from 1, has no length; take one of its nodes out")]
    Degenerate {
        /// The segment, from 1.
        segment: usize,
    },
    /// A node is too far away.
    #[error("node {node}, from 1, is {distance} away from the line, more than the tolerance {tolerance}")]
    TooFar {
        /// The node, from 1.
        node: usize,
        /// How far.
        distance: f64,
        /// How far it may be.
        tolerance: f64,
    },
}

impl<const D: usize> LineTie<D> {
    /// The segment nearest to a node, with the weights of its ends and the distance.
    fn nearest(&self, node: &Node<D>) -> Result<(usize, Vec<f64>, f64), LineTieError> {
        let mut best = (0, Vec::new(), f64::INFINITY);
        for (segment, ends) in self.master.windows(2).enumerate() {
            let found = project(Shape::Line2, &[ends[0].at, ends[1].at], &node.at)
                .ok_or(LineTieError::Degenerate { segment: segment + 1 })?;
            if found.distance < best.2 {
                best = (segment, found.weights, found.distance);
            }
        }
        Ok(best)
    }
}

impl<const D: usize> Constraint for LineTie<D> {
    const NAME: &'static str = "tie of lines";
    type Error = LineTieError;

    fn process(self, store: &mut Store) -> Result<(), LineTieError> {
        if self.slave.is_empty() || self.master.len() < 2 {
            return Err(LineTieError::TooFew { slave: self.slave.len(), master: self.master.len() });
        }
        for (i, node) in self.slave.iter().enumerate() {
            let (segment, weights, distance) = self.nearest(node)?;
            if !within(distance, self.tolerance) {
                return Err(LineTieError::TooFar { node: i + 1, distance, tolerance: self.tolerance });
            }
            for axis in 0..D {
                let ends = self.master[segment..].iter().zip(&weights).filter(|&(_, &n)| n != 0.0);
                let terms = ends.map(|(end, n)| (end.dofs[axis], -n)).chain([(node.dofs[axis], 1.0)]);
                store.equation(format!("node {}, {}", i + 1, AXES[axis]), terms, 0.0);
            }
        }
        Ok(())
    }
}
