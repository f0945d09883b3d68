//! `max |T_ij| <= 10` wherever a dense strong rank-revealing QR reaches that.
//!
//! `residual.rs` checks the residuals of T for the same systems.

use qless::{BackendChoice, Options};
use qless_scenes::families;

use super::rrqr::strong_rrqr;
use super::scenes::{definite, steep};
use crate::support::{check_reduction, diagnose, settings};

on_each_backend!(growth_is_that_of_a_strong_rrqr, growth_needs_the_bound, low_bounds_are_reached);

/// Bound of this comparison; the default of the library is 4.
const BOUND: f64 = 10.0;

fn growth_is_that_of_a_strong_rrqr(backend: BackendChoice) {
    for (name, scene) in [definite(), steep()].concat() {
        let rank = scene.truth.rank_free.expect("known");
        let dense = strong_rrqr(&scene.system, rank, BOUND);
        for options in settings(backend) {
            let analysis = diagnose(&scene.system, &options);
            assert_eq!(analysis.rank(), rank, "{name}, presolve {}", options.presolve);
            let reduction = analysis.reduction().expect("within the gate");
            let growth = reduction.t().values().iter().fold(0.0, |a: f64, v| a.max(v.abs()));
            println!(
                "{name}, presolve {}: {growth:.3} after {} exchanges; dense {:.3}, {:.3} after {}",
                options.presolve,
                reduction.exchanges(),
                dense.pivoted,
                dense.strong,
                dense.exchanges
            );
            assert!(reduction.t().values().iter().all(|v| v.is_finite()), "{name}: a number that is none");
            assert_eq!(growth, reduction.growth(), "{name}: growth as reported");
            assert!(growth <= BOUND || dense.strong > BOUND, "{name}: {growth}, dense {}", dense.strong);
        }
    }
}

/// With a bound below 2 two DOFs could be exchanged for ever; at 1 rounding suffices.
fn low_bounds_are_reached(backend: BackendChoice) {
    let planted = families::planted(60, 90, 6, 2, false).expect("in range");
    let mut exchanges = 0;
    for (name, scene) in definite().into_iter().chain([("planted", planted)]) {
        for growth in [1.0, 1.5] {
            let options = Options { backend, growth, ..Options::default() };
            let analysis = diagnose(&scene.system, &options);
            let reduction = analysis.reduction().expect("within the gate");
            exchanges += reduction.exchanges();
            let most = reduction.t().values().iter().fold(0.0, |a: f64, v| a.max(v.abs()));
            assert!(most <= growth * (1.0 + 1e-8), "{name}: {most} for {growth}");
            assert!(most == reduction.growth(), "{name}: growth as reported");
            check_reduction(&scene.system, &analysis, &reduction, 1e-11);
        }
    }
    assert!(exchanges > 100, "{exchanges}");
}

/// Without a bound T exceeds 1, so the test above can fail.
fn growth_needs_the_bound(backend: BackendChoice) {
    let unbounded = Options { backend, growth: 1e300, ..Options::default() };
    let growth = |(_, scene): (_, qless_scenes::Scene)| {
        diagnose(&scene.system, &unbounded).reduction().expect("within the gate").growth()
    };
    let steepest = steep().into_iter().map(growth).fold(0.0, f64::max);
    assert!(steepest > 1.0, "{steepest}");
}
