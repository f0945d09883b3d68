use qless_constraints::ConstraintSet;
use qless_constraints::types::{BeamToSolid, Face, Node6, Point, Section, Shape, Surface};

use super::faces::{SECTIONS, points, rectangle, square, used};
use super::{
    assert_balanced, assert_joined, dense, frame, masked, node, only, relative_residual, rigid, svd_rank, turned,
    values,
};
use crate::common::Outcome;

const POISSON: f64 = 0.3;

fn equations(section: Section, nodes: usize) -> usize {
    match section {
        Section::Rigid => 3 * nodes,
        Section::Plane => nodes + 3,
        Section::Mean => 6,
    }
}

/// Every section, shape, orientation, place and unit: rank, rigid motions, forces without resultant.
#[test]
fn beams_move_as_the_section() -> Outcome {
    for (seed, shape) in [Shape::Tri3, Shape::Quad4, Shape::Tri6, Shape::Quad8, Shape::Quad9].into_iter().enumerate() {
        for (scale, far) in [(1.0, 0.0), (1e-6, 0.0), (1e6, 0.0), (1.0, 1e4)] {
            let moved = |x: [f64; 3]| turned(frame(seed), x).map(|x| scale * x + far);
            let (face, beam) = (rectangle(shape, 6, moved), node(0, moved([1.2, 0.7, 0.4])));
            let count = used(&face).len();
            for section in SECTIONS {
                let set = only(81, BeamToSolid { beam, face: face.clone(), section });
                let expected = equations(section, count);
                let nodes: Vec<Node6> =
                    std::iter::once(beam).chain(face.nodes.iter().map(|&point| point.into())).collect();
                assert_joined(&format!("{shape:?} {section:?} {scale} {far}"), &set, expected, &nodes, [scale, far])?;
            }
        }
    }
    Ok(())
}

/// Translations leave nothing a million sizes away, where the coordinates themselves are rounded to a part in 1e10 of the face.
#[test]
fn far_away_translations_still_pass() {
    let shapes = [Shape::Tri3, Shape::Quad4, Shape::Tri6, Shape::Quad8, Shape::Quad9];
    for (seed, shape) in (0..20).flat_map(|seed| shapes.map(|shape| (seed, shape))) {
        for (scale, far) in [1e-6, 1.0, 1e6].into_iter().flat_map(|scale| [1e3, 1e6].map(|far| (scale, far))) {
            let moved = |x: [f64; 3]| turned(frame(seed), x).map(|x| scale * (x + far));
            let (face, beam) = (rectangle(shape, 6, moved), node(0, moved([1.2, 0.7, 0.4])));
            let nodes: Vec<Node6> = std::iter::once(beam).chain(face.nodes.iter().map(|&p| p.into())).collect();
            for section in SECTIONS {
                let set = only(81, BeamToSolid { beam, face: face.clone(), section });
                let u = rigid(81, &nodes, [1.0, -0.7, 2.0], [0.0; 3]);
                let left = relative_residual(&set, &u);
                assert!(left < 3e-14, "{shape:?} {section:?} {scale} {far}: {left}");
            }
        }
    }
}

/// `int x^p y^q dA` of a monomial over the rectangle 3 x 2 about its middle.
fn moment(p: i32, q: i32) -> f64 {
    let of = |p: i32, a: f64| (a.powi(p + 1) - (-a).powi(p + 1)) / f64::from(p + 1);
    of(p, 1.5) * of(q, 1.0)
}

/// What a beam hands over by its mean are the nodal forces of `sigma = N / A + (M_x y - M_y x) / I`: their virtual work with any
/// displacement that the faces can have is that of the stress. Linear displacements for linear faces, quadratic for others.
#[test]
fn mean_sections_hand_over_linear_stress() {
    for shape in [Shape::Tri3, Shape::Quad4, Shape::Tri6, Shape::Quad8] {
        let (face, beam) = (rectangle(shape, 6, |x| x), node(0, [1.5, 1.0, 0.0]));
        let g = dense(&only(81, BeamToSolid { beam, face: face.clone(), section: Section::Mean }));
        let [normal, about_x, about_y] = [1.3, -0.7, 2.1];
        // -C^T lambda on the nodes, with lambda the forces on the beam.
        let force = |dof: usize| -(normal * g[(2, dof)] + about_x * g[(3, dof)] + about_y * g[(4, dof)]);
        let quadratic = matches!(shape, Shape::Tri6 | Shape::Quad8);
        for (p, q) in [(0, 0), (1, 0), (0, 1), (1, 1), (2, 0), (0, 2)] {
            if p + q == 2 && !quadratic {
                continue;
            }
            let at = |node: &Point| (node.at[0] - 1.5).powi(p) * (node.at[1] - 1.0).powi(q);
            let found: f64 = used(&face).iter().map(|&i| force(face.nodes[i].dofs[2]) * at(&face.nodes[i])).sum();
            let truth = normal * moment(p, q) / moment(0, 0) + about_x * moment(p, q + 1) / moment(0, 2)
                - about_y * moment(p + 1, q) / moment(2, 0);
            assert!((found - truth).abs() < 1e-13, "{shape:?} {p} {q}: {found} {truth}");
        }
    }
}

/// Tributary areas, written out, where triangles and squares meet: a mean force gives each node `int N_i dA / A`.
#[test]
fn weights_are_tributary_areas() {
    let at = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [2.0, 0.0, 0.0]];
    let faces = vec![Face::new(Shape::Quad4, [0, 1, 2, 3]), Face::new(Shape::Tri3, [1, 4, 2])];
    let face = Surface { nodes: points(6, &at), faces };
    let centroid = [(0.5 + 0.5 * 4.0 / 3.0) / 1.5, (0.5 + 0.5 / 3.0) / 1.5, 0.0];
    let g = dense(&only(21, BeamToSolid { beam: node(0, centroid), face, section: Section::Mean }));
    for (i, area) in
        [1.0 / 4.0, 1.0 / 4.0 + 1.0 / 6.0, 1.0 / 4.0 + 1.0 / 6.0, 1.0 / 4.0, 1.0 / 6.0].into_iter().enumerate()
    {
        assert!((g[(2, 6 + 3 * i + 2)] + area / 1.5).abs() < 1e-15, "{g:?}");
    }
}

/// Pure bending, `u = k (x z, nu y z ..)`: the displacement is quadratic, the section turns by `k L` and stays plane; `Rigid`
/// does not let it contract.
#[test]
fn pure_bending_passes() {
    let (curvature, length) = (0.3, 2.0);
    for shape in [Shape::Tri6, Shape::Quad8] {
        // The section in the plane (y, z), the beam along x.
        let (face, beam) = (rectangle(shape, 6, |[y, z, _]| [length, y - 1.5, z - 1.0]), node(0, [length, 0.0, 0.0]));
        let exact = |[x, y, z]: [f64; 3]| {
            let sag = x * x + POISSON * (z * z - y * y);
            [curvature * x * z, -POISSON * curvature * y * z, -curvature / 2.0 * sag]
        };
        let mut u = vec![0.0; 81];
        for node in &face.nodes {
            (0..3).for_each(|k| u[node.dofs[k]] = exact(node.at)[k]);
        }
        // The mean of z^2 - y^2 over the section 3 x 2.
        u[2] = -curvature / 2.0 * (length * length + POISSON * (1.0 / 3.0 - 0.75));
        u[4] = curvature * length;
        let worst = |section| {
            let set = only(81, BeamToSolid { beam, face: face.clone(), section });
            values(&set, &u).iter().fold(0.0, |most: f64, c| most.max(c.abs()))
        };
        assert!(worst(Section::Mean) < 1e-14 && worst(Section::Plane) < 1e-14, "{shape:?}");
        assert!(worst(Section::Rigid) > 1e-2);
    }
}

/// A beam with hinges: what does not follow is free, and the rest is as before.
#[test]
fn hinges_leave_components_out() {
    let face = square(0, 6);
    let whole = dense(&only(18, BeamToSolid { beam: node(0, [0.5; 3]), face: face.clone(), section: Section::Mean }));
    let hinged = masked(node(0, [0.5; 3]), 0b10101);
    let part = dense(&only(18, BeamToSolid { beam: hinged, face, section: Section::Mean }));
    assert_eq!(part.nrows(), 3);
    for (row, of) in [0, 2, 4].into_iter().enumerate() {
        assert!((0..18).all(|k| part[(row, k)] == whole[(of, k)]));
    }
}

/// A hole: faces around a cylinder, which have no mean normal, follow as a rigid body or in the mean, but not as a plane.
#[test]
fn walls_of_holes_have_no_plane() {
    let ring = |z: f64| {
        (0..8).map(move |k| (std::f64::consts::TAU * f64::from(k) / 8.0).sin_cos()).map(move |(y, x)| [x, y, z])
    };
    let at: Vec<[f64; 3]> = ring(0.0).chain(ring(1.0)).collect();
    let faces = (0..8).map(|k| Face::new(Shape::Quad4, [k, (k + 1) % 8, 8 + (k + 1) % 8, 8 + k])).collect();
    let (face, beam) = (Surface { nodes: points(6, &at), faces }, node(0, [0.0, 0.0, 0.5]));
    for section in [Section::Rigid, Section::Mean] {
        let set = only(54, BeamToSolid { beam, face: face.clone(), section });
        assert_eq!(svd_rank(&set), if section == Section::Mean { 6 } else { 48 });
        let nodes: Vec<Node6> = std::iter::once(beam).chain(face.nodes.iter().map(|&point| point.into())).collect();
        assert!(relative_residual(&set, &rigid(54, &nodes, [1.0, 2.0, 3.0], [0.1, 0.2, -0.3])) < 1e-14);
        assert_balanced(&set, &nodes, 1e-14);
    }
    let mut builder = ConstraintSet::builder(54);
    let error =
        builder.add("it", BeamToSolid { beam, face, section: Section::Plane }).expect_err("no plane").to_string();
    assert!(error.contains("opposite normals"), "{error}");
}
