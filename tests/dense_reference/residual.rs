//! `|C_i u - b_i| <= 1e-13 max(1, 1 / d)` in every independent equation, relative to its parts.

use std::path::Path;

use qless::{Analysis, BackendChoice, ConstraintSystem, Kind, Options, Reduction};
use qless_scenes::oracle::singular_values;
use qless_scenes::{Rng, Scene};

use super::scenes::{definite, kept, steep};
use crate::support::{diagnose, settings};

/// Limit of the residual, relative to the reported condition number.
const PRECISION: f64 = 1e-13;

/// All DOFs for random u_q and u_p in `[-1, 1)`, and for each the sum s_j of the absolute values of its terms.
fn expand(reduction: &Reduction, seed: u64) -> (Vec<f64>, Vec<f64>) {
    let mut rng = Rng::new(seed);
    let mut random = |n: usize| (0..n).map(|_| rng.real()).collect::<Vec<f64>>();
    let (masters, prescribed) = (random(reduction.masters().len()), random(reduction.prescribed().len()));
    let u = reduction.expand(&masters, &prescribed).expect("of its lengths");
    let mut sizes: Vec<f64> = u.iter().map(|v| v.abs()).collect();
    for (i, &slave) in reduction.slaves().iter().enumerate() {
        let by_masters: f64 = reduction.t().row(i).map(|(j, v)| (v * masters[j]).abs()).sum();
        let by_prescribed: f64 = reduction.g_matrix().row(i).map(|(j, v)| (v * prescribed[j]).abs()).sum();
        sizes[slave] = by_masters + by_prescribed + reduction.g()[i].abs();
    }
    assert!(sizes.iter().all(|size| size.is_finite()), "a number that is none");
    (u, sizes)
}

/// [`Analysis::residual`] from T, G and g alone, with D = 1.
fn residual(system: &ConstraintSystem, analysis: &Analysis, reduction: &Reduction, seed: u64) -> f64 {
    let (u, sizes) = expand(reduction, seed);
    let largest = sizes.iter().copied().fold(0.0, f64::max);
    let of = |i: usize| {
        let b = system.rhs()[i];
        let sum: f64 = system.matrix().row(i).map(|(j, v)| v * u[j]).sum();
        let size: f64 = system.matrix().row(i).map(|(_, v)| v.abs()).sum::<f64>() * largest + b.abs();
        if sum == b { 0.0 } else { (sum - b).abs() / size }
    };
    (0..system.equations()).filter(|&i| analysis.kinds()[i] == Kind::Independent).map(of).fold(0.0, f64::max)
}

/// The first error as text.
fn fault(name: &str, system: &ConstraintSystem, options: &Options) -> Option<String> {
    let analysis = diagnose(system, options);
    let reduction = analysis.reduction().expect("within the gate");
    let limit = PRECISION * (1.0 / analysis.confidence().distance).max(1.0);
    let own = (1..=3).map(|seed| residual(system, &analysis, &reduction, seed)).fold(0.0, f64::max);
    let sigma = analysis.confidence().distance;
    let reported = analysis.residual(&reduction).expect("its own DOFs");
    let found = format!("{name}: reported {reported:.1e}, found {own:.1e}, distance {sigma:.1e}");
    println!("{:?}, presolve {}, {found}", options.backend, options.presolve);
    assert!(!reported.is_nan(), "{found}");
    (reported > limit || own > limit).then_some(found)
}

fn residuals_of_families(backend: BackendChoice) {
    for (name, scene) in [definite(), steep()].concat() {
        for options in settings(backend) {
            let fault = fault(name, &scene.system, &options);
            assert_eq!(fault, None, "presolve {}", options.presolve);
        }
    }
}

/// The same limit with the smallest singular value of the kept rows instead of the reported one.
fn residuals_by_the_true_condition(backend: BackendChoice) {
    let lossy = |options: &Options| {
        let over = |(name, scene): (&'static str, Scene)| {
            let analysis = diagnose(&scene.system, options);
            let sigma = singular_values(&kept(&scene.system, &analysis)).expect("within reach")[analysis.rank() - 1];
            let found = residual(&scene.system, &analysis, &analysis.reduction().expect("within the gate"), 1);
            (found > PRECISION * (1.0 / sigma).max(1.0)).then_some(name)
        };
        definite().into_iter().chain(steep()).filter_map(over).collect::<Vec<_>>()
    };
    for options in settings(backend) {
        assert_eq!(lossy(&options), [""; 0], "presolve {}", options.presolve);
    }
}

/// An error of 1e-9 in one of ten constants is found, so the tests can fail.
fn a_wrong_constant_is_found(backend: BackendChoice) {
    for (name, scene) in definite() {
        let analysis = diagnose(&scene.system, &Options { backend, ..Options::default() });
        let good = analysis.reduction().expect("within the gate");
        let mut g = good.g().to_vec();
        g.iter_mut().step_by(10).for_each(|g| *g += 1e-9);
        let dofs = [good.slaves(), good.masters(), good.prescribed()].map(<[usize]>::to_vec);
        let reduction =
            Reduction::from_parts(dofs, good.t().clone(), good.g_matrix().clone(), g).expect("the same DOFs");
        let found = residual(&scene.system, &analysis, &reduction, 1);
        assert!(found > PRECISION, "{name}: {found:e}");
    }
}

on_each_backend!(residuals_of_families, residuals_by_the_true_condition, a_wrong_constant_is_found);

fn class(folder: &Path) -> String {
    let text = std::fs::read_to_string(folder.join("expected.json")).expect("expected.json");
    let expected: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    expected["class"].as_str().expect("a class").to_owned()
}

/// All definite systems of the corpus with at most 5,000 equations.
fn check_corpus(backend: BackendChoice) {
    let options = Options { backend, ..Options::default() };
    let mut faults = Vec::new();
    for folder in ["cases", "extremes"]
        .into_iter()
        .flat_map(crate::support::corpus::folders)
        .filter(|folder| class(folder) == "definite")
    {
        let name = folder.file_name().expect("a folder").to_string_lossy().into_owned();
        let system = qless_io::read_case(&folder, None, None).unwrap_or_else(|e| panic!("{name}: {e}"));
        if system.equations() <= 5000 {
            faults.extend(fault(&name, &system, &options));
        }
    }
    assert!(faults.is_empty(), "{} faults:\n{}", faults.len(), faults.join("\n"));
}

#[test]
fn residuals_of_the_corpus_faer() {
    check_corpus(BackendChoice::Faer);
}

#[cfg(feature = "spqr")]
#[test]
fn residuals_of_the_corpus_spqr() {
    check_corpus(BackendChoice::Spqr);
}
