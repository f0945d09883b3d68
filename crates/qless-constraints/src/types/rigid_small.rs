//! `u_i = u_r + theta x (X_i - X_r)`, `theta_i = theta`: nodes that move as a rigid body, for small rotations.

use crate::scalar::vector::Vector;
use crate::types::couplings::arm::arm;
use crate::types::couplings::owners::Again;
use crate::types::couplings::rows::{check, follow};
use crate::types::{Component, CouplingError, Node6};
use crate::{Constraint, Store};

/// A rigid link (one node) or rigid body (many) for small rotations. Also known as RBE2.
///
/// `u_i = u_r + theta x (X_i - X_r)` and `theta_i = theta`, one equation for each component that a node has: leave DOFs out
/// (`None`, [`Node6::only`]) and these components stay free, as with a list of components on a card. Planar models leave out
/// what they do not have, on both sides: a DOF that the reference lacks must have the factor zero. Components may be those along
/// local axes, of each node its own ([`Node6::along`]): `e . u_i = e . (u_r + theta x (X_i - X_r))`.
///
/// DOFs removed: one for each equation; all are independent, as each has a DOF of its own. Two bodies that share nodes are redundant
/// (or in conflict) in what these nodes say twice. Units: lengths for translations, radians for rotations.
///
/// Source: RBE2 of Nastran; kinematics of a rigid body, linear in theta.
///
#[doc = include_str!("../../docs/pictures/small_rigid_body.svg")]
///
#[doc = include_str!("../../docs/types/small_rigid_body.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Component, Node6, Point, SmallRigidBody}};
/// let reference = Node6::new([0, 1, 2], [3, 4, 5], [0.0; 3]);
/// let solid = Node6::from(Point::new([6, 7, 8], [2.0, 0.0, 0.0]));
/// // A node of a shell, of which the translation z and the rotation about z follow.
/// let shell = Node6::new([9, 10, 11], [12, 13, 14], [0.0, 1.0, 0.0]).only([Component::Z, Component::TurnZ]);
/// let mut builder = ConstraintSet::builder(15);
/// builder.add("link", SmallRigidBody { reference, nodes: vec![solid, shell] })?;
/// let set = builder.build()?;
/// assert_eq!(set.label(4)?, "link, node 2, rotation z");
/// // A turn by 0.1 about z lifts the first node by 0.2, and turns the second.
/// let mut quantities = set.allocate();
/// let mut u = [0.0; 15];
/// (u[5], u[7], u[14]) = (0.1, 0.2, 0.1);
/// set.evaluate(&u, &mut quantities)?;
/// assert!(quantities.c().iter().all(|c| c.abs() < 1e-16));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SmallRigidBody {
    /// The node that leads, with theta as its rotations.
    pub reference: Node6,
    /// The nodes that follow, with the components in which they do.
    pub nodes: Vec<Node6>,
}

impl Constraint for SmallRigidBody {
    const NAME: &'static str = "rigid body, small rotations";
    type Error = CouplingError;

    fn process(self, store: &mut Store) -> Result<(), CouplingError> {
        if self.nodes.is_empty() {
            return Err(CouplingError::NoNodes);
        }
        check(&self.reference, self.nodes.iter(), Again::Refused)?;
        for (i, node) in self.nodes.iter().enumerate() {
            let r: Vector<f64> = arm(node.at, self.reference.at);
            for own in node.parts() {
                let (name, row) = (part(i, self.nodes.len(), node, own.component), own.row(r));
                follow(store, name, own.terms, &self.reference, row)?;
            }
        }
        Ok(())
    }
}

/// What the equation of a component is called.
pub(super) fn part(number: usize, nodes: usize, node: &Node6, component: Component) -> String {
    let short = node.name(component);
    if nodes == 1 { short } else { format!("node {}, {short}", number + 1) }
}
