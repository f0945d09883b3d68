//! Mortar ties of non-matching curved surfaces: `sum_j D_ij a . u_j - sum_k M_ik a . v_k = 0` for the axes a of node i.

mod integrals;
mod surface;

use qless::SystemBuilder;

use super::patch::{Faces, Grid};
use super::sums::{Terms, add_sums};
use crate::error::within;
use crate::{Dof, Rng, Scene, SceneError, Truth};
use integrals::{IntegralsRow, SurfaceMesh, frame};
pub use surface::Surface;

/// A tie of two meshes of a curved surface in space, with displacements u on the slave side and v on the master side.
///
/// `D_ij = int N_i N_j dA` and `M_ik = int N_i P_k dA` over the slave faces, with nine Gauss points per face. A Gauss point
/// belongs to the master face at the same `(s, t)`. Both meshes are grids of cells mapped to the surface; the seed moves their nodes
/// and chooses the diagonals of triangles. The equations of a node have the axes of its normal and two tangents, so that they connect
/// all components.
///
/// D is a mass matrix, symmetric and positive definite, so all equations except the sums are independent. The row sums of `D - M` are
/// zero. A linear displacement field satisfies the equations in the plane; on a curved surface its residual is of the order of the
/// distance between the two meshes, which is the squared element size. A master node occurs in no equation if its faces have no Gauss
/// point, which happens if the master side is at least twice as fine.
///
/// ```
/// use qless_scenes::families::{Faces, MortarSurface, Surface};
/// let tie = MortarSurface::new(Surface::Sphere, [6, 5], [4, 4]);
/// assert_eq!((tie.slave_faces, tie.master_faces), (Faces::Quads, Faces::Triangles));
/// let scene = MortarSurface { sums: 9, ..tie }.scene(1)?;
/// assert_eq!((scene.system.equations(), scene.system.dofs()), (3 * 7 * 6 + 9, 3 * (7 * 6 + 5 * 5)));
/// assert_eq!(scene.truth.rank_free, Some(3 * 7 * 6));
/// # Ok::<(), qless_scenes::SceneError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MortarSurface {
    /// The surface that both meshes approximate.
    pub surface: Surface,
    /// Cells of the slave side along s and t.
    pub slave: [usize; 2],
    /// Cells of the master side along s and t.
    pub master: [usize; 2],
    /// Faces of the slave side.
    pub slave_faces: Faces,
    /// Faces of the master side.
    pub master_faces: Faces,
    /// Number of redundant equations, each the sum of two others. The sum is exact if these share no DOF, which is preferred.
    pub sums: usize,
}

impl MortarSurface {
    /// Hexahedra on the slave side and tetrahedra on the master side, without sums.
    pub fn new(surface: Surface, slave: [usize; 2], master: [usize; 2]) -> Self {
        Self { surface, slave, master, slave_faces: Faces::Quads, master_faces: Faces::Triangles, sums: 0 }
    }

    /// [`MortarSurface::new`] with about `equations` equations and two thirds as many cells in each direction on the master side.
    pub fn with_equations(surface: Surface, equations: usize) -> Self {
        let cells = (equations / 3).isqrt().max(2) - 1;
        Self::new(surface, [cells; 2], [cells.div_ceil(3) * 2; 2])
    }

    /// m, the number of equations.
    pub fn equations(&self) -> usize {
        nodes(self.slave).saturating_mul(3).saturating_add(self.sums)
    }

    /// n, the number of DOFs.
    pub fn dofs(&self) -> usize {
        nodes(self.slave).saturating_add(nodes(self.master)).saturating_mul(3)
    }

    /// Builds the scene: equations by slave node and axis, then the sums; DOFs of slave nodes, then of master nodes.
    ///
    /// # Errors
    /// [`SceneError::Size`] for no cells or too many, or too many sums.
    pub fn scene(&self, seed: u64) -> Result<Scene, SceneError> {
        [self.slave, self.master]
            .as_flattened()
            .iter()
            .try_for_each(|&n| within("cells along a side", n, 1, 1 << 12))?;
        within("sums", self.sums, 0, super::MOST)?;
        let mut rng = Rng::new(seed);
        let slave = self.side(self.slave, self.slave_faces, &mut rng);
        let master = self.side(self.master, self.master_faces, &mut rng);
        let rows = integrals::rows(&slave, &master);
        let frames: Vec<_> = rows.iter().map(|row| frame(row.normal)).collect();
        let equation = |i: usize| along(&rows[i / 3], rows.len(), frames[i / 3][i % 3]);
        let mut builder = SystemBuilder::new(self.dofs());
        for i in 0..3 * rows.len() {
            let axis = ["normal", "tangent 1", "tangent 2"][i % 3];
            builder.labelled_equation(format!("tie node {}, {axis}", i / 3 + 1), equation(i), 0.0);
        }
        add_sums(&mut builder, self.sums, 3 * rows.len(), equation, &mut rng);
        let dofs = Dof::of_nodes(slave.space.len() + master.space.len(), 3);
        let truth = Truth::rank(self.equations(), 3 * rows.len()).without_generated(true);
        Ok(Scene { system: builder.build()?, truth, nodes: [slave.space, master.space].concat(), dofs })
    }

    fn side(&self, cells: [usize; 2], faces: Faces, rng: &mut Rng) -> SurfaceMesh {
        let Grid { nodes, faces } = Grid::jittered(cells, faces, rng);
        let space = nodes.iter().map(|&place| self.surface.at(place)).collect();
        SurfaceMesh { faces, square: nodes, space }
    }
}

fn nodes([along, across]: [usize; 2]) -> usize {
    along.saturating_add(1).saturating_mul(across.saturating_add(1))
}

/// An equation along an axis; master nodes are numbered after the slave nodes.
fn along(row: &IntegralsRow, slaves: usize, axis: [f64; 3]) -> Terms {
    let nodes = row.slave.iter().copied().chain(row.master.iter().map(|&(k, v)| (slaves + k, -v)));
    nodes.flat_map(|(node, v)| (0..3).map(move |c| (3 * node + c, axis[c] * v))).filter(|term| term.1 != 0.0).collect()
}
