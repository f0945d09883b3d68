use faer::Mat;
use qless_scenes::families::{Faces, MortarSurface, Surface};
use qless_scenes::{Component, Scene, SceneError};

use crate::support::{assert_rank_by_singular_values, assert_satisfied, assert_truth, blocks};

const SURFACES: [Surface; 4] = [Surface::Plane, Surface::Cylinder, Surface::Sphere, Surface::Waves];
const FACES: [Faces; 2] = [Faces::Quads, Faces::Triangles];

/// Each surface with each pair of face kinds, and a coarser, equal and finer master side.
fn ties(slave: [usize; 2]) -> Vec<MortarSurface> {
    let pairs = FACES.into_iter().flat_map(|slave| FACES.map(|master| (slave, master)));
    let finer = |[x, y]: [usize; 2]| [[x * 2 / 3, y - 1], [x, y], [x + 1, y + 2]];
    pairs
        .zip([0, 1, 2, 0])
        .flat_map(|((slave_faces, master_faces), ratio)| {
            let tie = |surface| MortarSurface::new(surface, slave, finer(slave)[ratio]);
            SURFACES.map(|surface| MortarSurface { slave_faces, master_faces, ..tie(surface) })
        })
        .collect()
}

/// A displacement that is linear in space.
fn linear(scene: &Scene) -> Vec<f64> {
    let value = |[x, y, z]: [f64; 3], c: Component| match c {
        Component::X => 1.0 + x - 0.5 * y + 0.25 * z,
        Component::Y => 0.5 - x + 2.0 * z,
        _ => 0.75 * y - z,
    };
    scene.dofs.iter().map(|dof| value(scene.nodes[dof.node], dof.component)).collect()
}

#[test]
fn equations_of_a_curved_tie_are_independent_but_for_the_sums() -> Result<(), SceneError> {
    for (k, tie) in ties([7, 6]).into_iter().enumerate() {
        for sums in [0, 8] {
            let scene = MortarSurface { sums, ..tie }.scene(k as u64)?;
            assert_eq!((scene.system.equations(), scene.system.dofs()), (tie.equations() + sums, tie.dofs()));
            assert_eq!(scene.truth.redundant, Some(sums));
            assert_rank_by_singular_values(&scene, &format!("{tie:?}"));
        }
    }
    for seed in 0..3 {
        let small = MortarSurface { sums: 2, ..MortarSurface::new(Surface::Waves, [6, 2], [4, 2]) };
        assert_truth(&small.scene(seed)?, "small tie");
    }
    Ok(())
}

#[test]
fn curved_ties_are_one_block() -> Result<(), SceneError> {
    for tie in ties([6, 5]) {
        assert_eq!(blocks(&tie.scene(2)?.system), 1, "{tie:?}");
    }
    Ok(())
}

/// D and M have equal row sums, so translations satisfy the equations.
#[test]
fn translations_pass() -> Result<(), SceneError> {
    for tie in ties([9, 8]) {
        let scene = tie.scene(3)?;
        for c in Component::SPACE {
            let u: Vec<f64> = scene.dofs.iter().map(|dof| f64::from(dof.component == c)).collect();
            assert_satisfied(&scene.system, &u);
        }
    }
    Ok(())
}

/// The mean over rows of `|C u|` relative to the row's `|C|`.
fn misfit(scene: &Scene) -> f64 {
    let rest = scene.system.matrix().times(&linear(scene)).expect("a number for each DOF");
    let size = |i: usize| scene.system.matrix().row(i).map(|(_, v)| v.abs()).sum::<f64>();
    rest.iter().enumerate().map(|(i, rest)| rest.abs() / size(i)).sum::<f64>() / rest.len() as f64
}

/// Linear fields satisfy the equations exactly in the plane. On curved surfaces half the element size gives a quarter of the residual.
#[test]
fn linear_fields_pass_to_the_order_of_the_mesh() -> Result<(), SceneError> {
    for (coarse, fine) in ties([12, 12]).into_iter().zip(ties([48, 48])) {
        let [coarse, fine] = [misfit(&coarse.scene(4)?), misfit(&fine.scene(4)?)];
        let order = (coarse / fine).log2() / 2.0;
        let plane = coarse.max(fine) < 1e-14;
        assert!(plane || (coarse < 0.05 && order > 1.7), "{coarse:e}, {fine:e}: order {order}");
    }
    let flat = MortarSurface::new(Surface::Plane, [5, 5], [4, 3]).scene(1)?;
    assert_satisfied(&flat.system, &linear(&flat));
    Ok(())
}

/// The axes of each node are orthonormal, so the product of the rows with their transpose is the square of D.
#[test]
fn slave_rows_are_a_mass_matrix_in_turned_axes() -> Result<(), SceneError> {
    for surface in SURFACES {
        let scene = MortarSurface::new(surface, [4, 3], [3, 3]).scene(5)?;
        let m = scene.system.equations();
        let mut turned = Mat::<f64>::zeros(m, m);
        for i in 0..m {
            scene.system.matrix().row(i).filter(|&(j, _)| j < m).for_each(|(j, v)| turned[(i, j)] = v);
        }
        let d = turned.transpose() * &turned;
        let largest = (0..m).fold(0.0, |most: f64, i| most.max(d[(i, i)]));
        // D^2 does not couple components, and is the same for all three.
        for (i, j) in (0..m).flat_map(|i| (0..m).map(move |j| (i, j))) {
            let expected = if i % 3 == j % 3 { d[(i / 3 * 3, j / 3 * 3)] } else { 0.0 };
            assert!((d[(i, j)] - expected).abs() < 1e-14 * largest, "{surface:?}: {i}, {j}");
        }
        let neighbours = (0..m).filter(|&i| d[(i, 0)].abs() > 1e-6 * largest).count();
        assert!(neighbours > 4, "{surface:?}: D is not lumped");
    }
    Ok(())
}

/// Nodes of both sides lie on the surface; the sphere has radius one.
#[test]
fn nodes_lie_on_the_surface() -> Result<(), SceneError> {
    let scene = MortarSurface::new(Surface::Sphere, [5, 5], [4, 3]).scene(1)?;
    for node in &scene.nodes {
        let square: f64 = node.iter().map(|x| x * x).sum();
        assert!((square - 1.0).abs() < 1e-14, "{node:?}");
    }
    Ok(())
}

#[test]
fn a_size_is_met_in_one_block() -> Result<(), SceneError> {
    for wanted in [300, 3000, 30_000, 300_000] {
        let tie = MortarSurface::with_equations(Surface::Sphere, wanted);
        assert!(tie.equations().abs_diff(wanted) * 8 < wanted, "{wanted}: {}", tie.equations());
    }
    let scene = MortarSurface::with_equations(Surface::Waves, 10_000).scene(1)?;
    assert_eq!((blocks(&scene.system), scene.system.equations()), (1, 9747));
    assert!(scene.system.matrix().nnz() < 100 * scene.system.equations());
    Ok(())
}

#[test]
fn the_seed_is_all_that_is_random() -> Result<(), SceneError> {
    let tie = MortarSurface { sums: 5, ..MortarSurface::new(Surface::Cylinder, [5, 4], [4, 4]) };
    assert_eq!(tie.scene(1)?, tie.scene(1)?);
    assert_ne!(tie.scene(1)?.system, tie.scene(2)?.system);
    let message = MortarSurface::new(Surface::Plane, [3, 0], [1, 1]).scene(1).expect_err("no cells").to_string();
    assert!(message.contains("cells along a side is 0"), "{message}");
    Ok(())
}
