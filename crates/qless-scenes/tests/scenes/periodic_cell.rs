use qless_scenes::families::{Edges, Faces, PeriodicCell};
use qless_scenes::oracle::singular_values;
use qless_scenes::{Scene, SceneError};

use crate::support::{assert_rank_by_singular_values, assert_satisfied, assert_truth, blocks};

/// Cells with coarser, equal and finer far faces, and both kinds of near faces.
fn cells(edges: Edges) -> Vec<PeriodicCell> {
    let sizes = [(3, 3), (3, 5), (5, 3), (4, 4), (4, 6)];
    let cell = |(near, far)| PeriodicCell::new(near, far, edges);
    let triangles = |cell: PeriodicCell| PeriodicCell { near_faces: Faces::Triangles, ..cell };
    sizes.into_iter().map(cell).flat_map(|cell| [cell, triangles(cell)]).collect()
}

/// The field `u = eps x`, and the strains.
fn affine(scene: &Scene) -> Vec<f64> {
    let strain = [0.5, -1.0, 2.0, 0.25, 0.75, -0.5];
    let [xx, yy, zz, yz, zx, xy] = strain;
    let rows = [[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]];
    let strains = scene.system.dofs() - 6;
    let value = |(j, dof): (usize, &qless_scenes::Dof)| {
        let place = scene.nodes[dof.node];
        let row = rows[j % 3];
        if j < strains { (0..3).map(|k| row[k] * place[k]).sum() } else { strain[j - strains] }
    };
    scene.dofs.iter().enumerate().map(value).collect()
}

#[test]
fn matching_edges_have_a_known_rank() -> Result<(), SceneError> {
    for (seed, cell) in cells(Edges::Matching).into_iter().enumerate() {
        let scene = cell.scene(seed as u64)?;
        assert_eq!(scene.system.equations(), cell.equations());
        assert_eq!(scene.truth.redundant, Some(3 * (3 * cell.near + 2)));
        assert_rank_by_singular_values(&scene, &format!("{cell:?}"));
        assert_truth(&scene, "periodic cell");
    }
    Ok(())
}

#[test]
fn affine_fields_are_periodic() -> Result<(), SceneError> {
    for cell in [cells(Edges::Matching), cells(Edges::Own)].concat() {
        let scene = cell.scene(7)?;
        assert_eq!(scene.system.equations(), cell.equations());
        assert_satisfied(&scene.system, &affine(&scene));
    }
    Ok(())
}

#[test]
fn strains_make_one_block_of_all() -> Result<(), SceneError> {
    for cell in [cells(Edges::Matching), cells(Edges::Own)].concat() {
        assert_eq!(blocks(&cell.scene(8)?.system), 1, "{cell:?}");
    }
    Ok(())
}

/// A node in the interior of a face has four masters, a node on an edge two, and a matching node one.
#[test]
fn weights_are_those_of_elements() -> Result<(), SceneError> {
    let [matching, own] = [Edges::Matching, Edges::Own].map(|edges| PeriodicCell::new(6, 5, edges).scene(2));
    let mut counts = [[0; 5]; 2];
    for (scene, counts) in [matching?, own?].iter().zip(&mut counts) {
        for i in 0..scene.system.equations() {
            let masters: Vec<f64> =
                scene.system.matrix().row(i).filter(|&(j, _)| j < scene.system.dofs() - 6).map(|(_, v)| -v).collect();
            counts[masters.len() - 1] += 1;
            assert!(masters.iter().all(|&weight| weight == -1.0 || (weight > 0.0 && weight <= 1.0)), "{masters:?}");
        }
    }
    assert_eq!(counts[0][1], 9 * (4 * 5 + 4), "matching edges and corners");
    assert_eq!((counts[1][1], counts[1][2]), (9 * 4, 9 * 4 * 4), "corners, edges");
    assert!(counts.iter().all(|count| count[4] > 0), "inside, four nodes of a quadrilateral: {counts:?}");
    Ok(())
}

/// The equations along the two ways around an edge differ, so fewer equations are redundant; their number depends on the meshes.
#[test]
fn edges_of_their_own_lock_more() -> Result<(), SceneError> {
    for (near, far, seed) in [(3, 3, 1), (3, 5, 2), (5, 4, 3)] {
        let cell = PeriodicCell::new(near, far, Edges::Own);
        let scene = cell.scene(seed)?;
        let values = singular_values(&scene.system).expect("within reach");
        let rank = values.iter().filter(|&&value| value > 1e-12 * values[0]).count();
        let redundant = cell.equations() - rank;
        // The number for matching edges with the number of elements of the far edges.
        let tied = 3 * (3 * far + 2);
        assert!(redundant >= 3 * 5 && redundant < tied, "{cell:?}: {redundant} of {tied} redundant");
        assert_eq!(scene.truth.rank_free, None);
    }
    Ok(())
}

#[test]
fn the_seed_places_the_nodes() -> Result<(), SceneError> {
    let cell = PeriodicCell::new(4, 5, Edges::Own);
    assert_eq!(cell.scene(1)?, cell.scene(1)?);
    assert_ne!(cell.scene(1)?.system, cell.scene(2)?.system);
    let message = PeriodicCell::new(4, 2, Edges::Own).scene(1).expect_err("too few").to_string();
    assert!(message.contains("far is 2; it must be from 3"), "{message}");
    Ok(())
}
