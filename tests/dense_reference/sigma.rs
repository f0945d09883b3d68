//! `rank = #{sigma_i > tolerance}` and `sigma_kept = sigma_min(kept rows)`, by a dense SVD of the equilibrated rows.

use qless::{BackendChoice, ConstraintSystem, Options, SystemBuilder, Tolerance};
use qless_scenes::Scene;
use qless_scenes::families::{self, Near};
use qless_scenes::oracle::singular_values;

use super::scenes::{definite, kept, steep};
use crate::support::{diagnose, settings};

on_each_backend!(
    rank_is_the_number_of_singular_values,
    sigma_kept_is_the_smallest_of_independent_rows,
    sigma_kept_is_near_the_smallest_of_the_kept_rows,
    sigma_kept_falls_with_the_distance_from_dependence,
);

/// Five steps of inverse iteration give an upper estimate within `n^(1/18)` of the smallest value for a random
/// start: 1.43 for n = 600. A start with a tenth of the expected component along its vector has 1.85.
const FACTOR: f64 = 2.0;
/// Rounding of the SVD, relative to the largest singular value.
const ROUNDING: f64 = 1e-13;

fn tolerance(options: &Options) -> f64 {
    let Tolerance::Relative(tolerance) = options.tolerance else { panic!("relative by default") };
    tolerance
}

fn rank_is_the_number_of_singular_values(backend: BackendChoice) {
    for (name, scene) in definite() {
        let values = singular_values(&scene.system).expect("within reach");
        for options in settings(backend) {
            let found = diagnose(&scene.system, &options).rank();
            let rank = values.iter().filter(|&&sigma| sigma > tolerance(&options)).count();
            assert_eq!(found, rank, "{name}, presolve {}: {values:?}", options.presolve);
            assert_eq!(scene.truth.rank_free.unwrap_or(rank), rank, "{name}: by construction");
            let zero = values.get(rank).map_or(0.0, |sigma| sigma / values[0]);
            assert!(values[rank - 1] > 1e-4 && zero < ROUNDING, "{name} is definite: {values:?}");
        }
    }
}

/// Without presolve and without dependent rows `sigma_min <= sigma_kept <= FACTOR sigma_min`; more than 1 counts as 1.
fn check_sigma(name: &str, system: &ConstraintSystem, backend: BackendChoice) -> usize {
    let analysis = diagnose(system, &whole(backend));
    assert_eq!(analysis.presolve().core_rows, system.equations(), "{name}: all rows are in blocks");
    assert_eq!(analysis.rank(), system.equations(), "{name}: no row is dependent");
    let values = singular_values(system).expect("within reach");
    let (found, least) = (analysis.confidence().sigma_kept, values[values.len() - 1].min(1.0));
    let range = least - ROUNDING * values[0]..=FACTOR * least;
    assert!(range.contains(&found), "{name}: sigma_kept {found:e} for {least:e}");
    analysis.rank()
}

fn whole(backend: BackendChoice) -> Options {
    Options { backend, presolve: false, ..Options::default() }
}

fn sigma_kept_is_the_smallest_of_independent_rows(backend: BackendChoice) {
    for (name, scene) in definite() {
        check_sigma(name, &kept(&scene.system, &diagnose(&scene.system, &whole(backend))), backend);
    }
}

/// The limit for all is `FACTOR sigma_r(C)`, which bounds the estimate for any choice of rows.
fn sigma_kept_is_near_the_smallest_of_the_kept_rows(backend: BackendChoice) {
    let mut off = Vec::new();
    for (name, scene) in definite() {
        let analysis = diagnose(&scene.system, &whole(backend));
        let last = |values: Vec<f64>| values[analysis.rank() - 1].min(1.0);
        let all = last(singular_values(&scene.system).expect("within reach"));
        let least = last(singular_values(&kept(&scene.system, &analysis)).expect("within reach"));
        let found = analysis.confidence().sigma_kept;
        println!("{name}: {found:.3e}, kept rows {least:.3e}, all rows {all:.3e}, factor {:.4}", found / least);
        assert!(found > 0.0 && found <= FACTOR * all, "{name}: sigma_kept {found:e}, of all rows {all:e}");
        off.extend((!(least / FACTOR..=FACTOR * least).contains(&found)).then_some(name));
    }
    assert!(off.is_empty(), "{off:?}");
}

/// Down to 100 times the tolerance the rank is full, sigma is estimated, and the rank is flagged.
fn sigma_kept_falls_with_the_distance_from_dependence(backend: BackendChoice) {
    for digits in 3..=8 {
        for column in [Near::Own, Near::Shared] {
            let system = families::near(10, 10_f64.powi(-digits), column).expect("in range").system;
            let name = format!("1e-{digits} {column:?}");
            let rank = check_sigma(&name, &system, backend);
            let least = singular_values(&system).expect("within reach")[rank - 1];
            let confidence = diagnose(&system, &Options { backend, ..Options::default() }).confidence();
            let off = confidence.sigma_kept / least;
            assert!((0.2..5.0).contains(&off), "{name}: {confidence:?}, not {least:e}");
            assert_eq!(confidence.ambiguous, digits > 5, "{name}: {confidence:?}");
        }
    }
}

/// The systems called ambiguous though their singular values are above 1e-4 or rounding.
fn doubted(options: &Options) -> Vec<&'static str> {
    let needless = |(name, scene): (&'static str, Scene)| {
        let values = singular_values(&scene.system).expect("within reach");
        let confidence = diagnose(&scene.system, options).confidence();
        let doubtful = |sigma: &f64| (ROUNDING..=1e-4).contains(&(sigma / values[0]));
        (confidence.ambiguous && !values.iter().any(doubtful)).then_some(name)
    };
    definite().into_iter().chain(steep()).filter_map(needless).collect()
}

#[test]
fn no_doubt_where_the_svd_has_none_faer() {
    assert_eq!(settings(BackendChoice::Faer).map(|options| doubted(&options)), [const { Vec::<&str>::new() }; 2]);
}

#[cfg(feature = "spqr")]
#[test]
fn no_doubt_where_the_svd_has_none_spqr() {
    assert_eq!(settings(BackendChoice::Spqr).map(|options| doubted(&options)), [const { Vec::<&str>::new() }; 2]);
}

/// `u_i - sum_{j > i} u_j = 1`, upper triangular with ones: exactly of full rank, at distance `2^-58` from a lower rank.
fn wilkinson() -> ConstraintSystem {
    let mut builder = SystemBuilder::new(60);
    for i in 0..60 {
        builder.equation((i..60).map(|j| (j, if j == i { 1.0 } else { -1.0 })), 1.0);
    }
    builder.build().expect("valid")
}

/// No pivot is small, so that a backend without column pivoting, and presolve, keep all 60 equations.
#[test]
fn only_the_check_finds_what_no_pivot_shows() {
    let system = wilkinson();
    let [.., last] = singular_values(&system).expect("within reach")[..] else { panic!("60 values") };
    assert!(last < 1e-15);
    for backend in [BackendChoice::Sparse, BackendChoice::Faer] {
        for presolve in [true, false] {
            let run = |check| {
                let analysis = diagnose(&system, &Options { backend, presolve, check, ..Options::default() });
                (analysis.rank(), analysis.confidence().ambiguous)
            };
            println!("{backend:?} presolve {presolve}: {:?} {:?}", run(true), run(false));
            assert_eq!(run(true).0, 59, "{backend:?}, presolve {presolve}");
            if presolve || backend == BackendChoice::Sparse {
                assert_eq!(run(false), (60, false), "{backend:?}, presolve {presolve}");
            }
        }
    }
}

/// The rank is the same, but one is ambiguous.
#[test]
fn without_the_check_nobody_is_told_of_a_doubt() {
    let system = families::near(10, 1e-7, Near::Own).expect("in range").system;
    for presolve in [true, false] {
        let checked = diagnose(&system, &Options { presolve, ..Options::default() });
        let unchecked = diagnose(&system, &Options { presolve, check: false, ..Options::default() });
        assert_eq!(checked.kinds(), unchecked.kinds());
        assert!(checked.confidence().ambiguous && !unchecked.confidence().ambiguous);
    }
}
