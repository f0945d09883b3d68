//! `rank = #{sigma_i > tolerance}` by a dense SVD of the equilibrated rows, and the distance of the kept rows from dependence.

use ::faer::Mat;
use ::faer::linalg::solvers::DenseSolveCore;
use qless::{BackendChoice, ConstraintSystem, Effort, Options, SystemBuilder, Tolerance};
use qless_scenes::families::{self, Near};
use qless_scenes::oracle::singular_values;
use qless_scenes::{Rng, Scene};

use super::scenes::{definite, steep};
use crate::support::{diagnose, settings};

on_each_backend!(
    rank_is_the_number_of_singular_values,
    distance_is_near_the_true_one,
    distance_is_near_the_dense_bound,
    distance_falls_with_nearness,
);

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

/// `1 / rho(|K| |K^-1|)` of a square K, by 200 steps of the power method.
fn dense_distance(k: &Mat<f64>) -> f64 {
    let n = k.nrows();
    let inverse = k.full_piv_lu().inverse();
    let growth = abs(k) * abs(&inverse);
    let mut v = Mat::from_fn(n, 1, |_, _| 1.0);
    let mut rho = 1.0;
    for _ in 0..200 {
        v = &growth * &v;
        rho = (0..n).map(|i| v[(i, 0)]).fold(0.0, f64::max);
        v = Mat::from_fn(n, 1, |i, _| v[(i, 0)] / rho);
    }
    1.0 / rho
}

fn abs(a: &Mat<f64>) -> Mat<f64> {
    Mat::from_fn(a.nrows(), a.ncols(), |i, j| a[(i, j)].abs())
}

/// Random square systems without triangular parts; the last row is a combination of the others up to `nearness`.
fn random_square(n: usize, nearness: f64, rng: &mut Rng) -> Mat<f64> {
    let mut k = Mat::from_fn(n, n, |_, _| rng.real() + 0.1);
    for j in 0..n {
        let sum: f64 = (0..n - 1).map(|i| (0.3 + i as f64) * k[(i, j)]).sum();
        k[(n - 1, j)] = sum * (1.0 + nearness * rng.real());
    }
    k
}

fn system_of(k: &Mat<f64>) -> ConstraintSystem {
    let mut builder = SystemBuilder::new(k.ncols());
    (0..k.nrows()).for_each(|i| _ = builder.equation((0..k.ncols()).map(|j| (j, k[(i, j)])), 0.0));
    builder.build().expect("valid")
}

/// Rohn (1989): `1 / d = max over signs S, T of rho_0(K^-1 S |K| T)`, rho_0 being the largest real eigenvalue.
fn exact_distance(k: &Mat<f64>) -> f64 {
    let n = k.nrows();
    let inverse = k.full_piv_lu().inverse();
    let sign = |signs: usize, i: usize| if signs >> i & 1 == 1 { -1.0 } else { 1.0 };
    let mut largest = 0.0_f64;
    for (s, t) in (0..1 << n).flat_map(|s| (0..1 << (n - 1)).map(move |t| (s, t))) {
        let scaled = Mat::from_fn(n, n, |i, j| sign(s, i) * k[(i, j)].abs() * sign(t, j));
        let values = (&inverse * scaled).eigenvalues().expect("small");
        let real = values.iter().filter(|value| value.im.abs() <= 1e-9 * value.re.hypot(value.im));
        largest = real.map(|value| value.re.abs()).fold(largest, f64::max);
    }
    1.0 / largest
}

/// On 500 small systems the estimate is within `10 n` of the true distance.
fn distance_is_near_the_true_one(backend: BackendChoice) {
    let mut rng = Rng::new(41);
    for seed in 0..500 {
        let n = 2 + seed % 4;
        let k = random_square(n, 10_f64.powi(-((seed / 4 % 8) as i32)), &mut rng);
        let exact = exact_distance(&k);
        for options in settings(backend) {
            let found = diagnose(&system_of(&k), &options);
            if found.rank() == n {
                let factor = found.confidence().distance / exact;
                let allowed = 10.0 * n as f64;
                assert!((1.0 / allowed..=allowed).contains(&factor), "{seed}: {factor:e} of {exact:e}, {k:?}");
            }
        }
    }
}

/// Larger systems, by the bound with the pseudoinverse.
fn distance_is_near_the_dense_bound(backend: BackendChoice) {
    let mut rng = Rng::new(42);
    for n in [10, 30, 60] {
        for digits in 0..6 {
            let k = random_square(n, 10_f64.powi(-digits), &mut rng);
            let bound = dense_distance(&k);
            for options in settings(backend) {
                let factor = diagnose(&system_of(&k), &options).confidence().distance / bound;
                assert!((0.05..50.0).contains(&factor), "{n}, 1e-{digits}: {factor:e} of {bound:e}");
            }
        }
    }
}

/// The rank is full, and in doubt from 1e-7.
fn distance_falls_with_nearness(backend: BackendChoice) {
    for digits in 3..=9 {
        for column in [Near::Own, Near::Shared] {
            let system = families::near(10, 10_f64.powi(-digits), column).expect("in range").system;
            let confidence = diagnose(&system, &Options { backend, ..Options::default() }).confidence();
            let distance = -confidence.distance.log10();
            assert!((distance - f64::from(digits)).abs() < 2.0, "1e-{digits}: {confidence:?}");
            assert!(confidence.ambiguous || digits < 7, "1e-{digits}: {confidence:?}");
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

/// `u_i - sum_{j > i} u_j = 1`, upper triangular with ones: of full rank though a singular value is `2^-58`.
#[test]
fn triangular_equations_are_independent() {
    let mut builder = SystemBuilder::new(60);
    for i in 0..60 {
        builder.equation((i..60).map(|j| (j, if j == i { 1.0 } else { -1.0 })), 1.0);
    }
    let system = builder.build().expect("valid");
    let [.., last] = singular_values(&system).expect("within reach")[..] else { panic!("60 values") };
    assert!(last < 1e-15);
    for backend in [BackendChoice::Sparse, BackendChoice::Faer] {
        let analysis = diagnose(&system, &Options { backend, ..Options::default() });
        assert_eq!((analysis.rank(), analysis.confidence().ambiguous), (60, false), "{backend:?}");
    }
}

/// The rank is the same, but one is ambiguous.
#[test]
fn without_the_check_nobody_is_told_of_a_doubt() {
    let system = families::near(10, 1e-9, Near::Shared).expect("in range").system;
    for presolve in [true, false] {
        let checked = diagnose(&system, &Options { presolve, ..Options::default() });
        let unchecked = diagnose(&system, &Options { presolve, effort: Effort::Quick, ..Options::default() });
        assert_eq!(checked.kinds(), unchecked.kinds());
        assert!(checked.confidence().ambiguous && !unchecked.confidence().ambiguous);
    }
}
