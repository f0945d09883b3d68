use qless_scenes::{Scene, oracle};

/// Compares all that a scene's truth states with exact elimination.
pub fn assert_truth(scene: &Scene, name: &str) {
    let (system, truth) = (&scene.system, &scene.truth);
    let rank = truth.rank_free.unwrap_or_else(|| panic!("{name}: the rank is known"));
    assert_eq!(oracle::rank_free(system), rank, "{name}: rank");
    assert_eq!(truth.redundant, Some(system.equations() - rank), "{name}: redundant");
    assert_eq!(oracle::consistent(system), !truth.conflicting, "{name}: consistency");
    assert!(scene.dofs.is_empty() || scene.dofs.len() == system.dofs(), "{name}: places");
    assert!(scene.dofs.iter().all(|dof| dof.node < scene.nodes.len()), "{name}: nodes");
}

/// [`assert_truth`], and the generated boundary conditions by one elimination per DOF.
pub fn assert_truth_and_generated(scene: &Scene, name: &str) {
    assert_truth(scene, name);
    if let Some(generated) = &scene.truth.generated {
        let dofs: Vec<usize> = generated.iter().map(|&(dof, _)| dof).collect();
        assert_eq!(oracle::generated(&scene.system), dofs, "{name}: generated boundary conditions");
    }
}
