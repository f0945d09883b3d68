//! Options of the scenes of one large block: surfaces, cells and mechanisms.

use clap::Args;
use qless_scenes::families::{Linkage, MortarSurface, PeriodicCell};
use qless_scenes::{Scene, SceneError};

use super::values::{Edging, FaceKind, ShapeName};

#[derive(Args, Debug)]
pub struct Cell {
    /// Elements per side of the near faces
    #[arg(long, default_value_t = 10)]
    near: usize,
    /// Elements per side of the far faces
    #[arg(long, default_value_t = 12)]
    far: usize,
    /// Faces of the near side
    #[arg(long, value_enum, default_value = "quads")]
    faces: FaceKind,
    /// Whether parallel edges match; if not, how many equations are redundant is not known beforehand
    #[arg(long, value_enum, default_value = "matching")]
    edges: Edging,
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

#[derive(Args, Debug)]
pub struct Tie {
    /// What both meshes approximate
    #[arg(long, value_enum, default_value = "sphere")]
    surface: ShapeName,
    /// About this many equations, on as many cells each way and two thirds of them on the master side
    #[arg(long, value_name = "N", default_value_t = 3000)]
    equations: usize,
    /// Cells of the slave side each way, instead of --equations
    #[arg(long, value_name = "N", num_args = 2, value_names = ["S", "T"])]
    slave: Option<Vec<usize>>,
    /// Cells of the master side each way, instead of two thirds of the slave's
    #[arg(long, value_name = "N", num_args = 2, value_names = ["S", "T"])]
    master: Option<Vec<usize>>,
    /// Faces of the slave side
    #[arg(long, value_enum, default_value = "quads")]
    slave_faces: FaceKind,
    /// Faces of the master side
    #[arg(long, value_enum, default_value = "triangles")]
    master_faces: FaceKind,
    /// Redundant equations, each the sum of two others
    #[arg(long, default_value_t = 0)]
    sums: usize,
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

#[derive(Args, Debug)]
pub struct NetScene {
    /// A square net of at most so many bodies
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
    /// Bodies are about so long: 1 in metres, 1000 in millimetres
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
        PeriodicCell { near, far, near_faces: faces.into(), edges: edges.into() }.scene(seed)
    }
}

impl Tie {
    /// # Errors
    /// [`SceneError`] for sizes that make no scene.
    pub fn generate(&self) -> Result<Scene, SceneError> {
        let about = MortarSurface::with_equations(self.surface.into(), self.equations);
        let slave = pair(self.slave.as_deref()).unwrap_or(about.slave);
        let master = pair(self.master.as_deref()).unwrap_or(slave.map(|n| n.div_ceil(3) * 2));
        let (slave_faces, master_faces) = (self.slave_faces.into(), self.master_faces.into());
        MortarSurface { slave, master, slave_faces, master_faces, sums: self.sums, ..about }.scene(self.seed)
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
