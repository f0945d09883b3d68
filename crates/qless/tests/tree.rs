//! SuiteSparseQR's task tree on oneTBB: it runs if requested, and its results equal those without a tree, bit for bit.

use std::path::{Path, PathBuf};
use std::process::Command;

use qless::Csr;
use qless::backend::spqr::Spqr;
use qless::backend::{Backend, Factor};

/// A linear congruential generator: the same systems in every run.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() * n as f64) as usize
    }
}

/// m x n by columns; some columns are empty, copies of others, sums of two others, or have a single entry.
fn system(seed: u64) -> (Csr, Vec<f64>) {
    let mut random = Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15));
    let (m, n) = (5 + random.below(150), 5 + random.below(150));
    let mut columns: Vec<Vec<(usize, f64)>> = Vec::new();
    for j in 0..n {
        let column = match random.below(12) {
            0 => Vec::new(),
            1 if j > 1 => columns[random.below(j)].clone(),
            2 if j > 1 => sum(&columns[random.below(j)], &columns[random.below(j)]),
            3 => vec![(random.below(m), 1.0 + random.next())],
            _ => {
                let near = j * m / n;
                let entries = 1 + random.below(5);
                let pairs = (0..entries).map(|_| ((near + random.below(9)).min(m - 1), random.next() - 0.5));
                sum(&pairs.collect::<Vec<_>>(), &[])
            }
        };
        columns.push(column);
    }
    let count = random.below(4);
    let rhs = (0..m * count).map(|_| random.next() - 0.5).collect();
    (by_columns(m, columns), rhs)
}

/// Sorted, repeated rows summed.
fn sum(a: &[(usize, f64)], b: &[(usize, f64)]) -> Vec<(usize, f64)> {
    let mut all = std::collections::BTreeMap::new();
    a.iter().chain(b).for_each(|&(i, v)| *all.entry(i).or_insert(0.0) += v);
    all.into_iter().collect()
}

fn by_columns(rows: usize, columns: Vec<Vec<(usize, f64)>>) -> Csr {
    let mut a = Csr::empty(rows);
    columns.into_iter().for_each(|column| a.push_row(column).expect("ascending"));
    a
}

/// A row for each edge of a square grid, a column for each node.
fn grid(side: usize) -> Csr {
    let mut columns: Vec<Vec<(usize, f64)>> = vec![Vec::new(); side * side];
    let mut row = 0;
    for i in 0..side {
        for j in 0..side {
            for (p, q) in [(i + 1, j), (i, j + 1)].into_iter().filter(|&(p, q)| p < side && q < side) {
                columns[i * side + j].push((row, 1.0));
                columns[p * side + q].push((row, -1.0 - 0.1 * ((i + 2 * j) % 5) as f64));
                row += 1;
            }
        }
    }
    by_columns(row, columns)
}

/// Settings for many small tasks.
fn on(threads: usize) -> Spqr {
    Spqr { small: 1.0, grain: 32.0, ..Spqr::on(threads) }
}

fn bits(factor: &Factor) -> (Vec<usize>, Vec<u64>) {
    let numbers = factor.r.values().iter().chain(&factor.rhs).chain(&factor.rest).chain([&factor.dropped]);
    let shape =
        factor.order.iter().chain(factor.r.starts()).copied().chain(factor.r.columns().iter().map(|&j| j as usize));
    (shape.collect(), numbers.map(|v| v.to_bits()).collect())
}

#[test]
fn a_thousand_systems_agree_with_the_sequence_to_the_last_bit() {
    assert!(Spqr::has_trees());
    let before = Spqr::trees();
    let mut trees = 0;
    for seed in 0..1200 {
        let (columns, rhs) = system(seed);
        let tolerance = if seed % 3 == 0 { 0.0 } else { 1e-10 };
        let expected = Spqr::default().factor(&columns, &rhs, tolerance).expect("a factorization");
        for threads in [2, 4] {
            let (found, statistics) = on(threads).factor_measured(&columns, &rhs, tolerance).expect("a factorization");
            assert!(bits(&found) == bits(&expected), "system {seed} on {threads} threads");
            trees += u64::from(statistics.tasks > 2);
        }
    }
    println!("{trees} trees in 2400 factorizations");
    assert!(trees >= 1000, "{trees}");
    assert!(Spqr::trees() - before >= trees, "the counter of trees did not advance");
}

#[test]
fn medium_systems_agree_on_every_number_of_threads() {
    for side in [40, 90] {
        let columns = grid(side);
        let rhs = vec![1.0; columns.cols()];
        let expected = Spqr::default().factor(&columns, &rhs, 1e-10).expect("a factorization");
        for threads in [1, 2, 3, 4, 8] {
            let found = on(threads).factor(&columns, &rhs, 1e-10).expect("a factorization");
            assert!(bits(&found) == bits(&expected), "{side} on {threads} threads");
        }
    }
}

#[test]
fn several_callers_at_once_do_not_meet() {
    let expected: Vec<_> = (0..4).map(|k| Spqr::default().factor(&grid(30 + k), &[], 1e-10).expect("right")).collect();
    std::thread::scope(|scope| {
        for (k, expected) in expected.iter().enumerate() {
            scope.spawn(move || {
                for threads in [1, 2, 4, 2, 4] {
                    let found = on(threads).factor(&grid(30 + k), &[], 1e-10).expect("a factorization");
                    assert!(bits(&found) == bits(expected), "caller {k}");
                }
            });
        }
    });
}

#[test]
fn one_thread_makes_no_tree() {
    let (_, statistics) = on(1).factor_measured(&grid(40), &[], 1e-10).expect("a factorization");
    assert_eq!(statistics.tasks, 1);
    let (_, statistics) = on(2).factor_measured(&grid(40), &[], 1e-10).expect("a factorization");
    assert!(statistics.tasks > 2, "{statistics:?}");
}

#[test]
fn the_version_says_that_there_are_trees() {
    let version = Spqr::default().version();
    assert!(version.contains("task tree on oneTBB 20"), "{version}");
}

/// A C program calls the library in a shared object.
#[test]
fn trees_run_in_a_shared_library() {
    let here = std::env::current_exe().expect("this program");
    let folder = here.parent().and_then(Path::parent).expect("a build folder").join("examples");
    let library = folder.join("libtree_cdylib.so");
    assert!(library.exists(), "cargo builds examples before it runs tests: {}", library.display());
    let output = Command::new(compiled(&folder)).env("LD_LIBRARY_PATH", &folder).output().expect("a program");
    let (text, errors) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    let trees: u64 = text.trim().parse().unwrap_or_else(|_| panic!("{text} {errors}"));
    assert!(trees > 0, "no tree ran in the shared library");
}

fn compiled(folder: &Path) -> PathBuf {
    let out = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let (source, program) = (out.join("host.c"), out.join("host"));
    let text = "#include <stdio.h>\nunsigned long long example_trees(void);\n\
        int main(void) { printf(\"%llu\\n\", example_trees()); return 0; }\n";
    std::fs::write(&source, text).expect("a folder for tests");
    let mut compiler = Command::new("cc");
    compiler.arg(&source).arg("-o").arg(&program).arg("-L").arg(folder).arg("-ltree_cdylib");
    assert!(compiler.status().expect("a C compiler").success());
    program
}
