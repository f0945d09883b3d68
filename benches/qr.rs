//! Sparse QR in Rust against SuiteSparseQR, one thread each: `OPENBLAS_NUM_THREADS=1 cargo bench --bench qr --features spqr`.
//!
//! Both sides are taken in turns in one process, analysis included; the medians are compared. `--test` takes the smallest
//! scene only, any other word the systems whose names hold it. Corpus systems are read from the folder QLESS_CORPUS.
//! `--solve` compares `x = A\b` of both, on these and on square, tall and wide systems of full rank.
//! `--peak` compares instead how much each side raises the memory of a process of its own (Linux).

mod solve;
mod timing;

use std::hint::black_box;
use std::path::{Path, PathBuf};

use qless::Csr;
use qless::backend::{Backend, spqr::Spqr};
use qless_qr::{Options, Symbolic, Tolerance};
use qless_scenes::fssi::{self, Level, Mesh};

use timing::{median, seconds};

/// Corpus systems with enough entries to time.
const LEAST: usize = 3000;
const TOLERANCE: f64 = 1e-10;

fn ours(columns: &Csr, rhs: &[f64]) -> usize {
    let symbolic =
        Symbolic::analyse(columns.cols(), columns.rows(), columns.starts(), columns.columns()).expect("a pattern");
    let options = Options::new().tolerance(Tolerance::Absolute(TOLERANCE));
    black_box(symbolic.factor(columns.values(), rhs, options).expect("a factorization")).rank()
}

fn theirs(columns: &Csr, rhs: &[f64]) -> usize {
    black_box(Spqr::default().factor(columns, rhs, TOLERANCE).expect("a factorization")).rank
}

/// Seconds of a factorization and its rank.
fn time(work: impl FnOnce() -> usize) -> (f64, usize) {
    let mut rank = 0;
    (seconds(|| rank = work()), rank)
}

/// Ratio of medians; at least three rounds, about a second in all.
fn compare(name: &str, columns: &Csr) -> f64 {
    let (m, n) = (columns.cols(), columns.rows());
    let rhs: Vec<f64> = (0..m).map(|i| (i % 7) as f64 - 3.0).collect();
    let (first, rank) = time(|| ours(columns, &rhs));
    let rounds = ((0.5 / first) as usize).clamp(3, 31);
    let mut times = (Vec::new(), Vec::new());
    let mut other = 0;
    for _ in 0..rounds {
        times.0.push(time(|| ours(columns, &rhs)).0);
        let (theirs, rank) = time(|| theirs(columns, &rhs));
        times.1.push(theirs);
        other = rank;
    }
    let (a, b) = (median(times.0), median(times.1));
    let analyse = || Symbolic::analyse(m, n, columns.starts(), columns.columns()).expect("a pattern");
    let analysis = seconds(|| drop(black_box(analyse())));
    let ranks = if rank == other { String::new() } else { format!("  ranks {rank} and {other}") };
    println!(
        "{name:<28}{m:>8}{n:>8}{:>9}{:>10.1}{:>10.2}{:>10.2}{:>10.2}{:>8.2}{ranks}",
        columns.nnz(),
        analyse().flops() / 1e6,
        analysis * 1e3,
        a * 1e3,
        b * 1e3,
        a / b
    );
    a / b
}

/// A system that is built on demand.
struct System {
    name: String,
    build: Box<dyn Fn() -> Option<Csr>>,
}

fn mortar(name: String, mesh: Mesh) -> System {
    let build = Box::new(move || Some(fssi::mortar(&mesh, 1).expect("a scene").system.matrix().clone()));
    System { name, build }
}

fn scenes(test: bool) -> Vec<System> {
    if test {
        return vec![mortar("mortar 300".into(), Mesh::with_equations(300))];
    }
    let levels = [Level::P50, Level::P80, Level::P110];
    let levels = levels.map(|level| mortar(format!("mortar {} %", level.percent()), level.mesh()));
    let large = Mesh::with_equations(4 * Level::P110.equations());
    levels.into_iter().chain([mortar("mortar 4 x 110 %".into(), large)]).collect()
}

fn corpus() -> Vec<System> {
    let Some(folder) = std::env::var_os("QLESS_CORPUS") else { return Vec::new() };
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.expect("an entry").path().join("C.mtx")).collect();
    files.sort();
    let name = |file: &PathBuf| Some(file.parent()?.file_name()?.to_string_lossy().into_owned());
    let case = |file: PathBuf| Some(System { name: name(&file)?, build: Box::new(move || read(&file)) });
    files.into_iter().filter(|file| file.is_file()).filter_map(case).collect()
}

/// The matrix of a file, if it has enough entries to time.
fn read(file: &Path) -> Option<Csr> {
    let system = qless_io::read_case(file, None, None).ok()?;
    Some(system.matrix().clone()).filter(|c| c.nnz() >= LEAST)
}

/// MiB that one factorization adds to what this process holds.
fn raised(columns: &Csr, side: &str) -> f64 {
    let status = |key: &str| {
        let text = std::fs::read_to_string("/proc/self/status").expect("Linux");
        let line = text.lines().find(|line| line.starts_with(key)).expect("a known key");
        line.split_whitespace().nth(1).and_then(|word| word.parse::<f64>().ok()).expect("a number") / 1024.0
    };
    let rhs = vec![1.0; columns.cols()];
    std::fs::write("/proc/self/clear_refs", "5").expect("Linux");
    let before = status("VmRSS");
    if side == "ours" {
        ours(columns, &rhs)
    } else {
        theirs(columns, &rhs)
    };
    status("VmHWM") - before
}

/// Both sides' peaks, each in a process of its own; no ratio where a process needs less than its own noise.
fn compare_peaks(name: &str) -> Option<f64> {
    let peak = |side: &str| {
        let program = std::env::current_exe().expect("a program");
        let child = std::process::Command::new(program).args(["--side", side, name]).output().expect("a process");
        String::from_utf8_lossy(&child.stdout).trim().parse::<f64>().expect("a number")
    };
    let (a, b) = (peak("ours"), peak("spqr"));
    println!("{name:<28}{a:>10.1} MiB{b:>10.1} MiB{:>8.2}", a / b);
    (b > 10.0).then_some(a / b)
}

/// All systems, C and C^T, by columns.
fn systems(test: bool) -> Vec<System> {
    let cases = if test { Vec::new() } else { corpus() };
    let both = |system: System| {
        let (name, build) = (system.name, std::rc::Rc::new(system.build));
        let again = build.clone();
        let straight = System {
            name: name.clone(),
            build: Box::new(move || build().map(|c| c.transpose().expect("few enough columns"))),
        };
        [straight, System { name: format!("{name} ^T"), build: Box::new(move || again()) }]
    };
    scenes(test).into_iter().chain(cases).flat_map(both).collect()
}

fn main() {
    let mut words: Vec<String> = std::env::args().skip(1).filter(|word| word != "--bench").collect();
    if let [flag, side, name] = &words[..]
        && flag == "--side"
    {
        let system = systems(name.starts_with("mortar 300")).into_iter().find(|system| system.name == *name);
        println!("{}", raised(&system.and_then(|system| (system.build)()).expect("a system"), side));
        return;
    }
    let mut has = |flag: &str| words.iter().position(|word| word == flag).map(|at| words.remove(at)).is_some();
    let (test, peaks, solves) = (has("--test"), has("--peak"), has("--solve"));
    let mut ratios = Vec::new();
    if solves {
        solve::heading();
        let shapes = solve::shapes(test).into_iter();
        let wanted = shapes.filter(|(name, _)| words.iter().all(|word| name.contains(word.as_str())));
        ratios.extend(wanted.map(|(name, columns)| solve::compare(name, &columns, false)));
    } else {
        heading();
    }
    for System { name, build } in systems(test) {
        if words.iter().all(|word| name.contains(word.as_str())) {
            let ratio = |columns| match (peaks, solves) {
                (true, _) => compare_peaks(&name),
                (_, true) => Some(solve::compare(&name, &columns, true)),
                _ => Some(compare(&name, &columns)),
            };
            ratios.extend(build().and_then(ratio));
        }
    }
    let mean = (ratios.iter().map(|ratio| ratio.ln()).sum::<f64>() / ratios.len().max(1) as f64).exp();
    let largest = ratios.iter().copied().fold(0.0, f64::max);
    println!("geometric mean of {} ratios: {mean:.2}, largest {largest:.2}", ratios.len());
}

fn heading() {
    println!(
        "{:<28}{:>8}{:>8}{:>9}{:>10}{:>10}{:>10}{:>10}{:>8}",
        "system", "m", "n", "nnz", "Mflop", "analysis", "ours ms", "spqr ms", "ratio"
    );
}
