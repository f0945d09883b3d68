//! `Q^T A P = [R1 R2; 0 0]` on small systems of every kind, for valgrind to watch what C allocates and frees.
//!
//! ```text
//! cargo build -p qless --features spqr --example spqr_valgrind
//! OPENBLAS_NUM_THREADS=1 valgrind --leak-check=full --error-exitcode=9 \
//!     target/debug/examples/spqr_valgrind
//! ```

use qless::Csr;
use qless::qr::Backend;
use qless::qr::spqr::Spqr;

fn main() {
    for (name, columns) in systems() {
        for count in [0, 1, 3] {
            let rhs: Vec<f64> = (0..columns.cols * count).map(|i| (i % 7) as f64 - 3.0).collect();
            match Spqr::default().factor(&columns, &rhs, 1e-10) {
                Ok(factor) => println!("{name}, {count} right-hand sides: rank {}, {:?}", factor.rank, factor.rest),
                Err(error) => println!("{name}, {count} right-hand sides: {error}"),
            }
        }
    }
}

fn systems() -> Vec<(&'static str, Csr)> {
    vec![
        ("no columns", Csr::empty(3)),
        ("no rows", Csr::empty(3).transpose()),
        ("zero", from_entries(4, 3, |_, _| 0.0)),
        ("tall", from_entries(12, 7, independent)),
        ("wide", from_entries(7, 12, independent)),
        ("duplicate columns", from_entries(12, 8, |i, j| independent(i, j / 2 * 2))),
        ("dead columns between", from_entries(12, 9, |i, j| if j % 3 == 1 { 0.0 } else { independent(i, j) })),
        ("rank one", from_entries(6, 6, |i, j| ((i + 1) * (j + 1)) as f64)),
        ("singletons", from_entries(9, 9, |i, j| if i <= j { independent(i, j) } else { 0.0 })),
        ("not finite", from_entries(3, 3, |i, j| if i == j { f64::NAN } else { 1.0 })),
        ("several fronts", from_entries(300, 200, |i, j| if i.abs_diff(j) < 4 { independent(i, j) } else { 0.0 })),
        ("loop of differences", from_entries(150, 150, |i, j| difference(i, j, 150))),
    ]
}

fn independent(i: usize, j: usize) -> f64 {
    ((i * 31 + j * 17) % 23) as f64 - 11.0 + if i == j { 40.0 } else { 0.0 }
}

/// `u_i - u_(i+1)` around a ring: any one row follows from the others.
fn difference(i: usize, j: usize, n: usize) -> f64 {
    f64::from(i == j) - f64::from((i + 1) % n == j)
}

/// A by columns from its entries.
fn from_entries(m: usize, n: usize, entry: impl Fn(usize, usize) -> f64) -> Csr {
    let mut columns = Csr::empty(m);
    for j in 0..n {
        columns.push_row((0..m).map(|i| (i, entry(i, j))).filter(|e| e.1 != 0.0));
    }
    columns
}
