//! Small systems of every shape, rank known by construction.

use qless::{Analysis, ConstraintSystem, Kind, SystemBuilder};
use qless_scenes::families::{self, Windows};
use qless_scenes::fssi::{self, Mesh};
use qless_scenes::{Rng, Scene, SceneError, Truth, paper};

/// A scene and its name.
pub type Named = (&'static str, Scene);

/// Systems of up to 700 rows whose singular values are either large or rounding.
pub fn definite() -> Vec<Named> {
    [sparse(), graphs(), models()].concat()
}

fn named<const N: usize>(all: [(&'static str, Result<Scene, SceneError>); N]) -> Vec<Named> {
    all.map(|(name, scene)| (name, scene.unwrap_or_else(|e| panic!("{name}: {e}")))).into()
}

fn sparse() -> Vec<Named> {
    let flat = Windows { extent: [14, 14, 1], d: 1, window: 4, stride: 2, rows: 2, combos: 20 };
    let solid = Windows { extent: [6, 6, 6], d: 1, window: 3, stride: 3, rows: 6, combos: 8 };
    let planted = |seed, conflict| families::planted(120, 200, 60, seed, conflict);
    named([
        ("planted", planted(1, false)),
        ("planted, conflicting", planted(2, true)),
        ("planted, square", families::planted(90, 90, 30, 2, false)),
        ("planted and singletons", planted(1, false).and_then(|scene| scene.with_singletons(60, 3, 1))),
        ("planted, rows scaled", planted(3, true).and_then(|scene| Ok(scene.scale_rows(40, 1)?.0))),
        ("windows in the plane", flat.scene(1)),
        ("windows in space", solid.scene(2)),
        ("dense", Ok(dense(&random(40, 80), 40))),
    ])
}

fn graphs() -> Vec<Named> {
    named([
        ("path", families::path(150)),
        ("cycle", families::cycle(150, 0.0)),
        ("grid", families::grid_2d(12, 10)),
        ("forest", families::random_graph(150, 80, 1)),
        ("random graph", families::random_graph(100, 220, 2)),
        ("star", families::spider(120)),
        ("arrow", families::arrow(120)),
        ("gradient of a plane", families::gradient([7, 6, 1], 3, 1)),
        ("gradient in space", families::gradient([4, 3, 3], 2, 1)),
    ])
}

fn models() -> Vec<Named> {
    let mesh = Mesh::with_equations(320);
    named([
        ("rigid spider", families::rbe2(50, 1, 1)),
        ("rigid spiders on the same legs", families::rbe2(40, 2, 1)),
        ("periodic cell", families::rve(3)),
        ("ties", fssi::tie(&mesh, 1)),
        ("mortar", fssi::mortar(&mesh, 1)),
        ("mortar, nested", fssi::mortar(&mesh.nested(), 1)),
        ("figure 2", paper::figure_2(paper::FloorInput::Star)),
        ("figure 6", paper::figure_6(0.5)),
    ])
}

/// Systems for which elimination or pivoting alone gives a large T, or with columns of very different size.
pub fn steep() -> Vec<Named> {
    let graded = |base: f64, cols: f64| {
        let scaled = |(i, row): (usize, Vec<f64>)| {
            let part = |(j, v)| v * base.powi(-(i as i32)) * cols.powi(-(j as i32));
            row.into_iter().enumerate().map(part).collect()
        };
        dense(&random(30, 60).into_iter().enumerate().map(scaled).collect::<Vec<_>>(), 30)
    };
    let combined = || {
        let rows = random(30, 70);
        let sums = (0..10).map(|k| rows[k].iter().zip(&rows[29 - k]).map(|(a, b)| a - 2.0 * b).collect());
        dense(&rows.iter().cloned().chain(sums).collect::<Vec<_>>(), 30)
    };
    named([
        ("dense with combinations", Ok(combined())),
        ("dense, rows graded", Ok(graded(4.0, 1.0))),
        ("dense, columns graded", Ok(graded(1.0, 1.25))),
        ("dense, both graded", Ok(graded(2.0, 1.25))),
        ("Kahan, angle 1.28", Ok(kahan(60, 0.285, 0.9585))),
        ("Kahan, rows of one size", Ok(kahan(60, 0.285, 1.0))),
        ("Wilkinson", Ok(kahan(40, 1.0, 1.0))),
        ("ladder", families::ladder(40)),
    ])
}

fn random(m: usize, n: usize) -> Vec<Vec<f64>> {
    let mut rng = Rng::new(m as u64);
    (0..m).map(|_| (0..n).map(|_| rng.real()).collect()).collect()
}

/// `s^i (u_i - c sum_{j > i} u_j) = 1`, n - 1 equations on n DOFs: upper triangular, so of full rank.
fn kahan(n: usize, c: f64, s: f64) -> Scene {
    let entry = |i: usize, j: usize| s.powi(i as i32) * if i == j { 1.0 } else { -c * f64::from(u8::from(j > i)) };
    let rows: Vec<Vec<f64>> = (0..n - 1).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect();
    dense(&rows, n - 1)
}

fn dense(rows: &[Vec<f64>], rank: usize) -> Scene {
    let mut builder = SystemBuilder::new(rows[0].len());
    for (i, row) in rows.iter().enumerate() {
        let terms = row.iter().copied().enumerate().filter(|&(_, v)| v != 0.0);
        builder.equation(terms, if i < rank { 1.0 } else { -1.0 });
    }
    let system: ConstraintSystem = builder.build().expect("valid");
    Scene { system, truth: Truth::rank(rows.len(), rank), nodes: Vec::new(), dofs: Vec::new() }
}

/// Kept equations with all boundary conditions.
pub fn kept(system: &ConstraintSystem, analysis: &Analysis) -> ConstraintSystem {
    let mut builder = SystemBuilder::new(system.dofs());
    for i in (0..system.equations()).filter(|&i| analysis.kinds()[i] == Kind::Independent) {
        builder.equation(system.matrix().row(i), system.rhs()[i]);
    }
    system.prescribed().iter().for_each(|&(j, value)| builder.prescribe(j, value));
    builder.build().expect("as valid as the whole")
}
