//! The scenes of `qless generate` and their sizes.

mod large;

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};
use qless_scenes::families::{self, Near, Windows};
use qless_scenes::fssi::{self, Level, Mesh};
use qless_scenes::paper::{self, FloorInput};
use qless_scenes::{Scene, SceneError};

use crate::values::{NamedValue, finite, one_of};
use large::{Cell, NetScene, Tie};

/// The scene, and the folder for it.
#[derive(Args)]
#[command(subcommand_value_name = "SCENE", subcommand_help_heading = "Scenes")]
pub struct SceneArgs {
    #[command(subcommand)]
    pub scene: SceneName,
    /// Folder for C.mtx, b.txt and the other files of the scene
    #[arg(short, long, value_name = "DIR", global = true)]
    pub output: Option<PathBuf>,
    /// No progress display
    #[arg(long, short, global = true)]
    pub quiet: bool,
}

#[derive(Subcommand)]
pub enum SceneName {
    /// Liquid tank in a soil box: the paper's Table 1, at its seven mesh levels or any size
    Fssi(Fssi),
    /// Paper, equations (12)-(14): rank 2; conflicting unless --rhs is 1
    Equations {
        /// Right-hand side of (14)
        #[arg(long, default_value_t = 1.0, allow_negative_numbers = true, value_parser = finite)]
        rhs: f64,
    },
    /// Paper, Figure 1: four bodies corner to corner; conflicting unless --h is 0
    #[command(name = "figure-1", alias = "figure1")]
    Figure1 {
        /// Prescribed value of H
        #[arg(long, default_value_t = 0.0, allow_negative_numbers = true, value_parser = finite)]
        h: f64,
    },
    /// Paper, Figure 2: a floor that moves as one
    #[command(name = "figure-2", alias = "figure2")]
    Figure2 {
        /// How the equations are written
        #[arg(long, value_parser = one_of(&FLOORS), default_value = "star")]
        form: FloorInput,
    },
    /// Paper, Figure 5: equations (12)-(14) with u2 prescribed
    #[command(name = "figure-5", alias = "figure5")]
    Figure5 {
        /// Prescribed value of u2
        #[arg(long, default_value_t = 0.5, allow_negative_numbers = true, value_parser = finite)]
        u2: f64,
    },
    /// Paper, Figure 6: generated boundary conditions
    #[command(name = "figure-6", alias = "figure6")]
    Figure6 {
        /// Prescribed value of u4
        #[arg(long, default_value_t = 0.5, allow_negative_numbers = true, value_parser = finite)]
        u4: f64,
    },
    /// Paper, Figure 8: 16 ties along four lines, 2 of them redundant
    #[command(name = "figure-8", alias = "figure8")]
    Figure8,
    /// Sparse rows with planted combinations
    Planted {
        #[arg(long, default_value_t = 1000)]
        rows: usize,
        #[arg(long, default_value_t = 2000)]
        dofs: usize,
        #[arg(long, default_value_t = 100)]
        combos: usize,
        /// Let the last combination contradict the rows that it combines
        #[arg(long)]
        conflict: bool,
        #[arg(long, default_value_t = 1)]
        seed: u64,
    },
    /// Ties u_k = u_(k+1) along a chain
    Path {
        #[arg(long, default_value_t = 1000)]
        nodes: usize,
    },
    /// A chain of ties that is closed by one more; conflicting unless --gap is 0
    Cycle {
        #[arg(long, default_value_t = 1000)]
        nodes: usize,
        #[arg(long, default_value_t = 0.0, allow_negative_numbers = true, value_parser = finite)]
        gap: f64,
    },
    /// Ties along all edges of a plane grid
    Grid {
        #[arg(long, default_value_t = 30)]
        nx: usize,
        #[arg(long, default_value_t = 30)]
        ny: usize,
    },
    /// Ties along random edges
    Graph {
        #[arg(long, default_value_t = 1000)]
        nodes: usize,
        #[arg(long, default_value_t = 1500)]
        edges: usize,
        #[arg(long, default_value_t = 1)]
        seed: u64,
    },
    /// Ties that all start with the same DOF
    Spider {
        #[arg(long, default_value_t = 1000)]
        legs: usize,
    },
    /// Ties to one DOF, and their sum
    Arrow {
        #[arg(long, default_value_t = 1000)]
        n: usize,
    },
    /// u_i = 2 u_(i+1): the wrong slaves make T grow to 2^rungs
    Ladder {
        #[arg(long, default_value_t = 50)]
        rungs: usize,
    },
    /// Nodes gripped by one or two rigid spiders
    Rbe2 {
        #[arg(long, default_value_t = 100)]
        nodes: usize,
        #[arg(long, default_value_t = 1)]
        masters: usize,
        #[arg(long, default_value_t = 1)]
        seed: u64,
    },
    /// Periodic unit cell of n x n x n elements, stated naively
    Rve {
        #[arg(long, default_value_t = 10)]
        n: usize,
    },
    /// Periodic unit cell whose opposite faces do not match, each far node interpolated on the near face
    PeriodicCell(Cell),
    /// Mortar tie of two meshes of a curved surface that do not match
    MortarSurface(Tie),
    /// Rows of hinged bodies with rungs of two bodies between them: a plane mechanism in space
    Linkage(NetScene),
    /// Triples of rows: the third is the sum of the other two, except for a difference of eps
    Near {
        #[arg(long, default_value_t = 10)]
        triples: usize,
        #[arg(long, default_value_t = 1e-8, allow_negative_numbers = true, value_parser = finite)]
        eps: f64,
        /// DOF in which the third row differs
        #[arg(long, value_parser = one_of(&NEARS), default_value = "own")]
        column: Near,
    },
    /// d x d blocks on the edges of a grid
    Gradient {
        #[command(flatten)]
        extent: Extent,
        #[arg(long, default_value_t = 3)]
        d: usize,
        #[arg(long, default_value_t = 1)]
        seed: u64,
    },
    /// Overlapping windows of local equations on a grid
    Windows {
        #[command(flatten)]
        extent: Extent,
        /// DOFs per node
        #[arg(long, default_value_t = 1)]
        d: usize,
        /// Nodes per side of a window
        #[arg(long, default_value_t = 4)]
        window: usize,
        /// Nodes from one window to the next
        #[arg(long, default_value_t = 2)]
        stride: usize,
        /// Equations per window
        #[arg(long, default_value_t = 2)]
        rows: usize,
        #[arg(long, default_value_t = 10)]
        combos: usize,
        #[arg(long, default_value_t = 1)]
        seed: u64,
    },
}

const FLOORS: [NamedValue<FloorInput>; 3] = [
    ("star", "All with u1", FloorInput::Star),
    ("chain", "Each with the one before", FloorInput::Chain),
    ("accepted", "All with u4", FloorInput::Accepted),
];

const NEARS: [NamedValue<Near>; 2] =
    [("own", "In a DOF of two of the three rows", Near::Own), ("shared", "In a DOF of all three rows", Near::Shared)];

#[derive(Clone, Copy, ValueEnum)]
pub enum Coupling {
    /// Each node to the face beside it; 12 redundant equations per layer
    Tie,
    /// Mortar integrals; the numerical rank is ambiguous
    Mortar,
}

/// Parses `110` or `110%`.
fn level(text: &str) -> Result<Level, String> {
    let percent = text.trim_end_matches('%').parse().ok();
    let level = Level::ALL.into_iter().find(|level| Some(level.percent()) == percent);
    level.ok_or_else(|| "the levels are 50, 60, 70, 80, 90, 100 and 110".to_owned())
}

#[derive(Args)]
pub struct Fssi {
    /// Mesh level of Table 1 in percent: 50, 60, ... 110
    #[arg(long, default_value = "110", value_parser = level, conflicts_with = "equations")]
    level: Level,
    /// About this many equations, instead of a level
    #[arg(long, value_name = "N")]
    equations: Option<usize>,
    /// How the soil box is coupled to its surroundings
    #[arg(long, value_enum, default_value = "tie")]
    coupling: Coupling,
    /// Numbers the DOFs
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

#[derive(Args)]
pub struct Extent {
    /// Nodes along x
    #[arg(long, default_value_t = 20)]
    nx: usize,
    /// Nodes along y
    #[arg(long, default_value_t = 20)]
    ny: usize,
    /// Nodes along z
    #[arg(long, default_value_t = 1)]
    nz: usize,
}

impl SceneName {
    /// # Errors
    /// [`SceneError`] for sizes that make no scene.
    pub fn generate(&self) -> Result<Scene, SceneError> {
        match *self {
            Self::Fssi(ref args) => args.generate(),
            Self::Equations { rhs } => paper::equations_12_to_14(rhs),
            Self::Figure1 { h } => paper::figure_1(h),
            Self::Figure2 { form } => paper::figure_2(form),
            Self::Figure5 { u2 } => paper::figure_5(u2),
            Self::Figure6 { u4 } => paper::figure_6(u4),
            Self::Figure8 => paper::figure_8(),
            Self::Planted { rows, dofs, combos, conflict, seed } => {
                families::planted(rows, dofs, combos, seed, conflict)
            }
            Self::Path { nodes } => families::path(nodes),
            Self::Cycle { nodes, gap } => families::cycle(nodes, gap),
            Self::Grid { nx, ny } => families::grid_2d(nx, ny),
            Self::Graph { nodes, edges, seed } => families::random_graph(nodes, edges, seed),
            Self::Spider { legs } => families::spider(legs),
            Self::Arrow { n } => families::arrow(n),
            Self::Ladder { rungs } => families::ladder(rungs),
            Self::Rbe2 { nodes, masters, seed } => families::rbe2(nodes, masters, seed),
            Self::Rve { n } => families::rve(n),
            Self::PeriodicCell(ref args) => args.generate(),
            Self::MortarSurface(ref args) => args.generate(),
            Self::Linkage(ref args) => args.generate(),
            Self::Near { triples, eps, column } => families::near(triples, eps, column),
            Self::Gradient { ref extent, d, seed } => families::gradient(extent.sides(), d, seed),
            Self::Windows { ref extent, d, window, stride, rows, combos, seed } => {
                Windows { extent: extent.sides(), d, window, stride, rows, combos }.scene(seed)
            }
        }
    }
}

impl Fssi {
    fn generate(&self) -> Result<Scene, SceneError> {
        let mesh = self.equations.map_or_else(|| self.level.mesh(), Mesh::with_equations);
        match self.coupling {
            Coupling::Tie => fssi::tie(&mesh, self.seed),
            Coupling::Mortar => fssi::mortar(&mesh, self.seed),
        }
    }
}

impl Extent {
    fn sides(&self) -> [usize; 3] {
        [self.nx, self.ny, self.nz]
    }
}
