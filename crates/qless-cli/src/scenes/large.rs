//! Options of the scenes of one large block: surfaces, cells and mechanisms.

use clap::Args;
use qless_scenes::families::{Edges, Faces, Linkage, MortarSurface, PeriodicCell, Surface};
use qless_scenes::{Scene, SceneError};

use crate::values::{NamedValue, one_of};

const FACES: [NamedValue<Faces>; 2] =
    [("quads", "Bilinear, of hexahedra", Faces::Quads), ("triangles", "Linear, of tetrahedra", Faces::Triangles)];

const EDGES: [NamedValue<Edges>; 2] =
    [("matching", "Nodes at the same places", Edges::Matching), ("own", "Each edge has its own nodes", Edges::Own)];

const SURFACES: [NamedValue<Surface>; 4] = [
    ("plane", "Flat", Surface::Plane),
    ("cylinder", "106 degrees of a cylinder", Surface::Cylinder),
    ("sphere", "Part of a sphere", Surface::Sphere),
    ("waves", "Hills and valleys", Surface::Waves),
];

#[derive(Args)]
pub struct Cell {
    /// Elements per side of the near faces
    #[arg(long, default_value_t = 10)]
    near: usize,
    /// Elements per side of the far faces
    #[arg(long, default_value_t = 12)]
    far: usize,
    /// Faces of the near side
    #[arg(long, value_parser = one_of(&FACES), default_value = "quads")]
    faces: Faces,
    /// Whether parallel edges match; if not, how many equations are redundant is not known beforehand
    #[arg(long, value_parser = one_of(&EDGES), default_value = "matching")]
    edges: Edges,
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

#[derive(Args)]
pub struct Tie {
    /// Surface that both meshes approximate
    #[arg(long, value_parser = one_of(&SURFACES), default_value = "sphere")]
    surface: Surface,
    /// Approximate number of equations; the master side has two thirds as many cells each way as the slave side
    #[arg(long, value_name = "N", default_value_t = 3000)]
    equations: usize,
    /// Cells of the slave side each way, instead of --equations
    #[arg(long, value_name = "N", num_args = 2, value_names = ["S", "T"])]
    slave: Option<Vec<usize>>,
    /// Cells of the master side each way, instead of two thirds of the slave's
    #[arg(long, value_name = "N", num_args = 2, value_names = ["S", "T"])]
    master: Option<Vec<usize>>,
    /// Faces of the slave side
    #[arg(long, value_parser = one_of(&FACES), default_value = "quads")]
    slave_faces: Faces,
    /// Faces of the master side
    #[arg(long, value_parser = one_of(&FACES), default_value = "triangles")]
    master_faces: Faces,
    /// Redundant equations, each the sum of two others
    #[arg(long, default_value_t = 0)]
    sums: usize,
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

#[derive(Args)]
pub struct NetScene {
    /// Largest number of bodies of a square net
    #[arg(long, default_value_t = 1000)]
    bodies: usize,
    /// Rows of bodies, instead of --bodies
    #[arg(long, requires = "columns", conflicts_with = "bodies")]
    rows: Option<usize>,
    /// Bodies per row
    #[arg(long, requires = "rows")]
    columns: Option<usize>,
    /// Bodies from one rung to the next
    #[arg(long, default_value_t = 1)]
    pitch: usize,
    /// Approximate length of a body: 1 in metres, 1000 in millimetres
    #[arg(long, default_value_t = 1)]
    length: usize,
    /// Ball joints in rungs that close a loop, by the seed
    #[arg(long)]
    balls: bool,
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

impl Cell {
    /// # Errors
    /// [`SceneError`] for sizes that make no scene.
    pub fn generate(&self) -> Result<Scene, SceneError> {
        let Self { near, far, faces, edges, seed } = *self;
        PeriodicCell { near, far, near_faces: faces, edges }.scene(seed)
    }
}

impl Tie {
    /// # Errors
    /// [`SceneError`] for sizes that make no scene.
    pub fn generate(&self) -> Result<Scene, SceneError> {
        let about = MortarSurface::with_equations(self.surface, self.equations);
        let slave = pair(self.slave.as_deref()).unwrap_or(about.slave);
        let master = pair(self.master.as_deref()).unwrap_or(slave.map(|n| n.div_ceil(3) * 2));
        let &Self { slave_faces, master_faces, sums, seed, .. } = self;
        MortarSurface { slave, master, slave_faces, master_faces, sums, ..about }.scene(seed)
    }
}

impl NetScene {
    /// # Errors
    /// [`SceneError`] for sizes that make no scene.
    pub fn generate(&self) -> Result<Scene, SceneError> {
        let square = Linkage::with_bodies(self.bodies, self.balls);
        let (rows, columns) = (self.rows.unwrap_or(square.rows), self.columns.unwrap_or(square.columns));
        Linkage { rows, columns, pitch: self.pitch, length: self.length, ..square }.scene(self.seed)
    }
}

/// The two numbers of an option that takes two.
fn pair(numbers: Option<&[usize]>) -> Option<[usize; 2]> {
    numbers.and_then(|numbers| numbers.try_into().ok())
}
