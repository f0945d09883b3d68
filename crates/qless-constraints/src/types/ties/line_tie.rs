//! Line to line: `u_p = sum_k N_k u_k` for every node of one line, on the nearest segment of the other line.

use super::interpolate;
use crate::geometry::node::{Node, field_of_node};
use crate::geometry::search::{FaceSearch, SearchError};
use crate::geometry::surface::{Surface, SurfaceError};
use crate::{Constraint, EquationSink};

/// A line tied to another line node by node (collocation): `u_p = N_1 u_1 + N_2 u_2`. Both lines are polylines with F fields
/// in D dimensions.
///
/// Cost for n nodes: O(n log n).
///
#[doc = include_str!("../../../docs/pictures/line_tie.svg")]
///
#[doc = include_str!("../../../docs/types/line_tie.md")]
/// # Example
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
pub struct LineTie<const D: usize, const F: usize = D> {
    /// The nodes that are tied.
    pub slave: Vec<Node<D, F>>,
    /// The nodes of the line to which `slave` is tied, in order along this line.
    pub master: Vec<Node<D, F>>,
    /// Largest distance of a node from the line, a length.
    pub tolerance: f64,
}

/// What can be wrong with a tie of lines.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LineTieError {
    /// There are too few nodes.
    #[error("{slave} nodes are tied to a line of {master} nodes; at least one and two are needed")]
    TooFew {
        /// Number of nodes that are tied.
        slave: usize,
        /// Number of nodes of the line.
        master: usize,
    },
    /// A segment has no length.
    #[error("segment {segment} of the line, from 1, has no length; remove one of its nodes")]
    Degenerate {
        /// Number of the segment, counted from 1.
        segment: usize,
    },
    /// A node is too far from the line, or its coordinates are not finite.
    #[error(transparent)]
    Search(SearchError),
}

impl From<SurfaceError> for LineTieError {
    fn from(error: SurfaceError) -> Self {
        match error {
            SurfaceError::Degenerate { face } => Self::Degenerate { segment: face },
            other => Self::Search(other.into()),
        }
    }
}

impl<const D: usize, const F: usize> Constraint for LineTie<D, F> {
    const NAME: &'static str = "tie of lines";
    type Error = LineTieError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), LineTieError> {
        if self.slave.is_empty() || self.master.len() < 2 {
            return Err(LineTieError::TooFew { slave: self.slave.len(), master: self.master.len() });
        }
        let line = Surface::polyline(self.master);
        let places: Vec<[f64; D]> = self.slave.iter().map(|node| node.at).collect();
        let nearest = FaceSearch::new(&line)?.within(&places, self.tolerance).map_err(LineTieError::Search)?;
        for (i, (node, found)) in self.slave.iter().zip(nearest).enumerate() {
            let ends = line.nodes[found.face..].iter().zip(&found.weights).map(|(end, &n)| (end.dofs, n));
            interpolate(sink, |k| field_of_node::<D, F>(i, k).into(), &node.dofs, ends);
        }
        Ok(())
    }
}
