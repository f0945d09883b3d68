//! Every backend against the others and against the truth: all scene families, and real systems with known rank.

mod support;

use std::panic::{AssertUnwindSafe, catch_unwind};

use qless::{Analysis, BackendChoice, ConstraintSystem, Kind, Options};
use qless_scenes::families::{self, Near, Windows};
use qless_scenes::fssi::{self, Mesh};
use qless_scenes::{Scene, SceneError, paper};
use support::{check_certificates, check_reduction, diagnose, orders, reorder, settings};

fn backends() -> Vec<BackendChoice> {
    let spqr = cfg!(feature = "spqr").then_some(BackendChoice::Spqr);
    [BackendChoice::Faer, BackendChoice::Sparse, BackendChoice::Gauss].into_iter().chain(spqr).collect()
}

/// Results that must not depend on the backend, on presolve or on the order.
#[derive(Clone, Debug, PartialEq)]
struct Answer {
    rank: usize,
    dependent: usize,
    conflicting: bool,
    /// Generated boundary conditions, by DOF numbers before reordering.
    generated: Vec<usize>,
}

/// The answer for a reordered system; its DOF j was `dofs[j]`.
fn answer(analysis: &Analysis, dofs: &[usize]) -> Answer {
    let mut generated: Vec<usize> = analysis.generated().iter().map(|&(j, _)| dofs[j]).collect();
    generated.sort_unstable();
    Answer {
        rank: analysis.rank(),
        dependent: analysis.dependent().len(),
        conflicting: analysis.kinds().contains(&Kind::Conflicting),
        generated,
    }
}

/// Checks every identity, and that the default backend reports no doubt without reason.
fn check_identities(system: &ConstraintSystem, analysis: &Analysis, options: &Options) {
    check_certificates(system, analysis);
    let reduction = analysis.reduction().expect("within the gate");
    check_reduction(system, analysis, &reduction, 1e-12);
    let residual = analysis.residual(&reduction).expect("its own DOFs");
    assert!(residual <= 1e-12, "residual {residual:e}");
    assert!(reduction.growth() <= options.growth, "growth {}", reduction.growth());
    let doubted = analysis.confidence().ambiguous && options.backend == BackendChoice::Faer;
    assert!(!doubted, "{:?}", analysis.confidence());
}

/// The system in natural, reversed and two random orders of rows and DOFs, with the original numbers of its DOFs.
fn in_every_order(system: &ConstraintSystem) -> Vec<(ConstraintSystem, Vec<usize>)> {
    let with_natural = |n: usize| std::iter::once((0..n).collect()).chain(orders(n)).collect::<Vec<Vec<usize>>>();
    let (rows, dofs) = (with_natural(system.equations()), with_natural(system.dofs()));
    rows.iter().zip(dofs).map(|(rows, dofs)| (reorder(system, rows, &dofs), dofs)).collect()
}

/// A failed assertion as text, so that one failure does not hide the next.
fn fault(what: &str, check: impl FnOnce()) -> Option<String> {
    let panic = catch_unwind(AssertUnwindSafe(check)).err()?;
    let message = panic.downcast_ref::<String>().cloned();
    let message = message.or_else(|| panic.downcast_ref::<&str>().map(ToString::to_string)).unwrap_or_default();
    Some(format!("{what}: {message}"))
}

fn check_all(scenes: Vec<(&str, Result<Scene, SceneError>)>) {
    let mut faults = Vec::new();
    for (name, scene) in scenes {
        let scene = scene.unwrap_or_else(|e| panic!("{name}: {e}"));
        backends().into_iter().for_each(|backend| faults.extend(check_scene(name, &scene, backend)));
    }
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}

/// Compares with the truth of the scene, or with the first answer for generated boundary conditions that the scene does not state.
fn check_scene(name: &str, scene: &Scene, backend: BackendChoice) -> Vec<String> {
    let (rank, redundant) = (scene.truth.rank_free.expect("known"), scene.truth.redundant.expect("known"));
    let known = scene.truth.generated.as_ref().map(|all| all.iter().map(|&(j, _)| j).collect());
    let unordered: Vec<usize> = (0..scene.system.dofs()).collect();
    let first = || answer(&diagnose(&scene.system, &Options::default()), &unordered).generated;
    let generated: Vec<usize> = known.unwrap_or_else(first);
    let truth = Answer { rank, dependent: redundant, conflicting: scene.truth.conflicting, generated };
    let mut faults = Vec::new();
    for (order, (system, dofs)) in in_every_order(&scene.system).iter().enumerate() {
        for options in settings(backend) {
            let what = format!("{name}, {backend:?}, presolve {}, order {order}", options.presolve);
            faults.extend(fault(&what, || {
                let analysis = diagnose(system, &options);
                assert_eq!(answer(&analysis, dofs), truth);
                check_identities(system, &analysis, &options);
            }));
        }
    }
    faults
}

#[test]
fn planted_combinations_and_windows() {
    let flat = Windows { extent: [14, 14, 1], d: 1, window: 4, stride: 2, rows: 2, combos: 20 };
    let solid = Windows { extent: [6, 6, 6], d: 1, window: 3, stride: 3, rows: 6, combos: 8 };
    let planted = |conflict| families::planted(120, 200, 60, 1, conflict);
    check_all(vec![
        ("planted", planted(false)),
        ("planted, conflicting", planted(true)),
        ("planted, square", families::planted(90, 90, 30, 2, false)),
        ("planted and singletons", planted(false).and_then(|scene| scene.with_singletons(60, 3, 1))),
        ("planted, rows scaled", planted(true).and_then(|scene| Ok(scene.scale_rows(40, 1)?.0))),
        ("windows in the plane", flat.scene(1)),
        ("windows in space", solid.scene(2)),
    ]);
}

#[test]
fn graphs() {
    check_all(vec![
        ("path", families::path(150)),
        ("cycle", families::cycle(150, 0.0)),
        ("cycle with a gap", families::cycle(150, 1e-3)),
        ("grid", families::grid_2d(12, 10)),
        ("forest", families::random_graph(150, 80, 1)),
        ("random graph", families::random_graph(100, 220, 2)),
        ("star", families::spider(120)),
        ("arrow", families::arrow(120)),
        ("ladder", families::ladder(30)),
        ("gradient, scalar", families::gradient([6, 5, 3], 1, 1)),
        ("gradient of a line", families::gradient([30, 1, 1], 3, 1)),
        ("gradient of a plane", families::gradient([7, 6, 1], 3, 1)),
        ("gradient in space", families::gradient([4, 3, 3], 2, 1)),
    ]);
}

#[test]
fn rigid_and_periodic() {
    check_all(vec![
        ("rigid spider", families::rbe2(50, 1, 1)),
        ("rigid spiders on the same legs", families::rbe2(40, 2, 1)),
        ("periodic cell", families::rve(4)),
        ("nearly dependent, own column", families::near(10, 1e-3, Near::Own)),
        ("nearly dependent, shared column", families::near(10, 1e-3, Near::Shared)),
        ("dependent triples", families::near(10, 0.0, Near::Own)),
    ]);
}

#[test]
fn figures_of_the_paper() {
    check_all(vec![
        ("equations 12 to 14", paper::equations_12_to_14(1.0)),
        ("equations 12 to 14, conflicting", paper::equations_12_to_14(0.0)),
        ("figure 1", paper::figure_1(0.0)),
        ("figure 1, conflicting", paper::figure_1(0.5)),
        ("figure 2", paper::figure_2(paper::FloorInput::Star)),
        ("figure 5", paper::figure_5(0.25)),
        ("figure 6", paper::figure_6(0.5)),
        ("figure 8", paper::figure_8()),
    ]);
}

#[test]
fn fluid_structure_soil() {
    let mesh = Mesh::with_equations(320);
    check_all(vec![
        ("ties", fssi::tie(&mesh, 1)),
        ("mortar", fssi::mortar(&mesh, 1)),
        ("mortar, nested", fssi::mortar(&mesh.nested(), 1)),
    ]);
}

/// Truth of a corpus system.
#[derive(serde::Deserialize)]
struct Expected {
    name: String,
    class: String,
    rank: Option<usize>,
    rank_free: Option<usize>,
    inconsistent: Option<bool>,
    inconsistent_free: Option<bool>,
}

/// All definite systems of the corpus with at most 5,000 equations.
fn definite_cases() -> Vec<(Expected, ConstraintSystem)> {
    let folders = support::corpus::folders("cases");
    let read = |folder: &std::path::PathBuf| {
        let text = std::fs::read_to_string(folder.join("expected.json")).expect("expected.json");
        let expected: Expected = serde_json::from_str(&text).expect("known fields");
        let system = qless_io::read_case(folder, None, None).unwrap_or_else(|e| panic!("{}: {e}", expected.name));
        (expected, system)
    };
    let fits =
        |(expected, system): &(Expected, ConstraintSystem)| expected.class == "definite" && system.equations() <= 5000;
    folders.iter().map(read).filter(fits).collect()
}

/// Faults of a backend on the corpus, with presolve, in natural and in one random order.
fn corpus_faults(backend: BackendChoice) -> Vec<(String, String)> {
    let options = Options { backend, ..Options::default() };
    let mut faults = Vec::new();
    for (expected, system) in definite_cases() {
        let rank = expected.rank_free.or(expected.rank);
        let conflicting = expected.inconsistent_free.or(expected.inconsistent);
        let random = reorder(&system, &orders(system.equations())[1], &orders(system.dofs())[1]);
        for (order, system) in [("natural", &system), ("random", &random)] {
            let found = fault(&format!("{order} order"), || {
                let analysis = diagnose(system, &options);
                let found = (Some(analysis.rank()), Some(analysis.kinds().contains(&Kind::Conflicting)));
                assert_eq!(found, (rank, conflicting), "rank and conflict");
                check_identities(system, &analysis, &options);
            });
            faults.extend(found.map(|fault| (expected.name.clone(), fault)));
        }
    }
    faults
}

#[test]
fn corpus_faer() {
    let faults = corpus_faults(BackendChoice::Faer);
    assert!(faults.is_empty(), "{faults:#?}");
}

#[test]
fn corpus_sparse() {
    let faults = corpus_faults(BackendChoice::Sparse);
    assert!(faults.is_empty(), "{faults:#?}");
}

#[cfg(feature = "spqr")]
#[test]
fn corpus_spqr() {
    let faults = corpus_faults(BackendChoice::Spqr);
    assert!(faults.is_empty(), "{faults:#?}");
}

/// Gauss elimination has no bound on the growth of its entries; it gives wrong results for these systems.
const WRONG_WITH_GAUSS: [&str; 0] = [];

#[test]
fn corpus_gauss() {
    let faults = corpus_faults(BackendChoice::Gauss);
    let mut names: Vec<_> = faults.iter().map(|(name, _)| name.as_str()).collect();
    names.dedup();
    assert_eq!(names, WRONG_WITH_GAUSS, "{faults:#?}");
}
