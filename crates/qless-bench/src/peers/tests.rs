//! Checks the ranks of known systems, `R^T R = P^T C^T C P`, and `C u = b` for the result of the elimination.

use qless::backend::{Backend, BackendError, Factor};
use qless::{ConstraintSystem, Csr, Options, SystemBuilder, analyse};
use qless_scenes::fssi::{Level, tie};
use qless_scenes::{Scene, families, paper};

use super::eliminate::eliminate;
use super::{Eigen, Lapack, Rule, Solver, free_columns};

fn peers() -> [Box<dyn Backend>; 4] {
    let [own, call] = [Rule::Own, Rule::Call];
    [Box::new(Eigen(own)), Box::new(Eigen(call)), Box::new(Lapack(own)), Box::new(Lapack(call))]
}

fn scenes() -> Vec<(&'static str, Scene)> {
    vec![
        ("path", families::path(40).expect("a scene")),
        ("ring", families::cycle(40, 0.0).expect("a scene")),
        ("grid", families::grid_2d(7, 7).expect("a scene")),
        ("arrow", families::arrow(12).expect("a scene")),
        ("planted", families::planted(60, 90, 15, 1, false).expect("a scene")),
        ("tall", families::planted(20, 25, 30, 2, false).expect("a scene")),
        ("cell", families::rve(2).expect("a scene")),
        ("near", families::near(3, 1e-3, families::Near::Shared).expect("a scene")),
        ("equations 12 to 14", paper::equations_12_to_14(1.0).expect("a scene")),
    ]
}

fn dense(row: impl Iterator<Item = (usize, f64)>, len: usize) -> Vec<f64> {
    let mut x = vec![0.0; len];
    row.for_each(|(i, v)| x[i] = v);
    x
}

/// `max |R^T R - P^T A^T A P| / max |A^T A|`.
fn gram_error(factor: &Factor, columns: &Csr) -> f64 {
    let r = factor.r.transpose().expect("few enough columns");
    let n = columns.rows();
    let of_r: Vec<_> = (0..n).map(|j| dense(r.row(j), factor.rank)).collect();
    let of_a: Vec<_> = factor.order.iter().map(|&j| dense(columns.row(j), columns.cols())).collect();
    let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
    let (mut off, mut size) = (0.0_f64, 0.0_f64);
    for (i, j) in (0..n).flat_map(|i| (i..n).map(move |j| (i, j))) {
        let right = dot(&of_a[i], &of_a[j]);
        off = off.max((dot(&of_r[i], &of_r[j]) - right).abs());
        size = size.max(right.abs());
    }
    off / size
}

#[test]
fn ranks_are_true_and_r_has_the_gram_matrix_of_c() {
    for (name, scene) in scenes() {
        let columns = free_columns(&scene.system);
        for peer in peers() {
            let factor = peer.factor(&columns, scene.system.rhs(), 1e-5).expect(name);
            assert_eq!(Some(factor.rank), scene.truth.rank_free, "{name}, {}", peer.name());
            let mut order = factor.order.clone();
            order.sort_unstable();
            assert_eq!(order, (0..columns.rows()).collect::<Vec<_>>(), "{name}: a permutation");
            for i in 0..factor.rank {
                assert_eq!(factor.r.row(i).next().map(|(j, _)| j), Some(i), "{name}: R1 is triangular");
            }
            let error = gram_error(&factor, &columns);
            assert!(error < 1e-13, "{name}, {}: {error:e}", peer.name());
            let (turned, rest) = (norm(&factor.rhs), factor.rest[0]);
            let b = norm(scene.system.rhs());
            assert!((turned.hypot(rest) - b).abs() <= 1e-13 * b, "{name}: Q^T keeps the length of b");
            assert!(rest <= 1e-12 * b, "{name}: the equations agree, {rest:e} is left");
        }
    }
}

/// Without redundant equations nothing depends on a solver's tolerance. HiGHS is tested with the Python package, which installs it.
#[test]
fn solvers_find_the_rank_of_independent_equations() {
    let planted = |seed| families::planted(60, 90, 0, seed, false).expect("a scene");
    let scenes = [1, 2, 3].map(planted).into_iter().chain([with_prescribed(), families::path(40).expect("a scene")]);
    let scenes: Vec<Scene> = scenes.collect();
    let systems: Vec<&ConstraintSystem> = scenes.iter().map(|scene| &scene.system).collect();
    let found = Solver::Mumps.ranks(&systems).expect("`scripts/install` installs MUMPS before this crate is built");
    for (found, scene) in found.iter().zip(&scenes) {
        assert_eq!(found.as_ref().ok().map(|found| found.0), scene.truth.rank_free, "{found:?}");
    }
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|v| v * v).sum::<f64>().sqrt()
}

#[test]
fn the_elimination_meets_the_equations() {
    let mut all = scenes();
    all.push(("prescribed", with_prescribed()));
    for (name, Scene { system, truth, .. }) in all {
        let analysis = analyse(&system, &Options::default()).expect(name);
        for peer in peers() {
            let reduction = eliminate(&system, peer.as_ref(), 1e-5).expect(name);
            assert_eq!(Some(reduction.slaves().len()), truth.rank_free, "{name}");
            let residual = analysis.residual(&reduction).expect("its own DOFs");
            assert!(residual < 1e-13, "{name}, {}: {residual:e}", peer.name());
        }
    }
}

/// `u0 - 2 u1 + u3 = 1`, twice, and `u2 + u3 = 0` with u3 prescribed, and an equation without free DOFs.
fn with_prescribed() -> Scene {
    let mut builder = SystemBuilder::new(4);
    builder.equation([(0, 1.0), (1, -2.0), (3, 1.0)], 1.0);
    builder.equation([(3, 2.0)], 1.0);
    builder.equation([(2, 1.0), (3, 1.0)], 0.0);
    builder.equation([(0, 1.0), (1, -2.0), (3, 1.0)], 1.0);
    builder.prescribe(3, 0.5);
    let system = builder.build().expect("valid");
    Scene { system, truth: qless_scenes::Truth::rank(4, 2), nodes: Vec::new(), dofs: Vec::new() }
}

#[test]
fn eigen_agrees_on_the_papers_table() {
    let scene = tie(&Level::P50.mesh(), 1).expect("a scene");
    let reduction = eliminate(&scene.system, &Eigen(Rule::Call), 1e-5).expect("it fits");
    assert_eq!(reduction.slaves().len(), 7412);
    let analysis = analyse(&scene.system, &Options::default()).expect("valid");
    assert!(analysis.residual(&reduction).expect("its own DOFs") < 1e-14);
}

#[test]
fn an_absolute_tolerance_changes_its_mind_with_the_units_and_eigens_own_does_not() {
    let scene = families::path(10).expect("a scene");
    let mut small = free_columns(&scene.system);
    small.values_mut().iter_mut().for_each(|v| *v *= 1e-6);
    let rank = |rule| Eigen(rule).factor(&small, &[], 1e-5).expect("small").rank;
    assert_eq!((rank(Rule::Call), rank(Rule::Own)), (0, 9));
}

#[test]
fn what_does_not_fit_is_refused_in_words() {
    let wide = Csr::from_parts(1 << 20, vec![0; (1 << 20) + 1], Vec::new(), Vec::new()).expect("nothing but zeros");
    let error = Lapack(Rule::Own).factor(&wide, &[], 0.0).expect_err("8 TiB");
    assert!(matches!(error, BackendError::OutOfMemory { .. }), "{error}");
}
