//! Models of known rank, up to the sizes of real ones.

use qless::exact::{self, ExactRank, Reading};
use qless::{ConstraintSystem, SystemBuilder};
use qless_scenes::fssi::{self, Level};
use qless_scenes::{Scene, families, paper};

fn typed(system: &ConstraintSystem) -> ExactRank {
    exact::rank(system, Reading::Typed).expect("within reach")
}

#[test]
fn families_of_exact_numbers_have_their_known_rank() {
    let scenes: Vec<Scene> = [
        families::path(50),
        families::cycle(50, 0.0),
        families::cycle(50, 1.0),
        families::grid_2d(20, 30),
        families::random_graph(100, 300, 4),
        families::planted(80, 120, 15, 3, false),
        families::planted(80, 120, 15, 3, true),
        families::rve(4),
        families::spider(40),
        families::arrow(40),
        families::ladder(40),
        paper::figure_6(1.0),
    ]
    .into_iter()
    .map(|scene| scene.expect("a scene"))
    .collect();
    for (k, scene) in scenes.iter().enumerate() {
        let (exact, truth) = (typed(&scene.system), &scene.truth);
        assert_eq!(Some(exact.rank), truth.rank_free, "scene {k}");
        assert_eq!(exact.is_solvable(), !truth.conflicting, "scene {k}");
    }
}

#[test]
fn the_largest_model_of_table_1_has_300_redundant_equations() {
    let scene = fssi::tie(&Level::P110.mesh(), 1).expect("a scene");
    let exact = typed(&scene.system);
    assert_eq!((exact.rank, exact.is_solvable()), (31_832 - 300, true));
}

/// Rounded integrals are not dependent to the last digit: the rank is full, though 60 equations are redundant in real arithmetic.
#[test]
fn rounded_mortar_integrals_have_full_rank() {
    let scene = fssi::mortar(&Level::P50.mesh(), 1).expect("a scene");
    assert_eq!(typed(&scene.system).rank, 7580);
}

#[test]
fn paths_and_rings_of_a_million_equations() {
    let path = families::path(1_000_001).expect("a scene");
    assert_eq!(typed(&path.system).rank, 1_000_000);
    let ring = families::cycle(1_000_000, 1.0).expect("a scene");
    let exact = typed(&ring.system);
    assert_eq!((exact.rank, exact.augmented_rank), (999_999, 1_000_000));
}

/// Two averages over many DOFs, and three-term equations between these DOFs: elimination changes long rows by short ones.
#[test]
fn long_rows_are_changed_in_place() {
    let n = 20_000;
    let mut builder = SystemBuilder::new(2 * n + 1);
    for i in 0..n {
        builder.equation([(2 * i, 1.0), (2 * i + 1, -1.0), (2 * n, -0.1)], 0.5);
    }
    builder.equation((0..n).map(|i| (2 * i, 0.1)), 0.0);
    builder.equation((0..n).map(|i| (2 * i + 1, 0.3)), 0.0);
    // 3 * first average - second: 0.3 * sum (u - v) = 0.3 * (0.1 n H + 0.5 n), with H = -5.
    builder.equation([(2 * n, 1.0)], -5.0);
    let exact = typed(&builder.build().expect("valid"));
    assert_eq!((exact.rank, exact.augmented_rank), (n + 2, n + 2));
}

/// `u_(i-1) + 4 u_i + u_(i+1) = 0` with `u_0` and `u_1` prescribed.
fn recurrence(rows: usize, start: [f64; 2]) -> SystemBuilder {
    let mut builder = SystemBuilder::new(rows + 2);
    for i in 1..=rows {
        builder.equation([(i - 1, 1.0), (i, 4.0), (i + 1, 1.0)], 0.0);
    }
    builder.prescribe(0, start[0]);
    builder.prescribe(1, start[1]);
    builder
}

/// Each equation fixes the next DOF, so the rank is full, although the values grow.
#[test]
fn a_recurrence_that_grows_has_full_rank() {
    let exact = typed(&recurrence(40, [0.0, 1.0]).build().expect("valid"));
    assert_eq!((exact.rank, exact.augmented_rank), (40, 40));
}

/// The values are whole numbers, so an error in the last digit is found.
#[test]
fn values_that_equations_fix_are_exact() {
    let (mut u, mut next) = (0_i64, 1_i64);
    for _ in 0..20 {
        (u, next) = (next, -4 * next - u);
    }
    assert!(next.unsigned_abs() > 100_000_000_000 && next.unsigned_abs() < 1 << 53);
    for (off, solvable) in [(0, true), (1, false), (-1, false)] {
        let mut builder = recurrence(20, [0.0, 0.1]);
        // A tenth of the last value as a decimal.
        let tenth: f64 = format!("{}e-1", next + off).parse().expect("a number");
        builder.equation([(21, 1.0)], tenth);
        let exact = typed(&builder.build().expect("valid"));
        assert_eq!((exact.rank, exact.is_solvable()), (20, solvable), "{off}");
    }
}
