//! Sparse QR in Rust against SuiteSparseQR, one thread each: `OPENBLAS_NUM_THREADS=1 cargo bench --bench qr --features spqr`.
//!
//! Both sides are taken in turns in one process, analysis included; the medians are compared. `--test` takes the smallest
//! scene only, any other word the systems whose names hold it. Corpus systems are read from the folder QLESS_CORPUS.

use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use qless::Csr;
use qless::qr::{Backend, spqr::Spqr};
use qless_qr::Symbolic;
use qless_scenes::fssi::{self, Level, Mesh};

/// Corpus systems with enough entries to time.
const LEAST: usize = 3000;
const TOLERANCE: f64 = 1e-10;

fn ours(columns: &Csr, rhs: &[f64]) -> usize {
    let symbolic = Symbolic::analyse(columns.cols, columns.rows(), &columns.start, &columns.col).expect("a pattern");
    black_box(symbolic.factor(&columns.val, rhs, TOLERANCE, usize::MAX).expect("a factorization")).rank
}

fn theirs(columns: &Csr, rhs: &[f64]) -> usize {
    black_box(Spqr.factor(columns, rhs, TOLERANCE).expect("a factorization")).rank
}

fn time(work: impl FnOnce() -> usize) -> (f64, usize) {
    let start = Instant::now();
    let rank = work();
    (start.elapsed().as_secs_f64(), rank)
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// Ratio of medians; at least three rounds, about a second in all.
fn compare(name: &str, columns: &Csr) -> f64 {
    let (m, n) = (columns.cols, columns.rows());
    let rhs: Vec<f64> = (0..m).map(|i| (i % 7) as f64 - 3.0).collect();
    let (first, rank) = time(|| ours(columns, &rhs));
    let rounds = ((0.5 / first) as usize).clamp(3, 31);
    let mut times = (Vec::new(), Vec::new());
    let mut other = 0;
    for _ in 0..rounds {
        times.0.push(time(|| ours(columns, &rhs)).0);
        let (seconds, rank) = time(|| theirs(columns, &rhs));
        times.1.push(seconds);
        other = rank;
    }
    let (a, b) = (median(times.0), median(times.1));
    let (symbolic, analysis) = {
        let start = Instant::now();
        let symbolic = Symbolic::analyse(m, n, &columns.start, &columns.col).expect("a pattern");
        (symbolic, start.elapsed().as_secs_f64())
    };
    let ranks = if rank == other { String::new() } else { format!("  ranks {rank} and {other}") };
    println!(
        "{name:<28}{m:>8}{n:>8}{:>9}{:>10.1}{:>10.2}{:>10.2}{:>10.2}{:>8.2}{ranks}",
        columns.nnz(),
        symbolic.flops() / 1e6,
        analysis * 1e3,
        a * 1e3,
        b * 1e3,
        a / b
    );
    a / b
}

fn scenes(test: bool) -> Vec<(String, Csr)> {
    let meshes: Vec<(String, Mesh)> = if test {
        vec![("mortar 300".into(), Mesh::with_equations(300))]
    } else {
        let levels =
            [Level::P50, Level::P80, Level::P110].map(|level| (format!("mortar {} %", level.percent()), level.mesh()));
        let large = Mesh::with_equations(4 * Level::P110.equations());
        levels.into_iter().chain([("mortar 4 x 110 %".into(), large)]).collect()
    };
    let matrix = |mesh: &Mesh| fssi::mortar(mesh, 1).expect("a scene").system.matrix().clone();
    meshes.iter().map(|(name, mesh)| (name.clone(), matrix(mesh))).collect()
}

fn corpus() -> Vec<(String, Csr)> {
    let Some(folder) = std::env::var_os("QLESS_CORPUS") else { return Vec::new() };
    let mut paths: Vec<_> =
        std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()).collect();
    paths.sort();
    paths.iter().filter_map(|path| case(path)).collect()
}

fn case(path: &Path) -> Option<(String, Csr)> {
    let file = path.join("C.mtx");
    let system = file.is_file().then(|| qless_io::read_case(&file, None, None))?.ok()?;
    let name = path.file_name()?.to_string_lossy().into_owned();
    Some((name, system.matrix().clone())).filter(|(_, c)| c.nnz() >= LEAST)
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| word != "--bench").collect();
    let test = words.iter().any(|word| word == "--test");
    let wanted = |name: &str| words.iter().filter(|word| *word != "--test").all(|word| name.contains(word.as_str()));
    println!(
        "{:<28}{:>8}{:>8}{:>9}{:>10}{:>10}{:>10}{:>10}{:>8}",
        "system", "m", "n", "nnz", "Mflop", "analysis", "ours ms", "spqr ms", "ratio"
    );
    let mut ratios = Vec::new();
    for (name, c) in scenes(test).into_iter().chain(corpus()) {
        for (name, columns) in [(name.clone(), c.transpose()), (format!("{name} ^T"), c)] {
            if wanted(&name) {
                ratios.push(compare(&name, &columns));
            }
        }
    }
    let mean = (ratios.iter().map(|ratio| ratio.ln()).sum::<f64>() / ratios.len().max(1) as f64).exp();
    println!(
        "geometric mean of {} ratios: {mean:.2}, largest {:.2}",
        ratios.len(),
        ratios.iter().copied().fold(0.0, f64::max)
    );
}
