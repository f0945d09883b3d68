//! Mortar ties `sum_j D_ij u_j - sum_k M_ik v_k = 0` with `D_ij = int phi_i phi_j` and `M_ik = int phi_i psi_k`.
//!
//! The slave side has displacements u and functions phi, the master side v and psi. All DOFs are free.

mod integrals;
mod side;

use qless::SystemBuilder;

use super::AXES;
use super::sums::{Terms, add_sums};
use crate::error::within;
use crate::{Component, Dof, Rng, Scene, SceneError, Truth};
pub(super) use integrals::gauss;
use integrals::{Band, products};
pub use side::{Degree, Side};

/// A tie of two meshes of a line or of a rectangle.
///
/// D is symmetric and positive definite, so all equations except the sums are independent. Its condition number does not grow
/// with the number of elements. A field that both sides can represent, such as a constant, satisfies every equation.
///
/// DOFs and equations are ordered by node and then by component. The slave nodes come before the master nodes.
///
/// ```
/// use qless_scenes::families::{Degree, Mortar, Side};
/// let (slave, master) = (Side::uniform(6, Degree::Linear)?, Side::jittered(4, Degree::Quadratic, 1)?);
/// let scene = Mortar { components: 2, ..Mortar::line(slave, master) }.scene(1)?;
/// assert_eq!((scene.system.equations(), scene.system.dofs()), (2 * 7, 2 * (7 + 9)));
/// assert_eq!(scene.truth.rank_free, Some(14));
/// # Ok::<(), qless_scenes::SceneError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Mortar {
    /// Slave and master mesh along x.
    pub along: [Side; 2],
    /// Slave and master mesh along y for a rectangle: `D = D_x (x) D_y`, `M = M_x (x) M_y`. `None` for a line.
    pub across: Option<[Side; 2]>,
    /// DOFs per node, 1 to 3.
    pub components: usize,
    /// Whether the axes of the equations are rotated relative to those of the DOFs, so that each equation has all components.
    pub skew: bool,
    /// Number of redundant equations, each the sum of two others. The sum is exact if these share no DOF, which is preferred.
    pub sums: usize,
}

/// A tie of a line with linear elements: n + 1 on the slave side, one of them ten times shorter, and n / 2 + 1 on the master side.
///
/// It has n + 2 equations on n + 2 slave and n / 2 + 2 master DOFs. The time is linear in n.
///
/// # Errors
/// [`SceneError::Size`] for n = 0, [`SceneError::Mesh`] for n above 1e8.
pub fn mortar_short(n: usize) -> Result<Scene, SceneError> {
    let slave = Side::with_short_element(n, Degree::Linear)?;
    Mortar::line(slave, Side::uniform(n / 2 + 1, Degree::Linear)?).scene(0)
}

impl Mortar {
    /// A tie of a line, with one DOF per node.
    pub fn line(slave: Side, master: Side) -> Self {
        Self { along: [slave, master], across: None, components: 1, skew: false, sums: 0 }
    }

    /// A tie of a rectangle with one DOF per node, from the meshes of each side along x and y.
    pub fn face(slave: [Side; 2], master: [Side; 2]) -> Self {
        let ([slave_x, slave_y], [master_x, master_y]) = (slave, master);
        Self { across: Some([slave_y, master_y]), ..Self::line(slave_x, master_x) }
    }

    /// Builds the scene; the seed chooses the sums.
    ///
    /// # Errors
    /// [`SceneError::Size`] for other than 1 to 3 components, or too many nodes or sums.
    pub fn scene(&self, seed: u64) -> Result<Scene, SceneError> {
        within("components", self.components, 1, 3)?;
        let count = |side: usize| {
            let across = self.across.as_ref().map_or(1, |sides| sides[side].count());
            self.along[side].count().saturating_mul(across)
        };
        within("nodes", count(0).saturating_add(count(1)), 2, super::MOST)?;
        let [slaves, masters] = [0, 1].map(|side| self.places(side));
        within("sums", self.sums, 0, super::MOST)?;
        let rows = self.rows(slaves.len());
        let nodes = [slaves, masters].concat();
        let mut builder = SystemBuilder::new(nodes.len() * self.components);
        for (i, row) in rows.iter().enumerate() {
            let letter = Component::SPACE[i % self.components].letter();
            builder.labelled_equation(format!("tie node {}, {letter}", i / self.components + 1), row.clone(), 0.0);
        }
        add_sums(&mut builder, self.sums, rows.len(), |i| rows[i].clone(), &mut Rng::new(seed));
        let dofs = Dof::of_nodes(nodes.len(), self.components);
        let truth = Truth::rank(rows.len() + self.sums, rows.len()).without_generated(true);
        Ok(Scene { system: builder.build()?, truth, nodes, dofs })
    }

    /// Coordinates of the nodes of a side, along x first.
    fn places(&self, side: usize) -> Vec<[f64; 3]> {
        let across = self.across.as_ref().map_or_else(|| vec![0.0], |sides| sides[side].nodes());
        let along = self.along[side].nodes();
        across.iter().flat_map(|&y| along.iter().map(move |&x| [x, y, 0.0])).collect()
    }

    /// All equations of the tie; `slaves` is the number of slave nodes.
    fn rows(&self, slaves: usize) -> Vec<Terms> {
        let along = [0, 1].map(|side| products(&self.along[0], &self.along[side]));
        let across = [0, 1].map(|side| {
            self.across.as_ref().map_or_else(|| vec![vec![(0, 1.0)]], |sides| products(&sides[0], &sides[side]))
        });
        let width = [0, 1].map(|side| self.along[side].nodes().len());
        let mut rows = Vec::with_capacity(slaves * self.components);
        for (j, i) in (0..across[0].len()).flat_map(|j| (0..along[0].len()).map(move |i| (j, i))) {
            let terms = |side: usize| tensor(&along[side], &across[side], width[side], [i, j]);
            let nodes: Vec<_> = terms(0).chain(terms(1).map(|(k, v)| (slaves + k, -v))).collect();
            rows.extend((0..self.components).map(|c| self.in_frame(&nodes, c)));
        }
        rows
    }

    /// One component of the vector equation `sum_k v_k u_k = 0`, where `nodes` holds the pairs (k, v_k).
    fn in_frame(&self, nodes: &[(usize, f64)], component: usize) -> Terms {
        let axes: [[f64; 3]; 3] = match (self.skew, self.components) {
            (true, 2) => [[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0; 3]],
            (true, 3) => AXES.map(|axis| axis.map(|c| c / 3.0)),
            _ => [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        };
        let axis = axes[component].into_iter().take(self.components).enumerate().filter(|&(_, cosine)| cosine != 0.0);
        let on_node =
            |&(k, v): &(usize, f64)| axis.clone().map(move |(c, cosine)| (self.components * k + c, cosine * v));
        nodes.iter().flat_map(on_node).collect()
    }
}

/// Row (i, j) of the Kronecker product of `along` and `across`, as pairs `(node, value)`.
fn tensor<'a>(
    along: &'a Band,
    across: &'a Band,
    width: usize,
    [i, j]: [usize; 2],
) -> impl Iterator<Item = (usize, f64)> + 'a {
    across[j].iter().flat_map(move |&(l, y)| along[i].iter().map(move |&(k, x)| (k + width * l, x * y)))
}
