//! What can be wrong with a face of p-refinement.

use std::fmt;

use crate::geometry::shape::Shape;
use crate::types::Polynomials;

/// Which side of a face it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// That follows.
    Fine,
    /// That leads.
    Coarse,
}

impl fmt::Display for Side {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if *self == Self::Fine { "finer" } else { "coarser" })
    }
}

/// What can be wrong with a face of p-refinement.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FaceOrderTieError {
    /// A shape is a line or a solid.
    #[error("a {shape:?} is no face")]
    NoFace {
        /// What it is.
        shape: Shape,
    },
    /// A shape has another number of nodes.
    #[error("{found} nodes are given; a {shape:?} has {}", shape.nodes())]
    Nodes {
        /// The shape.
        shape: Shape,
        /// How many were given.
        found: usize,
    },
    /// A side has another number of nodes than polynomials.
    #[error("the {side} side has {found} nodes, but {polynomials:?} (degree one or more) needs {}", polynomials.dimension())]
    Count {
        /// Which side.
        side: Side,
        /// Its polynomials.
        polynomials: Polynomials,
        /// Its nodes.
        found: usize,
    },
    /// The coarser side can be what the finer cannot.
    #[error(
        "not all of {coarse:?} of the coarser side are among {fine:?} of the finer, which could not follow: exchange the sides, or raise its degree"
    )]
    NotAmong {
        /// Polynomials of the finer side.
        fine: Polynomials,
        /// Polynomials of the coarser side.
        coarse: Polynomials,
    },
    /// A node is not on the face.
    #[error("node {node}, from 1, of the {side} side is at {at:?}, which is not on the face; correct its parameters")]
    Outside {
        /// Which side.
        side: Side,
        /// The node, from 1.
        node: usize,
        /// Its parameters.
        at: [f64; 2],
    },
    /// Nodes do not determine a polynomial.
    #[error(
        "the nodes of the {side} side do not determine a polynomial of it: two are in one place, or too many on one curve; move them"
    )]
    Undetermined {
        /// Which side.
        side: Side,
    },
    /// A node of the finer side has a DOF of a coarser one in another place.
    #[error(
        "node {node}, from 1, of the finer side has DOF {dof}, as a coarser node in another place has; correct one of them"
    )]
    Shared {
        /// The node, from 1.
        node: usize,
        /// The DOF, 0-based.
        dof: usize,
    },
}
