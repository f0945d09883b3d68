use std::array::from_fn;

use faer::Mat;
use faer::linalg::solvers::Solve;
use qless_constraints::ConstraintSet;
use qless_constraints::types::{
    Average, BeamToSolid, Body, Component, CouplingError, Node6, Point, RigidBody, Section, SmallRigidBody,
};

use super::{assert_balanced, cross, dense, frame, masked, node, only, relative_residual, rigid, svd_rank, turned};
use crate::linkages::{Outcome, random, rank};

/// What of a node is seen of a motion `(v, theta)` about the reference.
fn row(component: usize, r: [f64; 3]) -> [f64; 6] {
    from_fn(|j| {
        let unit: [f64; 3] = from_fn(|k| f64::from(u8::from(k == j % 3)));
        let motion = if j < 3 { unit } else { cross(unit, r) };
        if component < 3 { motion[component] } else { f64::from(u8::from(j == component)) }
    })
}

fn cloud(seed: usize, count: usize, scale: f64, centre: [f64; 3]) -> Vec<Node6> {
    let at = |i: usize| from_fn(|k| centre[k] + scale * random(100 * seed + 3 * i + k));
    (0..count).map(|i| node(i, at(i))).collect()
}

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
            let mut quantities = set.allocate();
            set.evaluate(&u, &mut quantities).expect("of this set");
            for (row, c) in quantities.c().iter().enumerate() {
                let label = set.label(row).expect("a row");
                let size = if label.contains("turn") { 1.0 } else { scale };
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

/// The rows of an average against `e_k^T (A^T W A)^-1 A^T W` of a dense solver, any components, weights, places and units.
#[test]
fn averages_are_least_squares() {
    for seed in 0..40 {
        for (scale, far) in [(1.0, 0.0), (1e-6, 0.0), (1e6, 0.0), (1.0, 1e4)] {
            let all = cloud(seed + 60, 7, scale, [far, far, -far]);
            let weights: Vec<f64> = (1..7).map(|i| (6.0 * random(31 * seed + i)).exp()).collect();
            // The first three nodes see everything, whatever the others see.
            let lead =
                |i: usize| if i < 4 { masked(all[i], 0b111) } else { masked(all[i], 1 + (29 * seed + 7 * i) % 63) };
            let nodes: Vec<(Node6, f64)> = (1..7).map(|i| (lead(i), weights[i - 1])).collect();
            let asked = 1 + (17 * seed) % 63;
            let set = only(42, Average { reference: masked(all[0], asked), nodes: nodes.clone() });
            assert_eq!((set.equations(), svd_rank(&set)), (asked.count_ones() as usize, set.equations()));
            let truth = least_squares(all[0].at, &nodes, scale);
            let (g, tolerance) = (dense(&set), 1e-12 * (1.0 + far));
            for (i, k) in (0..6).filter(|k| asked >> k & 1 == 1).enumerate() {
                // Factors of translations and of rotations, each relative to the largest.
                for kind in 0..2 {
                    let dofs = || (6..42).filter(move |dof| dof % 6 / 3 == kind);
                    let largest = dofs().fold(0.0, |most: f64, dof| most.max(truth[(k, dof)].abs()));
                    let worst = dofs().fold(0.0, |most: f64, dof| most.max((g[(i, dof)] + truth[(k, dof)]).abs()));
                    assert!(worst <= tolerance * largest, "{seed} {scale} {far} {k}: {worst} of {largest}");
                }
                assert!((0..6).all(|own| g[(i, own)] == f64::from(u8::from(own == k))));
            }
            let u = rigid(42, &all, [scale, -2.0 * scale, 0.5 * scale], [0.7, -0.3, 0.4]);
            assert!(relative_residual(&set, &u) < 1e-13, "{}", relative_residual(&set, &u));
            if asked == 63 {
                assert_balanced(&set, &all, 1e-13);
            }
        }
    }
}

/// The reference as a linear function of the DOFs, 6 x 42, lengths in `unit`.
fn least_squares(at: [f64; 3], nodes: &[(Node6, f64)], unit: f64) -> Mat<f64> {
    let arm = |node: &Node6| -> [f64; 3] { from_fn(|k| (node.at[k] - at[k]) / unit) };
    let length = |r: [f64; 3]| r.iter().map(|x| x * x).sum::<f64>().sqrt();
    let mean = nodes.iter().map(|(node, _)| length(arm(node))).sum::<f64>() / nodes.len() as f64;
    let (mut normal, mut right) = (Mat::<f64>::zeros(6, 6), Mat::<f64>::zeros(6, 42));
    for (node, weight) in nodes {
        for (k, dof) in (0..6).filter_map(|k| node.dofs[k].map(|dof| (k, dof))) {
            let (d, w) = (row(k, arm(node)), if k < 3 { *weight } else { weight * mean * mean });
            for i in 0..6 {
                (0..6).for_each(|j| normal[(i, j)] += w * d[i] * d[j]);
                // Translations are seen, and below asked for, in the unit of length.
                right[(i, dof)] += w * d[i] / if k < 3 { unit } else { 1.0 };
            }
        }
    }
    let mut motion = normal.partial_piv_lu().solve(&right);
    (0..3).for_each(|i| (0..42).for_each(|dof| motion[(i, dof)] *= unit));
    motion
}

/// Corners of a unit square, the reference in its middle: `u` is the mean, `theta_z = sum (r x u)_z / 2`, `theta_x = sum r_y u_z`.
#[test]
fn square_is_exact() {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let nodes = (0..4).map(|i| (masked(node(i + 1, [corners[i][0], corners[i][1], 2.0]), 0b111), 3.0)).collect();
    let set = only(30, Average { reference: node(0, [0.5, 0.5, 2.0]), nodes });
    let g = set.allocate().g().clone();
    for row in 0..6 {
        let mut truth = vec![(row, 1.0)];
        for (i, [x, y]) in corners.into_iter().enumerate() {
            let first = 6 * (i + 1);
            match row {
                0..3 => truth.push((first + row, -0.25)),
                3 => truth.push((first + 2, 0.5 - y)),
                4 => truth.push((first + 2, x - 0.5)),
                _ => truth.extend([(first, (y - 0.5) / 2.0), (first + 1, (0.5 - x) / 2.0)]),
            }
        }
        truth.sort_by_key(|&(dof, _)| dof);
        let found: Vec<(usize, f64)> = g.row(row).collect();
        let near = |(a, b): (&(usize, f64), &(usize, f64))| a.0 == b.0 && (a.1 - b.1).abs() < 1e-15;
        assert!(found.len() == truth.len() && found.iter().zip(&truth).all(near), "{row}: {found:?} {truth:?}");
    }
}

/// Two nodes at -1 and 1 on x with rotations: `theta_x = (t_1 + t_2) / 2`, `theta_z = (v_2 - v_1 + t_1 + t_2) / 4`.
#[test]
fn two_nodes_with_rotations_are_exact() {
    let nodes = vec![(node(1, [-1.0, 0.0, 0.0]), 1.0), (node(2, [1.0, 0.0, 0.0]), 1.0)];
    let g = dense(&only(18, Average { reference: node(0, [0.0; 3]), nodes }));
    let near = |row: usize, truth: &[(usize, f64)]| {
        let whole: f64 = (6..18).map(|dof| g[(row, dof)].abs()).sum();
        truth.iter().all(|&(dof, a)| (g[(row, dof)] + a).abs() < 1e-15)
            && (whole - truth.iter().map(|t| t.1.abs()).sum::<f64>()).abs() < 1e-14
    };
    assert!(near(3, &[(9, 0.5), (15, 0.5)]), "{g:?}");
    assert!(near(5, &[(7, -0.25), (13, 0.25), (11, 0.25), (17, 0.25)]), "{g:?}");
    assert!(near(0, &[(6, 0.5), (12, 0.5)]), "{g:?}");
}

/// Why the average of these nodes is refused.
fn refusal(reference: Node6, nodes: &[Node6]) -> Option<CouplingError> {
    let mut builder = ConstraintSet::builder(60);
    let nodes = nodes.iter().map(|&node| (node, 1.0)).collect();
    match builder.add("it", Average { reference, nodes }) {
        Ok(_) => None,
        Err(qless_constraints::AddError::Input { source, .. }) => Some(source),
        Err(error) => panic!("{error}"),
    }
}

/// Nodes in a line in any direction, place and unit: rotations are refused, and the motion named is that about the line; what the
/// line does see follows; one node that sees rotations is enough.
#[test]
fn lines_do_not_see_their_own_rotation() {
    for (seed, count) in (0..20).flat_map(|seed| [2, 3, 7].map(|count| (seed, count))) {
        for (scale, far) in [(1.0, 0.0), (1e-6, 0.0), (1e6, 0.0), (1.0, 1e6)] {
            let axes = frame(seed);
            let on = |s: f64| from_fn(|k| far * [1.0, -2.0, 0.5][k] + scale * s * axes[0][k]);
            let nodes: Vec<Node6> = (0..count).map(|i| masked(node(i + 1, on(i as f64 + random(i))), 0b111)).collect();
            let reference = node(0, on(0.77));
            for component in 3..6 {
                let Some(CouplingError::Undetermined { component: named, rotation, translation }) =
                    refusal(masked(reference, 1 << component), &nodes)
                else {
                    panic!("{seed} {count} {scale} {far}: accepted or refused for another reason")
                };
                assert_eq!(named as usize, component);
                // Far away the direction of the line is that of rounded coordinates.
                let tolerance = 1e-12 + 1e-14 * far;
                assert!(cross(rotation, axes[0]).iter().all(|x| x.abs() < tolerance), "{rotation:?} {:?}", axes[0]);
                assert!(translation.iter().all(|x| x.abs() < 1e-7), "{translation:?}");
            }
            assert_eq!(refusal(masked(reference, 0b111), &nodes), None, "{seed} {count} {scale} {far}");
            // Beside the line, translations across it and the line's offset are not seen either.
            let beside = Node6 { at: from_fn(|k| reference.at[k] + 0.3 * scale * axes[1][k]), ..reference };
            assert!(refusal(masked(beside, 0b111), &nodes).is_some());
            let mut seeing = nodes.clone();
            seeing[1] = node(2, nodes[1].at);
            assert_eq!(refusal(beside, &seeing), None);
        }
    }
}

/// Along an axis all but the rotation about it follow; nodes in one place and single nodes tell their translations.
#[test]
fn what_is_left_follows() {
    let nodes = [0.0, 1.0, 3.0].map(|x| masked(node(1 + x as usize, [x + 0.1, 0.7, -0.2]), 0b111));
    let reference = node(0, [2.1, 0.7, -0.2]);
    let rest = Component::ALL.into_iter().filter(|&component| component != Component::TurnX);
    let weighted = nodes.iter().map(|&node| (node, 2.0)).collect();
    let set = only(30, Average { reference: reference.only(rest), nodes: weighted });
    assert_eq!((set.equations(), svd_rank(&set)), (5, 5));
    // theta_z = sum (x - x_mean) v / sum (x - x_mean)^2, with x - x_mean = -4/3, -1/3, 5/3.
    let g = dense(&set);
    for (first, a) in [(6, -4.0 / 14.0), (12, -1.0 / 14.0), (24, 5.0 / 14.0)] {
        assert!((g[(4, first + 1)] + a).abs() < 1e-15 && (g[(3, first + 2)] - a).abs() < 1e-15, "{g:?}");
    }
    let one = [masked(node(1, [5.0, 6.0, 7.0]), 0b111)];
    let (here, there) = (node(0, one[0].at), node(0, [5.0, 6.0, 8.0]));
    assert_eq!(refusal(masked(here, 0b111), &one), None);
    assert_eq!(refusal(masked(there, 0b100), &one), None);
    assert!(refusal(masked(here, 0b1000), &one).is_some() && refusal(masked(there, 1), &one).is_some());
    let whole = [node(1, one[0].at)];
    assert_eq!(refusal(there, &whole), None);
    let set = only(12, Average { reference: there, nodes: vec![(whole[0], 0.1)] });
    assert!(relative_residual(&set, &rigid(12, &[there, whole[0]], [1.0, 2.0, 3.0], [0.1, 0.2, -0.3])) < 1e-14);
    // A group that is only seen along x tells no y.
    let flat = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let flat: Vec<Node6> = (0..3).map(|i| masked(node(i + 1, flat[i]), 1)).collect();
    assert!(matches!(
        refusal(masked(node(0, [0.0; 3]), 2), &flat),
        Some(CouplingError::Undetermined { component: Component::Y, .. })
    ));
}

/// A thin triangle is one as long as it is not rounding; the nearer to a line, the larger the factors.
#[test]
fn thin_groups_are_seen_until_rounding() {
    let group = |breadth: f64, far: f64| {
        let at = [[0.0, 0.0], [1.0, 0.0], [0.4, breadth]];
        let place = |i: usize| [far + at[i][0], far + at[i][1], far];
        let nodes: Vec<Node6> = (0..3).map(|i| masked(node(i + 1, place(i)), 0b111)).collect();
        refusal(masked(node(0, [far + 0.5, far, far]), 0b1000), &nodes)
    };
    for exponent in 0..7 {
        assert_eq!(group(10.0_f64.powi(-exponent), 0.0), None, "1e-{exponent}");
    }
    assert!(group(1e-10, 0.0).is_some() && group(0.0, 0.0).is_some());
    // Coordinates of 1e9 have units in the last place of 1e-7.
    assert!(group(1e-6, 1e9).is_some() && group(1e-1, 1e9).is_none());
}

/// Bodies that share n nodes: six rigid motions less what the nodes see of them is what is said twice.
#[test]
fn overlaps_are_counted() -> Outcome {
    let places = cloud(9, 8, 2.0, [0.0; 3]);
    let solid = |i: usize| masked(places[i], 0b111);
    for (shared, twice) in [(1, 0), (2, 1), (3, 3), (4, 6)] {
        let mut builder = ConstraintSet::builder(48);
        let group = |first: usize| (2..2 + shared).map(solid).chain([solid(6 + first)]).collect::<Vec<_>>();
        builder.add("one", SmallRigidBody { reference: places[0], nodes: group(0) })?;
        builder.add("two", SmallRigidBody { reference: places[1], nodes: group(1) })?;
        let set = builder.build().expect("few DOFs");
        assert_eq!(set.equations() - svd_rank(&set), twice, "{shared}");
        assert_eq!(rank(&set, &[0.0; 48])?, set.equations() - twice, "{shared}");
    }
    // The mean of nodes of a rigid body moves as the body does: with its own node as the reference, all six are said twice.
    for (reference, twice) in [(0, 6), (1, 0)] {
        let mut builder = ConstraintSet::builder(48);
        let nodes: Vec<Node6> = (2..6).map(solid).collect();
        builder.add("rigid", SmallRigidBody { reference: places[0], nodes: nodes.clone() })?;
        let nodes = nodes.into_iter().map(|node| (node, 1.5)).collect();
        builder.add("mean", Average { reference: places[reference], nodes })?;
        let set = builder.build().expect("few DOFs");
        assert_eq!((set.equations() - svd_rank(&set), set.equations() - rank(&set, &[0.0; 48])?), (twice, twice));
    }
    // The same face held by two beams.
    let face = super::solid::square(0, 12);
    for (sections, twice) in [
        ([Section::Rigid, Section::Rigid], 6),
        ([Section::Plane, Section::Plane], 1),
        ([Section::Rigid, Section::Mean], 0),
        ([Section::Mean, Section::Mean], 0),
    ] {
        let mut builder = ConstraintSet::builder(24);
        for (i, section) in sections.into_iter().enumerate() {
            let beam = node(i, [0.2, 0.4, 0.1 + i as f64]);
            builder.add("end", BeamToSolid { beam, face: face.clone(), section })?;
        }
        let set = builder.build().expect("few DOFs");
        let redundant = set.equations() - svd_rank(&set);
        assert_eq!((redundant, set.equations() - rank(&set, &[0.0; 24])?), (twice, twice), "{sections:?}");
    }
    Ok(())
}

/// The same group in another orientation has the same factors, turned.
#[test]
fn orientation_does_not_matter() {
    for seed in 0..10 {
        let (axes, all) = (frame(seed), cloud(seed + 300, 5, 2.0, [0.1, 0.2, 0.3]));
        let average = |turn: &dyn Fn([f64; 3]) -> [f64; 3]| {
            let moved: Vec<Node6> = all.iter().map(|node| Node6 { at: turn(node.at), ..*node }).collect();
            let nodes = (1..5).map(|i| (moved[i], i as f64)).collect();
            dense(&only(30, Average { reference: moved[0], nodes }))
        };
        let (here, there) = (average(&|x| x), average(&|x| turned(axes, x)));
        // T there T^T = here, with T the rotation of each triple of DOFs.
        for (a, b) in (0..2).flat_map(|a| (0..10).map(move |b| (a, b))) {
            for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
                let pairs = (0..3).flat_map(|p| (0..3).map(move |q| (p, q)));
                let back: f64 = pairs.map(|(p, q)| axes[p][i] * there[(3 * a + p, 3 * b + q)] * axes[q][j]).sum();
                assert!((back - here[(3 * a + i, 3 * b + j)]).abs() < 1e-13, "{seed}");
            }
        }
    }
}

#[test]
fn nodes_have_dofs_of_their_own() {
    let (reference, other) = (node(0, [0.0; 3]), node(1, [1.0, 0.0, 0.0]));
    let shared = Node6 { dofs: [Some(6), Some(2), None, None, None, None], ..other };
    assert_eq!(refusal(reference, &[other, shared]), Some(CouplingError::SharedDof { node: 2, dof: 2 }));
    let twice = Point::new([9; 3], [1.0; 3]).into();
    assert_eq!(refusal(reference, &[twice]), Some(CouplingError::SharedDof { node: 1, dof: 9 }));
    assert_eq!(refusal(reference, &[masked(other, 0)]), Some(CouplingError::NoComponents { node: 1 }));
    assert_eq!(refusal(masked(reference, 0), &[other]), Some(CouplingError::NoComponents { node: 0 }));
    let nowhere = Node6 { at: [f64::NAN, 0.0, 0.0], ..other };
    assert_eq!(refusal(reference, &[nowhere]), Some(CouplingError::NoPlace { node: 1 }));
}

/// Units of any size, weights of any size, references of any distance: rigid motions pass, or the input is refused.
#[test]
fn extremes_pass_or_are_refused() {
    let motion = |scale: f64| ([0.5 * scale, scale, -scale], [0.3, -0.2, 0.6]);
    for exponent in [-140, -60, -6, 0, 6, 60, 140] {
        let scale = 10.0_f64.powi(exponent);
        for (lightest, reach) in [(1.0, 1.0), (1e-300, 1.0), (1e-12, 1.0), (1.0, 1e6), (1.0, 1e-9)] {
            let mut all = cloud(800, 6, scale, [0.0; 3]);
            all[0].at = all[0].at.map(|x| reach * x);
            let weight = |i: usize| if i == 1 { lightest } else { i as f64 };
            let nodes = (1..6).map(|i| (masked(all[i], [0b11_1111, 0b111][i % 2]), weight(i))).collect();
            let set = only(36, Average { reference: all[0], nodes });
            let (shift, theta) = motion(scale);
            let u = rigid(36, &all, shift, theta);
            let worst = relative_residual(&set, &u);
            assert!(worst < 1e-12, "{exponent} {lightest} {reach}: {worst}");
        }
    }
}

/// A light node beside a line tells the rotation about it as long as its weight is not rounding of the others'.
#[test]
fn light_nodes_count_until_rounding() {
    let refused = |weight: f64| {
        let at = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.4, 1.0, 0.0]];
        let nodes = (0..3).map(|i| (masked(node(i + 1, at[i]), 0b111), if i == 2 { weight } else { 1.0 })).collect();
        let mut builder = ConstraintSet::builder(24);
        builder.add("it", Average { reference: masked(node(0, [0.5, 0.0, 0.0]), 0b1000), nodes }).is_err()
    };
    assert!(!refused(1.0) && !refused(1e-6) && !refused(1e-12) && refused(1e-24));
}

/// The order of nodes does not matter but for rounding, nor does a node that is given in two halves of its weight.
#[test]
fn order_and_halves_do_not_matter() {
    let all = cloud(900, 6, 1.0, [3.0, 2.0, 1.0]);
    let of = |nodes: Vec<(Node6, f64)>| dense(&only(36, Average { reference: all[0], nodes }));
    let lead = |i: usize| (masked(all[i], 0b111), i as f64);
    let plain = of((1..6).map(lead).collect());
    let mixed = of([5, 3, 1, 2, 4].map(lead).to_vec());
    let halves = of((1..6).flat_map(|i| [(lead(i).0, 0.5 * lead(i).1); 2]).collect());
    for (i, j) in (0..6).flat_map(|i| (0..36).map(move |j| (i, j))) {
        assert!((plain[(i, j)] - mixed[(i, j)]).abs() < 1e-14 && (plain[(i, j)] - halves[(i, j)]).abs() < 1e-14);
    }
}
