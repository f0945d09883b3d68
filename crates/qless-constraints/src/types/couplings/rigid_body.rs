//! Nodes that move as a rigid body: `u_i = u_r + theta x (X_i - X_r)` for small rotations, `x_i = x_r + R (X_i - X_r)`
//! for finite ones.

use super::equations::{RepeatedNodes, check, follow};
use super::rigid_motion::arm;
use crate::geometry::node::Point;
use crate::scalar::Scalar;
use crate::scalar::vector::Vector;
use crate::types::joints::attachment::{AttachedPoint, Body};
use crate::types::joints::coincident::coincident;
use crate::types::joints::height::height;
use crate::types::joints::orientation::Aligned;
use crate::types::joints::relative::relative;
use crate::types::{Component, CouplingError, Node6};
use crate::{Constraint, EquationSink, Nonlinear};

/// A rigid link (one node) or rigid body (many nodes) for small rotations. Also known as RBE2.
///
/// `u_i = u_r + theta x (X_i - X_r)` and `theta_i = theta`, one equation for each component of a node. Omitted DOFs
/// (`None`, [`Node6::only`]) stay free, as with a list of components in a deck. In planar models, the reference and the
/// nodes omit the DOFs out of the plane. An equation that needs a missing DOF of the reference is refused. Components may
/// be along local axes of each node ([`Node6::along`]): `e . u_i = e . (u_r + theta x (X_i - X_r))`.
///
#[doc = include_str!("../../../docs/pictures/small_rigid_body.svg")]
///
#[doc = include_str!("../../../docs/types/small_rigid_body.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Component, Node6, Point, SmallRigidBody}};
/// let reference = Node6::new([0, 1, 2], [3, 4, 5], [0.0; 3]);
/// let solid = Node6::from(Point::new([6, 7, 8], [2.0, 0.0, 0.0]));
/// // A shell node whose translation and rotation z follow.
/// let shell = Node6::new([9, 10, 11], [12, 13, 14], [0.0, 1.0, 0.0]).only([Component::Z, Component::TurnZ]);
/// let mut builder = ConstraintSet::builder(15);
/// builder.add("link", SmallRigidBody { reference, nodes: vec![solid, shell] })?;
/// let set = builder.build()?;
/// assert_eq!(set.label(4)?, "link, node 2, rotation z");
/// // A rotation by 0.1 about z moves the first node by 0.2 along y, and rotates the second.
/// let mut evaluation = set.allocate();
/// let mut u = [0.0; 15];
/// (u[5], u[7], u[14]) = (0.1, 0.2, 0.1);
/// set.evaluate(&u, &mut evaluation)?;
/// assert!(evaluation.c().iter().all(|c| c.abs() < 1e-16));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct SmallRigidBody {
    /// The reference node; theta are its rotations.
    pub reference: Node6,
    /// The dependent nodes, restricted to their coupled components.
    pub nodes: Vec<Node6>,
}

impl Constraint for SmallRigidBody {
    const NAME: &'static str = "rigid body, small rotations";
    type Error = CouplingError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), CouplingError> {
        if self.nodes.is_empty() {
            return Err(CouplingError::NoNodes);
        }
        check(&self.reference, self.nodes.iter(), RepeatedNodes::Refused)?;
        for (i, node) in self.nodes.iter().enumerate() {
            let r: Vector<f64> = arm(node.at, self.reference.at);
            for component in node.coupled_components() {
                let (name, row) = (equation_name(i, self.nodes.len(), node, component.kind), component.row(r));
                follow(sink, name, component.terms, &self.reference, row)?;
            }
        }
        Ok(())
    }
}

/// Name of the equation of a component.
pub(super) fn equation_name(number: usize, nodes: usize, node: &Node6, component: Component) -> String {
    let short = node.name(component);
    if nodes == 1 { short } else { format!("node {}, {short}", number + 1) }
}

/// A rigid link (one node) or rigid body (many nodes), exact for finite rotations.
///
/// `x_i = x_r + R (X_i - X_r)`, one equation for each translation of a node. Omitted DOFs (`None`, [`Node6::only`])
/// stay free. Components along local axes ([`Node6::along`]) are along axes `R e` that rotate with the body. A node
/// with rotations has a rotation vector and three more equations, `log(R^T R_i) = 0`, angles in the axes of the body.
/// The body may have a rotation vector or Euler parameters. A node has all three rotations or none: single components
/// of a rotation vector have no meaning. A node with Euler parameters is a [`Body`]: join it by a fixed joint.
///
#[doc = include_str!("../../../docs/pictures/rigid_body.svg")]
///
#[doc = include_str!("../../../docs/types/rigid_body.md")]
/// # Example
///
/// ```
/// use qless_constraints::{ConstraintSet, types::{Body, Node6, Point, RigidBody}};
/// let body = Body::with_vector([0, 1, 2], [0.0; 3], [3, 4, 5]);
/// let node = Node6::from(Point::new([6, 7, 8], [2.0, 0.0, 0.0]));
/// let mut builder = ConstraintSet::builder(9);
/// builder.add("link", RigidBody { body, nodes: vec![node] })?;
/// let set = builder.build()?;
/// // A quarter turn about z brings the node from (2, 0, 0) to (0, 2, 0).
/// let mut evaluation = set.allocate();
/// set.evaluate(&[0.0, 0.0, 0.0, 0.0, 0.0, std::f64::consts::FRAC_PI_2, -2.0, 2.0, 0.0], &mut evaluation)?;
/// assert!(evaluation.c().iter().all(|c| c.abs() < 1e-15));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct RigidBody {
    /// Position and rotation of the body.
    pub body: Body,
    /// The dependent nodes, restricted to their coupled components.
    pub nodes: Vec<Node6>,
}

/// The equation for one translation of a node that moves with a body: `c = X_k + u_k - x_k(body)`. `X_k` is the node's coordinate along
/// axis k, and `x_k(body)` is the coordinate to which the body moves it. The node's DOF `u_k` precedes the DOFs of the body.
struct BodyCoordinate {
    body: AttachedPoint,
    axis: usize,
    at: f64,
}

impl Nonlinear for BodyCoordinate {
    const EQUATION_NAMES: &'static [&'static str] = &[""];

    fn value<S: Scalar>(&self, u: &[S], c: &mut [S]) {
        c[0] = S::from(self.at) + u[0] - self.body.point(&u[1..])[self.axis];
    }

    /// All pairs of rotation DOFs of the body.
    fn pairs(&self, dofs: usize, pair: &mut dyn FnMut(usize, usize)) {
        let first = 1 + self.body.kind.positions();
        (first..dofs).for_each(|j| (first..=j).for_each(|k| pair(j, k)));
    }
}

impl RigidBody {
    /// Equations for the translations of node i: all three together, or one by one.
    fn translations(&self, sink: &mut EquationSink, i: usize) {
        let node = self.nodes[i];
        if let Some(point) = point(&node).filter(|_| Component::ALL[..3].iter().all(|&k| node.has(k))) {
            return coincident(sink, self.name(i), &self.body, &Body::node(point), node.at);
        }
        for component in node.coupled_components().filter(|component| !component.kind.is_rotation()) {
            let name = equation_name(i, self.nodes.len(), &node, component.kind);
            if let Some(point) = point(&node).filter(|_| node.local.is_some()) {
                height(sink, name, &self.body, &Body::node(point), node.at, component.axis);
            } else if let [(dof, _)] = component.terms[..] {
                self.coordinate(sink, name, node.at, (component.kind as usize, dof));
            }
        }
    }

    /// Adds the equation [`BodyCoordinate`] for the translation `dof` of a node along axis `axis`.
    fn coordinate(&self, sink: &mut EquationSink, name: String, at: Vector<f64>, (axis, dof): (usize, usize)) {
        let parameters = BodyCoordinate { body: self.body.attach(at), axis, at: at[axis] };
        sink.numbers(at);
        sink.place(&[dof], &[at[axis]], false);
        self.body.state(sink);
        sink.nonlinear(name, &[vec![dof], self.body.dofs()].concat(), parameters);
    }

    /// Adds `log(R^T R_i) = 0` with the rotation R of the body and the rotation `R_i` of node i, if the rotations of the node are coupled.
    fn rotations(&self, sink: &mut EquationSink, i: usize) -> Result<(), CouplingError> {
        let node = self.nodes[i];
        let listed = Component::ALL[3..].iter().filter(|&&component| node.has(component)).count();
        match (listed, &node.dofs[3..]) {
            (0, _) => Ok(()),
            (3, &[Some(x), Some(y), Some(z)]) => {
                // The equations use only the rotations, so the position may be that of the body.
                let follower = Body::with_vector(self.body.position, self.body.at, [x, y, z]);
                sink.numbers(node.at);
                relative(sink, self.name(i), &self.body, &follower, Aligned);
                Ok(())
            }
            _ => Err(CouplingError::PartOfRotations { node: i + 1 }),
        }
    }

    /// Name of node i; empty if there is only one.
    fn name(&self, i: usize) -> String {
        if self.nodes.len() == 1 { String::new() } else { format!("node {}", i + 1) }
    }
}

impl Constraint for RigidBody {
    const NAME: &'static str = "rigid body, finite rotations";
    type Error = CouplingError;

    fn emit(self, sink: &mut EquationSink) -> Result<(), CouplingError> {
        if self.nodes.is_empty() {
            return Err(CouplingError::NoNodes);
        }
        if !self.body.turns() {
            return Err(CouplingError::NoRotations);
        }
        // The body as a node, without the fourth Euler parameter.
        let r = self.body.rotation_dofs();
        let reference = Node6::new(self.body.position, [r[0], r[1], r[2]], self.body.at);
        check(&reference, self.nodes.iter(), RepeatedNodes::Refused)?;
        for i in 0..self.nodes.len() {
            self.translations(sink, i);
            self.rotations(sink, i)?;
        }
        Ok(())
    }
}

/// The node as a point, if it has all three translations.
fn point(node: &Node6) -> Option<Point> {
    let [x, y, z, ..] = node.dofs;
    Some(Point::new([x?, y?, z?], node.at))
}
