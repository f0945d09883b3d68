//! Stack depth does not grow with the model: every call runs in a thread with a stack of 256 KiB.

use qless::{Kind, Options, analyse};
use qless_scenes::{Scene, families};

const STACK: usize = 256 * 1024;

fn in_a_small_stack(scene: Scene, rank: usize, certificate: usize) {
    let work = move || {
        let analysis = analyse(&scene.system, &Options::default()).expect("valid");
        assert_eq!(analysis.rank(), rank);
        let terms: usize =
            analysis.dependent().iter().map(|d| analysis.because(d.row).expect("one of its rows").len()).sum();
        assert_eq!(terms, certificate);
        assert!(analysis.kinds().iter().all(|&kind| kind != Kind::Conflicting));
        let reduction = analysis.reduction().expect("within the gate");
        let (growth, residual) = (reduction.growth(), analysis.residual(&reduction).expect("its own DOFs"));
        assert!(residual <= 1e-13 && growth <= 1.0, "{residual} {growth}");
    };
    std::thread::Builder::new().stack_size(STACK).spawn(work).expect("a thread").join().expect("no overflow");
}

#[test]
fn a_chain_of_two_term_equations() {
    in_a_small_stack(families::path(200_001).expect("in range"), 200_000, 0);
}

#[test]
fn a_closed_chain() {
    in_a_small_stack(families::cycle(200_000, 0.0).expect("in range"), 199_999, 199_999);
}

#[test]
fn a_spider_with_a_hundred_thousand_legs() {
    in_a_small_stack(families::spider(100_000).expect("in range"), 100_000, 0);
}
