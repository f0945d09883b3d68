use std::collections::HashMap;

use qless::ConstraintSystem;
use qless_scenes::fssi::{Level, Mesh, mortar, tie};
use qless_scenes::{Component, Scene, SceneError};

use crate::support::assert_truth;

/// Number of DOFs at each level.
const DOFS: [usize; 7] = [11_288, 15_592, 21_204, 26_480, 33_832, 41_372, 48_528];

fn rows(system: &ConstraintSystem, prefix: &str) -> Vec<usize> {
    (0..system.equations()).filter(|&i| system.equation_label(i).starts_with(prefix)).collect()
}

#[test]
fn table_1_is_met_at_every_level() -> Result<(), SceneError> {
    for level in Level::ALL {
        let scene = tie(&level.mesh(), 1)?;
        assert_eq!(scene.system.equations(), level.equations());
        assert_eq!(scene.truth.redundant, Some(level.redundant()));
        assert_eq!(scene.system.dofs(), DOFS[level as usize], "{level:?}");
        assert_truth(&scene, &format!("{level:?}"));
    }
    Ok(())
}

#[test]
fn every_dof_occurs_and_has_a_place() -> Result<(), SceneError> {
    for scene in [tie(&Level::P50.mesh(), 1)?, mortar(&Level::P50.mesh(), 1)?] {
        let columns = scene.system.matrix().transpose().expect("it fits");
        assert!((0..columns.rows()).all(|j| columns.row(j).len() > 0));
        assert_eq!(scene.dofs.len(), scene.system.dofs());
        let mut seen: Vec<_> = scene.dofs.iter().map(|dof| (dof.node, dof.component)).collect();
        seen.sort_unstable();
        seen.dedup();
        assert_eq!(seen.len(), scene.dofs.len());
    }
    Ok(())
}

/// Linear fields satisfy every tie and mortar row exactly (the patch test).
#[test]
fn linear_fields_satisfy_every_equation() -> Result<(), SceneError> {
    let mesh = Mesh::with_equations(2500);
    for scene in [tie(&mesh, 3)?, mortar(&mesh, 3)?, mortar(&mesh.nested(), 3)?, mortar(&mesh.deep(), 3)?] {
        let u = linear_field(&scene);
        let error = scene
            .system
            .matrix()
            .times(&u)
            .expect("a number for each DOF")
            .into_iter()
            .fold(0.0, |worst: f64, r| worst.max(r.abs()));
        assert!(error < 1e-10, "residual {error:e} of values up to 300");
    }
    Ok(())
}

fn linear_field(scene: &Scene) -> Vec<f64> {
    let value = |[x, y, z]: [f64; 3], c: Component| match c {
        Component::X => 1.0 + 2.0 * x - y + 0.5 * z,
        Component::Y => 3.0 - x + 0.25 * y + z,
        Component::Z => x + y - 2.0 * z,
        Component::Normal => 0.0,
    };
    scene
        .dofs
        .iter()
        .map(|dof| {
            let [x, y, z] = scene.nodes[dof.node];
            let radius = ((x - 50.0).powi(2) + (y - 50.0).powi(2)).sqrt();
            let part = |c| value([x, y, z], c);
            match dof.component {
                Component::Normal => ((x - 50.0) * part(Component::X) + (y - 50.0) * part(Component::Y)) / radius,
                c => part(c),
            }
        })
        .collect()
}

#[test]
fn redundancy_is_on_the_edges_alone() -> Result<(), SceneError> {
    let system = tie(&Level::P50.mesh(), 1)?.system;
    let mut seen: HashMap<Vec<(usize, u64)>, usize> = HashMap::new();
    for row in rows(&system, "tie side") {
        *seen.entry(system.matrix().row(row).map(|(j, v)| (j, v.to_bits())).collect()).or_default() += 1;
    }
    assert_eq!(seen.values().filter(|&&count| count == 2).count(), 168);
    assert!(seen.values().all(|&count| count <= 2));
    Ok(())
}

#[test]
fn mortar_rows_have_no_column_of_their_own() -> Result<(), SceneError> {
    let system = mortar(&Level::P50.mesh(), 1)?.system;
    let columns = system.matrix().transpose().expect("it fits");
    for row in rows(&system, "mortar") {
        assert!(system.matrix().row(row).all(|(j, _)| columns.row(j).len() > 1));
        assert!(system.matrix().row(row).len() <= 9 + 16, "near and far nodes around one node");
    }
    Ok(())
}

#[test]
fn mortar_has_table_1_counts_and_a_known_rank() -> Result<(), SceneError> {
    for level in Level::ALL {
        let scene = mortar(&level.mesh(), 1)?;
        assert_eq!((scene.system.equations(), scene.system.dofs()), (level.equations(), DOFS[level as usize]));
        let mesh = level.mesh();
        assert_eq!(scene.truth.redundant, Some(12 * (mesh.layers - mesh.far_layers)));
        assert_eq!(mortar(&mesh.nested(), 1)?.truth.redundant, Some(level.redundant()));
    }
    Ok(())
}

/// Singular values of the normalized mortar rows in x, descending, relative to the largest.
fn singular_values(scene: &Scene) -> Vec<f64> {
    let system = &scene.system;
    let rows: Vec<usize> =
        rows(system, "mortar").into_iter().filter(|&i| system.equation_label(i).ends_with('x')).collect();
    let mut dense = faer::Mat::<f64>::zeros(rows.len(), system.dofs());
    for (i, &row) in rows.iter().enumerate() {
        let length = system.matrix().row(row).map(|(_, v)| v * v).sum::<f64>().sqrt();
        system.matrix().row(row).for_each(|(j, v)| dense[(i, j)] = v / length);
    }
    let values = dense.singular_values().expect("the decomposition converges");
    values.iter().map(|s| s / values[0]).collect()
}

/// Each of the three components has a third of the redundant equations, behind a gap of at least 1e10.
#[test]
fn mortar_rank_is_the_number_of_singular_values_above_rounding() -> Result<(), SceneError> {
    let mesh = Mesh { columns: 10, layers: 6, far_columns: 6, far_layers: 4, rings: 2, sectors: 8, wall: 2 };
    assert_eq!((mesh.redundant_mortar(), mesh.nested().redundant_mortar()), (24, 72));
    for mesh in [mesh, mesh.nested()] {
        let values = singular_values(&mortar(&mesh, 1)?);
        let kept = values.len() - mesh.redundant_mortar() / 3;
        assert!(values[kept - 1] > 1e-4 && values[kept] < 1e-14, "{:?}", &values[kept - 1..]);
    }
    Ok(())
}

/// With a deep far field no combination of rows cancels; one per edge node is near cancellation.
#[test]
fn deep_mortar_has_small_singular_values_and_full_exact_rank() -> Result<(), SceneError> {
    let mesh = Mesh { columns: 20, layers: 6, far_columns: 7, far_layers: 8, rings: 2, sectors: 8, wall: 2 }.deep();
    let scene = mortar(&mesh, 1)?;
    assert!(scene.truth.ambiguous);
    assert_truth(&scene, "deep mortar");
    let values = singular_values(&scene);
    let kept = values.len() - 4 * mesh.layers;
    assert!(values[kept - 1] > 0.02 && values[kept] < 1e-3 && values[values.len() - 1] > 1e-6);
    Ok(())
}

#[test]
fn larger_twins_keep_their_known_redundancy() -> Result<(), SceneError> {
    let four_times = Mesh::with_equations(4 * 31_832);
    assert_eq!((four_times.equations(), four_times.redundant()), (126_728, 600));
    for equations in [300, 1000, 60_000] {
        let mesh = Mesh::with_equations(equations);
        assert_truth(&tie(&mesh, 1)?, &format!("{mesh:?}"));
        assert!(!mesh.is_nested() && mesh.nested().is_nested() && !mesh.deep().is_nested());
    }
    for equations in [30_000, 300_000, 3_000_000] {
        let found = Mesh::with_equations(equations).equations();
        assert!(found.abs_diff(equations) * 20 < equations, "{found} for {equations}");
    }
    Ok(())
}

#[test]
fn the_seed_moves_dofs_and_nothing_else() -> Result<(), SceneError> {
    let (a, b) = (tie(&Level::P50.mesh(), 1)?, tie(&Level::P50.mesh(), 2)?);
    assert_eq!(a, tie(&Level::P50.mesh(), 1)?);
    assert_ne!(a.system.matrix(), b.system.matrix());
    let row = |scene: &Scene, i: usize| {
        let mut terms: Vec<_> =
            scene.system.matrix().row(i).map(|(j, v)| (scene.system.dof_label(j), v.to_bits())).collect();
        terms.sort();
        terms
    };
    assert!((0..a.system.equations()).all(|i| row(&a, i) == row(&b, i)));
    Ok(())
}

#[test]
fn bad_meshes_are_refused_by_name() {
    let good = Level::P50.mesh();
    let refused = |mesh: Mesh| tie(&mesh, 0).expect_err("refused").to_string();
    assert!(refused(Mesh { columns: 6, ..good }).contains("columns is 6; it must be from 7"));
    assert!(refused(Mesh { sectors: 10, ..good }).contains("sectors is 10; it must be a multiple of 4"));
}
