//! Helpers of the tests: every backend, every order, the identities.
#![allow(dead_code, reason = "each test binary uses a part")]

pub mod corpus;

use std::collections::HashMap;

use qless::{
    Analysis, BackendChoice, CertificateTerm, ConstraintSystem, Kind, Options, Reduction, SystemBuilder, analyse,
};

/// Runs a test `fn(BackendChoice)` on each backend as a test of its own.
#[macro_export]
macro_rules! on_each_backend {
    ($($test:ident),* $(,)?) => {
        mod faer { $(#[test] fn $test() { super::$test(qless::BackendChoice::Faer); })* }
        #[cfg(feature = "spqr")]
        mod spqr { $(#[test] fn $test() { super::$test(qless::BackendChoice::Spqr); })* }
        mod sparse { $(#[test] fn $test() { super::$test(qless::BackendChoice::Sparse); })* }
        mod gauss { $(#[test] fn $test() { super::$test(qless::BackendChoice::Gauss); })* }
    };
}

/// Default settings on a backend, with and without presolve.
pub fn settings(backend: BackendChoice) -> [Options; 2] {
    let options = Options { backend, ..Options::default() };
    [options.clone(), Options { presolve: false, ..options }]
}

pub fn diagnose(system: &ConstraintSystem, options: &Options) -> Analysis {
    analyse(system, options).unwrap_or_else(|e| panic!("{options:?}: {e}"))
}

/// The same equations in another order of rows (`rows[k]` is the old row at place k) and DOFs.
pub fn reorder(system: &ConstraintSystem, rows: &[usize], dofs: &[usize]) -> ConstraintSystem {
    let mut place = vec![0; dofs.len()];
    dofs.iter().enumerate().for_each(|(new, &old)| place[old] = new);
    let mut builder = SystemBuilder::new(dofs.len());
    for &i in rows {
        builder.equation(system.matrix().row(i).map(|(j, v)| (place[j], v)), system.rhs()[i]);
    }
    system.prescribed().iter().for_each(|&(j, value)| builder.prescribe(place[j], value));
    builder.build().expect("as valid as before")
}

/// 0..n in reversed order and in two random orders.
pub fn orders(n: usize) -> Vec<Vec<usize>> {
    let shuffled = |seed: u64| {
        let mut list: Vec<usize> = (0..n).collect();
        let mut rng = qless_scenes::Rng::new(seed);
        (1..n).rev().for_each(|k| list.swap(k, rng.below(k + 1)));
        list
    };
    vec![(0..n).rev().collect(), shuffled(7), shuffled(8)]
}

/// The largest part of `target - sum c_i row_i` on the free DOFs, relative to the parts.
pub fn certificate_error(system: &ConstraintSystem, target: &[(usize, f64)], because: &[CertificateTerm]) -> f64 {
    let mut rest: HashMap<usize, f64> = HashMap::new();
    let mut size = 0.0_f64;
    let mut add = |j: usize, part: f64| {
        *rest.entry(j).or_default() += part;
        size = size.max(part.abs());
    };
    target.iter().for_each(|&(j, v)| add(j, v));
    for term in because {
        system.matrix().row(term.row).for_each(|(j, v)| add(j, -term.coefficient * v));
    }
    let free = |j: &usize| system.prescribed().binary_search_by_key(j, |p| p.0).is_err();
    rest.iter().filter(|(j, _)| free(j)).fold(0.0, |a: f64, (_, v)| a.max(v.abs())) / size.max(f64::MIN_POSITIVE)
}

/// Checks that every certificate has kept equations only and that its identity holds.
pub fn check_certificates(system: &ConstraintSystem, analysis: &Analysis) {
    for dependent in analysis.dependent() {
        let because = analysis.because(dependent.row).expect("one of its rows");
        assert!(because.iter().all(|term| analysis.kinds()[term.row] == Kind::Independent), "row {}", dependent.row);
        let target: Vec<_> = system.matrix().row(dependent.row).collect();
        let error = certificate_error(system, &target, &because);
        assert!(error <= 1e-9, "row {}: certificate off by {error:e}", dependent.row);
    }
}

/// `C [T; I] = 0` and `C u = b` in every independent equation for random u_q and u_p; slaves, masters and prescribed
/// DOFs are all DOFs, once each.
pub fn check_reduction(system: &ConstraintSystem, analysis: &Analysis, reduction: &Reduction, tolerance: f64) {
    let mut all = [reduction.slaves(), reduction.masters(), reduction.prescribed()].concat();
    all.sort_unstable();
    assert_eq!(all, (0..system.dofs()).collect::<Vec<_>>(), "every DOF has one role");
    assert_eq!(reduction.slaves().len(), analysis.rank());
    let mut rng = qless_scenes::Rng::new(3);
    let mut numbers = |n: usize| (0..n).map(|_| rng.below(1000) as f64 / 500.0 - 1.0).collect::<Vec<_>>();
    let (masters, prescribed) = (numbers(reduction.masters().len()), numbers(reduction.prescribed().len()));
    let zeros = vec![0.0; prescribed.len()];
    let u = reduction.expand(&masters, &prescribed).expect("of its lengths");
    let at_rest = reduction.expand(&vec![0.0; masters.len()], &zeros).expect("of its lengths");
    let moved: Vec<f64> =
        reduction.expand(&masters, &zeros).expect("of its lengths").iter().zip(&at_rest).map(|(a, b)| a - b).collect();
    for (what, x, constant) in [("C u = b", &u, 1.0), ("C [T; I] = 0", &moved, 0.0)] {
        let largest = x.iter().chain(&at_rest).fold(0.0, |a: f64, v| a.max(v.abs()));
        for i in (0..system.equations()).filter(|&i| analysis.kinds()[i] == Kind::Independent) {
            let b = constant * system.rhs()[i];
            let sum: f64 = system.matrix().row(i).map(|(j, v)| v * x[j]).sum();
            let size: f64 = system.matrix().row(i).map(|(_, v)| v.abs()).sum::<f64>() * largest + b.abs();
            assert!((sum - b).abs() <= tolerance * size, "{what}, row {i}: {:e} of {size:e}", sum - b);
        }
    }
}
