//! `T_p = sum_k N_k(xi) T_k`: a field of one value per node, tied at a node to the point of a face that is nearest to it.

use crate::geometry::node::Node;
use crate::geometry::search::{FaceSearch, Nearest, SearchError};
use crate::geometry::surface::Surface;
use crate::{Constraint, Store};

use super::LinearEquationError;

/// A temperature, pressure or potential at a node, tied to those of a face: one equation. Of displacements, see [`super::NodeTie`].
///
/// ```
/// use qless_constraints::ConstraintSet;
/// use qless_constraints::types::{Face, FieldTie, Node, Shape, Surface};
/// let at = |dof: usize, x: f64| Node::of_field(dof, [x, 0.0]);
/// let faces = vec![Face::new(Shape::Line2, [0, 1]), Face::new(Shape::Line2, [1, 2])];
/// let wall = Surface { nodes: vec![at(0, 0.0), at(1, 1.0), at(2, 2.0)], faces };
/// let mut builder = ConstraintSet::builder(4);
/// for tie in FieldTie::to_surface(&[at(3, 1.75)], &wall, 1e-6)? {
///     builder.add("tie", tie)?;
/// }
/// let g = builder.build()?.allocate().g().clone();
/// assert_eq!(g.row(0).collect::<Vec<_>>(), [(1, -0.25), (2, -0.75), (3, 1.0)]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct FieldTie {
    /// The value that is tied, a 0-based DOF.
    pub dof: usize,
    /// The values of the face, 0-based DOFs, and `N_k`.
    pub face: Vec<(usize, f64)>,
}

impl FieldTie {
    /// Ties each node to the face of a surface that is nearest to it, see [`FaceSearch`]; one tie per node, in their order. The value
    /// at a node is its first DOF ([`Node::of_field`]).
    ///
    /// The nodes should not be of the surface: the equations of such a tie would say `0 = 0`.
    ///
    /// # Errors
    /// [`SearchError`]: what is wrong with the surface, or the first node without a face within the tolerance, a length.
    pub fn to_surface<const D: usize>(
        nodes: &[Node<D>],
        surface: &Surface<D>,
        tolerance: f64,
    ) -> Result<Vec<Self>, SearchError> {
        let places: Vec<[f64; D]> = nodes.iter().map(|node| node.at).collect();
        let nearest = FaceSearch::new(surface)?.within(&places, tolerance)?;
        let tie = |(node, found): (&Node<D>, Nearest)| {
            let dofs = surface.faces[found.face].nodes.iter().map(|&k| surface.nodes[k].dofs[0]);
            Self { dof: node.dofs[0], face: dofs.zip(found.weights).collect() }
        };
        Ok(nodes.iter().zip(nearest).map(tie).collect())
    }
}

impl Constraint for FieldTie {
    const NAME: &'static str = "tie of a field";
    type Error = LinearEquationError;

    fn process(self, store: &mut Store) -> Result<(), LinearEquationError> {
        if self.face.is_empty() {
            return Err(LinearEquationError::NoTerms);
        }
        let masters = self.face.into_iter().filter(|&(_, n)| n != 0.0).map(|(dof, n)| (dof, -n));
        store.equation("", masters.chain([(self.dof, 1.0)]), 0.0);
        Ok(())
    }
}
