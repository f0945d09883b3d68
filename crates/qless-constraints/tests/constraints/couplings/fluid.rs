use std::array::from_fn;

use qless_constraints::ConstraintSet;
use qless_constraints::types::{Face, FluidNode, FluidWall, Point, Shape, Surface};

use super::{cross, dense, frame, only, svd_rank, turned, values};
use crate::common::{Outcome, random, rank};

/// A grid of `n` x `m` squares over 3 x 2.
fn grid(n: usize, m: usize, moved: impl Fn([f64; 3]) -> [f64; 3]) -> (Vec<[f64; 3]>, Vec<Face>) {
    let at = |i: usize| moved([3.0 * (i % (n + 1)) as f64 / n as f64, 2.0 * (i / (n + 1)) as f64 / m as f64, 0.0]);
    let face = |k: usize| {
        let a = k / n * (n + 1) + k % n;
        Face::new(Shape::Quad4, [a, a + 1, a + n + 2, a + n + 1])
    };
    ((0..(n + 1) * (m + 1)).map(at).collect(), (0..n * m).map(face).collect())
}

/// The structure's DOFs first, then one for each node of the fluid.
fn wall(moved: impl Fn([f64; 3]) -> [f64; 3], tolerance: f64) -> FluidWall {
    let (places, faces) = grid(2, 3, &moved);
    let nodes: Vec<Point> = (0..places.len()).map(|i| Point::new(from_fn(|k| 3 * i + k), places[i])).collect();
    let first = 3 * nodes.len();
    let (at, own) = grid(5, 2, &moved);
    let fluid = (0..at.len()).map(|i| FluidNode { normal: first + i, at: at[i] }).collect();
    FluidWall { structure: Surface { nodes, faces }, fluid, faces: own, tolerance }
}

/// A flat wall in any place and unit: `u_n` is the normal part of any linear displacement, each `u_n` is determined, and forces on it
/// reach the wall with the same resultant and moment, along the normal.
#[test]
fn flat_walls_hand_over_pressure() -> Outcome {
    for seed in 0..6 {
        for (scale, far) in [(1.0, 0.0), (1e-6, 0.0), (1e6, 0.0), (1.0, 1e4)] {
            let axes = frame(seed + 20);
            let moved = |x: [f64; 3]| turned(axes, x).map(|x| scale * x + far);
            let wall = wall(moved, 1e-9 * (scale + far));
            let normal: [f64; 3] = from_fn(|k| axes[k][2]);
            let (first, dofs) = (wall.fluid[0].normal, wall.fluid[0].normal + wall.fluid.len());
            let set = only(dofs, wall.clone());
            assert_eq!((set.equations(), svd_rank(&set), rank(&set, &vec![0.0; dofs])?), (18, 18, 18));
            // A linear displacement about the first corner.
            let field = |x: [f64; 3]| {
                let r: [f64; 3] = from_fn(|k| (x[k] - wall.fluid[0].at[k]) / scale);
                from_fn::<f64, 3, _>(|i| 0.3 + (0..3).map(|k| random(3 * i + k) * r[k]).sum::<f64>())
            };
            let mut u = vec![0.0; dofs];
            for node in &wall.structure.nodes {
                (0..3).for_each(|k| u[node.dofs[k]] = field(node.at)[k]);
            }
            for node in &wall.fluid {
                u[node.normal] = (0..3).map(|k| normal[k] * field(node.at)[k]).sum();
            }
            let tolerance = 1e-13 + 1e-14 * far;
            assert!(
                values(&set, &u).iter().all(|c| c.abs() < tolerance),
                "{seed} {scale} {far}: {:?}",
                values(&set, &u)
            );
            // Random forces on u_n; moments about the first corner.
            let g = dense(&set);
            let lambda: Vec<f64> = (0..18).map(|j| 1.0 + random(j)).collect();
            let arm = |x: [f64; 3]| from_fn::<f64, 3, _>(|k| (x[k] - wall.fluid[0].at[k]) / scale);
            let mut sums = [[0.0; 6]; 2];
            let mut add = |side: usize, at: [f64; 3], f: [f64; 3]| {
                let m = cross(arm(at), f);
                (0..3).for_each(|k| {
                    (sums[side][k], sums[side][3 + k]) = (sums[side][k] + f[k], sums[side][3 + k] + m[k]);
                });
            };
            for node in &wall.structure.nodes {
                add(0, node.at, from_fn(|k| -(0..18).map(|j| g[(j, node.dofs[k])] * lambda[j]).sum::<f64>()));
            }
            for (j, node) in wall.fluid.iter().enumerate() {
                assert_eq!(g[(j, first + j)], 1.0);
                add(1, node.at, normal.map(|n| n * lambda[j]));
            }
            assert!((0..6).all(|k| (sums[0][k] - sums[1][k]).abs() < 1e-11 + 1e-12 * far), "{sums:?}");
        }
    }
    Ok(())
}

/// A cylinder of twelve sides and a fluid of eight sides of the same height: normals are radial, rigid shifts pass.
#[test]
fn round_walls_have_radial_normals() {
    let ring = |sides: usize, z: f64| {
        (0..sides).map(move |k| {
            let (sin, cos) = (std::f64::consts::TAU * k as f64 / sides as f64).sin_cos();
            [cos, sin, z]
        })
    };
    let tube = |sides: usize| {
        let places: Vec<[f64; 3]> = ring(sides, 0.0).chain(ring(sides, 1.0)).collect();
        let face = |k: usize| Face::new(Shape::Quad4, [k, (k + 1) % sides, sides + (k + 1) % sides, sides + k]);
        (places, (0..sides).map(face).collect::<Vec<_>>())
    };
    let ((places, faces), (at, own)) = (tube(12), tube(8));
    let nodes: Vec<Point> = (0..24).map(|i| Point::new(from_fn(|k| 3 * i + k), places[i])).collect();
    let fluid: Vec<FluidNode> = (0..16).map(|i| FluidNode { normal: 72 + i, at: at[i] }).collect();
    let set = only(88, FluidWall { structure: Surface { nodes, faces }, fluid, faces: own, tolerance: 0.05 });
    assert_eq!(svd_rank(&set), 16);
    let g = dense(&set);
    for (j, [x, y, _]) in at.iter().enumerate() {
        let normal: [f64; 3] = from_fn(|k| -(0..24).map(|i| g[(j, 3 * i + k)]).sum::<f64>());
        assert!(
            (normal[0] - x).abs() < 1e-14 && (normal[1] - y).abs() < 1e-14 && normal[2].abs() < 1e-14,
            "{normal:?}"
        );
    }
}

/// Why a wall is refused.
fn refusal(wall: FluidWall) -> String {
    let mut builder = ConstraintSet::builder(100);
    builder.add("it", wall).map_or_else(|error| error.to_string(), |_| "accepted".to_owned())
}

#[test]
fn walls_with_faults_are_refused() {
    let flat = || wall(|x| x, 1e-9);
    // A box: two sides meet in a right angle along x = 1.2, and the fluid's nodes there have two normals.
    let folded = wall(|[x, y, _]| if x > 1.2 { [1.2, y, x - 1.2] } else { [x, y, 0.0] }, 1.0);
    let message = refusal(folded.clone());
    assert!(message.contains("face 2 and") && message.contains("split the wall at its edge"), "{message}");
    let sides = [[0, 1, 5, 6], [2, 3, 7, 8]].map(|side| side.map(|face: usize| folded.faces[face].clone()).to_vec());
    sides.into_iter().for_each(|faces| assert_eq!(refusal(FluidWall { faces, ..folded.clone() }), "accepted"));
    let mut turned = flat();
    turned.faces[1].nodes.reverse();
    assert!(refusal(turned).contains("reverse faces that point to the other side"));
    let mut away = flat();
    away.fluid[7].at[2] = 0.25;
    assert!(refusal(away).contains("0.25 away"), "{}", refusal(flat()));
    let mut shared = flat();
    shared.fluid[3].normal = shared.fluid[1].normal;
    assert!(refusal(shared).contains("DOF 37 of node 4, from 1, of the fluid also belongs to another"));
    assert!(refusal(FluidWall { faces: vec![], ..flat() }).contains("fluid's side: the surface has no faces"));
    let line = FluidWall { faces: vec![Face::new(Shape::Line2, [0, 1])], ..flat() };
    assert!(refusal(line).contains("is a Line2, which has no normal"));
    let missing = FluidWall { faces: vec![Face::new(Shape::Tri3, [0, 1, 99])], ..flat() };
    assert!(refusal(missing).contains("names node 99"));
    assert!(refusal(FluidWall { tolerance: f64::NAN, ..flat() }).contains("tolerance NaN"));
    assert_eq!(refusal(flat()), "accepted");
}
