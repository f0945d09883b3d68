//! Ties: a node follows a weighted sum of other nodes, `u_p - sum_k N_k u_k = 0`, or it follows its image on the
//! opposite face of a periodic cell or cyclic sector.

mod cyclic;
mod face_order_tie;
mod hanging_node;
mod line_tie;
mod node_tie;
mod order_tie;
mod periodic;

use std::borrow::Cow;

use crate::EquationSink;
pub use cyclic::{Cyclic, CyclicError, CyclicHarmonic, Turning};
pub use face_order_tie::{FaceOrderTie, FaceOrderTieError, FaceSide, TieSide};
pub use hanging_node::{HangingNode, HangingNodeError};
pub use line_tie::{LineTie, LineTieError};
pub use node_tie::{NodeTie, NodeTieError};
pub use order_tie::{OrderTie, OrderTieError};
pub use periodic::{MacroStrain, Periodic, PeriodicError};

/// Adds the F equations `u_p - sum_k N_k u_k = 0`. Masters with weight zero are left out.
fn interpolate<const F: usize>(
    sink: &mut EquationSink,
    name: impl Fn(usize) -> Cow<'static, str>,
    slave: &[usize; F],
    masters: impl Iterator<Item = ([usize; F], f64)>,
) {
    let masters: Vec<_> = masters.filter(|&(_, n)| n != 0.0).collect();
    for (k, &dof) in slave.iter().enumerate() {
        let terms = masters.iter().map(|(dofs, n)| (dofs[k], -n));
        sink.equation(name(k), terms.chain([(dof, 1.0)]), 0.0);
    }
}

/// Returns true if this node of the finer side is also a node of the coarser side: both have the same DOFs and the same place.
///
/// The error is a DOF of this node that also belongs to a node of the coarser side with another place or other DOFs.
fn is_shared<P: Copy, const F: usize>(
    dofs: &[usize; F],
    coarse: &[(P, [usize; F])],
    is_here: impl Fn(P) -> bool,
) -> Result<bool, usize> {
    if coarse.iter().any(|&(at, own)| own == *dofs && is_here(at)) {
        return Ok(true);
    }
    let shared = dofs.iter().find(|dof| coarse.iter().any(|(_, others)| others.contains(dof)));
    shared.map_or(Ok(false), |&dof| Err(dof))
}
