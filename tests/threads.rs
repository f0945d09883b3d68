//! The answer is the same, bit for bit, for every number of threads.

use qless::{Options, Reduction, analyse};
use qless_scenes::families;

fn on_threads(threads: usize) -> (Vec<usize>, Reduction) {
    let scene = families::random_graph(400, 380, 5).expect("a scene");
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
    pool.install(|| {
        let analysis = analyse(&scene.system, &Options { presolve: false, ..Options::default() }).expect("valid");
        assert!(analysis.presolve.blocks > 1, "several blocks, or there is nothing to share out");
        let reduction = analysis.reduction(&scene.system);
        (analysis.dependent.iter().map(|d| d.row).collect(), reduction)
    })
}

#[test]
fn one_and_more_threads_agree_to_the_last_bit() {
    let (rows, reduction) = on_threads(1);
    for threads in [2, 3] {
        let (other_rows, other) = on_threads(threads);
        assert_eq!(rows, other_rows);
        assert_eq!((&reduction.slaves, &reduction.t, &reduction.g), (&other.slaves, &other.t, &other.g));
    }
}
