use std::array::from_fn;

use qless_constraints::types::{Face, Node6, Point, Section, Shape, ShellToSolid, Surface, ThicknessLine};

use super::faces::{SECTIONS, points, rectangle, used};
use super::{assert_joined, dense, frame, node, only, turned, values};
use crate::common::{Outcome, random};

/// The upper surface of a block of `cells` x `cells` x 1 elements with eight nodes on the unit cube.
fn top_of_block(cells: usize) -> Surface<3> {
    let side = cells + 1;
    let at = |i: usize| [i % side, i / side % side].map(|k| k as f64 / cells as f64);
    let nodes: Vec<[f64; 3]> = (0..2 * side * side).map(|i| [at(i)[0], at(i)[1], (i / (side * side)) as f64]).collect();
    let face = |k: usize| {
        let a = side * side + k / cells * side + k % cells;
        Face::new(Shape::Quad4, [a, a + 1, a + 1 + side, a + side])
    };
    Surface { nodes: points(0, &nodes), faces: (0..cells * cells).map(face).collect() }
}

/// The side of a block of `cells` x `cells` faces, lines along y with a shell node in the middle of each.
fn shell_on_block(cells: usize, dof: usize, section: Section) -> ShellToSolid {
    let (face, side) = (top_of_block(cells), cells + 1);
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

/// Shells on sides of any shape, orientation, place and unit: rank, rigid motions, forces without resultant.
#[test]
fn shells_move_as_their_lines() -> Outcome {
    for (seed, shape) in [Shape::Tri3, Shape::Quad4, Shape::Tri6, Shape::Quad8].into_iter().enumerate() {
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
                let shells = lines.iter().map(|line| line.shell);
                let nodes: Vec<Node6> = shells.chain(face.nodes.iter().map(|&point| point.into())).collect();
                assert_joined(&format!("{shape:?} {section:?} {scale} {far}"), &set, expected, &nodes, [scale, far])?;
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
