//! Constraint systems `C u = b` whose rank, redundancy and conflicts are known by construction.
//!
//! Each generator returns a [`Scene`]: the [`qless::ConstraintSystem`], the [`Truth`] about it and, if the model has a
//! geometry, the coordinates of its nodes. The same arguments give the same bits on every machine: random numbers come
//! from [`Rng`], and no function of the platform's mathematical library is used.
//!
//! | module | scenes |
//! | --- | --- |
//! | [`fssi`] | fluid-structure-soil interaction, sizes and redundancies of the paper's Table 1, tied or mortar-coupled |
//! | [`paper`] | the paper's figures and small examples |
//! | [`families`] | families of any size and seed: planted combinations, graphs, rigid spiders, periodic cells, grids |
//! | [`oracle`] | exact rank and dense singular values, as a reference |
//! | [`memory`] | keeps freed memory in the process between the rounds of a benchmark |
//!
//! ```
//! use qless_scenes::{fssi, oracle};
//! let scene = fssi::tie(&fssi::Level::P50.mesh(), 1)?;
//! assert_eq!(scene.system.equations(), 7580);
//! assert_eq!(scene.truth.redundant, Some(168));
//! assert_eq!(oracle::rank_free(&scene.system)?, 7412);
//! # Ok::<(), qless_scenes::SceneError>(())
//! ```

mod change;
pub mod corpus;
mod error;
pub mod families;
pub mod fssi;
pub mod memory;
pub mod oracle;
pub mod paper;
mod rng;
mod scene;

pub use change::Order;
pub use error::SceneError;
pub use rng::Rng;
pub use scene::{Component, Dof, Scene, Truth};

/// The example of the README, as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
