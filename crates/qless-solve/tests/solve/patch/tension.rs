use std::array::from_fn;

use faer::sparse::SparseColMat;
use qless_constraints::types::{BeamToSolid, Node6, Point, Section, ShellToSolid, ThicknessLine};
use qless_constraints::{Constraint, ConstraintSet};
use qless_solve::enforce::Problem;

use super::{Block, MODULUS, POISSON};
use crate::linkages::Outcome;

const SECTIONS: [Section; 3] = [Section::Rigid, Section::Plane, Section::Mean];

/// A shell on the top of a block of `cells` x `cells` faces; lines along y with a shell node in the middle of each.
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

/// Solves a block under the constraint with given forces along z and supports below.
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
    // Rollers below, supports of the rigid motions in the plane, and all DOFs of the shell or beam that are otherwise free.
    let side = block.side();
    let mut fixed: Vec<usize> = (0..side * side).map(|i| 3 * i + 2).chain([0, 1, 3 * cells + 1]).collect();
    fixed.extend(held.iter().map(|dof| solid + dof));
    let held: Vec<(usize, f64)> = fixed.into_iter().map(|dof| (dof, 0.0)).collect();
    let mut evaluation = set.allocate();
    set.evaluate(&vec![0.0; dofs], &mut evaluation)?;
    let system = set.linearised(&evaluation, &held)?;
    Ok((Problem::new(&k, &f, &system)?.transformation()?.u, block))
}

/// The largest difference of the solid's displacements from uniform tension.
fn error_of(u: &[f64], block: &Block) -> f64 {
    let off = |node: &Point| {
        let [x, y, z] = node.at;
        let truth = [-POISSON * x, -POISSON * y, z].map(|u| u / MODULUS);
        (0..3).map(|k| (u[node.dofs[k]] - truth[k]).abs()).fold(0.0, f64::max)
    };
    block.nodes().iter().map(off).fold(0.0, f64::max)
}

/// A beam's force causes uniform tension with `Mean` and `Plane`; `Rigid` prevents the lateral contraction.
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

/// A consistent line load on the edge of a shell causes uniform tension in the solid.
#[test]
fn shell_force_becomes_uniform_tension() -> Outcome {
    for cells in [1, 3] {
        for section in SECTIONS {
            let solid = 3 * 2 * (cells + 1) * (cells + 1);
            let share = |i: usize| if i == 0 || i == cells { 0.5 } else { 1.0 } / cells as f64;
            let loads: Vec<(usize, f64)> = (0..=cells).map(|i| (6 * i + 2, share(i))).collect();
            // Rotations about the lines, along y, and unused DOFs.
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
