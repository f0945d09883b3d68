use std::array::from_fn;

use qless_constraints::ConstraintSet;
use qless_constraints::types::{Body, Node6, RigidBody, SmallRigidBody};

use super::{cloud, cross, dense, masked, node, only, relative_residual, rigid, row, svd_rank};
use crate::common::{Outcome, random, rank};

/// Any components of any nodes: one independent equation for each, and rigid motions pass, in all units and far from the origin.
#[test]
fn rigid_bodies_take_component_lists() -> Outcome {
    for seed in 0..30 {
        for (scale, far) in [(1.0, 0.0), (1e-6, 0.0), (1e6, 0.0), (1.0, 1e5)] {
            let all = cloud(seed, 6, scale, [far, -far, far]);
            let nodes: Vec<Node6> = (1..6).map(|i| masked(all[i], 1 + (37 * seed + 11 * i) % 63)).collect();
            let count = nodes.iter().map(|node| node.dofs.iter().flatten().count()).sum();
            let set = only(36, SmallRigidBody { reference: all[0], nodes: nodes.clone() });
            assert_eq!((set.equations(), svd_rank(&set), rank(&set, &[0.0; 36])?), (count, count, count));
            let u = rigid(36, &all, [0.3 * scale, scale, -scale], [0.2, -0.4, 0.5]);
            assert!(relative_residual(&set, &u) < 1e-15, "{seed} {scale} {far}: {}", relative_residual(&set, &u));
            // Coefficients are those of the definition.
            let g = dense(&set);
            let own = nodes.iter().flat_map(|node| (0..6).filter_map(move |k| node.dofs[k].map(|dof| (node, k, dof))));
            for (i, (node, k, dof)) in own.enumerate() {
                let truth = row(k, from_fn(|axis| node.at[axis] - all[0].at[axis]));
                assert!(g[(i, dof)] == 1.0 && (0..6).all(|j| g[(i, j)] == -truth[j]), "{seed}, row {i}");
            }
        }
    }
    Ok(())
}

/// A planar frame has no other DOFs than it needs; a component that is needed and not there is named.
#[test]
fn references_may_lack_what_is_not_needed() {
    let planar = |i: usize, at: [f64; 3]| masked(node(i, at), 0b10_0011);
    let set =
        only(18, SmallRigidBody { reference: planar(0, [1.0, 2.0, 0.3]), nodes: vec![planar(2, [4.0, 6.0, 0.3])] });
    let g = set.allocate().g().clone();
    assert_eq!(g.row(0).collect::<Vec<_>>(), [(0, -1.0), (5, 4.0), (12, 1.0)]);
    assert_eq!(g.row(1).collect::<Vec<_>>(), [(1, -1.0), (5, -3.0), (13, 1.0)]);
    let mut builder = ConstraintSet::builder(18);
    let lifted = SmallRigidBody { reference: planar(0, [1.0, 2.0, 0.3]), nodes: vec![planar(2, [4.0, 6.0, 0.8])] };
    let error = builder.add("it", lifted).expect_err("needs the rotation y").to_string();
    assert!(
        error.contains("the equation \"x\" needs the rotation y of the reference, with a factor of 0.5"),
        "{error}"
    );
}

/// Finite rotations of any size, any translations, rotation vectors: every equation holds and is independent.
#[test]
fn finite_rigid_bodies_take_component_lists() -> Outcome {
    for seed in 0..20 {
        for scale in [1e-6, 1.0, 1e6] {
            let all = cloud(seed, 5, scale, [0.0; 3]);
            let body = Body::with_vector([0, 1, 2], all[0].at, [3, 4, 5]);
            let nodes: Vec<Node6> =
                (1..5).map(|i| masked(all[i], [0b111, 0b11_1111, 0b101, 0b11_1010][(i + seed) % 4])).collect();
            let count: usize = nodes.iter().map(|node| node.dofs.iter().flatten().count()).sum();
            let set = only(30, RigidBody { body, nodes });
            let (theta, shift) = (from_fn(|k| 5.0 * random(seed + 40 * k)), [2.0 * scale, -scale, 0.5 * scale]);
            let mut u = vec![0.0; 30];
            for (i, own) in all.iter().enumerate() {
                let r: [f64; 3] = from_fn(|k| own.at[k] - all[0].at[k]);
                let by = rodrigues(theta, r);
                (0..3).for_each(|k| (u[6 * i + k], u[6 * i + 3 + k]) = (shift[k] + by[k] - r[k], theta[k]));
            }
            let mut evaluation = set.allocate();
            set.evaluate(&u, &mut evaluation).expect("of this set");
            for (row, c) in evaluation.c().iter().enumerate() {
                let label = set.label(row).expect("a row");
                let size = if label.contains("turn") || label.contains("rotation") { 1.0 } else { scale };
                assert!(c.abs() < 1e-14 * size, "{seed}, {label}: {c}");
            }
            assert_eq!((set.equations(), rank(&set, &u)?), (count, count));
        }
    }
    Ok(())
}

/// `exp([theta]) r`, by its series.
fn rodrigues(theta: [f64; 3], r: [f64; 3]) -> [f64; 3] {
    let (mut sum, mut term) = (r, r);
    for k in 1..60 {
        term = cross(theta, term).map(|x| x / f64::from(k));
        sum = from_fn(|i| sum[i] + term[i]);
    }
    sum
}
