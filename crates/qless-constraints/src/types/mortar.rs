//! `sum_j D_ij u_j - sum_k M_ik u_k = 0`, `D_ij = int N_i N_j ds`, `M_ik = int N_i N_k ds`: a tie in the mean.
//!
//! Linear functions on both lines; products are integrated exactly on each piece between two nodes of either line.

use crate::geometry::node::{AXES, Node, separation, within};
use crate::{Constraint, Store};

/// Two meshes of the same straight line, tied by a mortar method with the functions of the slave side as multipliers.
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{MortarTie, PlanarPoint}};
/// let at = |node: usize, x: f64| PlanarPoint::new([2 * node, 2 * node + 1], [x, 0.0]);
/// let slave = vec![at(0, 0.0), at(1, 1.0), at(2, 2.0)];
/// let master = vec![at(3, 0.0), at(4, 0.7), at(5, 2.0)];
/// let mut builder = ConstraintSet::builder(12);
/// builder.add("interface", MortarTie { slave, master, tolerance: 1e-9 })?;
/// let set = builder.build()?;
/// // A field that is linear along the line satisfies all equations.
/// let mut quantities = set.allocate();
/// let u = [0.0, 1.0, 1.0, 3.0, 2.0, 5.0, 0.0, 1.0, 0.7, 2.4, 2.0, 5.0];
/// set.evaluate(&u, &mut quantities)?;
/// assert!(quantities.c().iter().all(|c| c.abs() < 1e-15));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct MortarTie<const D: usize> {
    /// Nodes of the side that carries the multipliers, in order; one equation per node and component.
    pub slave: Vec<Node<D>>,
    /// Nodes of the other side, in order.
    pub master: Vec<Node<D>>,
    /// Farthest that a node may be from the line, a length; also how far its ends may differ.
    pub tolerance: f64,
}

/// What can be wrong with a mortar tie.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MortarError {
    /// Each side needs two nodes.
    #[error("the sides have {slave} and {master} nodes; each needs at least two")]
    TooFew {
        /// Nodes of the slave side.
        slave: usize,
        /// Nodes of the master side.
        master: usize,
    },
    /// The nodes of a side do not follow one another along the line.
    #[error("node {node}, from 1, of the {side} side does not lie beyond the node before it; sort the nodes")]
    Order {
        /// "slave" or "master".
        side: &'static str,
        /// The node, from 1.
        node: usize,
    },
    /// A node lies beside the line through the ends of the slave side.
    #[error(
        "node {node}, from 1, of the {side} side is {distance} beside the line, more than the tolerance {tolerance}"
    )]
    OffLine {
        /// "slave" or "master".
        side: &'static str,
        /// The node, from 1.
        node: usize,
        /// How far.
        distance: f64,
        /// How far it may be.
        tolerance: f64,
    },
    /// The master side does not reach to an end of the slave side.
    #[error(
        "the slave side goes from 0 to {slave} along the line, the master side from {from} to {to}: it must cover it"
    )]
    NotCovered {
        /// Length of the slave side.
        slave: f64,
        /// Where the master side begins.
        from: f64,
        /// Where it ends.
        to: f64,
    },
}

impl<const D: usize> MortarTie<D> {
    /// Where the nodes of a side are along the line.
    fn along(&self, nodes: &[Node<D>], side: &'static str) -> Result<Vec<f64>, MortarError> {
        let (first, last) = (&self.slave[0].at, &self.slave[self.slave.len() - 1].at);
        let length = separation(first, last);
        let mut along: Vec<f64> = Vec::with_capacity(nodes.len());
        for (i, node) in nodes.iter().enumerate() {
            let s = (0..D).map(|k| (node.at[k] - first[k]) * (last[k] - first[k]) / length).sum::<f64>();
            let foot = std::array::from_fn(|k| first[k] + s / length * (last[k] - first[k]));
            let distance = separation(&foot, &node.at);
            if !within(distance, self.tolerance) {
                return Err(MortarError::OffLine { side, node: i + 1, distance, tolerance: self.tolerance });
            }
            if along.last().is_some_and(|&before| s <= before) {
                return Err(MortarError::Order { side, node: i + 1 });
            }
            along.push(s);
        }
        Ok(along)
    }
}

/// The segment that a point lies in, and its two functions there.
fn functions(nodes: &[f64], s: f64) -> (usize, [f64; 2]) {
    let segment = nodes.partition_point(|&x| x < s).clamp(1, nodes.len() - 1) - 1;
    let xi = (s - nodes[segment]) / (nodes[segment + 1] - nodes[segment]);
    (segment, [1.0 - xi, xi])
}

/// Points and weights of Gauss's rule on each piece between neighbouring nodes of either side.
fn quadrature(slave: &[f64], master: &[f64]) -> Vec<(f64, f64)> {
    let (first, last) = (slave[0], slave[slave.len() - 1]);
    let mut cuts: Vec<f64> = slave.iter().chain(master).copied().filter(|&s| first <= s && s <= last).collect();
    cuts.sort_by(f64::total_cmp);
    let two_points = |piece: &[f64]| {
        let (middle, half) = (f64::midpoint(piece[0], piece[1]), (piece[1] - piece[0]) / 2.0);
        [-1.0, 1.0].map(|side| (middle + side * half / 3.0_f64.sqrt(), half))
    };
    cuts.windows(2).filter(|piece| piece[1] > piece[0]).flat_map(two_points).collect()
}

impl<const D: usize> Constraint for MortarTie<D> {
    const NAME: &'static str = "mortar tie";
    type Error = MortarError;

    fn process(self, store: &mut Store) -> Result<(), MortarError> {
        if self.slave.len() < 2 || self.master.len() < 2 {
            return Err(MortarError::TooFew { slave: self.slave.len(), master: self.master.len() });
        }
        let (slave, master) = (self.along(&self.slave, "slave")?, self.along(&self.master, "master")?);
        let (length, from, to) = (slave[slave.len() - 1], master[0], master[master.len() - 1]);
        if from > self.tolerance || to < length - self.tolerance {
            return Err(MortarError::NotCovered { slave: length, from, to });
        }
        let mut rows: Vec<Vec<(&Node<D>, f64)>> = vec![Vec::new(); slave.len()];
        for (s, weight) in quadrature(&slave, &master) {
            let ((i, own), (k, other)) = (functions(&slave, s), functions(&master, s));
            for a in 0..2 {
                for b in 0..2 {
                    rows[i + a].push((&self.slave[i + b], weight * own[a] * own[b]));
                    rows[i + a].push((&self.master[k + b], -weight * own[a] * other[b]));
                }
            }
        }
        for (i, row) in rows.iter().enumerate() {
            for axis in 0..D {
                let terms = row.iter().map(|&(node, v)| (node.dofs[axis], v));
                store.equation(format!("node {}, {}", i + 1, AXES[axis]), terms, 0.0);
            }
        }
        Ok(())
    }
}
