//! Assembly of c, G and H of a million mixed constraints: `cargo bench -p qless-constraints --bench assembly` (`-- --test` for a small size).
//!
//! Two memory tests take turns with it in one process; they write the same number of nonzeros into the same arrays with the same number of
//! threads. "Writing" stores values in order, without arithmetic or reads: the limit of the memory. "Indexed" stores each value at a position
//! from a list, as H requires. The ratio of the medians of c, G and H together to "writing" should be at most 2; "best" compares the shortest
//! times, which other programs disturb least.
//!
//! Why the ratio is above 1: writing is bound by memory. Of the mix's 81 MB one core writes 27 GB/s and two write 33 (a virtual machine on a
//! Zen 5 server), so that a second core hardly helps writing. A linear equation of 5 terms, for which writing stores 48 bytes, stores 8 bytes
//! of c and reads 16 bytes of DOFs and positions, and 5 values of u from a cache: a ratio of 1. A rod stores 56 bytes of c and G and 36 of H,
//! and reads 24 of DOFs, 32 of parameters, 16 of curvatures and 24 of positions in H. A rigid link with finite rotations needs about 150
//! flops for its three rows and 170 for its curvature, for 290 bytes; eight links are evaluated at once.

mod model;

use std::hint::black_box;
use std::time::Instant;

use qless_constraints::ConstraintSet;
use rayon::prelude::*;

use model::{finite, linear, mixed, of_one_kind, rod};

/// Values per task of "writing".
const CHUNK: usize = 1 << 14;
const ROUNDS: usize = 31;
const REPEATS: usize = 4;

fn main() {
    let short = std::env::args().any(|argument| argument == "--test");
    let constraints = if short { 10_000 } else { 1_000_000 };
    println!(
        "{:>20} {:>9} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10} {:>6} {:>7} {:>6}",
        "mix", "equations", "nnz(G+H)", "c and G", "H", "c, G, H", "writing", "indexed", "ratio", "indexed", "best"
    );
    let mixed = measure("mixed", &mixed(constraints));
    measure("linear equations", &of_one_kind(constraints, linear));
    measure("rods", &of_one_kind(constraints, rod));
    measure("finite rotations", &of_one_kind(constraints / 10, finite));
    let met = if mixed <= 2.0 { "met" } else { "not met" };
    println!("target for the mix: a ratio of at most 2; {met}");
}

/// Returns the ratio of medians.
fn measure(name: &str, set: &ConstraintSet) -> f64 {
    let u: Vec<f64> = (0..set.dofs()).map(|j| 1e-3 * (j % 17) as f64).collect();
    let w: Vec<f64> = (0..set.equations()).map(|i| (i % 5) as f64).collect();
    let mut evaluation = set.allocate();
    // The first H allocates its array.
    set.assemble(&u, &w, &mut evaluation).expect("of this set");
    let mut copy = [set.equations(), evaluation.g().nnz(), evaluation.h().nnz()].map(|length| vec![0.0; length]);
    let [mut values, mut hessian, mut all, mut writing, mut indexed] = [const { Vec::new() }; 5];
    let longest = copy.iter().map(Vec::len).max().unwrap_or(0);
    let places: Vec<u32> = (0..longest).map(|k| (k % CHUNK) as u32).collect();
    for round in 0..ROUNDS {
        // As long as the assembly, so that other programs interrupt both equally often.
        writing.push(time(|| (0..REPEATS).for_each(|i| write(&mut copy, (round + i) as f64))) / REPEATS as f64);
        indexed.push(time(|| (0..REPEATS).for_each(|i| write_indexed(&mut copy, &places, i as f64))) / REPEATS as f64);
        values.push(time(|| set.evaluate(&u, &mut evaluation).expect("of this set")));
        hessian.push(time(|| set.effective_hessian(&u, &w, &mut evaluation).expect("of this set")));
        all.push(time(|| set.assemble(&u, &w, &mut evaluation).expect("of this set")));
        black_box((&evaluation, &copy));
    }
    let shortest = |times: &[f64]| times.iter().copied().fold(f64::INFINITY, f64::min);
    let best = shortest(&all) / shortest(&writing);
    let [values, hessian, all, writing, indexed] = [values, hessian, all, writing, indexed].map(median);
    let (nnz, ratio, other) = (evaluation.g().nnz() + evaluation.h().nnz(), all / writing, all / indexed);
    let [a, b, c, d, e] = [values, hessian, all, writing, indexed].map(|seconds| 1e3 * seconds);
    print!("{name:>20} {:>9} {nnz:>10} ", set.equations());
    println!("{a:>7.2} ms {b:>7.2} ms {c:>7.2} ms {d:>7.2} ms {e:>7.2} ms {ratio:>6.2} {other:>7.2} {best:>6.2}");
    ratio
}

/// Writes every number of c, G and H once.
fn write(numbers: &mut [Vec<f64>; 3], value: f64) {
    for array in numbers {
        array.par_chunks_mut(CHUNK).for_each(|chunk| chunk.fill(black_box(value)));
    }
}

/// The same, each at a position from a list.
fn write_indexed(numbers: &mut [Vec<f64>; 3], places: &[u32], value: f64) {
    for array in numbers {
        array.par_chunks_mut(CHUNK).zip(places.par_chunks(CHUNK)).for_each(|(chunk, places)| {
            let (value, count) = (black_box(value), chunk.len());
            places[..count].iter().for_each(|&place| chunk[place as usize] = value);
        });
    }
}

fn time(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64()
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
