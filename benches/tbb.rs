//! SuiteSparseQR's task tree on two threads against the sequence, one BLAS thread each: `cargo bench --bench tbb --features tbb`.
//!
//! Both run in turns in one process; ratios are of medians. Hosts of virtual machines sometimes take cores away. A round counts only
//! if two cores did at least 1.7 times the work of one just before and just after it. The output states the number of such rounds.
//! `--test` takes small sizes. The process keeps its memory from one round to the next; `-- --fresh` leaves glibc its rule.

mod timing;

use std::hint::black_box;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use qless::Csr;
use qless::backend::Backend;
use qless::backend::spqr::{Spqr, Statistics};
use qless_scenes::families::{Windows, gradient};
use qless_scenes::fssi::{self, Level};
use qless_scenes::{Scene, SceneError, memory};

use timing::{median, seconds};

const TOLERANCE: f64 = 1e-10;
/// Work that two cores must do for a round to count, relative to one core.
const CORES: f64 = 1.7;
/// Pause before a measurement of the cores.
const REST: Duration = Duration::from_millis(60);
/// Pause between two measurements of the cores.
const PAUSE: Duration = Duration::from_millis(300);
/// Time limit for one system.
const LIMIT: Duration = Duration::from_secs(40);

struct System {
    name: &'static str,
    /// Least ratios of the factorization alone and of the whole call.
    wanted: [f64; 2],
    scene: Result<Scene, SceneError>,
}

/// The families, the smaller of two sizes for a test.
fn systems(test: bool) -> Vec<System> {
    let of = |large: usize, small: usize| if test { small } else { large };
    let flat =
        Windows { extent: [of(400, 60), of(400, 60), 1], d: 1, window: 4, stride: 2, rows: 2, combos: of(15_000, 300) };
    let side = of(40, 12);
    let solid = Windows { extent: [side; 3], d: 1, window: 4, stride: 3, rows: 6, combos: of(1_500, 40) };
    let plane = of(128, 30);
    let cube = of(16, 6);
    let fall_back = [0.97, 0.97];
    let system = |name, wanted, scene| System { name, wanted, scene };
    vec![
        system("2-D constraints", [1.7, 1.4], flat.scene(1)),
        system("2-D three DOFs", [1.7, 1.4], gradient([plane, plane, 1], 3, 1)),
        system("3-D three DOFs", [1.35, 1.25], gradient([cube; 3], 3, 1)),
        system("3-D constraints", fall_back, solid.scene(1)),
        system(
            "2-D with singletons",
            fall_back,
            flat.scene(1).and_then(|scene| scene.with_singletons(of(30_000, 500), 3, 2)),
        ),
        system("2-D one DOF", fall_back, gradient([of(300, 40), of(300, 40), 1], 1, 1)),
        system("tie 110 %", fall_back, fssi::tie(&Level::P110.mesh(), 1)),
        system("mortar 50 %", fall_back, fssi::mortar(&Level::P50.mesh(), 1)),
    ]
}

fn factor(spqr: Spqr, columns: &Csr) -> Statistics {
    let (factor, statistics) = spqr.factor_measured(columns, &[], TOLERANCE).expect("a factorization");
    black_box(factor.rank);
    statistics
}

/// A fixed amount of arithmetic.
fn spin() {
    let sum = (0..20_000_000_u64).fold(1_u64, |sum, k| sum.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(k));
    black_box(sum);
}

/// The work of two threads relative to that of one.
fn cores() -> f64 {
    // Idle threads of oneTBB and OpenBLAS spin for some time before they sleep.
    std::thread::sleep(REST);
    let one = seconds(spin);
    let two = seconds(|| {
        std::thread::scope(|scope| {
            scope.spawn(spin);
            scope.spawn(spin);
        });
    });
    2.0 * one / two
}

/// Prints a row; waits at most `limit` for two cores.
fn compare(name: &str, wanted: [f64; 2], columns: &Csr, limit: Duration) {
    let first = factor(Spqr::default(), columns);
    let wanted_rounds = if limit.is_zero() { 1 } else { (3.0 / first.total).clamp(5.0, 25.0) as usize };
    let (mut alone, mut tree, mut rounds, mut good) = (Vec::new(), Vec::new(), 0, 0);
    let start = Instant::now();
    while alone.len() < wanted_rounds {
        let late = start.elapsed() > limit;
        if !late && cores() < CORES {
            std::thread::sleep(PAUSE);
            continue;
        }
        // The order alternates, because the memory pages of a call depend on the call before.
        let (mut first, mut second) = (Spqr::default(), Spqr::on(2));
        let swapped = rounds % 2 == 1;
        if swapped {
            std::mem::swap(&mut first, &mut second);
        }
        let (first, second) = (factor(first, columns), factor(second, columns));
        let pair = if swapped { (second, first) } else { (first, second) };
        rounds += 1;
        // If no round counts, the last one is shown.
        let is_good = !late && cores() >= CORES;
        if is_good || (late && alone.is_empty()) {
            good += usize::from(is_good);
            alone.push(pair.0);
            tree.push(pair.1);
        }
        if late {
            break;
        }
    }
    let of = |all: &[Statistics], value: fn(&Statistics) -> f64| median(all.iter().map(value).collect());
    let ratio = |value: fn(&Statistics) -> f64| of(&alone, value) / of(&tree, value);
    let (inner, whole) = (ratio(|s| s.factorization), ratio(|s| s.total));
    let total = of(&tree, |s| s.total);
    let rest = total - of(&tree, |s| s.factorization);
    let holds = inner >= wanted[0] && whole >= wanted[1];
    println!(
        "{name:<20}{:>8}{:>8}{:>6}{:>9.1}{:>9.1}{inner:>9.2}{whole:>8.2}{:>8.0} %{:>8.0}{:>8.0}{:>5}/{rounds:<3}  {}",
        columns.cols(),
        columns.rows(),
        tree[0].tasks,
        1e3 * of(&alone, |s| s.total),
        1e3 * total,
        100.0 * rest / total,
        first.memory as f64 / 1e6,
        tree[0].memory as f64 / 1e6,
        good,
        if holds { "" } else { "below what is wanted" }
    );
}

fn main() -> ExitCode {
    memory::kept(run)
}

fn run() {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| word != "--bench").collect();
    let test = words.iter().any(|word| word == "--test");
    assert!(Spqr::has_trees(), "SuiteSparseQR runs in sequence here: {}", Spqr::default().version());
    println!("{}", Spqr::default().version());
    println!(
        "{:<20}{:>8}{:>8}{:>6}{:>9}{:>9}{:>9}{:>8}{:>10}{:>8}{:>8}{:>9}",
        "system",
        "m",
        "n",
        "tasks",
        "alone ms",
        "tree ms",
        "factor x",
        "whole x",
        "the rest",
        "MB",
        "tree MB",
        "rounds"
    );
    for System { name, wanted, scene } in systems(test) {
        if words.iter().filter(|word| !word.starts_with("--")).all(|word| name.contains(word.as_str())) {
            let columns = scene.expect("a scene").system.matrix().transpose().expect("it fits");
            compare(name, wanted, &columns, if test { Duration::ZERO } else { LIMIT });
        }
    }
}
