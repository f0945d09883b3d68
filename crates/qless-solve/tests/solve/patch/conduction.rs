use faer::sparse::{SparseColMat, Triplet};
use qless_constraints::ConstraintSet;
use qless_constraints::types::{HangingNode, MortarTie, Multipliers, Node, Shape, Surface};
use qless_solve::enforce::Problem;

use crate::linkages::Outcome;

/// `int grad N_i . grad N_j` of a rectangle with four nodes, in order around.
fn conduct(nodes: [usize; 4], [a, b]: [f64; 2]) -> Vec<Triplet<usize, usize, f64>> {
    let x = [[2.0, -2.0, -1.0, 1.0], [-2.0, 2.0, 1.0, -1.0], [-1.0, 1.0, 2.0, -2.0], [1.0, -1.0, -2.0, 2.0]];
    let y = [[2.0, 1.0, -1.0, -2.0], [1.0, 2.0, -2.0, -1.0], [-1.0, -2.0, 2.0, 1.0], [-2.0, -1.0, 1.0, 2.0]];
    let value = |i: usize, j: usize| b / a / 6.0 * x[i][j] + a / b / 6.0 * y[i][j];
    (0..16).map(|k| Triplet::new(nodes[k / 4], nodes[k % 4], value(k / 4, k % 4))).collect()
}

/// A square element beside one that was refined twice at their common edge: a constant heat flow passes, also through hanging nodes whose
/// parents hang.
#[test]
fn a_constant_flow_passes_two_levels_of_refinement() -> Outcome {
    // Columns of elements of sizes 1, 1/2 and 1/4; the nodes on the interfaces x = 1 and x = 3/2 are shared.
    let (mut places, mut k) = (Vec::<[f64; 2]>::new(), Vec::new());
    let mut number = |at: [f64; 2]| {
        places.iter().position(|&p| p == at).unwrap_or_else(|| {
            places.push(at);
            places.len() - 1
        })
    };
    for (x, size) in [(0.0, 1.0), (1.0, 0.5), (1.5, 0.25)] {
        for cell in 0..(1.0 / size) as usize {
            let y = cell as f64 * size;
            let corners = [[x, y], [x + size, y], [x + size, y + size], [x, y + size]].map(&mut number);
            k.extend(conduct(corners, [size, size]));
        }
    }
    let find = |x: f64, y: f64| places.iter().position(|&p| p == [x, y]).map(|i| [i]).ok_or("no node");
    let mut builder = ConstraintSet::builder(places.len());
    for (x, size, cells) in [(1.0, 1.0, 1), (1.5, 0.5, 2)] {
        for cell in 0..cells {
            let [low, high] = [0.0, 1.0].map(|end| (f64::from(cell) + end) * size);
            let (node, parent) = (find(x, low + size / 2.0)?, vec![find(x, low)?, find(x, high)?]);
            builder.add(format!("{x} {cell}"), HangingNode { node, shape: Shape::Line2, parent, at: [0.0, 0.0] })?;
        }
    }
    let set = builder.build().expect("few DOFs");
    let truth = |[x, y]: [f64; 2]| 3.0 - 2.0 * x + 0.5 * y;
    let outer = |&[x, y]: &[f64; 2]| x == 0.0 || x == 1.75 || y == 0.0 || y == 1.0;
    let held: Vec<_> = (0..places.len()).filter(|&i| outer(&places[i])).map(|i| (i, truth(places[i]))).collect();
    let system = set.linearised_at(&vec![0.0; set.dofs()], &held)?;
    let k = SparseColMat::try_new_from_triplets(places.len(), places.len(), &k)?;
    let solution = Problem::new(&k, &vec![0.0; places.len()], &system)?.transformation()?;
    assert!(places.len() - held.len() >= 4);
    for (i, &place) in places.iter().enumerate() {
        assert!((solution.u[i] - truth(place)).abs() < 1e-14 * 16.0, "{place:?}: {}, {}", solution.u[i], truth(place));
    }
    Ok(())
}

/// A plate of two rows of non-matching elements on the unit square with insulated sides: a constant flow passes the interface exactly,
/// whichever row is the slave, rotated, in every unit of length and conductivity.
#[test]
fn a_constant_flow_passes_rows_that_do_not_match() -> Outcome {
    let kinds = [Multipliers::Standard, Multipliers::Dual];
    let counts = [[3, 4], [4, 3], [5, 2]];
    for ((cells, kind), (unit, angle)) in counts
        .into_iter()
        .flat_map(|cells| kinds.map(|kind| (cells, kind)))
        .flat_map(|case| [(1.0, 0.0), (1.0, 0.7), (1e-6, 2.0), (1e6, -1.0)].map(|place| (case, place)))
    {
        let (sin, cos) = f64::sin_cos(angle);
        let turned = |[x, y]: [f64; 2]| [cos * x - sin * y, sin * x + cos * y].map(|x| unit * (x + 3.0));
        let first = [0, 2 * (cells[0] + 1)];
        let flat = |row: usize, i: usize| {
            let side = cells[row] + 1;
            [(i % side) as f64 / cells[row] as f64, (row + i / side) as f64 / 2.0]
        };
        let (mut k, mut edges) = (Vec::new(), Vec::new());
        for row in 0..2 {
            let (side, low) = (cells[row] + 1, first[row]);
            for cell in 0..cells[row] {
                let corners = [cell, cell + 1, cell + 1 + side, cell + side].map(|i| low + i);
                k.extend(conduct(corners, [1.0 / cells[row] as f64, 0.5]));
            }
            // The upper edge of the lower row, and the lower edge of the upper row.
            let edge = (0..side).map(|i| if row == 0 { side + i } else { i });
            edges.push(Surface::polyline(edge.map(|i| Node::of_field(low + i, turned(flat(row, i)))).collect()));
        }
        let dofs = first[1] + 2 * (cells[1] + 1);
        let places: Vec<_> = (0..dofs).map(|i| if i < first[1] { flat(0, i) } else { flat(1, i - first[1]) }).collect();
        let [slave, master] = [edges[0].clone(), edges[1].clone()];
        let mut builder = ConstraintSet::builder(dofs);
        builder.add("interface", MortarTie { slave, master, multipliers: kind, tolerance: 1e-9 * unit })?;
        let set = builder.build().expect("few DOFs");
        let truth = |[_, y]: [f64; 2]| 20.0 - 7.0 * y;
        let outer = (0..dofs).filter(|&i| places[i][1] == 0.0 || places[i][1] == 1.0);
        let held: Vec<_> = outer.map(|i| (i, truth(places[i]))).collect();
        for conductivity in [1.0, 1e-6, 1e6] {
            let scaled: Vec<_> = k.iter().map(|t| Triplet::new(t.row, t.col, conductivity * t.val)).collect();
            let k = SparseColMat::try_new_from_triplets(dofs, dofs, &scaled)?;
            let system = set.linearised_at(&vec![0.0; set.dofs()], &held)?;
            let solution = Problem::new(&k, &vec![0.0; dofs], &system)?.transformation()?;
            let off = |i: usize| (solution.u[i] - truth(places[i])).abs();
            let most = (0..dofs).map(off).fold(0.0, f64::max);
            assert!(most < 20.0 * 1e-14, "{cells:?}, {kind:?}, {unit}, {angle}, {conductivity}: {most}");
        }
    }
    Ok(())
}
