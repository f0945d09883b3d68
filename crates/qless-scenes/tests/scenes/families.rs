use qless_scenes::families::{
    Near, Planted, Windows, arrow, cycle, gradient, grid_2d, incidence, ladder, near, path, planted, random_graph,
    rbe2, rve, spider,
};
use qless_scenes::{Rng, SceneError};

use crate::support::{assert_truth, assert_truth_and_generated};

#[test]
fn planted_combinations() -> Result<(), SceneError> {
    for seed in 0..20 {
        assert_truth(&planted(40, 70, 15, seed, false)?, "planted");
        assert_truth(&planted(30, 30, 9, seed, true)?, "planted, square and conflicting");
        assert_truth(&planted(1, 1, 3, seed, true)?, "planted, one row");
        let long = Planted { rows: 60, dofs: 90, combos: 10, terms: 12, conflict: false };
        assert_truth(&long.scene(seed)?, "planted, long rows");
    }
    Ok(())
}

#[test]
fn graphs() -> Result<(), SceneError> {
    assert_truth(&path(50)?, "path");
    assert_truth(&cycle(50, 0.0)?, "cycle");
    assert_truth(&cycle(50, 1e-3)?, "open cycle");
    assert_truth(&grid_2d(7, 9)?, "grid");
    for seed in 0..20 {
        assert_truth(&random_graph(60, 30 + 4 * seed as usize, seed)?, "random graph");
    }
    Ok(())
}

/// Steps that are differences of a potential are consistent; a changed step on a cycle makes them conflict.
#[test]
fn steps_around_cycles() -> Result<(), SceneError> {
    let mut rng = Rng::new(5);
    for _ in 0..50 {
        let potential: Vec<f64> = (0..20).map(|_| rng.coefficient(50)).collect();
        let pairs: Vec<_> = (0..40).map(|_| rng.distinct(2, 20).expect("few")).map(|pair| (pair[0], pair[1])).collect();
        let mut edges: Vec<_> = pairs.iter().map(|&(a, b)| (a, b, potential[a] - potential[b])).collect();
        assert_truth(&incidence(20, &edges)?, "potential");
        assert!(!incidence(20, &edges)?.truth.conflicting);
        edges[rng.below(40)].2 += 1.0;
        assert_truth(&incidence(20, &edges)?, "changed step");
    }
    Ok(())
}

#[test]
fn shapes() -> Result<(), SceneError> {
    assert_truth(&spider(30)?, "spider");
    assert_truth(&arrow(30)?, "arrow");
    assert_truth(&ladder(60)?, "ladder");
    Ok(())
}

#[test]
fn rigid_spiders() -> Result<(), SceneError> {
    for seed in 0..5 {
        for k in [3, 4, 25] {
            assert_truth_and_generated(&rbe2(k, 1, seed)?, "one master");
            assert_truth_and_generated(&rbe2(k, 2, seed)?, "two masters");
        }
    }
    Ok(())
}

#[test]
fn periodic_cells() -> Result<(), SceneError> {
    for n in [1, 2, 3, 6] {
        assert_truth(&rve(n)?, "periodic cell");
    }
    let ten = rve(10)?;
    assert_eq!((ten.system.equations(), ten.system.dofs(), ten.truth.redundant), (1089, 1815, Some(96)));
    Ok(())
}

/// The near node and the far node of each equation lie one cell length apart along its axis.
#[test]
fn periodic_pairs_face_each_other() -> Result<(), SceneError> {
    let cell = rve(3)?;
    for row in 0..cell.system.equations() {
        let place = |sign: f64| {
            let mut terms = cell.system.matrix().row(row);
            let (dof, _) = terms.find(|&(_, a)| a == sign).expect("the row has both signs");
            cell.nodes[cell.dofs[dof].node]
        };
        let (far, near) = (place(1.0), place(-1.0));
        let apart: f64 = (0..3).map(|axis| (far[axis] - near[axis]).abs()).sum();
        assert!((apart - 1.0).abs() < 1e-15, "row {row}");
    }
    Ok(())
}

#[test]
fn near_dependence() -> Result<(), SceneError> {
    for column in [Near::Own, Near::Shared] {
        for eps in [0.0, 1e-1, 1e-4, 1e-8, 1e-14, 1e-18] {
            assert_truth(&near(3, eps, column)?, "near dependence");
        }
    }
    Ok(())
}

#[test]
fn gradients() -> Result<(), SceneError> {
    for extent in [[6, 5, 1], [4, 3, 3], [9, 1, 1], [2, 2, 1]] {
        for d in 1..=3 {
            assert_truth(&gradient(extent, d, 4)?, "gradient");
        }
    }
    let (flat, solid) = (gradient([128, 128, 1], 3, 0)?.system, gradient([16, 16, 16], 3, 0)?.system);
    assert_eq!((flat.equations(), flat.dofs()), (97_536, 49_152));
    assert_eq!((solid.equations(), solid.dofs()), (34_560, 12_288));
    Ok(())
}

#[test]
fn windows() -> Result<(), SceneError> {
    for seed in 0..3 {
        let flat = Windows { extent: [12, 11, 1], d: 1, window: 4, stride: 2, rows: 2, combos: 15 };
        let solid = Windows { extent: [5, 6, 5], d: 2, window: 3, stride: 2, rows: 3, combos: 6 };
        let tight = Windows { extent: [6, 6, 1], d: 1, window: 4, stride: 2, rows: 4, combos: 5 };
        for family in [flat, solid, tight] {
            let scene = family.scene(seed)?;
            assert_eq!((scene.system.equations(), scene.system.dofs()), (family.equations(), family.dofs()));
            assert_truth(&scene, "windows");
        }
    }
    Ok(())
}

#[test]
fn sizes_that_make_no_scene_are_refused_by_name() {
    let refused = [
        (planted(5, 4, 0, 0, false).map(drop), "dofs is 4; it must be from 5"),
        (planted(5, 9, 0, 0, true).map(drop), "combos is 0; it must be from 1"),
        (path(1).map(drop), "nodes is 1"),
        (incidence(2, &[(0, 2, 0.0)]).map(drop), "an edge's node is 2"),
        (cycle(4, f64::NAN).map(drop), "right-hand side of row 3 is NaN"),
        (rbe2(2, 1, 0).map(drop), "k is 2"),
        (rve(0).map(drop), "n is 0"),
        (gradient([1, 1, 1], 1, 0).map(drop), "the number of nodes is 1"),
    ];
    for (result, expected) in refused {
        let message = result.expect_err(expected).to_string();
        assert!(message.contains(expected), "{message}");
    }
}
