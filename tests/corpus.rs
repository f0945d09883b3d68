//! Real and extreme systems with known rank: those of `tests/corpus`, and of the folder that `QLESS_CORPUS` names. Prints the score as a table; a `definite` system that is not right fails the test.

#[path = "support/corpus.rs"]
mod known;

use std::path::PathBuf;
use std::time::Instant;

use qless::{Analysis, BackendChoice, ConstraintSystem, Kind, Options, analyse};

/// The truth about a system.
#[derive(serde::Deserialize)]
struct Expected {
    name: String,
    class: String,
    rank: Option<usize>,
    rank_free: Option<usize>,
    inconsistent: Option<bool>,
    inconsistent_free: Option<bool>,
    rank_low: Option<usize>,
    rel_distance: Option<f64>,
}

struct Case {
    folder: PathBuf,
    expected: Expected,
}

fn cases(part: &str) -> Vec<Case> {
    let read = |folder: PathBuf| {
        let text = std::fs::read_to_string(folder.join("expected.json")).expect("expected.json");
        Case { expected: serde_json::from_str(&text).expect("known fields"), folder }
    };
    known::folders(part).into_iter().map(read).collect()
}

fn backends() -> Vec<BackendChoice> {
    let mut all = vec![BackendChoice::Faer, BackendChoice::Sparse];
    if cfg!(feature = "spqr") {
        all.push(BackendChoice::Spqr);
    }
    all
}

/// The first error of an answer, if any.
fn fault(case: &Case, system: &ConstraintSystem, analysis: &Analysis) -> Option<String> {
    let expected = &case.expected;
    let rank = expected.rank_free.or(expected.rank);
    let conflicting = analysis.kinds().contains(&Kind::Conflicting);
    let inconsistent = expected.inconsistent_free.or(expected.inconsistent);
    match expected.class.as_str() {
        "definite" | "scaling" | "range" => {
            if rank != Some(analysis.rank()) {
                return Some(format!("rank {} for {rank:?}", analysis.rank()));
            }
            if inconsistent != Some(conflicting) {
                return Some(format!("conflicting {conflicting} for {inconsistent:?}"));
            }
            certificates(system, analysis)
        }
        "ambiguous" => ambiguous_fault(expected, analysis),
        other => Some(format!("accepted, though {other}")),
    }
}

/// A flagged rank is right, and so is the exact one: equations that are triangular are independent, however near a lower rank is by their
/// singular values. At a relative distance d from lower rank below `100 t`, for the tolerance t, the lower rank is right as well, if flagged.
fn ambiguous_fault(expected: &Expected, analysis: &Analysis) -> Option<String> {
    let (full, low) = (expected.rank?, expected.rank_low.or(expected.rank)?);
    let (rank, is_flagged) = (analysis.rank(), analysis.confidence().ambiguous);
    let distance = expected.rel_distance.unwrap_or(T);
    let least = if distance > 100.0 * T { full } else { low };
    if !(least..=full).contains(&rank) && !is_flagged {
        return Some(format!("rank {rank}, neither {least} to {full} nor flagged"));
    }
    (!is_flagged && rank != full && distance < 1e-6).then(|| "not flagged as ambiguous".to_owned())
}

/// The tolerance.
const T: f64 = 1e-10;

/// Checks that `row_k - sum c_i row_i` vanishes on the free DOFs for the first dependent rows.
fn certificates(system: &ConstraintSystem, analysis: &Analysis) -> Option<String> {
    let mut free = vec![true; system.dofs()];
    system.prescribed().iter().for_each(|&(j, _)| free[j] = false);
    for dependent in analysis.dependent().iter().take(200) {
        let mut rest = std::collections::HashMap::new();
        let mut size = 0.0_f64;
        let mut add = |row: usize, factor: f64| {
            for (j, v) in system.matrix().row(row).filter(|&(j, _)| free[j]) {
                *rest.entry(j).or_insert(0.0) += factor * v;
                size = size.max((factor * v).abs());
            }
        };
        add(dependent.row, 1.0);
        for term in analysis.because(dependent.row).expect("one of its rows") {
            if analysis.kinds()[term.row] != Kind::Independent {
                return Some(format!("row {} is explained by dependent row {}", dependent.row + 1, term.row + 1));
            }
            add(term.row, -term.coefficient);
        }
        let left = rest.values().fold(0.0, |a: f64, v: &f64| a.max(v.abs()));
        if left > 1e-9 * size {
            return Some(format!("certificate of row {} leaves {left:e} of {size:e}", dependent.row + 1));
        }
    }
    None
}

fn reduction_fault(case: &Case, residual: f64, growth: f64, options: &Options) -> Option<String> {
    if !matches!(case.expected.class.as_str(), "definite") {
        return None;
    }
    if residual > 1e-12 {
        return Some(format!("residual {residual:e}"));
    }
    (growth > options.growth).then(|| format!("growth {growth}"))
}

fn run(part: &str, options: &Options) -> Vec<String> {
    let mut wrong = Vec::new();
    println!(
        "{:<36} {:<9} {:>7} {:>7} {:>9} {:>9} {:>8} {:>8}  fault",
        "system", "class", "rows", "rank", "sigma", "dropped", "growth", "seconds"
    );
    for case in cases(part) {
        let start = Instant::now();
        let name = &case.expected.name;
        let system = match qless_io::read_case(&case.folder, None, None) {
            Ok(system) => system,
            Err(error) => {
                println!("{name:<36} {:<9} {error}", case.expected.class);
                if case.expected.class != "invalid" {
                    wrong.push(format!("{name}: {error}"));
                }
                continue;
            }
        };
        let analysis = match analyse(&system, options) {
            Ok(analysis) => analysis,
            Err(error) => {
                println!("{name:<36} {:<9} {error}", case.expected.class);
                if !matches!(case.expected.class.as_str(), "range" | "invalid") {
                    wrong.push(format!("{name}: {error}"));
                }
                continue;
            }
        };
        let mid = start.elapsed();
        let reduction = analysis.reduction().expect("within the gate");
        let residual = analysis.residual(&reduction).expect("its own DOFs");
        let fault =
            fault(&case, &system, &analysis).or_else(|| reduction_fault(&case, residual, reduction.growth(), options));
        println!(
            "{name:<36} {:<9} {:>7} {:>7} {:>9.1e} {:>9.1e} {:>8.2} {:>8.3} {:>8.3} {}{}",
            case.expected.class,
            system.equations(),
            analysis.rank(),
            analysis.confidence().distance,
            analysis.confidence().error,
            reduction.growth(),
            mid.as_secs_f64(),
            start.elapsed().as_secs_f64(),
            if analysis.confidence().ambiguous && case.expected.class != "ambiguous" { "FLAGGED " } else { "" },
            fault.as_deref().unwrap_or(""),
        );
        wrong.extend(fault.map(|fault| format!("{name}: {fault}")));
    }
    wrong
}

#[test]
fn cases_are_right() {
    for backend in backends() {
        println!("{backend:?}");
        let wrong = run("cases", &Options { backend, ..Options::default() });
        assert!(wrong.is_empty(), "{backend:?}: {wrong:#?}");
    }
}

#[test]
fn extremes_are_right() {
    for backend in backends() {
        println!("{backend:?}");
        let wrong = run("extremes", &Options { backend, ..Options::default() });
        assert!(wrong.is_empty(), "{backend:?}: {wrong:#?}");
    }
}

/// The multifrontal QR by itself: every definite case without presolve.
#[test]
fn cases_are_right_on_the_sparse_backend_without_presolve() {
    let options = Options { backend: BackendChoice::Sparse, presolve: false, ..Options::default() };
    let wrong = run("cases", &options);
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// The truth of the small corpus agrees with exact arithmetic.
#[test]
fn the_small_corpus_is_what_it_says() {
    let small = known::small("cases");
    let cases: Vec<_> = cases("cases").into_iter().filter(|case| case.folder.starts_with(&small)).collect();
    assert!(cases.len() >= 24, "{} cases", cases.len());
    for case in cases {
        let name = &case.expected.name;
        let system = qless_io::read_case(&case.folder, None, None).unwrap_or_else(|e| panic!("{name}: {e}"));
        let rank = qless_scenes::oracle::rank_free(&system).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(Some(rank), case.expected.rank_free, "{name}");
    }
}

/// Sizes, rank and conflicts of each small deck. A cleaned deck is independent unless it conflicts.
#[test]
fn small_decks_are_right() {
    let folder = known::small("decks");
    let expected = std::fs::read_to_string(folder.join("expected.csv")).expect("expected.csv");
    let lines: Vec<_> = expected.lines().skip(1).collect();
    assert_eq!(lines.len() + 1, std::fs::read_dir(&folder).expect("a folder").count(), "each deck has its line");
    for line in lines {
        let (name, truth) = line.split_once(',').expect("a name and a truth");
        let deck = qless_io::deck::read(&folder.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"));
        let system = deck.model().system(&deck.model().cases()[0]).unwrap_or_else(|e| panic!("{name}: {e}"));
        let analysis = analyse(&system, &Options::default()).unwrap_or_else(|e| panic!("{name}: {e}"));
        let conflicting = analysis.kinds().contains(&Kind::Conflicting);
        assert_eq!(format!("{},{},{conflicting}", system.equations(), analysis.rank()), truth, "{name}");
        let plan = qless_io::deck::clean::plan(&deck, &Options::default());
        assert_eq!(plan.is_err(), conflicting, "{name}: conflicting decks are not cleaned");
    }
}
