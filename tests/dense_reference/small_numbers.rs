//! Small numbers in certificates and equations: which of them are rounding.

use qless::{BackendChoice, SystemBuilder};
use qless_scenes::Rng;

use crate::support::{check_certificates, diagnose, settings};

on_each_backend!(certificates_may_decay, a_small_coefficient_makes_an_equation_independent);

/// Equations of a band whose diagonal dominates determine all DOFs. A further equation of the first DOFs is a combination of all of them,
/// with coefficients that fall by about ten from one to the next, far below rounding. That leaves no doubt.
fn certificates_may_decay(backend: BackendChoice) {
    for seed in 0..40 {
        let mut rng = Rng::new(seed);
        let n = 20 + rng.below(30);
        let mut builder = SystemBuilder::new(n);
        for i in 0..n {
            let near = (i.saturating_sub(2)..n.min(i + 3)).map(|j| (j, if j == i { 1.0 } else { 0.1 * rng.real() }));
            builder.equation(near.collect::<Vec<_>>(), 0.0);
        }
        builder.equation((0..3).map(|j| (j, 1.0 + rng.real())).collect::<Vec<_>>(), 0.0);
        let system = builder.build().expect("valid");
        for options in settings(backend) {
            let analysis = diagnose(&system, &options);
            let what = format!("seed {seed}, presolve {}: {:?}", options.presolve, analysis.confidence());
            assert_eq!(analysis.rank(), n, "{what}");
            assert!(!analysis.confidence().ambiguous, "{what}");
            check_certificates(&system, &analysis);
        }
    }
}

/// A copy of an equation with one more DOF, whose coefficient is near rounding beside the others and large in other equations.
fn a_small_coefficient_makes_an_equation_independent(backend: BackendChoice) {
    for seed in 0..200 {
        let mut rng = Rng::new(seed);
        let (m, n) = (3 + rng.below(5), 10 + rng.below(4));
        let mut rows: Vec<Vec<f64>> = (0..m).map(|_| (0..n).map(|_| rng.real()).collect()).collect();
        let (k, j) = (rng.below(m), rng.below(n));
        rows[k][j] = 0.0;
        let mut copy = rows[k].clone();
        copy[j] = 2.0_f64.powi(-30 - rng.below(18) as i32);
        rows.push(copy);
        let mut builder = SystemBuilder::new(n);
        rows.iter().for_each(|row| _ = builder.equation(row.iter().copied().enumerate().filter(|e| e.1 != 0.0), 0.0));
        let system = builder.build().expect("valid");
        for options in settings(backend) {
            let analysis = diagnose(&system, &options);
            let what = format!("seed {seed}, presolve {}, {:e}", options.presolve, rows[m][j]);
            assert!(analysis.rank() == m + 1 || analysis.confidence().ambiguous, "{what}: rank {}", analysis.rank());
        }
    }
}
