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
