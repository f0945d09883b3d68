use std::array::from_fn;

use faer::Mat;
use faer::linalg::solvers::Solve;
use qless_constraints::types::{Average, Node6};

use super::{
    assert_balanced, cloud, dense, frame, masked, node, only, relative_residual, rigid, row, svd_rank, turned,
};
use crate::common::random;

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
