//! Periodicity of a cube with non-matching opposite faces and a mean strain eps: `u(x) - sum_k N_k(x - e_d) u_k - eps e_d = 0`.

mod boundary;

use qless::SystemBuilder;

use super::patch::{Faces, Locator};
use super::sums::Terms;
use crate::error::within;
use crate::{Component, Dof, Rng, Scene, SceneError, Truth};
use boundary::Boundary;

/// Whether the meshes of the four parallel edges of a cell match.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edges {
    /// The four parallel edges have nodes at the same places.
    Matching,
    /// Each edge has its own nodes.
    Own,
}

/// A cube with a mean strain `eps`, with a mesh of its own on each face.
///
/// Every node x of each far face `x_d = 1`, including its edges and corners, is interpolated from the nodes `u_k` of the opposite
/// element of the near face. Affine fields `u = eps x` satisfy all equations. The six strains are the last DOFs, at two reference
/// nodes: `xx, yy, zz`, then `yz, zx, xy`; they connect the components to one block.
///
/// With [`Edges::Matching`] a node of a far face has one independent equation per component. A node on two far faces (the
/// `near - 1` inner nodes of an edge and its end on a near face) has one redundant equation per component, and the last corner has
/// two: in all `3 (3 near + 2)`. With [`Edges::Own`] the equations of such a node agree only for fields that are linear along the
/// edges, which locks the near edges: a common mistake in practice. The number of redundant equations is then unknown.
///
/// A node of a near face occurs in no equation if no far node lies opposite its elements. Finer far faces have few such nodes.
///
/// ```
/// use qless_scenes::families::{Edges, PeriodicCell};
/// let cell = PeriodicCell::new(3, 5, Edges::Matching);
/// let scene = cell.scene(1)?;
/// assert_eq!((scene.system.equations(), scene.truth.redundant), (cell.equations(), Some(33)));
/// # Ok::<(), qless_scenes::SceneError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PeriodicCell {
    /// Elements per side of the near faces.
    pub near: usize,
    /// Elements per side of the far faces.
    pub far: usize,
    /// Elements of the near faces, except for the strips along their edges, which always have triangles.
    pub near_faces: Faces,
    /// Meshes of the edges.
    pub edges: Edges,
}

/// Interpolation weights up to this size come from the rounding of positions and are dropped.
const NOTHING: f64 = 1e-12;

impl PeriodicCell {
    /// A cell with near faces of hexahedra.
    pub fn new(near: usize, far: usize, edges: Edges) -> Self {
        Self { near, far, near_faces: Faces::Quads, edges }
    }

    /// m: three equations for each node of each of the three far faces, including the nodes of its edges.
    pub fn equations(&self) -> usize {
        let [near, far] = [self.near, self.far].map(|n| n.saturating_sub(1));
        let edges = match self.edges {
            Edges::Matching => near.saturating_mul(4),
            Edges::Own => far.saturating_mul(4),
        };
        far.saturating_pow(2).saturating_add(edges).saturating_add(4).saturating_mul(9)
    }

    /// Builds the scene: equations by far face, node and component. The seed moves the nodes.
    ///
    /// # Errors
    /// [`SceneError::Size`] for fewer than 3 elements per side, or too many.
    pub fn scene(&self, seed: u64) -> Result<Scene, SceneError> {
        for (what, n) in [("near", self.near), ("far", self.far)] {
            within(what, n, 3, 1 << 11)?;
        }
        let mut boundary = Boundary::new(self, &mut Rng::new(seed));
        let strains = 3 * boundary.nodes.len();
        let mut builder = SystemBuilder::new(strains + 6);
        for axis in 0..3 {
            let locator = Locator::new(&boundary.near[axis], |node| flat(axis, boundary.nodes[node]));
            for &node in &boundary.far[axis] {
                let masters = masters(&locator, flat(axis, boundary.nodes[node]));
                for c in Component::SPACE {
                    let letters = (Component::SPACE[axis].letter(), c.letter());
                    let label = format!("periodic {}, node {}, {}", letters.0, node + 1, letters.1);
                    builder.labelled_equation(
                        label,
                        equation(node, &masters, c as usize, strains + strain(axis, c)),
                        0.0,
                    );
                }
            }
        }
        boundary.nodes.extend([[2.0, 0.0, 0.0], [0.0, 2.0, 0.0]]);
        let dofs = Dof::of_nodes(boundary.nodes.len(), 3);
        Ok(Scene { system: builder.build()?, truth: self.truth(), nodes: boundary.nodes, dofs })
    }

    fn truth(&self) -> Truth {
        let redundant = 3 * (3 * self.near + 2);
        let truth = match self.edges {
            Edges::Matching => Truth::independent(self.equations()).with_redundant(redundant),
            Edges::Own => Truth::default(),
        };
        truth.without_generated(true)
    }
}

/// The coordinates along the two axes after the given one.
fn flat(axis: usize, place: [f64; 3]) -> [f64; 2] {
    [place[(axis + 1) % 3], place[(axis + 2) % 3]]
}

/// Index of the strain that moves the far face of an axis along c.
fn strain(axis: usize, c: Component) -> usize {
    let c = c as usize;
    if axis == c { axis } else { 6 - axis - c }
}

/// Nodes and weights of the element at a point; a point on an edge has the nodes of the edge only.
fn masters(locator: &Locator, point: [f64; 2]) -> Terms {
    let (face, weights) = locator.at(point);
    let mut masters: Terms = face.nodes().iter().copied().zip(weights).filter(|term| term.1.abs() > NOTHING).collect();
    // The weights must add up to one despite rounding and dropped weights.
    let others: f64 = masters.iter().skip(1).map(|term| term.1).sum();
    masters[0].1 = 1.0 - others;
    masters
}

fn equation(node: usize, masters: &Terms, c: usize, strain: usize) -> Terms {
    let interpolated = masters.iter().map(|&(master, weight)| (3 * master + c, -weight));
    [(3 * node + c, 1.0)].into_iter().chain(interpolated).chain([(strain, -1.0)]).collect()
}
