use std::array::from_fn;

use faer::sparse::SparseColMat;
use qless_constraints::enforce::Problem;
use qless_constraints::types::{
    BeamToSolid, Face, LinearEquation, Node6, Point, Section, Shape, ShellToSolid, Surface, ThicknessLine,
};
use qless_constraints::{Constraint, ConstraintSet};

use super::{assert_balanced, dense, frame, node, only, relative_residual, rigid, svd_rank, turned, values};
use crate::linkages::{Outcome, random, rank};
use crate::patch::{Block, MODULUS, POISSON};

const SECTIONS: [Section; 3] = [Section::Rigid, Section::Plane, Section::Mean];

/// Nodes with three DOFs each from `dof` on.
fn points(dof: usize, at: &[[f64; 3]]) -> Vec<Point> {
    (0..at.len()).map(|i| Point::new(from_fn(|k| dof + 3 * i + k), at[i])).collect()
}

/// A unit square at a height.
pub fn square(height: usize, dof: usize) -> Surface<3> {
    let z = height as f64;
    let corners = [[0.0, 0.0, z], [1.0, 0.0, z], [1.0, 1.0, z], [0.0, 1.0, z]];
    Surface { nodes: points(dof, &corners), faces: vec![Face::new(Shape::Quad4, [0, 1, 2, 3])] }
}

/// The rectangle 3 x 2 in faces of one shape, four of them or eight, with inner nodes off the middle where edges stay straight
/// lines and faces parallelograms (or triangles); then moved.
fn rectangle(shape: Shape, dof: usize, moved: impl Fn([f64; 3]) -> [f64; 3]) -> Surface<3> {
    let (xs, ys) = ([0.0, 0.45, 0.9, 1.95, 3.0], [0.0, 0.25, 0.5, 1.25, 2.0]);
    let quads = [[0, 0], [2, 0], [0, 2], [2, 2]];
    let of = |[i, j]: [usize; 2]| 5 * j + i;
    let around = |[i, j]: [usize; 2]| -> Vec<usize> {
        [[0, 0], [2, 0], [2, 2], [0, 2], [1, 0], [2, 1], [1, 2], [0, 1], [1, 1]]
            .map(|[a, b]| of([i + a, j + b]))
            .to_vec()
    };
    let faces = quads.into_iter().flat_map(|quad| {
        let n = around(quad);
        match shape {
            Shape::Quad4 | Shape::Quad8 => vec![Face::new(shape, &n[..shape.nodes()])],
            Shape::Tri3 => vec![Face::new(shape, [n[0], n[1], n[2]]), Face::new(shape, [n[0], n[2], n[3]])],
            _ => vec![
                Face::new(shape, [n[0], n[1], n[2], n[4], n[5], n[8]]),
                Face::new(shape, [n[0], n[2], n[3], n[8], n[6], n[7]]),
            ],
        }
    });
    let at: Vec<[f64; 3]> = (0..25).map(|i| moved([xs[i % 5], ys[i / 5], 0.0])).collect();
    Surface { faces: faces.collect(), nodes: points(dof, &at) }
}

/// Nodes that faces name.
fn used(surface: &Surface<3>) -> Vec<usize> {
    let mut used: Vec<usize> = surface.faces.iter().flat_map(|face| face.nodes.iter().copied()).collect();
    used.sort_unstable();
    used.dedup();
    used
}

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
    for (seed, shape) in [Shape::Tri3, Shape::Quad4, Shape::Tri6, Shape::Quad8].into_iter().enumerate() {
        for (scale, far) in [(1.0, 0.0), (1e-6, 0.0), (1e6, 0.0), (1.0, 1e4)] {
            let moved = |x: [f64; 3]| turned(frame(seed), x).map(|x| scale * x + far);
            let (face, beam) = (rectangle(shape, 6, moved), node(0, moved([1.2, 0.7, 0.4])));
            let count = used(&face).len();
            for section in SECTIONS {
                let set = only(81, BeamToSolid { beam, face: face.clone(), section });
                let expected = equations(section, count);
                assert_eq!((set.equations(), svd_rank(&set), rank(&set, &[0.0; 81])?), (expected, expected, expected));
                let nodes: Vec<Node6> =
                    std::iter::once(beam).chain(face.nodes.iter().map(|&point| point.into())).collect();
                let u = rigid(81, &nodes, [scale, -scale, 2.0 * scale], [0.3, -0.2, 0.5]);
                let tolerance = 1e-13 * (1.0 + far / 100.0);
                assert!(relative_residual(&set, &u) < tolerance, "{shape:?} {section:?} {scale} {far}");
                assert_balanced(&set, &nodes, tolerance);
            }
        }
    }
    Ok(())
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
    let hinged = Node6 { dofs: [Some(0), None, Some(2), None, Some(4), None], at: [0.5; 3] };
    let part = dense(&only(18, BeamToSolid { beam: hinged, face, section: Section::Mean }));
    assert_eq!(part.nrows(), 3);
    for (row, of) in [0, 2, 4].into_iter().enumerate() {
        assert!((0..18).all(|k| part[(row, k)] == whole[(of, k)]));
    }
}

/// Solves a block under the constraint with a force of one along z on `dofs`, each with its part, and supports below.
fn tension<C: Constraint>(
    cells: usize,
    constraint: C,
    loads: &[(usize, f64)],
    held: &[usize],
) -> Outcome<(Vec<f64>, Block)> {
    let block = Block { cells, z: 0.0, first: 0 };
    let solid = 3 * block.nodes().len();
    let dofs = solid + 60;
    let k = SparseColMat::try_new_from_triplets(dofs, dofs, &block.stiffness())?;
    let mut f = vec![0.0; dofs];
    loads.iter().for_each(|&(dof, force)| f[solid + dof] = force);
    let mut builder = ConstraintSet::builder(dofs);
    builder.add("top", constraint).unwrap_or_else(|error| panic!("{error}"));
    let set = builder.build().expect("few DOFs");
    // Rollers below; what holds the rigid motions within the plane; the DOFs of the frame that nothing else holds.
    let side = block.side();
    let mut fixed: Vec<usize> = (0..side * side).map(|i| 3 * i + 2).chain([0, 1, 3 * cells + 1]).collect();
    fixed.extend(held.iter().map(|dof| solid + dof));
    let held: Vec<(usize, f64)> = fixed.into_iter().map(|dof| (dof, 0.0)).collect();
    let system = set.linearised(&set.allocate(), &held)?;
    Ok((Problem::new(&k, &f, &system)?.transformation()?.u, block))
}

/// The solid's displacements are those of uniform tension; returns the largest error.
fn error_of(u: &[f64], block: &Block) -> f64 {
    let off = |node: &Point| {
        let [x, y, z] = node.at;
        let truth = [-POISSON * x, -POISSON * y, z].map(|u| u / MODULUS);
        (0..3).map(|k| (u[node.dofs[k]] - truth[k]).abs()).fold(0.0, f64::max)
    };
    block.nodes().iter().map(off).fold(0.0, f64::max)
}

/// Pure tension: a beam's force becomes uniform stress with `Mean` and `Plane`; `Rigid` holds the contraction.
#[test]
fn beam_force_becomes_uniform_tension() -> Outcome {
    for cells in [1, 3] {
        for section in SECTIONS {
            let solid = 3 * 2 * (cells + 1) * (cells + 1);
            let face = Block { cells, z: 0.0, first: 0 }.surface(1);
            let beam = Node6::new(from_fn(|k| solid + k), from_fn(|k| solid + 3 + k), [0.5, 0.5, 1.0]);
            let free: Vec<usize> = (6..60).collect();
            let (u, block) = tension(cells, BeamToSolid { beam, face, section }, &[(2, 1.0)], &free)?;
            let error = error_of(&u, &block);
            if section == Section::Rigid {
                assert!(error > 1e-2, "{error}");
            } else {
                assert!(error < 1e-13, "{section:?}: {error}");
                assert!((u[solid + 2] - 1.0 / MODULUS).abs() < 1e-13, "{section:?}: {}", u[solid + 2]);
            }
        }
    }
    Ok(())
}

/// The side of a block of `cells` x `cells` faces, lines along y with a shell node in the middle of each.
fn shell_on_block(cells: usize, dof: usize, section: Section) -> ShellToSolid {
    let (face, side) = (Block { cells, z: 0.0, first: 0 }.surface(1), cells + 1);
    let line = |i: usize| ThicknessLine {
        shell: Node6::new(
            from_fn(|k| dof + 6 * i + k),
            from_fn(|k| dof + 6 * i + 3 + k),
            [i as f64 / cells as f64, 0.5, 1.0],
        ),
        nodes: (0..side).map(|j| side * side + side * j + i).collect(),
    };
    ShellToSolid { lines: (0..side).map(line).collect(), face, section }
}

/// A line load on the edge of a shell, as its linear elements have it, becomes uniform tension in the solid.
#[test]
fn shell_force_becomes_uniform_tension() -> Outcome {
    for cells in [1, 3] {
        for section in SECTIONS {
            let solid = 3 * 2 * (cells + 1) * (cells + 1);
            let share = |i: usize| if i == 0 || i == cells { 0.5 } else { 1.0 } / cells as f64;
            let loads: Vec<(usize, f64)> = (0..=cells).map(|i| (6 * i + 2, share(i))).collect();
            // Rotations about the lines, along y, and what belongs to no shell node.
            let free: Vec<usize> = (0..=cells).map(|i| 6 * i + 4).chain(6 * (cells + 1)..60).collect();
            let (u, block) = tension(cells, shell_on_block(cells, solid, section), &loads, &free)?;
            let error = error_of(&u, &block);
            if section == Section::Rigid {
                assert!(error > 1e-2, "{error}");
            } else {
                assert!(error < 1e-13, "{section:?} {cells}: {error}");
            }
        }
    }
    Ok(())
}

/// Shells on sides of any shape, orientation, place and unit: rank, rigid motions, forces without resultant.
#[test]
fn shells_move_as_their_lines() -> Outcome {
    for (seed, shape) in [Shape::Quad4, Shape::Quad8].into_iter().enumerate() {
        for (scale, far) in [(1.0, 0.0), (1e-6, 0.0), (1e6, 0.0), (1.0, 1e4)] {
            let moved = |x: [f64; 3]| turned(frame(seed + 5), x).map(|x| scale * x + far);
            let face = rectangle(shape, 30, moved);
            let on_face = used(&face);
            let xs = [0.0, 0.45, 0.9, 1.95, 3.0];
            // Columns of nodes, of which linear faces have every second.
            let columns: Vec<usize> = (0..5).filter(|&i| on_face.contains(&i)).collect();
            let line = |&i: &usize| ThicknessLine {
                shell: node(i, moved([xs[i], 0.9, 0.2])),
                nodes: (0..5).map(|j| 5 * j + i).filter(|node| on_face.contains(node)).collect(),
            };
            let lines: Vec<ThicknessLine> = columns.iter().map(line).collect();
            for section in SECTIONS {
                let expected = lines.iter().map(|line| match section {
                    Section::Rigid => 3 * line.nodes.len(),
                    Section::Plane => 2 * line.nodes.len() + 1,
                    Section::Mean => 5,
                });
                let expected: usize = expected.sum();
                let set = only(105, ShellToSolid { lines: lines.clone(), face: face.clone(), section });
                assert_eq!((set.equations(), svd_rank(&set), rank(&set, &[0.0; 105])?), (expected, expected, expected));
                let shells = lines.iter().map(|line| line.shell);
                let nodes: Vec<Node6> = shells.chain(face.nodes.iter().map(|&point| point.into())).collect();
                let u = rigid(105, &nodes, [scale, -scale, 2.0 * scale], [0.3, -0.2, 0.5]);
                let tolerance = 1e-13 * (1.0 + far / 100.0);
                assert!(relative_residual(&set, &u) < tolerance, "{shape:?} {section:?} {scale} {far}");
                assert_balanced(&set, &nodes, tolerance);
            }
        }
    }
    Ok(())
}

/// One Quad8 of side 2: a stress of one gives corners -1/3 and middles 4/3 of it, a stress of z 1/9 and 4/9. So lines at the ends
/// have weights (-1/2, 2, -1/2), and all turn as their ends do.
#[test]
fn quadratic_lines_are_exact() {
    let at = [
        [-1.0, 0.0, -1.0],
        [1.0, 0.0, -1.0],
        [1.0, 0.0, 1.0],
        [-1.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
        [1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0],
        [-1.0, 0.0, 0.0],
    ];
    let face = Surface { nodes: points(18, &at), faces: vec![Face::new(Shape::Quad8, from_fn::<_, 8, _>(|k| k))] };
    let line =
        |i: usize, x: f64, nodes: &[usize]| ThicknessLine { shell: node(i, [x, 0.0, 0.0]), nodes: nodes.to_vec() };
    let lines = vec![line(0, -1.0, &[0, 7, 3]), line(1, 0.0, &[4, 6]), line(2, 1.0, &[2, 5, 1])];
    let g = dense(&only(42, ShellToSolid { lines, face, section: Section::Mean }));
    let weights: [&[(usize, f64)]; 3] =
        [&[(0, -0.5), (7, 2.0), (3, -0.5)], &[(4, 0.5), (6, 0.5)], &[(2, -0.5), (5, 2.0), (1, -0.5)]];
    let ends = [[0, 3], [4, 6], [1, 2]];
    for line in 0..3 {
        for axis in 0..3 {
            let row = 5 * line + axis;
            for &(node, w) in weights[line] {
                assert!((g[(row, 18 + 3 * node + axis)] - w).abs() < 1e-14, "{line} {axis} {node}");
            }
            assert!((g[(row, 6 * line + axis)] + 1.0).abs() < 1e-14);
        }
        // Rows of the rotations: e . (u_top - u_bottom) / 2 = (d x ..) . theta, whatever e is and whichever end is the top.
        for row in [5 * line + 3, 5 * line + 4] {
            let [bottom, top] = ends[line].map(|node| [0, 1, 2].map(|k| g[(row, 18 + 3 * node + k)]));
            let turn: [f64; 3] = from_fn(|k| g[(row, 6 * line + 3 + k)]);
            assert!(
                (0..3).all(|k| (bottom[k] + top[k]).abs() < 1e-14) && bottom[2].abs() < 1e-14 && turn[2].abs() < 1e-14
            );
            // u = theta x z: u_x = theta_y z, u_y = -theta_x z.
            assert!(
                (2.0 * top[0] + turn[1]).abs() < 1e-14 && (2.0 * top[1] - turn[0]).abs() < 1e-14,
                "{top:?} {turn:?}"
            );
            assert!((top[0].hypot(top[1]) - 0.5).abs() < 1e-14);
        }
    }
}

/// Bending of a shell: moments on its edge, as its linear elements have them, are a stress linear through the thickness: `m z / I`.
#[test]
fn shell_moments_become_linear_stress() {
    let (cells, dof) = (3, 0);
    let mut shell = shell_on_block(cells, dof, Section::Mean);
    for node in &mut shell.face.nodes {
        node.dofs = node.dofs.map(|k| k + 24);
    }
    let face = shell.face.clone();
    let set = only(24 + 3 * face.nodes.len(), shell);
    let g = dense(&set);
    // Unit moment about x for each length of the edge, thickness 1 along y: sigma = 12 (y - 1/2) e_z up to its sign.
    let share = |i: usize| if i == 0 || i == cells { 0.5 } else { 1.0 } / cells as f64;
    let turning = |row: usize| (0..=cells).find_map(|i| Some((i, g[(row, 6 * i + 3)])).filter(|x| x.1.abs() > 0.5));
    let force = |k: usize| {
        let rows = (0..set.equations()).filter_map(|row| turning(row).map(|(i, a)| -share(i) / a * g[(row, k)]));
        rows.sum::<f64>()
    };
    // Virtual work with displacements 1, x, y, x y along z, which the faces have exactly.
    for (p, q) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        let work = |node: &Point| force(node.dofs[2]) * node.at[0].powi(p) * node.at[1].powi(q);
        let found: f64 = used(&face).iter().map(|&i| work(&face.nodes[i])).sum();
        let along = 1.0 / f64::from(p + 1);
        let truth = along * f64::from(q);
        assert!((found - truth).abs() < 1e-13, "{p} {q}: {found} {truth}");
    }
}

/// Couplings and other constraints of the same nodes: what is said twice is found, what contradicts is too.
#[test]
fn supports_of_a_coupled_face_are_redundant() -> Outcome {
    let mut builder = ConstraintSet::builder(18);
    builder.add("end", BeamToSolid { beam: node(0, [0.5, 0.5, 0.0]), face: square(0, 6), section: Section::Plane })?;
    for dof in [8, 11, 14, 17] {
        builder.add("support", LinearEquation { terms: vec![(dof, 1.0)], rhs: 0.0 })?;
    }
    let set = builder.build().expect("few DOFs");
    // Four supports of a plane are one more than it takes.
    assert_eq!((set.equations(), svd_rank(&set), rank(&set, &[0.0; 18])?), (11, 10, 10));
    Ok(())
}

/// Lines in any order of nodes, and a random cloud of linear fields: means of `Mean` do not depend on it.
#[test]
fn order_of_nodes_does_not_matter() {
    let mut one = shell_on_block(3, 96, Section::Mean);
    let u: Vec<f64> = (0..120).map(|k| random(k + 400)).collect();
    let before = values(&only(120, one.clone()), &u);
    one.lines.iter_mut().for_each(|line| line.nodes.rotate_left(2));
    let after = values(&only(120, one), &u);
    let same = |a: f64, b: f64| (a - b).abs().min((a + b).abs()) < 1e-13;
    // The direction of a line, and with it the signs of its rotations, may be the other one.
    assert!(before.iter().zip(&after).all(|(&a, &b)| same(a, b)), "{before:?} {after:?}");
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
    assert!(error.contains("point against each other"), "{error}");
}
