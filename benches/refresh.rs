//! A new right-hand side for the same C, against the full run: `cargo bench --bench refresh` (`-- --test` for small systems).
//!
//! Both in one process, in alternation; the ratio is that of the medians. "Preparing" factors the slaves' matrices once.

mod timing;

use std::hint::black_box;
use std::sync::Arc;

use qless::change::Refresher;
use qless::{Analysis, ConstraintSystem, Options, Reduction, analyse};
use qless_scenes::families::{self, Windows};
use qless_scenes::fssi::{self, Mesh};

use timing::{median, seconds};

const ROUNDS: usize = 5;

fn main() {
    let short = std::env::args().any(|argument| argument == "--test");
    let size = |small: usize, large: usize| if short { small } else { large };
    println!(
        "{:>24} {:>9} {:>10} {:>10} {:>10} {:>7}",
        "system", "equations", "full run", "preparing", "refreshing", "ratio"
    );
    let nodes = size(2_000, 300_000);
    measure("graph", &families::random_graph(nodes, nodes, 1).expect("a scene").system);
    let side = size(20, 40);
    let windows = Windows { extent: [side, side, 1], d: 1, window: 4, stride: 2, rows: 2, combos: 20 };
    measure("windows in the plane", &windows.scene(1).expect("a scene").system);
    let mesh = Mesh::with_equations(size(1_000, 2_000));
    measure("mortar tie", &fssi::mortar(&mesh, 1).expect("a scene").system);
}

fn measure(name: &str, system: &ConstraintSystem) {
    let (analysis, mut reduction) = full(system);
    let [mut whole, mut preparing, mut refreshing] = [const { Vec::new() }; 3];
    for round in 0..ROUNDS {
        whole.push(seconds(|| drop(black_box(full(system)))));
        preparing.push(seconds(|| drop(black_box(Refresher::new(Arc::clone(&analysis)).expect("factored")))));
        let refresher = Refresher::new(Arc::clone(&analysis)).expect("factored");
        let rhs: Vec<f64> = system.rhs().iter().map(|b| b + round as f64).collect();
        let values: Vec<f64> = system.prescribed().iter().map(|&(_, v)| v).collect();
        refreshing.push(seconds(|| _ = black_box(refresher.refresh(&rhs, &values, &mut reduction).expect("valid"))));
    }
    let [whole, preparing, refreshing] = [whole, preparing, refreshing].map(median);
    print!("{name:>24} {:>9} {:>7.1} ms {:>7.1} ms ", system.equations(), 1e3 * whole, 1e3 * preparing);
    println!("{:>7.2} ms {:>7}", 1e3 * refreshing, format!("1/{:.0}", whole / refreshing));
}

fn full(system: &ConstraintSystem) -> (Arc<Analysis>, Reduction) {
    let analysis = Arc::new(analyse(system, &Options::default()).expect("analysed"));
    let reduction = analysis.reduction().expect("within the gate");
    (analysis, reduction)
}
