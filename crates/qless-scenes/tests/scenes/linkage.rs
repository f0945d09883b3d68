use qless::SystemBuilder;
use qless_constraints::ConstraintSet;
use qless_constraints::types::{Body, Revolute, Spherical};
use qless_scenes::families::Linkage;
use qless_scenes::oracle::{rank_free, singular_values};
use qless_scenes::{Scene, SceneError};

use crate::support::{
    assert_rank_by_singular_values, assert_satisfied, assert_truth, assert_truth_and_generated, blocks,
};

/// A chain, a ring, a ladder and nets.
fn nets(balls: bool) -> [Linkage; 7] {
    let sizes = [(1, 6, 1), (4, 1, 1), (2, 4, 3), (2, 5, 1), (3, 3, 1), (3, 5, 2), (5, 2, 1)];
    sizes.map(|(rows, columns, pitch)| Linkage { rows, columns, pitch, length: 1, balls })
}

#[test]
fn each_loop_in_the_plane_has_three_redundant_equations() -> Result<(), SceneError> {
    for (seed, net) in nets(false).into_iter().enumerate() {
        let scene = net.scene(seed as u64)?;
        assert_eq!(scene.system.equations(), 5 * (net.bodies() - 1 + net.loops()));
        assert_eq!(scene.system.dofs(), 6 * net.bodies());
        assert_eq!(scene.truth.redundant, Some(3 * net.loops()));
        assert_truth(&scene, &format!("{net:?}"));
    }
    Ok(())
}

#[test]
fn ball_joints_make_fewer_redundant() -> Result<(), SceneError> {
    for seed in 0..6 {
        for net in nets(true) {
            let scene = net.scene(seed)?;
            assert!(scene.truth.redundant <= Some(3 * net.loops()));
            assert_truth(&scene, &format!("{net:?}, seed {seed}"));
        }
    }
    let found: Vec<_> = (0..9).map(|seed| nets(true)[2].scene(seed).map(|scene| scene.truth.redundant)).collect();
    assert!([3, 1, 0].iter().all(|&count| found.contains(&Ok(Some(count)))), "{found:?}");
    Ok(())
}

/// Another unit of length multiplies coefficients by whole factors and does not change the rank.
#[test]
fn lengths_in_millimetres() -> Result<(), SceneError> {
    for net in nets(true) {
        let (small, large) = (net.scene(2)?, Linkage { length: 1000, ..net }.scene(2)?);
        assert_eq!(small.truth, large.truth);
        assert_truth(&large, &format!("{net:?}"));
        let longer = |node: &[f64; 3]| node.map(|x| 1000.0 * x);
        assert_eq!(small.nodes.iter().map(longer).collect::<Vec<_>>(), large.nodes);
    }
    Ok(())
}

#[test]
fn singular_values_agree() -> Result<(), SceneError> {
    for (net, balls) in [(2, false), (2, true), (4, true), (5, false)] {
        assert_rank_by_singular_values(&nets(balls)[net].scene(3)?, "linkage");
    }
    assert_truth_and_generated(&nets(true)[2].scene(1)?, "ring");
    Ok(())
}

#[test]
fn linkages_are_one_block() -> Result<(), SceneError> {
    for net in nets(true) {
        assert_eq!(blocks(&net.scene(4)?.system), 1, "{net:?}");
    }
    Ok(())
}

/// The rigid motion `u = a + w x x`, `theta = w`.
#[test]
fn the_whole_moves_as_one_body() -> Result<(), SceneError> {
    let scene = nets(true)[5].scene(1)?;
    let (a, w) = ([3.0, -1.0, 2.0], [0.5, 4.0, -2.0]);
    let turn = |r: [f64; 3], k: usize| w[(k + 1) % 3] * r[(k + 2) % 3] - w[(k + 2) % 3] * r[(k + 1) % 3];
    let dof = |j: usize| if j % 6 < 3 { a[j % 6] + turn(scene.nodes[j / 6], j % 6) } else { w[j % 6 - 3] };
    assert_satisfied(&scene.system, &(0..scene.system.dofs()).map(dof).collect::<Vec<_>>());
    Ok(())
}

/// The same joints as types of `qless-constraints`; their points are recovered from the equations.
fn library(
    scene: &Scene,
    joints: &[(bool, [usize; 2], [f64; 3])],
) -> Result<SystemBuilder, Box<dyn std::error::Error>> {
    let body = |k: usize| {
        let dofs = |first: usize| [0, 1, 2].map(|c| 6 * k + first + c);
        Body::with_vector(dofs(0), scene.nodes[k], dofs(3))
    };
    let mut set = ConstraintSet::builder(scene.system.dofs());
    for &(hinge, [a, b], at) in joints {
        let (a, b) = (body(a), body(b));
        if hinge {
            set.add("hinge", Revolute { a, b, at, axis: [-1.0, 2.0, 2.0] })?;
        } else {
            set.add("ball", Spherical { a, b, at })?;
        }
    }
    let set = set.build().expect("few DOFs");
    let mut quantities = set.allocate();
    set.evaluate(&vec![0.0; set.dofs()], &mut quantities).expect("of this set");
    let mut builder = SystemBuilder::new(set.dofs());
    (0..set.equations()).for_each(|row| {
        builder.equation(quantities.g().row(row), 0.0);
    });
    Ok(builder)
}

/// Kind, bodies and position of each joint, from its rows.
fn joints(scene: &Scene) -> Vec<(bool, [usize; 2], [f64; 3])> {
    let system = &scene.system;
    let starts: Vec<usize> = (0..system.equations()).filter(|&i| system.equation_label(i).ends_with(", x")).collect();
    let joint = |(k, &row): (usize, &usize)| {
        let next = starts.get(k + 1).copied().unwrap_or(system.equations());
        let dense = |row: usize, j: usize| system.matrix().row(row).find(|term| term.0 == j).map_or(0.0, |term| term.1);
        let of =
            |sign: f64| system.matrix().row(row).find(|&(j, v)| j % 6 == 0 && v == sign).map_or(0, |term| term.0 / 6);
        let a = of(1.0);
        // The row along x has theta_y r_z - theta_z r_y, that along y theta_z r_x - theta_x r_z.
        let r = [dense(row + 1, 6 * a + 5), -dense(row, 6 * a + 5), dense(row, 6 * a + 4)];
        (next - row == 5, [a, of(-1.0)], [0, 1, 2].map(|c| scene.nodes[a][c] + r[c]))
    };
    starts.iter().enumerate().map(joint).collect()
}

/// Both sets of equations span the same space: each alone has the rank of both together.
#[test]
fn joints_are_those_of_the_constraint_library() -> Result<(), Box<dyn std::error::Error>> {
    for net in [nets(true)[2], nets(true)[4], nets(false)[3]] {
        let scene = net.scene(5)?;
        let mut builder = library(&scene, &joints(&scene))?;
        let rank = |system| {
            let values = singular_values(&system).expect("within reach");
            values.iter().filter(|&&value| value > 1e-11 * values[0]).count()
        };
        let other = builder.clone().build()?;
        assert_eq!(other.equations(), scene.system.equations());
        assert_eq!(rank(other), rank_free(&scene.system).expect("within reach"));
        (0..scene.system.equations()).for_each(|i| {
            builder.equation(scene.system.matrix().row(i), 0.0);
        });
        assert_eq!(rank(builder.build()?), rank_free(&scene.system).expect("within reach"));
    }
    Ok(())
}

#[test]
fn ten_thousand_bodies() -> Result<(), SceneError> {
    let net = Linkage::with_bodies(10_000, true);
    assert_eq!((net.rows, net.bodies(), net.loops()), (58, 9976, 57 * 57));
    let scene = net.scene(1)?;
    assert_eq!((blocks(&scene.system), scene.system.dofs()), (1, 6 * 9976));
    assert_eq!(scene, net.scene(1)?);
    assert_ne!(scene.system, net.scene(2)?.system);
    let message = Linkage { pitch: 0, ..net }.scene(1).expect_err("no pitch").to_string();
    assert!(message.contains("pitch is 0"), "{message}");
    Ok(())
}
