//! How peak memory grows: the paper's tie model from 3e4 to 3e6 equations, `cargo bench --bench peak` (`-- --test` for the two
//! smallest sizes).
//!
//! It is a separate program: its counting allocator zeroes arrays itself, whereas the system's allocator defers that to the first use
//! of each page; this would change the times of [`scaling`](../scaling.rs).

mod sizes;

use peak_alloc::PeakAlloc;

use sizes::{ORDERS, Order, exponent, sizes, system, whole};

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

fn main() {
    let most = ORDERS.map(|(name, order)| growth(name, order)).into_iter().fold(0.0, f64::max);
    assert!(most <= 12.0, "peak memory is {most} times the bytes of C");
}

/// Prints a table of all sizes; the largest peak memory over the bytes of C in compressed columns.
fn growth(name: &str, order: Order) -> f64 {
    println!("{:>9} {:>10} {:>9} {:>12} {:>12} {:>8}", "equations", "nnz", "DOFs", "C", "peak", "ratio");
    let samples: Vec<[f64; 3]> = sizes().iter().map(|&size| line(name, size, order)).collect();
    println!("exponent: {:.2}", exponent(samples.iter().map(|&[equations, peak, _]| (equations, peak))));
    samples.iter().map(|&[_, peak, csc]| peak / csc).fold(0.0, f64::max)
}

/// Prints a line of the table: equations, peak, C.
fn line(name: &str, size: usize, order: Order) -> [f64; 3] {
    let system = system(size, order);
    MEMORY.reset_peak_usage();
    let before = MEMORY.current_usage();
    whole(&system);
    let peak = (MEMORY.peak_usage() - before) as f64;
    let (equations, nnz) = (system.equations(), system.matrix().nnz());
    let csc = (12 * nnz + 8 * (system.dofs() + 1)) as f64;
    let (of_c, of_peak, ratio) = (csc / 1e6, peak / 1e6, peak / csc);
    println!("{equations:>9} {nnz:>10} {name:>9} {of_c:>9.1} MB {of_peak:>9.1} MB {ratio:>8.1}");
    [equations as f64, peak, csc]
}
