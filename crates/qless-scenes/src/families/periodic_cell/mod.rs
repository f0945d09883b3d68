//! `u(x) - sum_k N_k(x - e_d) u_k - eps e_d = 0`: periodicity of a cube whose opposite faces do not match.

mod boundary;

use qless::SystemBuilder;

use super::patch::{Faces, Locator};
use super::sums::Terms;
use crate::error::within;
use crate::{Component, Dof, Rng, Scene, SceneError, Truth};
use boundary::Boundary;

/// Whether the four parallel edges of a cell match.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edges {
    /// They have nodes at the same places.
    Matching,
    /// Each has its own.
    Own,
}

/// A cube with a mean strain `eps`, whose faces have meshes of their own.
///
/// Every node x of each far face `x_d = 1`, those of its edges and corners included, is interpolated between the nodes `u_k` of
/// the near face's element over which it lies. Affine fields `u = eps x` satisfy all equations. The six strains are the last
/// DOFs, those of two reference nodes: `xx, yy, zz`, then `yz, zx, xy`, which make one block of the components.
///
/// With [`Edges::Matching`] the equations of each node of a far face say the same, so that one equation per component is
/// independent for each: nodes on two far faces, an edge's `near - 1` and its far end, have one redundant equation and the last
/// corner has two, in all `3 (3 near + 2)`. With [`Edges::Own`] they agree on fields
/// that are linear along edges only, and so lock the near edges: a mistake that is often made. How many are redundant is then
/// not known beforehand.
///
/// Nodes of a near face without a far node over their elements occur in no equation: few where the far faces are finer.
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
    /// Elements of the near faces, but for a strip along their edges, which is always of triangles.
    pub near_faces: Faces,
    /// Meshes of the edges.
    pub edges: Edges,
}

/// Weights below this are rounding of where a point is.
const NOTHING: f64 = 1e-12;

impl PeriodicCell {
    /// Near faces of hexahedra.
    pub fn new(near: usize, far: usize, edges: Edges) -> Self {
        Self { near, far, near_faces: Faces::Quads, edges }
    }

    /// m: nine for each node inside a far face, and for each of its edges' nodes.
    pub fn equations(&self) -> usize {
        let [near, far] = [self.near, self.far].map(|n| n.saturating_sub(1));
        let edges = match self.edges {
            Edges::Matching => near.saturating_mul(4),
            Edges::Own => far.saturating_mul(4),
        };
        far.saturating_pow(2).saturating_add(edges).saturating_add(4).saturating_mul(9)
    }

    /// The equations by far face, node and component; the seed places the nodes.
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
        let dofs = (0..strains + 6).map(|j| Dof { node: j / 3, component: Component::SPACE[j % 3] }).collect();
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

/// The two coordinates that follow an axis.
fn flat(axis: usize, place: [f64; 3]) -> [f64; 2] {
    [place[(axis + 1) % 3], place[(axis + 2) % 3]]
}

/// Which strain moves the far face of an axis along c.
fn strain(axis: usize, c: Component) -> usize {
    let c = c as usize;
    if axis == c { axis } else { 6 - axis - c }
}

/// Nodes of the element over which a point lies, and their weights; only those of an edge for a point on it.
fn masters(locator: &Locator, point: [f64; 2]) -> Terms {
    let (face, weights) = locator.at(point);
    let mut masters: Terms = face.nodes().iter().copied().zip(weights).filter(|term| term.1.abs() > NOTHING).collect();
    // Whatever was rounded or left out, they add up to one.
    let others: f64 = masters.iter().skip(1).map(|term| term.1).sum();
    masters[0].1 = 1.0 - others;
    masters
}

fn equation(node: usize, masters: &Terms, c: usize, strain: usize) -> Terms {
    let interpolated = masters.iter().map(|&(master, weight)| (3 * master + c, -weight));
    [(3 * node + c, 1.0)].into_iter().chain(interpolated).chain([(strain, -1.0)]).collect()
}
