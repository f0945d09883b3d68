//! Mortar ties of the paper's Table 1: dense coupling, no column singletons, blocks of thousands of rows that are factored sparse.
//!
//! A QR without pivoting keeps dependent rows here, so these systems test the check of the rank. The number of redundant rows follows
//! from the mesh: 12 for each layer by which the near field exceeds the far field ([`fssi::mortar`]).

mod support;

use qless::{BackendChoice, Kind, Options};
use qless_scenes::families;
use qless_scenes::fssi::{self, Level};
use support::{check_certificates, check_reduction, diagnose};

fn check(level: Level, redundant: usize, backend: BackendChoice) {
    let scene = fssi::mortar(&level.mesh(), 1).expect("a scene");
    let analysis = diagnose(&scene.system, &Options { backend, ..Options::default() });
    assert_eq!(analysis.rank(), level.equations() - redundant, "{} %", level.percent());
    assert_eq!(analysis.dependent().iter().filter(|d| d.kind == Kind::Redundant).count(), redundant);
    check_certificates(&scene.system, &analysis);
}

fn ranks(backend: BackendChoice) {
    check(Level::P50, 60, backend);
    check(Level::P80, 96, backend);
}

#[test]
fn ranks_faer() {
    ranks(BackendChoice::Faer);
}

#[cfg(feature = "spqr")]
#[test]
fn ranks_spqr() {
    ranks(BackendChoice::Spqr);
}

/// The chosen slaves of large blocks are well-conditioned; the first independent columns would not be.
#[test]
fn a_reduction_meets_the_equations() {
    let scene = fssi::mortar(&fssi::Mesh::with_equations(5000), 1).expect("a scene");
    let analysis = diagnose(&scene.system, &Options { backend: BackendChoice::Sparse, ..Options::default() });
    let reduction = analysis.reduction().expect("within the gate");
    assert!(analysis.presolve().largest_block > 1200, "{:?}", analysis.presolve());
    assert!(reduction.growth() <= 4.0, "growth {}", reduction.growth());
    let limit = 1e-13 / analysis.confidence().distance;
    let residual = analysis.residual(&reduction).expect("its own DOFs");
    assert!(residual <= limit, "residual {residual:e}, limit {limit:e}");
    check_reduction(&scene.system, &analysis, &reduction, limit);
}

/// The certificates exceed the memory for one batch: 1,253 equations over 15,621 others.
#[test]
fn many_redundant_equations_are_explained() {
    let linkage = families::Linkage::with_bodies(3000, true);
    let scene = linkage.scene(1).expect("a linkage");
    let analysis = diagnose(&scene.system, &Options::default());
    assert_eq!(Some(analysis.rank()), scene.truth.rank_free);
    assert!(analysis.dependent().len() * analysis.rank() > 4_000_000);
    check_certificates(&scene.system, &analysis);
}
