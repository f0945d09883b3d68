//! Families of scenes with a size and a seed, whose rank follows from their construction.
//!
//! | family | equations x DOFs | rank |
//! | --- | --- | --- |
//! | [`planted`] | (rows + combos) x dofs | rows |
//! | [`path`], [`cycle`], [`grid_2d`], [`random_graph`] | edges x nodes | nodes - components |
//! | [`spider`] | legs x (legs + 1) | legs |
//! | [`arrow`] | (n + 1) x (n + 1) | n |
//! | [`ladder`] | rungs x (rungs + 1) | rungs |
//! | [`rbe2`] | (3 k masters) x (3 k + 6 masters) | 3 k, or 3 k + 6 with two masters |
//! | [`rve`] | 9 (n + 1)^2 x 3 ((n + 1)^3 - (n - 1)^3 + 3) | 3 ((n + 1)^3 - n^3) |
//! | [`geometric_chain`] | (n - 1) x n, one DOF prescribed | n - 1, near-singular for a factor above 1 |
//! | [`recurrence`] | rows x (rows + 2), two DOFs prescribed | rows, near-singular |
//! | [`rotations`] | 2 n x 2 (n + 1) | 2 n |
//! | [`spotted_band`] | n x n | n |
//! | [`typed_twice`] | (n + copies) x 2 n | n + copies, at distance 10^-digits from n |
//! | [`typed_cosines`] | 10 n x (8 n + 2) | 8 n, at distance 10^-digits from 7 n |
//! | [`near`] | 3 triples x 7 triples | 3 triples, at distance eps from 2 triples |
//! | [`Mortar`], [`mortar_short`] | (d slave nodes + sums) x d (slave + master nodes) | d slave nodes |
//! | [`MortarSurface`] | (3 slave nodes + sums) x 3 (slave + master nodes) | 3 slave nodes |
//! | [`PeriodicCell`] | (9 nodes of a far face) x (3 surface nodes + 6) | all but 3 (3 near + 2), or unknown |
//! | [`Linkage`] | (5 hinges + 3 balls) x 6 bodies | all but 3, 1 or 0 per loop |
//! | [`gradient`] | (d edges) x (d nodes) of a grid | d nodes, or nodes - 1 for d = 1 |
//! | [`Windows`] | wide, local windows on a grid | all but the planted combinations |
//!
//! [`crate::Scene::scale_rows`], [`crate::Scene::scale_dofs`] and [`crate::Scene::shuffle`] change the scales and the order of
//! a scene. [`crate::Scene::with_singletons`] adds rows with a DOF of their own, [`crate::Scene::beside`] another scene.
//!
//! ```
//! use qless_scenes::{families, oracle};
//! let scene = families::planted(40, 70, 15, 1, false)?;
//! assert_eq!(oracle::rank_free(&scene.system)?, 40);
//! # Ok::<(), qless_scenes::SceneError>(())
//! ```

mod band;
mod chains;
mod gradient;
mod graph;
mod linkage;
mod mortar;
mod mortar_surface;
mod near;
mod patch;
mod periodic_cell;
mod planted;
mod rigid;
mod rods;
mod rve;
mod shapes;
mod sums;
mod typed;
mod windows;

pub use band::spotted_band;
pub use chains::{geometric_chain, recurrence, rotations};
pub use gradient::gradient;
pub use graph::{cycle, grid_2d, incidence, path, random_graph};
pub use linkage::Linkage;
pub use mortar::{Degree, Mortar, Side, mortar_short};
pub use mortar_surface::{MortarSurface, Surface};
pub use near::{Near, near};
pub use patch::Faces;
pub use periodic_cell::{Edges, PeriodicCell};
pub use planted::{Planted, planted};
pub use rigid::rbe2;
pub use rods::typed_cosines;
pub use rve::rve;
pub use shapes::{arrow, ladder, spider};
pub use typed::typed_twice;
pub use windows::Windows;

pub(crate) use crate::error::MOST;

/// The rows of a rotation, times 3: orthogonal whole vectors that are not parallel to x, y or z.
const AXES: [[f64; 3]; 3] = [[2.0, -1.0, 2.0], [2.0, 2.0, -1.0], [-1.0, 2.0, 2.0]];
