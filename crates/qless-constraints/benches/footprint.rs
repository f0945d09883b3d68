//! Memory of a set and of its construction: `cargo bench -p qless-constraints --bench footprint` (`-- --test` for a small size).
//!
//! A separate program, since the counting allocator would change the times of other benchmarks. "Arrays" is the memory after the set is built
//! and its evaluation is allocated. Limit: at no time more than 1.5 times that.

mod model;

use peak_alloc::PeakAlloc;

use model::{finite, linear, rod, tie};
use qless_constraints::ConstraintSet;

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

fn main() {
    let short = std::env::args().any(|argument| argument == "--test");
    let constraints = if short { 10_000 } else { 1_000_000 };
    // Threads have their own memory.
    let _ = measure(1000, rod);
    println!(
        "{:>20} {:>10} {:>10} {:>10} {:>10} {:>6}",
        "bytes a constraint", "c, G, H", "set", "arrays", "peak", "ratio"
    );
    let kinds =
        [("rods", rod as model::Add), ("linear equations", linear), ("ties", tie), ("finite rotations", finite)];
    for (name, add) in kinds {
        let count = if name == "finite rotations" { constraints / 10 } else { constraints };
        let [evaluation, set, peak] = measure(count, add).map(|bytes| bytes as f64 / count as f64);
        let arrays = evaluation + set;
        println!("{name:>20} {evaluation:>10.0} {set:>10.0} {arrays:>10.0} {peak:>10.0} {:>6.2}", peak / arrays);
        assert!(short || peak <= 1.5 * arrays, "{name}: the peak is {} times the arrays", peak / arrays);
    }
}

/// Bytes of the evaluation, of the set, and the peak.
fn measure(constraints: usize, add: model::Add) -> [usize; 3] {
    let nodes = constraints / 2 + 200;
    MEMORY.reset_peak_usage();
    let before = MEMORY.current_usage();
    let mut builder = ConstraintSet::builder(6 * nodes);
    (0..constraints).for_each(|i| add(&mut builder, i / 2, nodes));
    let set = builder.build().expect("few DOFs");
    let of_set = MEMORY.current_usage() - before;
    let mut evaluation = set.allocate();
    let (u, w) = (vec![0.0; set.dofs()], vec![0.0; set.equations()]);
    set.assemble(&u, &w, &mut evaluation).expect("of this set");
    drop((u, w));
    let arrays = MEMORY.current_usage() - before;
    let peak = MEMORY.peak_usage() - before;
    drop(evaluation);
    [arrays - of_set, of_set, peak]
}
