use qless_scenes::{SceneError, families, fssi, paper};

use crate::support::{assert_truth, assert_truth_and_generated};

#[test]
fn row_scales_and_order_keep_the_truth() -> Result<(), SceneError> {
    for seed in 0..5 {
        let scene = families::planted(40, 60, 10, seed, seed % 2 == 0)?;
        let (scaled, factors) = scene.scale_rows(60, seed)?;
        assert!(factors.iter().all(|f| f.log2().fract() == 0.0 && f.log2().abs() <= 60.0));
        let (shuffled, order) = scaled.shuffle(seed)?;
        assert_truth(&shuffled, "scaled and shuffled");
        for row in 0..shuffled.system.equations() {
            let mut back: Vec<_> = shuffled.system.matrix().row(row).map(|(j, v)| (order.dofs[j], v)).collect();
            back.sort_by_key(|&(j, _)| j);
            assert_eq!(back, scaled.system.matrix().row(order.rows[row]).collect::<Vec<_>>());
        }
    }
    Ok(())
}

#[test]
fn units_keep_the_solution() -> Result<(), SceneError> {
    let scene = paper::figure_6(0.5)?.scale_dofs(&[2.0, 0.5, 4.0, 1024.0, 0.25, 1.0])?;
    assert_truth_and_generated(&scene, "figure 6 in other units");
    assert_eq!(scene.system.prescribed(), [(3, 0.5 / 1024.0)]);
    assert_eq!(scene.truth.generated, Some(vec![(2, 0.125), (4, 4.0)]));
    let (shuffled, _) = scene.shuffle(1)?;
    assert_truth_and_generated(&shuffled, "figure 6 in other units, shuffled");
    Ok(())
}

#[test]
fn bad_units_are_refused() -> Result<(), SceneError> {
    let scene = families::path(3)?;
    assert!(scene.scale_dofs(&[1.0, 0.0, 1.0]).is_err());
    assert!(scene.scale_dofs(&[1.0, 1.0]).is_err());
    assert!(scene.scale_rows(1001, 0).is_err());
    Ok(())
}

#[test]
fn geometry_follows_the_shuffle() -> Result<(), SceneError> {
    let scene = fssi::tie(&fssi::Mesh::with_equations(600), 1)?;
    let (shuffled, order) = scene.shuffle(9)?;
    assert_truth(&shuffled, "shuffled twin");
    for (j, &old) in order.dofs.iter().enumerate() {
        assert_eq!(shuffled.dofs[j], scene.dofs[old]);
        assert_eq!(shuffled.system.dof_label(j), scene.system.dof_label(old));
    }
    Ok(())
}

#[test]
fn singletons_add_their_rank() -> Result<(), SceneError> {
    let scene = families::planted(40, 60, 10, 3, false)?.with_singletons(25, 3, 1)?;
    assert_eq!((scene.system.equations(), scene.system.dofs()), (75, 85));
    assert_truth(&scene, "with singletons");
    Ok(())
}

#[test]
fn prescribing_drops_what_is_no_longer_known() -> Result<(), SceneError> {
    let held = paper::figure_8()?.with_prescribed(&[(5, 1.0)])?;
    assert_eq!(held.system.prescribed(), [(0, 0.0), (1, 0.0), (5, 1.0)]);
    assert_eq!((held.truth.rank_free, &held.truth.generated), (None, &None));
    assert!(held.with_prescribed(&[(5, 2.0)]).is_err());
    Ok(())
}

#[test]
fn scenes_beside_each_other_keep_what_is_known_of_both() -> Result<(), SceneError> {
    let near = families::near(2, 1e-7, families::Near::Shared)?;
    let chain = families::geometric_chain(6, 2.0)?;
    let open = families::cycle(5, 1.0)?;
    let both = near.beside(&families::rotations(20)?)?;
    assert_truth(&both, "near dependence beside rotations");
    assert!(both.truth.ambiguous && !both.truth.conflicting);
    let solved = paper::figure_6(0.5)?.beside(&chain)?;
    assert_truth_and_generated(&solved, "figure 6 beside a chain");
    let generated = [(2, 0.5), (4, 1.0), (7, 2.0), (8, 4.0), (9, 8.0), (10, 16.0), (11, 32.0)];
    assert_eq!(solved.truth.generated, Some(generated.to_vec()));
    let mixed = both.beside(&open)?.beside(&solved)?.shuffle(5)?.0;
    assert_truth(&mixed, "four scenes, shuffled");
    assert!(mixed.truth.conflicting && mixed.truth.ambiguous);
    Ok(())
}

/// Rows of both scenes do not change, except for the DOF numbers of the second scene. Labels and places are kept.
#[test]
fn scenes_beside_each_other_share_nothing() -> Result<(), SceneError> {
    let (a, b) = (families::rbe2(3, 1, 1)?, families::rve(1)?);
    let (m, n) = (a.system.equations(), a.system.dofs());
    let both = a.beside(&b)?;
    for row in 0..m {
        assert!(both.system.matrix().row(row).eq(a.system.matrix().row(row)));
        assert_eq!(both.system.equation_label(row), a.system.equation_label(row));
    }
    for row in 0..b.system.equations() {
        assert!(both.system.matrix().row(m + row).eq(b.system.matrix().row(row).map(|(j, v)| (n + j, v))));
        assert_eq!(both.system.equation_label(m + row), b.system.equation_label(row));
    }
    assert_eq!(both.system.dof_label(0), a.system.dof_label(0));
    assert!(both.dofs.is_empty() && both.nodes.is_empty(), "rotations have no place");
    let twice = b.beside(&b)?;
    let at = |j: usize| twice.nodes[twice.dofs[j].node];
    assert!((0..b.system.dofs()).all(|j| at(j) == at(b.system.dofs() + j) && at(j) == b.nodes[b.dofs[j].node]));
    Ok(())
}
