//! `min sum_i w_i |u_i - u_r - theta x r_i|^2`: a reference node, with the displacement `u_r` and the rotation theta, that follows the
//! weighted average of other nodes at `r_i` from it (RBE3).

use super::equations::{RepeatedNodes, check, lead};
use super::mean_rigid_motion::{MotionObservation, RigidMotionFit};
use super::node6::CoupledComponent;
use super::rigid_motion::arm;
use crate::scalar::clean;
use crate::scalar::vector::hypot;
use crate::types::{CouplingError, Node6};
use crate::{Constraint, EquationSink};

/// A weighted average: the reference follows the rigid motion that fits the motion of the nodes best. Also known as
/// RBE3.
///
/// `(u_r, theta) = argmin sum_i w_i (sum_k (u_ik - (u_r + theta x r_i)_k)^2 + L^2 sum_k (theta_ik - theta_k)^2)` with
/// `r_i = X_i - X_r`. The sums go over the components k of node i, which may be along local axes of that node
/// ([`Node6::along`]). L is the mean of all `|r_i|`, so that the unit of length does not matter. Each component of the
/// reference has one equation, `u_rk = sum_j a_j u_j`. The fit always determines all six components, even if only some
/// of them are coupled. The equations add no stiffness. They distribute a load on the reference over the nodes, as forces
/// with the same resultant.
///
/// Components that the nodes do not determine are refused. Nodes on a line do not determine the rotation about the line.
/// If the reference is off the line, they do not determine all translations of the reference either. Two nodes are always
/// on a line. Nodes count as on a line if they deviate by less than about 1e-8 of its length (measured by singular
/// values), or by less than the rounding of the coordinates. In this case couple only the determined components
/// ([`Node6::only`]), or add nodes with rotations. Cost: O(nodes) for each component.
///
#[doc = include_str!("../../../docs/pictures/average.svg")]
///
#[doc = include_str!("../../../docs/types/average.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Average, Component, Node6, Point}};
/// let at = |node: usize, x: f64, y: f64| Point::new([3 * node, 3 * node + 1, 3 * node + 2], [x, y, 0.0]).into();
/// let nodes = vec![(at(2, 0.0, 0.0), 1.0), (at(3, 1.0, 0.0), 1.0), (at(4, 0.0, 1.0), 2.0)];
/// let reference = Node6::new([0, 1, 2], [3, 4, 5], [0.25, 0.5, 0.0]);
/// let mut builder = ConstraintSet::builder(15);
/// builder.add("load", Average { reference, nodes: nodes.clone() })?;
/// // Two nodes determine all components but the rotation about the line through them, here x.
/// let pair = nodes[..2].to_vec();
/// let on_line = Node6 { at: [0.5, 0.0, 0.0], ..reference };
/// let error = builder.add("pair", Average { reference: on_line, nodes: pair.clone() }).unwrap_err();
/// assert!(error.to_string().contains("do not determine the rotation x of the reference"));
/// let rest = Component::ALL.into_iter().filter(|&component| component != Component::TurnX);
/// builder.add("pair", Average { reference: on_line.only(rest), nodes: pair })?;
/// assert_eq!(builder.build()?.equations(), 6 + 5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Average {
    /// The dependent node, restricted to its coupled components.
    pub reference: Node6,
    /// The independent nodes, restricted to the components that count, with their weights.
    pub nodes: Vec<(Node6, f64)>,
}

impl Average {
    fn check(&self) -> Result<(), CouplingError> {
        if self.nodes.is_empty() {
            return Err(CouplingError::NoNodes);
        }
        check(&self.reference, self.nodes.iter().map(|(node, _)| node), RepeatedNodes::Allowed)?;
        for (i, (_, weight)) in self.nodes.iter().enumerate() {
            if !(*weight > 0.0 && weight.is_finite()) {
                return Err(CouplingError::Weight { node: i + 1, weight: *weight });
            }
        }
        Ok(())
    }

    /// The mean distance L of the nodes from the reference, or 1 if all nodes coincide with it. In that case translations and rotations are
    /// fitted separately, so L has no effect.
    fn mean_arm(&self) -> f64 {
        let length = |(node, _): &(Node6, f64)| hypot(arm(node.at, self.reference.at));
        let mean = self.nodes.iter().map(length).map(|length| length / self.nodes.len() as f64).sum();
        if mean > 0.0 { mean } else { 1.0 }
    }

    /// The coupled components of all nodes. Each is an observation (position, axis and weight) with its terms in the DOFs of the node.
    fn observations(&self) -> Vec<(MotionObservation, CoupledComponent)> {
        let (length, most) = (self.mean_arm(), self.nodes.iter().fold(0.0, |most: f64, (_, weight)| most.max(*weight)));
        let observe = |(node, weight): &(Node6, f64)| {
            let (at, root) = (node.at, (weight / most).sqrt());
            node.coupled_components().map(move |component| {
                let is_rotation = component.kind.is_rotation();
                let root = if is_rotation { root * length } else { root };
                (MotionObservation { at, axis: component.axis, is_rotation, root }, component)
            })
        };
        self.nodes.iter().flat_map(observe).collect()
    }
}

impl Constraint for Average {
    const NAME: &'static str = "weighted average";
    type Error = CouplingError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), CouplingError> {
        self.check()?;
        let (observations, components): (Vec<_>, Vec<_>) = self.observations().into_iter().unzip();
        let fit = RigidMotionFit::new(&observations);
        for component in self.reference.coupled_components() {
            let motion = component.row([0.0; 3]);
            let mut factors = fit.factors_of(motion, self.reference.at)?;
            for rotations in [false, true] {
                let kind = observations.iter().map(|o| o.is_rotation == rotations);
                clean(factors.iter_mut().zip(kind).filter_map(|(a, own)| own.then_some(a)), fit.blur);
            }
            let led = components.iter().zip(factors);
            let terms =
                led.flat_map(|(component, factor)| component.terms.iter().map(move |&(dof, a)| (dof, factor * a)));
            lead(sink, self.reference.long_name(component.kind), terms, &self.reference, motion)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::types::Component;

    /// L is the mean distance of all listed nodes from the reference, or 1 if they coincide with it.
    #[test]
    fn arm_is_the_mean_distance() {
        let node = |x: f64| (Node6::new([7, 8, 9], [10, 11, 12], [x, 0.0, 0.0]), 1.0);
        let reference = Node6::new([0, 1, 2], [3, 4, 5], [0.0; 3]).only([Component::X]);
        assert_eq!(Average { reference, nodes: vec![node(1.0), node(-4.0)] }.mean_arm(), 2.5);
        assert_eq!(Average { reference, nodes: vec![node(0.0)] }.mean_arm(), 1.0);
    }
}
