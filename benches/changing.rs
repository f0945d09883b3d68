//! One equation changed in a set of 1e6 equations in 1e5 blocks, against the full run: `cargo bench --bench changing` (`-- --test` for a
//! small set). Both in one process, in alternation; wanted: at most 1/1000.

mod timing;

use std::hint::black_box;

use qless::change::EquationId;
use qless::{ChangingSystem, Options, SystemBuilder, analyse};

use timing::{median, seconds};

const ROUNDS: usize = 5;
const CHANGES: usize = 101;
/// Equations of a block: rings of equal DOFs, closed twice.
const BLOCK: usize = 10;

fn main() {
    let short = std::env::args().any(|argument| argument == "--test");
    let blocks = if short { 1_000 } else { 100_000 };
    let (mut set, ids) = fresh(blocks);
    let (mut full, mut whole, mut change) = (Vec::new(), Vec::new(), Vec::new());
    for round in 0..ROUNDS {
        full.push(seconds(|| drop(black_box(fresh(blocks)))));
        whole.push(seconds(|| _ = black_box(as_one(blocks))));
        // The first call pays for the release of the large sets, so many changes run in sequence.
        change.extend((0..CHANGES).map(|c| {
            let k = (round * 7919 + c * 104_729 + 13) % ids.len();
            seconds(|| {
                set.set_rhs(ids[k], 1e-3 * (round + c) as f64).expect("there");
                assert_eq!(set.update().expect("analysed"), 1);
            })
        }));
    }
    let (full, whole, change) = (median(full), median(whole), median(change));
    println!("{} equations in {blocks} blocks", ids.len());
    println!("full run, block by block: {:.0} ms; as one system: {:.0} ms", 1e3 * full, 1e3 * whole);
    println!("one equation changed: {:.1} us = 1/{:.0} and 1/{:.0}", 1e6 * change, full / change, whole / change);
}

fn rows(blocks: usize) -> impl Iterator<Item = [(usize, f64); 3]> {
    (0..blocks * BLOCK).map(|i| {
        let (block, k) = (i / BLOCK, i % BLOCK);
        let dof = |k: usize| block * BLOCK + k % BLOCK;
        [(dof(k), 1.0), (dof(k + 1), -0.5), (dof(k + 3), -0.5)]
    })
}

fn fresh(blocks: usize) -> (ChangingSystem, Vec<EquationId>) {
    let mut set = ChangingSystem::new(blocks * BLOCK, Options::default()).expect("few DOFs");
    let ids = rows(blocks).map(|row| set.add(row, 0.0).expect("valid")).collect();
    set.update().expect("analysed");
    (set, ids)
}

/// The same as one system, with its reduction.
fn as_one(blocks: usize) -> usize {
    let mut builder = SystemBuilder::new(blocks * BLOCK);
    rows(blocks).for_each(|row| _ = builder.equation(row, 0.0));
    let system = builder.build().expect("a system");
    let analysis = analyse(&system, &Options::default()).expect("analysed");
    analysis.reduction().expect("within the gate").slaves().len()
}
