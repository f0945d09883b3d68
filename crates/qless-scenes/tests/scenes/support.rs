use qless::ConstraintSystem;
use qless_scenes::{Scene, oracle};

/// Compares the truth of a scene with exact elimination.
pub fn assert_truth(scene: &Scene, name: &str) {
    let (system, truth) = (&scene.system, &scene.truth);
    let rank = truth.rank_free.unwrap_or_else(|| panic!("{name}: the rank is known"));
    assert_eq!(oracle::rank_free(system).expect("within reach"), rank, "{name}: rank");
    assert_eq!(truth.redundant, Some(system.equations() - rank), "{name}: redundant");
    assert_eq!(oracle::consistent(system).expect("within reach"), !truth.conflicting, "{name}: consistency");
    assert!(scene.dofs.is_empty() || scene.dofs.len() == system.dofs(), "{name}: places");
    assert!(scene.dofs.iter().all(|dof| dof.node < scene.nodes.len()), "{name}: nodes");
}

/// [`assert_truth`], and a check of the generated boundary conditions by one elimination per DOF.
pub fn assert_truth_and_generated(scene: &Scene, name: &str) {
    assert_truth(scene, name);
    if let Some(generated) = &scene.truth.generated {
        let dofs: Vec<usize> = generated.iter().map(|&(dof, _)| dof).collect();
        assert_eq!(
            oracle::generated(&scene.system).expect("within reach"),
            dofs,
            "{name}: generated boundary conditions"
        );
    }
}

/// At the true rank the dense singular values drop from above 1e-4 to rounding.
pub fn assert_rank_by_singular_values(scene: &Scene, name: &str) {
    let values = oracle::singular_values(&scene.system).expect("within reach");
    let rank = scene.truth.rank_free.unwrap_or_else(|| panic!("{name}: the rank is known"));
    let [last, next] = [rank - 1, rank].map(|k| values.get(k).map_or(0.0, |value| value / values[0]));
    assert!(last > 1e-4 && next < 1e-14, "{name}: rank {rank}, values {last:e} and {next:e}");
    assert_eq!(scene.truth.redundant, Some(scene.system.equations() - rank), "{name}: redundant");
}

/// `|C u| <= rounding of |C| |u|` in every row.
pub fn assert_satisfied(system: &ConstraintSystem, u: &[f64]) {
    for (i, rest) in system.matrix().times(u).expect("a number for each DOF").into_iter().enumerate() {
        let size: f64 = system.matrix().row(i).map(|(j, v)| (v * u[j]).abs()).sum();
        assert!(rest.abs() <= 1e-14 * size, "row {i}: {rest:e} of {size:e}");
    }
}

/// Number of connected components of rows and DOFs, without DOFs that occur in no row.
pub fn blocks(system: &ConstraintSystem) -> usize {
    let mut up: Vec<usize> = (0..system.dofs()).collect();
    let mut occurs = vec![false; system.dofs()];
    for i in 0..system.equations() {
        let mut first = None;
        for (j, _) in system.matrix().row(i) {
            occurs[j] = true;
            let (a, b) = (root(&mut up, *first.get_or_insert(j)), root(&mut up, j));
            up[a] = b;
        }
    }
    (0..system.dofs()).filter(|&j| occurs[j] && up[j] == j).count()
}

fn root(up: &mut [usize], mut j: usize) -> usize {
    while up[j] != j {
        up[j] = up[up[j]];
        j = up[j];
    }
    j
}
