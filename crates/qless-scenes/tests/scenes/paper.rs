use qless_scenes::paper::{FloorInput, equations_12_to_14, figure_1, figure_2, figure_5, figure_6, figure_8};
use qless_scenes::{Scene, SceneError, oracle};

use crate::support::assert_truth_and_generated;

#[test]
fn every_figure_is_as_its_truth_says() -> Result<(), SceneError> {
    let scenes = [
        ("figure 1", figure_1(0.0)?),
        ("figure 1, conflicting", figure_1(0.5)?),
        ("figure 2, star", figure_2(FloorInput::Star)?),
        ("figure 2, chain", figure_2(FloorInput::Chain)?),
        ("figure 2, accepted", figure_2(FloorInput::Accepted)?),
        ("equations 12-14", equations_12_to_14(1.0)?),
        ("equations 12-14, conflicting", equations_12_to_14(0.0)?),
        ("figure 5", figure_5(0.25)?),
        ("figure 6", figure_6(0.5)?),
        ("figure 8", figure_8()?),
    ];
    for (name, scene) in &scenes {
        assert_truth_and_generated(scene, name);
    }
    Ok(())
}

/// The ring in the middle alone has 4 equations of rank 3.
#[test]
fn figure_1_has_a_ring_of_four() -> Result<(), SceneError> {
    let scene = figure_1(0.0)?;
    let ring = ["tie D-F", "tie F-L", "tie L-I", "tie I-D"];
    let found = (0..8).filter(|&i| ring.contains(&scene.system.equation_label(i).as_str())).count();
    assert_eq!((found, scene.truth.redundant), (4, Some(2)));
    assert!((0..8).any(|i| scene.system.equation_label(i) == "tie H-C"));
    Ok(())
}

#[test]
fn figure_8_ties_the_prescribed_dofs_first_and_closes_the_ring_last() -> Result<(), SceneError> {
    let system = figure_8()?.system;
    assert_eq!(system.equation_label(0), "tie u1 - u213");
    assert_eq!(system.prescribed(), [(0, 0.0), (1, 0.0)]);
    let mut without = qless::Csr::empty(system.dofs());
    (1..15).for_each(|i| without.push_row(system.matrix().row(i)).expect("ascending"));
    assert_eq!(oracle::exact_rank(&without).expect("within reach"), 14);
    Ok(())
}

#[test]
fn generated_values_solve_figures_5_and_6() -> Result<(), SceneError> {
    let residual = |scene: &Scene| {
        let mut u = vec![0.0; scene.system.dofs()];
        let known = scene.system.prescribed().iter().chain(scene.truth.generated.iter().flatten());
        known.for_each(|&(dof, value)| u[dof] = value);
        let reached = scene.system.matrix().times(&u).expect("a number for each DOF");
        reached.iter().zip(scene.system.rhs()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    assert!(residual(&figure_5(0.7)?) < 1e-15);
    assert!(residual(&figure_6(0.7)?) < 1e-15);
    Ok(())
}
