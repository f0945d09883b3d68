//! New right-hand sides without a new factorization give the results of a new run, on every backend.

#[macro_use]
mod support;

use std::sync::Arc;

use qless::change::{RefreshError, Refresher};
use qless::{
    Analysis, ArgumentError, BackendChoice, ConstraintSystem, Doubt, Kind, Noise, Options, Preferences, Reduction,
    SystemBuilder,
};
use qless_scenes::Rng;
use qless_scenes::families::{self, Windows};
use qless_scenes::fssi::{self, Mesh};
use support::{check_reduction, diagnose, settings};

on_each_backend!(
    right_hand_sides_are_those_of_a_fresh_run,
    conflicts_come_and_go,
    doubts_of_sides_come_and_go,
    prescribed_values_contradict_and_agree,
    a_kept_equation_still_wins,
    what_is_preferred_holds_for_new_values,
    a_replaced_equation_stays_redundant,
    large_sides_hide_no_conflict,
    stated_errors_of_new_sides_count,
);

fn random(rng: &mut Rng) -> f64 {
    rng.below(2001) as f64 / 1000.0 - 1.0
}

/// The same C with other right-hand sides and prescribed values.
fn with(system: &ConstraintSystem, rhs: &[f64], prescribed: &[f64]) -> ConstraintSystem {
    let values: Vec<_> = system.prescribed().iter().zip(prescribed).map(|(&(j, _), &v)| (j, v)).collect();
    ConstraintSystem::from_csr(system.matrix(), rhs, &values).expect("as valid as before")
}

/// `b = C u` for a random u, and the prescribed values in it.
fn consistent(system: &ConstraintSystem, seed: u64) -> (Vec<f64>, Vec<f64>) {
    let mut rng = Rng::new(seed);
    let u: Vec<f64> = (0..system.dofs()).map(|_| random(&mut rng)).collect();
    (
        system.matrix().times(&u).expect("a number for each DOF"),
        system.prescribed().iter().map(|&(j, _)| u[j]).collect(),
    )
}

fn largest(numbers: impl IntoIterator<Item = f64>) -> f64 {
    numbers.into_iter().fold(f64::MIN_POSITIVE, |most: f64, v| most.max(v.abs()))
}

/// Compares T, G and slaves to the last bit, g and fixed values to `1e-13` of the largest, and kinds.
fn check(system: &ConstraintSystem, options: &Options, rhs: &[f64], prescribed: &[f64]) -> (Arc<Analysis>, Reduction) {
    let analysis = Arc::new(diagnose(system, options));
    let mut reduction = analysis.reduction().expect("within the gate");
    let refresher = Refresher::new(Arc::clone(&analysis)).expect("factored");
    let refreshed = refresher.refresh(rhs, prescribed, &mut reduction).expect("valid");
    let other = with(system, rhs, prescribed);
    let fresh = diagnose(&other, options);
    let truth = fresh.reduction().expect("within the gate");
    assert_eq!((reduction.slaves(), reduction.masters()), (truth.slaves(), truth.masters()));
    assert_eq!(reduction.prescribed(), truth.prescribed());
    assert!(reduction.t() == truth.t() && reduction.g_matrix() == truth.g_matrix(), "T and G depend on C only");
    let limit = 1e-13 * largest(truth.g().iter().copied().chain(rhs.iter().copied()));
    for (i, (a, b)) in reduction.g().iter().zip(truth.g()).enumerate() {
        assert!((a - b).abs() <= limit, "g[{i}]: {a}, fresh {b}");
    }
    assert_eq!(refreshed.kinds, fresh.kinds());
    assert_eq!(refreshed.confidence.doubt, fresh.confidence().doubt);
    assert_eq!(refreshed.generated.len(), fresh.generated().len());
    for (a, b) in refreshed.generated.iter().zip(fresh.generated()) {
        assert!(a.0 == b.0 && (a.1 - b.1).abs() <= limit, "{a:?}, fresh {b:?}");
    }
    for (a, b) in refreshed.mismatches.iter().zip(fresh.dependent()) {
        assert!((a - b.mismatch).abs() <= 1e-12 * largest(rhs.iter().copied()), "{a}, fresh {}", b.mismatch);
    }
    // The results also satisfy C u = b, up to the condition number.
    check_reduction(&other, &fresh, &reduction, 1e-12_f64.max(1e-13 / fresh.confidence().distance));
    (analysis, reduction)
}

fn systems() -> Vec<ConstraintSystem> {
    let windows = Windows { extent: [14, 14, 1], d: 1, window: 4, stride: 2, rows: 2, combos: 20 };
    let scenes = [
        families::planted(120, 200, 60, 1, false),
        families::planted(60, 60, 30, 2, true),
        families::planted(80, 120, 20, 3, false).and_then(|scene| scene.with_singletons(60, 3, 1)),
        families::cycle(150, 0.0),
        families::random_graph(200, 190, 5),
        windows.scene(1),
    ];
    let systems = scenes.into_iter().map(|scene| scene.expect("a scene").system);
    systems.flat_map(|system| [prescribed(&system), system]).collect()
}

/// Prescribes every eleventh DOF.
fn prescribed(system: &ConstraintSystem) -> ConstraintSystem {
    let values: Vec<_> = (0..system.dofs()).step_by(11).map(|j| (j, 0.25)).collect();
    ConstraintSystem::from_csr(system.matrix(), system.rhs(), &values).expect("valid")
}

fn right_hand_sides_are_those_of_a_fresh_run(backend: BackendChoice) {
    for (seed, system) in systems().iter().enumerate() {
        for options in settings(backend) {
            let (rhs, values) = consistent(system, seed as u64 + 1);
            let (analysis, _) = check(system, &options, &rhs, &values);
            let refresher = Refresher::new(Arc::clone(&analysis)).expect("factored");
            let refreshed =
                refresher.refresh(&rhs, &values, &mut analysis.reduction().expect("within the gate")).expect("valid");
            assert!(!refreshed.kinds.contains(&Kind::Conflicting), "b = C u is consistent");
            // Every dependent equation conflicts.
            let wrong: Vec<f64> = (0..rhs.len()).map(|i| rhs[i] + 0.1 * (1 + i % 3) as f64).collect();
            check(system, &options, &wrong, &values);
        }
    }
}

/// An equation typed twice, with sides that differ in the last digit or do not; a doubt of the rank stays whatever the sides are.
fn doubts_of_sides_come_and_go(backend: BackendChoice) {
    let typed = |second: f64, b: f64| {
        let mut builder = SystemBuilder::new(2);
        builder.equation([(0, 1.234), (1, 5.678)], 3.0);
        builder.equation([(0, 2.468), (1, second)], b);
        builder.build().expect("valid")
    };
    for options in settings(backend) {
        let doubt = |second: f64, [b, next]: [f64; 2]| {
            let analysis = Arc::new(diagnose(&typed(second, b), &options));
            let fresh = diagnose(&typed(second, next), &options).confidence().doubt;
            let mut reduction = analysis.reduction().expect("within the gate");
            let refresher = Refresher::new(analysis).expect("factored");
            let refreshed = refresher.refresh(&[3.0, next], &[], &mut reduction).expect("valid").confidence.doubt;
            assert_eq!(refreshed, fresh);
            fresh
        };
        assert_eq!(doubt(11.356, [6.0024, 6.0]), None);
        assert_eq!(doubt(11.356, [6.0, 6.0024]), Some(Doubt::Mismatch));
        assert!(doubt(11.356 * (1.0 + 1e-9), [6.0, 1.0]).is_some_and(|doubt| doubt != Doubt::Mismatch));
    }
}

fn conflicts_come_and_go(backend: BackendChoice) {
    let system = families::planted(120, 200, 60, 1, false).expect("a scene").system;
    for options in settings(backend) {
        let analysis = Arc::new(diagnose(&system, &options));
        let mut reduction = analysis.reduction().expect("within the gate");
        let refresher = Refresher::new(Arc::clone(&analysis)).expect("factored");
        let (mut rhs, none) = consistent(&system, 9);
        let before = refresher.refresh(&rhs, &none, &mut reduction).expect("valid");
        let g = reduction.g().to_vec();
        let row = analysis.dependent()[3].row;
        rhs[row] += 0.125;
        let wrong = refresher.refresh(&rhs, &none, &mut reduction).expect("valid");
        for (i, (then, now)) in before.kinds.iter().zip(&wrong.kinds).enumerate() {
            assert_eq!(*now, if i == row { Kind::Conflicting } else { *then }, "row {i}");
        }
        assert!((wrong.mismatches[3] - before.mismatches[3] - 0.125).abs() < 1e-13);
        assert_eq!(reduction.g(), g, "an equation that is left out has no part in g");
        rhs[row] -= 0.125;
        assert_eq!(refresher.refresh(&rhs, &none, &mut reduction).expect("valid").kinds, before.kinds);
    }
}

/// `u_0 = u_1`, `u_1 = u_2 + b` with both ends prescribed: conflicting unless the values differ by b.
fn prescribed_values_contradict_and_agree(backend: BackendChoice) {
    let mut builder = SystemBuilder::new(4);
    builder.equation([(0, 1.0), (1, -1.0)], 0.0);
    builder.equation([(1, 1.0), (2, -1.0)], 0.0);
    [(0, 0.0), (2, 0.0)].into_iter().for_each(|(j, v)| builder.prescribe(j, v));
    let system = builder.build().expect("valid");
    for options in settings(backend) {
        for (values, b, truth) in
            [([1.0, 1.0], 0.0, false), ([1.0, 0.5], 0.0, true), ([1.0, 0.5], 0.5, false), ([0.0, 0.5], 0.5, true)]
        {
            let analysis = Arc::new(diagnose(&system, &options));
            let refresher = Refresher::new(Arc::clone(&analysis)).expect("factored");
            let refreshed = refresher
                .refresh(&[0.0, b], &values, &mut analysis.reduction().expect("within the gate"))
                .expect("valid");
            assert_eq!(refreshed.kinds.contains(&Kind::Conflicting), truth, "{values:?}, {b}");
            check(&system, &options, &[0.0, b], &values);
        }
    }
}

/// If an equation is to be kept, another one conflicts, and g satisfies the kept one.
fn a_kept_equation_still_wins(backend: BackendChoice) {
    for (seed, system) in systems().iter().enumerate().take(6) {
        let wanted: Vec<usize> = (0..system.equations()).rev().step_by(3).collect();
        let masters: Vec<usize> = (0..system.dofs()).step_by(2).collect();
        for preferences in [
            Preferences { equations: wanted.clone(), ..Preferences::default() },
            Preferences { masters, ..Preferences::default() },
        ] {
            for options in settings(backend) {
                let options = Options { preferences: preferences.clone(), ..options };
                let (rhs, values) = consistent(system, seed as u64 + 20);
                check(system, &options, &rhs, &values);
                let wrong: Vec<f64> = (0..rhs.len()).map(|i| rhs[i] + 0.1 * (i % 2) as f64).collect();
                check(system, &options, &wrong, &values);
            }
        }
    }
}

/// A small system with combinations of its equations, with coefficients over `decades` decades, or small integers for 0 decades; the
/// equations and masters that are preferred.
fn with_preferences(seed: u64, decades: usize) -> (ConstraintSystem, Preferences) {
    let mut rng = Rng::new(seed);
    let (n, m) = (3 + rng.below(10), 1 + rng.below(3));
    let value = |rng: &mut Rng| match (rng.below(3), decades) {
        (0, _) => 0.0,
        (_, 0) => rng.below(7) as f64 - 3.0,
        _ => random(rng) * 10_f64.powi(rng.below(decades + 1) as i32 - decades as i32 / 2),
    };
    let mut rows: Vec<Vec<f64>> = (0..m).map(|_| (0..n).map(|_| value(&mut rng)).collect()).collect();
    for _ in 0..=rng.below(2) {
        let (a, b) = (rng.below(m), rng.below(m));
        let combination = rows[a].iter().zip(&rows[b]).map(|(x, y)| 2.0 * x - y).collect();
        rows.insert(rng.below(rows.len() + 1), combination);
    }
    let mut builder = SystemBuilder::new(n);
    for row in &rows {
        builder.equation(row.iter().copied().enumerate().filter(|(_, v)| *v != 0.0), 0.0);
    }
    (0..n).filter(|_| rng.below(4) == 0).for_each(|j| builder.prescribe(j, 0.0));
    let mut some = |count: usize| (0..count).filter(|_| rng.below(2) == 0).collect();
    let preferences = Preferences { equations: some(rows.len()), masters: some(n), ..Preferences::default() };
    (builder.build().expect("valid"), preferences)
}

/// A refresh is accepted where a fresh run has a reduction, and its g leaves residuals as small.
fn what_is_preferred_holds_for_new_values(backend: BackendChoice) {
    let mut replaced = 0;
    for seed in 0..600 {
        let (system, preferences) = with_preferences(seed, [0, 3, 6, 12][seed as usize % 4]);
        for options in settings(backend) {
            let options = Options { preferences: preferences.clone(), ..options };
            let analysis = diagnose(&system, &options);
            let (rhs, values) = consistent(&system, seed);
            let fresh = diagnose(&with(&system, &rhs, &values), &options);
            let kinds = |analysis: &Analysis| -> Vec<bool> {
                analysis.kinds().iter().map(|&kind| kind == Kind::Independent).collect()
            };
            if kinds(&analysis) != kinds(&fresh) || fresh.reduction().is_err() {
                continue;
            }
            let first = diagnose(&system, &Options { preferences: Preferences::default(), ..options.clone() });
            replaced += usize::from(kinds(&first) != kinds(&analysis) && !values.is_empty());
            let Ok(mut reduction) = analysis.reduction() else { continue };
            let refreshed = Refresher::new(analysis).expect("factored").refresh(&rhs, &values, &mut reduction);
            assert!(refreshed.is_ok(), "{seed}: {refreshed:?} {system:?} {preferences:?}");
            let residual = fresh.residual(&reduction).expect("the same DOFs");
            assert!(residual <= 1e-13, "{seed}: {residual:e} {system:?} {preferences:?}");
        }
    }
    assert!(replaced > 50, "{replaced}");
}

/// A large right-hand side hides nothing about an equation that was replaced by a preferred one.
fn a_replaced_equation_stays_redundant(backend: BackendChoice) {
    let mut builder = SystemBuilder::new(3);
    builder.equation([(0, 1.0), (1, 1.0)], 1e9);
    builder.equation([(2, 1.0)], 1.0);
    builder.equation([(0, 1.0), (1, 1.0), (2, 1.0)], 1e9 + 1.0);
    let system = builder.build().expect("valid");
    for options in settings(backend) {
        let preferences = Preferences { equations: vec![0, 2], ..Preferences::default() };
        let (_, reduction) = check(&system, &Options { preferences, ..options }, system.rhs(), &[]);
        assert_eq!(reduction.expand(&[0.0], &[]).expect("one master")[2], 1.0);
    }
}

/// The third equation is a combination of the first two and off or not; the fourth has a side of 1e9 to 1e16 and is in no certificate.
/// A refresh and a new analysis find the conflict or are in doubt, and one is seldom in doubt without the other.
fn large_sides_hide_no_conflict(backend: BackendChoice) {
    let (mut found, mut differing) = ([0; 4], 0);
    for seed in 0..600 {
        let mut random = Rng::new(seed);
        let mut whole = |most: usize| random.below(2 * most + 1) as f64 - most as f64;
        let (a, c, off) = (whole(3), whole(3), whole(2) / [2.0, 2e7][seed as usize % 2]);
        let (b1, b2) = (whole(9), whole(9));
        let mut row = || (0..4).map(|_| whole(4)).collect::<Vec<f64>>();
        let (first, second, large) = (row(), row(), row());
        let third = first.iter().zip(&second).map(|(x, y)| a * x + c * y).collect();
        let mut builder = SystemBuilder::new(4);
        for row in [first, second, third, large] {
            builder.equation(row.into_iter().enumerate().filter(|(_, v)| *v != 0.0), 0.0);
        }
        let system = builder.build().expect("valid");
        let rhs = [b1, b2, a * b1 + c * b2 + off, 10_f64.powi(9 + (seed % 8) as i32)];
        for options in settings(backend) {
            let analysis = diagnose(&system, &options);
            let mut reduction = analysis.reduction().expect("within the gate");
            let refreshed = Refresher::new(analysis).expect("factored").refresh(&rhs, &[], &mut reduction);
            let refreshed = refreshed.expect("valid");
            let fresh = diagnose(&with(&system, &rhs, &[]), &options);
            if fresh.rank() < 3 {
                continue;
            }
            // Sums of whole numbers are exact, so every sure verdict must be right.
            for (kinds, doubt) in
                [(&refreshed.kinds[..], refreshed.confidence.doubt), (fresh.kinds(), fresh.confidence().doubt)]
            {
                let is_right = kinds.contains(&Kind::Conflicting) == (off != 0.0);
                assert!(is_right || doubt.is_some(), "{seed}: {system:?} {rhs:?} {kinds:?}");
                found[usize::from(doubt.is_some()) + 2 * usize::from(off != 0.0)] += 1;
            }
            differing += usize::from(refreshed.confidence.ambiguous != fresh.confidence().ambiguous);
        }
    }
    assert_eq!(found[1], 0, "consistent systems in doubt");
    assert!(found[0] > 100 && found[2] > 100 && 50 * differing < found.iter().sum(), "{found:?} {differing}");
}

fn stated_errors_of_new_sides_count(backend: BackendChoice) {
    let mut builder = SystemBuilder::new(2);
    builder.equation([(0, 1.0), (1, 1.0)], 0.0);
    builder.equation([(0, 2.0), (1, 2.0)], 0.0);
    let system = builder.build().expect("valid");
    for options in settings(backend) {
        for (noise, rhs) in [
            (Noise::Relative(1e-4), [1.0, 2.00001]),
            (Noise::Relative(1e-4), [1.0, 2.001]),
            (Noise::Floors { coefficients: vec![0.0; 2], rhs: vec![0.0, 0.25] }, [1.0, 2.125]),
            (Noise::Floors { coefficients: vec![0.0; 2], rhs: vec![0.0, 0.25] }, [1.0, 3.0]),
        ] {
            check(&system, &Options { noise, ..options.clone() }, &rhs, &[]);
        }
    }
}

/// A block that is solved by seminormal equations.
#[test]
fn large_blocks_too() {
    let system = fssi::mortar(&Mesh::with_equations(5000), 1).expect("a scene").system;
    let options = Options { backend: BackendChoice::Sparse, ..Options::default() };
    let analysis = diagnose(&system, &options);
    assert!(analysis.presolve().largest_block > 1200, "{:?}", analysis.presolve());
    let (rhs, values) = consistent(&system, 4);
    check(&system, &options, &rhs, &values);
}

#[test]
fn what_is_no_right_hand_side_is_refused() {
    let system = families::cycle(5, 0.0).expect("a scene").system;
    let analysis = diagnose(&system, &Options::default());
    let mut reduction = analysis.reduction().expect("within the gate");
    let before = reduction.g().to_vec();
    let refresher = Refresher::new(analysis).expect("factored");
    let short = refresher.refresh(&[0.0; 4], &[], &mut reduction);
    let error = ArgumentError::WrongLength { what: "the right-hand side", found: 4, expected: 5 };
    assert_eq!(short, Err(RefreshError::Argument(error)));
    let extra = refresher.refresh(&[0.0; 5], &[1.0], &mut reduction);
    let of_one = |error: &ArgumentError| matches!(error, ArgumentError::WrongLength { found: 1, expected: 0, .. });
    assert!(matches!(extra, Err(RefreshError::Argument(error)) if of_one(&error)));
    let infinite = refresher.refresh(&[0.0, 0.0, f64::INFINITY, 0.0, 0.0], &[], &mut reduction);
    let error = infinite.expect_err("not finite").to_string();
    assert_eq!(error, "the right-hand side: number 2 (from 0) is inf; give a finite number");
    assert_eq!(reduction.g(), before);
}
