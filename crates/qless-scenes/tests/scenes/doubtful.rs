use qless_scenes::families::{geometric_chain, recurrence, rotations, spotted_band, typed_cosines, typed_twice};
use qless_scenes::oracle::singular_values;
use qless_scenes::{Scene, SceneError};

use crate::support::{assert_truth, assert_truth_and_generated};

/// Singular values relative to the largest, descending.
fn relative(scene: &Scene) -> Vec<f64> {
    let values = singular_values(&scene.system).expect("within reach");
    values.iter().map(|sigma| sigma / values[0]).collect()
}

/// Generated and prescribed values together satisfy every equation up to rounding.
fn assert_solved(scene: &Scene) {
    let generated = scene.truth.generated.as_ref().expect("known");
    let mut u = vec![f64::NAN; scene.system.dofs()];
    generated.iter().chain(scene.system.prescribed()).for_each(|&(dof, value)| u[dof] = value);
    for (i, rest) in scene.system.matrix().times(&u).expect("a number for each DOF").into_iter().enumerate() {
        let size: f64 = scene.system.matrix().row(i).map(|(j, v)| (v * u[j]).abs()).sum();
        assert!(rest.abs() <= 1e-15 * size, "row {i}: {rest:e} of {size:e}");
    }
}

#[test]
fn geometric_chains() -> Result<(), SceneError> {
    for factor in [1.0, 0.5, 2.0, 1.01, 1.5, -3.0, 0.1] {
        for n in [2, 3, 10, 40] {
            let scene = geometric_chain(n, factor)?;
            assert_truth_and_generated(&scene, "geometric chain");
            assert_solved(&scene);
        }
    }
    for factor in [1.1, 1.5, 2.0] {
        let least = |n: usize| -> Result<f64, SceneError> { Ok(relative(&geometric_chain(n, factor)?)[n - 2]) };
        let expected = (0..10).fold(1.0, |power, _| power / factor);
        let found = least(40)? / least(30)?;
        assert!((found / expected - 1.0).abs() < 0.1, "{factor}: {found:e}, expected {expected:e}");
    }
    assert!(!geometric_chain(2000, 0.9)?.truth.ambiguous && geometric_chain(2000, 1.01)?.truth.ambiguous);
    assert_eq!(geometric_chain(2000, 2.0)?.truth.generated, None);
    Ok(())
}

/// The truth is ambiguous exactly if the smallest singular value is small: below 1e-4, within a factor of 100.
#[test]
fn steep_chains_are_ambiguous() -> Result<(), SceneError> {
    let chains = (2..60).map(|n| geometric_chain(n, 1.4)).chain((1..20).map(recurrence));
    let (mut doubted, mut sure) = (0, 0);
    for scene in chains {
        let scene = scene?;
        let least = relative(&scene)[scene.system.equations() - 1];
        if scene.truth.ambiguous {
            assert!(least < 1e-3, "{least:e}");
            doubted += 1;
        } else {
            assert!(least > 1e-6, "{least:e}");
            sure += 1;
        }
    }
    assert!(doubted > 20 && sure > 20);
    Ok(())
}

#[test]
fn recurrences() -> Result<(), SceneError> {
    for rows in [1, 2, 7, 25, 60] {
        let scene = recurrence(rows)?;
        assert_truth_and_generated(&scene, "recurrence");
        assert_solved(&scene);
    }
    assert_eq!(recurrence(3)?.truth.generated, Some(vec![(2, -4.0), (3, 15.0), (4, -56.0)]));
    let falls = relative(&recurrence(10)?)[9] / relative(&recurrence(11)?)[10];
    assert!((falls - (2.0 + 3_f64.sqrt())).abs() < 1e-3, "{falls}");
    Ok(())
}

/// `sigma_min >= 1 / n`: the singular values are those of a path.
#[test]
fn rotations_are_harmless() -> Result<(), SceneError> {
    for n in [1, 8, 9, 50, 200] {
        let scene = rotations(n)?;
        assert_truth(&scene, "rotations");
        assert!(singular_values(&scene.system).expect("within reach")[2 * n - 1] > 1.0 / n as f64);
    }
    assert_truth_and_generated(&rotations(9)?, "rotations");
    Ok(())
}

/// Eight rotations by 45 degrees are the identity.
#[test]
fn rotations_come_back() -> Result<(), SceneError> {
    let scene = rotations(8)?;
    let mut u = vec![0.6, -0.8];
    for row in 0..16 {
        let terms: Vec<_> = scene.system.matrix().row(row).collect();
        assert_eq!(terms[2], (u.len(), -1.0));
        u.push(terms[..2].iter().map(|&(j, v)| v * u[j]).sum());
    }
    assert!((u[16] - 0.6).abs() < 1e-15 && (u[17] + 0.8).abs() < 1e-15, "{u:?}");
    Ok(())
}

/// Pivots of the band without row exchanges.
fn pivots(scene: &Scene) -> Vec<f64> {
    let entry = |i: usize, j: usize| scene.system.matrix().row(i).find(|e| e.0 == j).map_or(0.0, |e| e.1);
    let mut pivots: Vec<f64> = vec![entry(0, 0)];
    for i in 1..scene.system.equations() {
        pivots.push(entry(i, i) - entry(i, i - 1) * entry(i - 1, i) / pivots[i - 1]);
    }
    pivots
}

#[test]
fn spotted_bands() -> Result<(), SceneError> {
    let mut least = f64::INFINITY;
    for seed in 0..40 {
        for n in [2, 3, 17, 150] {
            let scene = spotted_band(n, seed)?;
            assert_truth(&scene, "spotted band");
            let size = |v: &&f64| ![1.0 / 6.0, 4.0 / 6.0].contains(*v);
            assert!(scene.system.matrix().values().iter().filter(size).all(|v| [-1.0, 4.0].contains(v)));
            assert!((1..=n.div_ceil(16)).contains(&scene.system.matrix().values().iter().filter(size).count()));
            least = pivots(&scene).into_iter().map(f64::abs).fold(least, f64::min);
            assert!(relative(&scene)[n - 1] > 5e-3, "{n}, {seed}: {:e}", relative(&scene)[n - 1]);
        }
    }
    assert!((0.333..0.41).contains(&least), "{least}");
    Ok(())
}

/// Whether a number has at most `digits` significant decimal digits.
fn is_typed(value: f64, digits: usize) -> bool {
    format!("{value:.*e}", digits - 1).parse() == Ok(value)
}

/// One large singular value for each equation typed once; those of the copies have about the size of the rounding.
#[test]
fn equations_typed_twice() -> Result<(), SceneError> {
    for (seed, digits) in (0..5).flat_map(|seed| (3..=8).map(move |digits| (seed, digits))) {
        let (n, unit) = (60, 10_f64.powi(-(digits as i32)));
        let scene = typed_twice(n, digits, seed)?;
        assert_truth(&scene, "typed twice");
        let copies: Vec<usize> =
            (0..scene.system.equations()).filter(|&i| scene.system.equation_label(i).ends_with("again")).collect();
        assert_eq!(copies.len() + n, scene.system.equations());
        assert!((10..35).contains(&copies.len()) && scene.truth.ambiguous);
        assert!(copies.iter().all(|&i| scene.system.matrix().row(i).all(|(_, v)| is_typed(v, digits))));
        let values = relative(&scene);
        assert!(values[n - 1] > 0.1, "{:e}", values[n - 1]);
        assert!(values[n] < 5.0 * unit && values[values.len() - 1] > 1e-3 * unit, "{digits}: {:?}", &values[n..]);
    }
    Ok(())
}

/// 7 large singular values per pentagon, one of the size of the rounding, and two zeros.
#[test]
fn cosines_typed_with_few_digits() -> Result<(), SceneError> {
    for (seed, digits) in (0..5).flat_map(|seed| (3..=8).map(move |digits| (seed, digits))) {
        let (n, unit) = (9, 10_f64.powi(-(digits as i32)));
        let scene = typed_cosines(n, digits, seed)?;
        assert_truth(&scene, "typed cosines");
        assert_eq!(scene.truth.rank_free, Some(8 * n));
        assert!(scene.system.matrix().values().iter().all(|&v| is_typed(v, digits)));
        let values = relative(&scene);
        assert!(values[7 * n - 1] > 0.02, "{:e}", values[7 * n - 1]);
        assert!(values[7 * n] < 2.0 * unit && values[8 * n - 1] > 1e-3 * unit, "{digits}: {:?}", &values[7 * n..]);
        assert!(values[8 * n..].iter().all(|&sigma| sigma < 1e-14));
    }
    Ok(())
}

/// `sum_j C_ij x_j = n . (x_a - x_b)` is the length of rod i if n is the unit vector along it.
#[test]
fn rods_run_between_their_nodes() -> Result<(), SceneError> {
    let scene = typed_cosines(4, 6, 1)?;
    let place = |j: usize| scene.nodes[scene.dofs[j].node];
    for row in 0..scene.system.equations() {
        let terms: Vec<_> = scene.system.matrix().row(row).collect();
        let along: f64 = terms.iter().map(|&(j, v)| v * place(j)[scene.dofs[j].component as usize]).sum();
        let (a, b) = (place(terms[0].0), place(terms[terms.len() - 1].0));
        let length = ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2)).sqrt();
        assert!((along - length).abs() < 1e-5, "row {row}: {along}, {length}");
    }
    Ok(())
}

#[test]
fn sizes_that_make_no_scene_are_refused_by_name() {
    let refused = [
        (geometric_chain(1, 2.0), "n is 1; it must be from 2"),
        (geometric_chain(5, 0.0), "the factor is 0"),
        (geometric_chain(5, f64::NAN), "the factor is NaN"),
        (geometric_chain(5, 1e-310), "coefficient"),
        (recurrence(0), "rows is 0"),
        (rotations(0), "n is 0"),
        (spotted_band(1, 0), "n is 1; it must be from 2"),
        (typed_twice(5, 2, 0), "digits is 2; it must be from 3 to 8"),
        (typed_cosines(5, 9, 0), "digits is 9; it must be from 3 to 8"),
    ];
    for (result, expected) in refused {
        let message = result.expect_err(expected).to_string();
        assert!(message.contains(expected), "{message}");
    }
}
