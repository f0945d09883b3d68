//! `qless-scenes`: invalid sizes, numbers and truths.

use qless::Csr;
use qless_scenes::families::{
    self, Degree, Edges, Faces, Linkage, Mortar, MortarSurface, Near, PeriodicCell, Planted, Side, Surface, Windows,
};
use qless_scenes::fssi::{self, Mesh};
use qless_scenes::{Component, Dof, Rng, Scene, SceneError, Truth, oracle, paper};

use super::{BAD, HUGE, refused, survives};

#[test]
fn sizes_out_of_range() {
    for n in [0, 1 << 28].into_iter().chain(HUGE) {
        let no = |what: &str, call: &dyn Fn() -> Result<Scene, SceneError>| _ = refused(what, call);
        no("path", &|| families::path(n));
        no("cycle", &|| families::cycle(n, 0.0));
        no("grid", &|| families::grid_2d(n, 2));
        no("grid", &|| families::grid_2d(2, n));
        no("graph", &|| families::random_graph(n, 2, 1));
        no("incidence", &|| families::incidence(n, &[]));
        no("gradient", &|| families::gradient([n, 1, 1], 1, 1));
        no("gradient", &|| families::gradient([2, 2, 1], n, 1));
        no("rbe2", &|| families::rbe2(n, 1, 1));
        no("rbe2", &|| families::rbe2(3, n, 1));
        no("near", &|| families::near(n, 0.1, Near::Shared));
        no("chain", &|| families::geometric_chain(n, 2.0));
        no("recurrence", &|| families::recurrence(n));
        no("rotations", &|| families::rotations(n));
        no("band", &|| families::spotted_band(n, 1));
        no("spider", &|| families::spider(n));
        no("arrow", &|| families::arrow(n));
        no("ladder", &|| families::ladder(n));
        no("rve", &|| families::rve(n));
        no("typed", &|| families::typed_twice(n, 5, 1));
        no("typed", &|| families::typed_twice(5, n, 1));
        no("cosines", &|| families::typed_cosines(n, 5, 1));
        no("cosines", &|| families::typed_cosines(2, n, 1));
        no("planted", &|| families::planted(n, 10, 1, 1, false));
        no("planted", &|| families::planted(10, n, 1, 1, false));
        no("planted", &|| Planted { rows: 3, dofs: 4, combos: 1, terms: n, conflict: false }.scene(1));
        no("windows", &|| windows(|w| w.extent = [n, 2, 2]).scene(1));
        no("windows", &|| windows(|w| w.d = n).scene(1));
        no("windows", &|| windows(|w| w.stride = n).scene(1));
        no("windows", &|| windows(|w| w.rows = n).scene(1));
        no("cell", &|| PeriodicCell::new(n, 4, Edges::Own).scene(1));
        no("cell", &|| PeriodicCell::new(4, n, Edges::Matching).scene(1));
        no("surface", &|| MortarSurface::new(Surface::Sphere, [n, 2], [2, 2]).scene(1));
        no("linkage", &|| Linkage { rows: n, columns: 2, pitch: 1, length: 1, balls: true }.scene(1));
        no("linkage", &|| Linkage { rows: 2, columns: 2, pitch: n, length: 1, balls: true }.scene(1));
        no("fssi", &|| fssi::tie(&Mesh { columns: n, ..Mesh::with_equations(100) }, 1));
        no("fssi", &|| fssi::mortar(&Mesh { sectors: n, ..Mesh::with_equations(100) }, 1));
        if n > 0 {
            refused("a permutation", || Rng::new(1).permutation(n));
            refused("numbers", || Rng::new(1).distinct(n, n));
            refused("a short element", || families::mortar_short(n));
        }
        refused("a side", || Side::uniform(n, Degree::Linear));
        refused("a side", || Side::jittered(n, Degree::Quadratic, 1));
        refused("a side", || Side::with_short_element(n, Degree::Linear));
    }
    let long = || Side::uniform(1 << 14, Degree::Quadratic).expect("a side");
    refused("a face", || Mortar::face([long(), long()], [long(), long()]).scene(1));
    assert_eq!(Faces::Quads, Faces::Quads);
}

fn windows(change: impl Fn(&mut Windows)) -> Windows {
    let mut windows = Windows { extent: [6, 6, 1], d: 1, window: 3, stride: 2, rows: 1, combos: 1 };
    change(&mut windows);
    windows
}

#[test]
fn counts_of_what_cannot_be_made() {
    for n in [0, 1].into_iter().chain(HUGE) {
        survives("counts", || {
            let w = Windows { extent: [n; 3], d: n, window: n, stride: n, rows: n, combos: n };
            let linkage = Linkage { rows: n, columns: n, pitch: n, length: n, balls: false };
            let surface = MortarSurface { sums: n, ..MortarSurface::new(Surface::Sphere, [n; 2], [n; 2]) };
            let mesh = Mesh { columns: n, layers: n, far_columns: n, far_layers: n, rings: n, sectors: n, wall: n };
            let cell = PeriodicCell::new(n, n, Edges::Own);
            let counts =
                [w.equations(), w.dofs(), linkage.bodies(), linkage.loops(), surface.equations(), surface.dofs()];
            let of_mesh = [mesh.equations(), mesh.redundant(), mesh.redundant_mortar(), mesh.nested().equations()];
            let more = [cell.equations(), Linkage::with_bodies(n, true).bodies(), usize::from(mesh.is_nested())];
            (counts, of_mesh, more, MortarSurface::with_equations(Surface::Sphere, n).dofs(), mesh.check().is_err())
        });
        survives("a truth", || Truth::rank(3, n).with_redundant(n).with_redundant(usize::MAX));
    }
    survives("deep", || {
        [0, 1, 2, 9].map(|columns| Mesh { columns, ..Mesh::with_equations(100) }.deep().check().is_ok())
    });
}

/// Functions that accept every argument.
#[test]
fn scenes_and_truths_of_any_size() {
    use paper::FloorInput::{Accepted, Chain, Star};
    for scene in [paper::figure_8(), paper::figure_2(Star), paper::figure_2(Chain), paper::figure_2(Accepted)] {
        survives("a figure", || scene).expect("always there");
    }
    for n in [0, 1].into_iter().chain(HUGE) {
        let truth = survives("a truth", || Truth::independent(n).with_conflict(true).with_redundant(usize::MAX));
        assert_eq!((truth.rank_free, truth.redundant, truth.conflicting), (Some(0), Some(usize::MAX), true));
    }
    assert_eq!(fssi::Level::ALL.map(fssi::Level::percent), [50, 60, 70, 80, 90, 100, 110]);
    assert_eq!([Component::X, Component::Normal].map(Component::letter), ['x', 'n']);
    assert_eq!(Side::uniform(1, Degree::Linear).expect("one").elements(), 1);
}

#[test]
fn numbers_that_make_no_scene() {
    for bad in BAD {
        refused("gap", || families::cycle(4, bad));
        refused("factor", || families::geometric_chain(4, bad));
        refused("eps", || families::near(2, bad, Near::Shared));
        refused("b", || paper::equations_12_to_14(bad));
        refused("u2", || paper::figure_5(bad));
        refused("u4", || paper::figure_6(bad));
        refused("h", || paper::figure_1(bad));
        refused("an edge", || families::incidence(2, &[(0, 1, bad)]));
        refused("ends", || Side::new(vec![0.0, bad, 1.0], Degree::Linear));
        let scene = families::path(3).expect("a path");
        refused("units", || scene.scale_dofs(&[1.0, bad, 1.0]));
        refused("a value", || scene.with_prescribed(&[(0, bad)]));
    }
    refused("an edge", || families::incidence(2, &[(0, 2, 0.0)]));
    refused("an edge", || families::incidence(2, &[(usize::MAX, 0, 0.0)]));
    refused("ends", || Side::new(vec![], Degree::Linear));
    survives("nothing", || Rng::new(0).distinct(usize::MAX, 0).expect("none").len() + Rng::new(0).below(0));
    survives("nothing", || Rng::new(0).coefficient(0) + Rng::new(0).coefficient(usize::MAX));
}

/// A scene with inconsistent fields, which are public.
#[test]
fn scenes_that_were_changed() {
    let mut scene = families::path(3).expect("a path");
    scene.dofs = vec![Dof { node: usize::MAX, component: Component::X }];
    scene.truth = Truth { rank_free: Some(usize::MAX), generated: Some(vec![(usize::MAX, 0.0)]), ..Truth::default() };
    survives("changes", || {
        scene.shuffle(1).expect("valid");
        scene.scale_dofs(&[2.0; 3]).expect("valid");
        scene.scale_rows(3, 1).expect("valid");
        scene.beside(&scene).expect("valid");
        scene.with_singletons(2, usize::MAX, 1).expect("valid");
    });
    for units in [vec![], vec![1.0; 2], vec![1.0; 4], vec![0.0; 3]] {
        refused("units", || scene.scale_dofs(&units));
    }
    for n in HUGE {
        refused("exponents", || scene.scale_rows(n, 1));
        refused("singletons", || scene.with_singletons(n, 1, 1));
        refused("a DOF", || scene.with_prescribed(&[(n, 0.0)]));
    }
}

#[test]
fn the_oracle_of_what_is_no_matrix() {
    for bad in BAD {
        let matrix = Csr::from_parts(1, vec![0, 1], vec![0], vec![bad]).expect("a matrix");
        refused("a number", || oracle::exact_rank(&matrix));
    }
    assert_eq!(survives("nothing", || oracle::exact_rank(&Csr::default())), Ok(0));
    refused("wide", || oracle::exact_rank(&Csr::empty(usize::MAX)));
    let large = families::path(20_000).expect("a path").system;
    refused("dense", || oracle::singular_values(&large));
}
