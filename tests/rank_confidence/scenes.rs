//! Every family of `qless-scenes` at sizes of up to 400 DOFs, in several shapes.

use qless::SystemBuilder;
use qless_scenes::families::{self, Degree, Mortar, Near, Side, Windows};
use qless_scenes::fssi::{self, Mesh};
use qless_scenes::{Scene, SceneError, Truth, paper};

use super::svd_reference::Case;

/// Family, sizes and seed; the scene.
pub type Named = (String, Scene);

pub fn all() -> Vec<Case> {
    let case = |(name, scene): Named| Case { near: scene.truth.ambiguous, ..Case::new(name, scene.system) };
    named().into_iter().map(case).collect()
}

/// The system itself, and in another order with rows scaled by powers of two.
pub fn named() -> Vec<Named> {
    let plain: Vec<Named> = [sparse(), graphs(), chains(), near(), models(), mortar(), steep()].concat();
    let changed = plain.iter().map(|(name, scene)| {
        let scaled = scene.scale_rows(30, 5).and_then(|(scaled, _)| scaled.shuffle(6));
        (format!("{name}, rows scaled (30, 5), shuffled (6)"), scaled.expect("as valid as before").0)
    });
    plain.iter().cloned().chain(changed).collect()
}

fn collect(all: Vec<(String, Result<Scene, SceneError>)>) -> Vec<Named> {
    all.into_iter().map(|(name, scene)| (name.clone(), scene.unwrap_or_else(|e| panic!("{name}: {e}")))).collect()
}

fn sparse() -> Vec<Named> {
    let flat = Windows { extent: [14, 14, 1], d: 1, window: 4, stride: 2, rows: 2, combos: 20 };
    let solid = Windows { extent: [6, 6, 6], d: 1, window: 3, stride: 3, rows: 6, combos: 8 };
    let mut all = vec![("windows in the plane".into(), flat.scene(1)), ("windows in space".into(), solid.scene(2))];
    for (rows, dofs, combos, seed, conflict) in
        [(20, 30, 10, 1, false), (80, 120, 40, 2, true), (60, 60, 20, 3, false), (150, 300, 50, 4, false)]
    {
        let scene = families::planted(rows, dofs, combos, seed, conflict);
        all.push((format!("planted({rows}, {dofs}, {combos}, {seed}, {conflict})"), scene));
    }
    let singletons = families::planted(60, 90, 20, 1, false).and_then(|scene| scene.with_singletons(40, 3, 1));
    all.push(("planted(60, 90, 20, 1) with singletons(40, 3, 1)".into(), singletons));
    all.extend([40, 200].map(|n| (format!("spotted_band({n}, 1)"), families::spotted_band(n, 1))));
    collect(all)
}

fn graphs() -> Vec<Named> {
    collect(vec![
        ("path(150)".into(), families::path(150)),
        ("cycle(150, 0)".into(), families::cycle(150, 0.0)),
        ("cycle(50, 1)".into(), families::cycle(50, 1.0)),
        ("grid_2d(12, 10)".into(), families::grid_2d(12, 10)),
        ("random_graph(150, 80, 1)".into(), families::random_graph(150, 80, 1)),
        ("random_graph(100, 220, 2)".into(), families::random_graph(100, 220, 2)),
        ("spider(120)".into(), families::spider(120)),
        ("arrow(120)".into(), families::arrow(120)),
        ("gradient([7, 6, 1], 3, 1)".into(), families::gradient([7, 6, 1], 3, 1)),
        ("gradient([4, 3, 3], 2, 1)".into(), families::gradient([4, 3, 3], 2, 1)),
        ("gradient([12, 12, 1], 1, 1)".into(), families::gradient([12, 12, 1], 1, 1)),
    ])
}

fn chains() -> Vec<Named> {
    let mut all: Vec<_> = [20, 40, 80].map(|n| (format!("ladder({n})"), families::ladder(n))).into();
    all.extend([10, 100].map(|n| (format!("rotations({n})"), families::rotations(n))));
    all.extend([3, 8, 15, 60].map(|n| (format!("recurrence({n})"), families::recurrence(n))));
    for (n, factor) in [(5, 2.0), (12, 2.0), (40, 2.0), (100, 1.1), (20, 0.5), (10, 10.0), (9, -3.0)] {
        all.push((format!("geometric_chain({n}, {factor})"), families::geometric_chain(n, factor)));
    }
    collect(all)
}

fn near() -> Vec<Named> {
    let mut all = Vec::new();
    for digits in [1, 2, 3, 5, 7, 9, 11, 13] {
        for column in [Near::Own, Near::Shared] {
            let scene = families::near(4, 10_f64.powi(-digits), column);
            all.push((format!("near(4, 1e-{digits}, {column:?})"), scene));
        }
    }
    all.extend((3..=8).map(|d| (format!("typed_twice(30, {d}, 1)"), families::typed_twice(30, d, 1))));
    all.extend((3..=8).map(|d| (format!("typed_cosines(4, {d}, 1)"), families::typed_cosines(4, d, 1))));
    collect(all)
}

fn models() -> Vec<Named> {
    let mesh = Mesh { columns: 7, layers: 2, far_columns: 5, far_layers: 2, rings: 2, sectors: 4, wall: 3 };
    let (mesh, thick) =
        if mesh.check().is_ok() { (mesh, Mesh { layers: 3, ..mesh }) } else { panic!("{:?}", mesh.check()) };
    collect(vec![
        ("rbe2(50, 1, 1)".into(), families::rbe2(50, 1, 1)),
        ("rbe2(40, 2, 1)".into(), families::rbe2(40, 2, 1)),
        ("rve(2)".into(), families::rve(2)),
        ("rve(3)".into(), families::rve(3)),
        ("fssi tie".into(), fssi::tie(&mesh, 1)),
        ("fssi mortar".into(), fssi::mortar(&mesh, 1)),
        ("fssi mortar, thick".into(), fssi::mortar(&thick, 1)),
        ("fssi mortar, nested".into(), fssi::mortar(&mesh.nested(), 1)),
        ("fssi mortar, deep".into(), fssi::mortar(&mesh.deep(), 1)),
        ("paper, equations 12 to 14, rhs 1".into(), paper::equations_12_to_14(1.0)),
        ("paper, equations 12 to 14, rhs 0".into(), paper::equations_12_to_14(0.0)),
        ("paper, figure 1".into(), paper::figure_1(1.0)),
        ("paper, figure 2, star".into(), paper::figure_2(paper::FloorInput::Star)),
        ("paper, figure 2, chain".into(), paper::figure_2(paper::FloorInput::Chain)),
        ("paper, figure 5".into(), paper::figure_5(0.5)),
        ("paper, figure 6".into(), paper::figure_6(0.5)),
        ("paper, figure 8".into(), paper::figure_8()),
    ])
}

fn mortar() -> Vec<Named> {
    let side = |elements, degree, seed| Side::jittered(elements, degree, seed);
    let line = |sums| -> Result<Scene, SceneError> {
        let line = Mortar::line(side(40, Degree::Linear, 1)?, side(25, Degree::Quadratic, 2)?);
        Mortar { sums, components: 2, skew: true, ..line }.scene(1)
    };
    let face = || -> Result<Scene, SceneError> {
        let sides = |elements, seed| {
            Ok::<_, SceneError>([side(elements, Degree::Linear, seed)?, side(elements, Degree::Linear, seed + 1)?])
        };
        Mortar::face(sides(6, 1)?, sides(5, 3)?).scene(1)
    };
    let mut all = vec![
        ("mortar line".into(), line(0)),
        ("mortar line, 10 sums".into(), line(10)),
        ("mortar face".into(), face()),
    ];
    all.extend([10, 60, 200].map(|n| (format!("mortar_short({n})"), families::mortar_short(n))));
    collect(all)
}

/// Triangular systems without small pivots: n - 1 equations on n DOFs have a clear rank, n equations are near dependence for large n.
fn steep() -> Vec<Named> {
    let name =
        |c: f64, n: usize, wide: bool| format!("triangle(c {c}, n {n}, {})", if wide { "wide" } else { "square" });
    let all = [(0.285, 60), (0.5, 40), (1.0, 40), (1.0, 12)];
    let each = all.into_iter().flat_map(|(c, n)| [true, false].map(|wide| (name(c, n, wide), triangle(n, c, wide))));
    each.collect()
}

/// `u_i - c sum_(j > i) u_j = 1`: Kahan's matrix with rows of one size, Wilkinson's for c = 1.
pub fn triangle(n: usize, c: f64, wide: bool) -> Scene {
    let mut builder = SystemBuilder::new(n);
    let rows = n - usize::from(wide);
    for i in 0..rows {
        builder.equation((i..n).map(|j| (j, if j == i { 1.0 } else { -c })), 1.0);
    }
    let system = builder.build().expect("valid");
    Scene { system, truth: Truth { ambiguous: !wide, ..Truth::independent(rows) }, nodes: Vec::new(), dofs: Vec::new() }
}
