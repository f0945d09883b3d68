//! Small systems for which an earlier version gave a wrong answer without doubt. Now the answer must be right, ambiguous or an error.

mod support;

use qless::diagnosis::NoiseTerm;
use qless::{
    AnalysisError, BackendChoice, ConstraintSystem, Kind, Noise, Options, ReductionError, SystemBuilder, analyse,
};
use qless_scenes::families::{self, Windows};
use qless_scenes::{Scene, fssi, oracle};
use support::{check_reduction, diagnose, settings};

on_each_backend!(
    near_singular_chains_are_doubted,
    recurrences_are_doubted,
    spotted_bands_are_solved,
    an_ambiguous_block_beside_a_harmless_chain_is_in_doubt,
    windows_are_sure,
    weights_of_rounding_are_read_both_ways,
    values_beyond_doubles_are_refused,
);

/// The rank is that of exact arithmetic, or there is doubt.
fn right_or_doubted(name: &str, scene: &Scene, options: &Options) {
    let analysis = diagnose(&scene.system, options);
    let exact = oracle::rank_free(&scene.system).expect("within reach");
    assert!(analysis.rank() == exact || analysis.confidence().ambiguous, "{name}: {:?}", analysis.confidence());
    let refuses =
        analysis.kinds().contains(&Kind::Conflicting) && oracle::consistent(&scene.system).expect("within reach");
    assert!(!refuses || analysis.confidence().ambiguous, "{name}: conflicting for sure");
}

fn near_singular_chains_are_doubted(backend: BackendChoice) {
    for n in [500, 2000, 2500, 3000, 5000, 12_000] {
        let scene = families::geometric_chain(n, 1.01).expect("in range");
        right_or_doubted(&format!("{n} links"), &scene, &Options { backend, ..Options::default() });
    }
}

fn recurrences_are_doubted(backend: BackendChoice) {
    for rows in 2..60 {
        let scene = families::recurrence(rows).expect("in range");
        right_or_doubted(&format!("{rows} rows"), &scene, &Options { backend, ..Options::default() });
    }
}

fn spotted_bands_are_solved(backend: BackendChoice) {
    for (n, seed) in [(100, 1), (300, 2), (3000, 3)] {
        let scene = families::spotted_band(n, seed).expect("in range");
        for options in settings(backend) {
            let analysis = diagnose(&scene.system, &options);
            assert_eq!(analysis.rank(), n);
            check_reduction(&scene.system, &analysis, &analysis.reduction().expect("sound"), 1e-12);
        }
    }
}

/// The doubt of a component does not depend on the bounds of other components.
fn an_ambiguous_block_beside_a_harmless_chain_is_in_doubt(backend: BackendChoice) {
    let harmless = families::rotations(300).expect("in range");
    let doubtful = families::near(3, 1e-7, families::Near::Own).expect("in range");
    let both = doubtful.beside(&harmless).expect("apart");
    for options in settings(backend) {
        assert!(!diagnose(&harmless.system, &options).confidence().ambiguous);
        assert!(diagnose(&doubtful.system, &options).confidence().ambiguous);
        assert!(diagnose(&both.system, &options).confidence().ambiguous);
    }
}

/// 210, 460 and 1,810 equations of local windows, with a few combinations.
fn windows(nodes: usize) -> Scene {
    let windows = Windows { extent: [nodes, nodes, 1], d: 1, window: 4, stride: 2, rows: 2, combos: 10 };
    windows.scene(1).expect("in range")
}

fn windows_are_sure(backend: BackendChoice) {
    for nodes in [20, 30, 60] {
        let scene = windows(nodes);
        let analysis = diagnose(&scene.system, &Options { backend, ..Options::default() });
        assert_eq!(Some(analysis.rank()), scene.truth.rank_free, "{nodes} nodes a side");
        assert!(!analysis.confidence().ambiguous, "{nodes} nodes a side: {:?}", analysis.confidence());
    }
}

/// A tie from a search, stated twice; weights of 4.4e-15 may stand for zeros.
fn weights_of_rounding_are_read_both_ways(backend: BackendChoice) {
    let mut builder = SystemBuilder::new(80);
    for k in 0..20 {
        let (slave, a, b, c) = (k, 20 + k, 20 + (k + 1) % 20, 40 + k);
        builder.equation([(slave, 1.0), (a, -0.5), (b, -0.5)], 0.0);
        builder.equation([(slave, 2.0), (a, -1.0), (b, -1.0), (c, 20.0 * f64::EPSILON)], 0.0);
        builder.equation([(c, 1.0), (a, 0.25), (60 + k, 1.0)], 0.0);
        builder.equation([(c, 1.0), (b, 0.5), (60 + k, -1.0)], 0.0);
    }
    let system = builder.build().expect("valid");
    let places: Vec<_> = (0..20).map(|k| (4 * k + 1, 40 + k)).collect();
    let named = |terms: &[NoiseTerm]| terms.iter().map(|term| (term.row, term.dof)).collect::<Vec<_>>();
    for options in settings(backend) {
        let analysis = diagnose(&system, &options);
        let other = analysis.other_reading().expect("another rank");
        let said = (analysis.rank(), analysis.confidence().ambiguous, other.rank, other.as_zero);
        assert_eq!(said, (80, true, 60, true), "presolve {}", options.presolve);
        assert_eq!(named(&other.terms), places);
        let analysis = diagnose(&system, &Options { noise: Noise::Relative(1e-12), ..options.clone() });
        assert_eq!((analysis.rank(), analysis.confidence().ambiguous), (60, false), "presolve {}", options.presolve);
        assert_eq!(named(analysis.noise()), places);
    }
}

/// `u_0 = 1e308` and `u_1 - u_0 = 1e308`.
fn too_large() -> ConstraintSystem {
    let mut builder = SystemBuilder::new(2);
    builder.equation([(0, 1.0)], 1e308);
    builder.equation([(1, 1.0), (0, -1.0)], 1e308);
    builder.build().expect("valid")
}

fn values_beyond_doubles_are_refused(backend: BackendChoice) {
    let system = too_large();
    for options in settings(backend) {
        match analyse(&system, &options) {
            Err(error) => assert!(matches!(error, AnalysisError::Range { .. }), "{error}"),
            Ok(analysis) => {
                let refused = analysis.reduction();
                assert!(matches!(refused, Err(ReductionError::NotFinite { .. } | ReductionError::Residual { .. })));
            }
        }
    }
}

#[test]
fn equations_of_subnormal_numbers_are_refused() {
    for terms in [vec![(0, 5e-324)], vec![(0, 5e-324), (1, -5e-324)], vec![(1, 2e-308)]] {
        for b in [0.0, 1.0, 5e-324] {
            let mut builder = SystemBuilder::new(2);
            builder.equation([(0, 1.0), (1, 1.0)], 0.0);
            builder.equation(terms.clone(), b);
            let system = builder.build().expect("valid");
            let refused = analyse(&system, &Options::default());
            assert_eq!(refused.err(), Some(AnalysisError::Subnormal { row: 1 }));
        }
    }
}

/// The results for a number of threads.
fn on_threads(scene: &Scene, threads: usize, options: &Options) -> impl PartialEq + std::fmt::Debug + use<> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    pool.install(|| {
        let analysis = diagnose(&scene.system, options);
        let reduction = analysis.reduction().expect("sound");
        let (slaves, t, g) = (reduction.slaves().to_vec(), reduction.t().clone(), reduction.g().to_vec());
        (analysis.kinds().to_vec(), analysis.confidence(), slaves, t, g)
    })
}

fn same_on_any_threads(backend: BackendChoice, extent: usize, mesh: &fssi::Mesh) {
    for scene in [windows(extent), fssi::mortar(mesh, 1).expect("a scene")] {
        let options = Options { backend, ..Options::default() };
        let one = on_threads(&scene, 1, &options);
        for threads in [2, 3, 8] {
            assert!(on_threads(&scene, threads, &options) == one, "{threads} threads");
        }
    }
}

#[test]
fn results_are_the_same_bits_on_any_number_of_threads() {
    let (large, small) = (fssi::Level::P50.mesh(), fssi::Mesh::with_equations(1_500));
    same_on_any_threads(BackendChoice::Sparse, 60, &large);
    #[cfg(feature = "spqr")]
    same_on_any_threads(BackendChoice::Spqr, 60, &large);
    // Blocks are dense here, or nearly so: larger ones take minutes.
    same_on_any_threads(BackendChoice::Faer, 30, &small);
    same_on_any_threads(BackendChoice::Gauss, 30, &small);
}
