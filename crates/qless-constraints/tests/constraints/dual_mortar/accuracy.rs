use faer::Mat;
use faer::sparse::{SparseColMat, Triplet};
use qless_constraints::ConstraintSet;
use qless_constraints::enforce::Problem;
use qless_constraints::types::{MortarTie, Multipliers, Node, Shape, Surface};

use super::{line, pair, residual, tied};
use crate::hanging::conduct;
use crate::linkages::Outcome;
use crate::surface_mortar::Mesh;

/// A smooth field arrives with an error of order h^2, with either kind.
#[test]
fn ties_converge_with_the_square_of_the_size() -> Outcome {
    let field = |[x, y, _]: [f64; 3]| (2.0 * x).sin() * (1.5 * y).cos();
    for kind in [Multipliers::Standard, Multipliers::Dual] {
        let mut errors = Vec::new();
        for cells in [6, 12, 24] {
            let mesh = Mesh { shape: Shape::Quad4, cells, wiggle: 0.0, bend: 0.0 };
            let [slave, master] = pair(mesh, Mesh { cells: cells * 4 / 3, ..mesh }, |[x, y]| [x, y, 0.0]);
            let set = tied(&slave, &master, kind, 1e-9)?;
            let (g, n) = (set.allocate().g().clone(), slave.nodes.len());
            // D u = M v, dense.
            let (mut d, mut rhs) = (Mat::<f64>::zeros(n, n), Mat::<f64>::zeros(n, 1));
            for i in 0..n {
                for (j, v) in g.row(i) {
                    if j < n { d[(i, j)] = v } else { rhs[(i, 0)] -= v * field(master.nodes[j - n].at) }
                }
            }
            let u = faer::linalg::solvers::Solve::solve(&d.partial_piv_lu(), &rhs);
            let off = |(i, node): (usize, &Node<3, 1>)| (u[(i, 0)] - field(node.at)).abs();
            errors.push(slave.nodes.iter().enumerate().map(off).fold(0.0, f64::max));
        }
        println!("{kind:?}: {errors:?}");
        assert!(errors.windows(2).all(|pair| pair[0] / pair[1] > 3.0), "{kind:?}: {errors:?}");
    }
    Ok(())
}

/// Two meshes of an arc that do not match, in the plane: constants pass, and lengths come near to the truth.
#[test]
fn curved_lines_pass_constants() -> Outcome {
    for (quadratic, kind) in [(false, Multipliers::Dual), (true, Multipliers::Dual), (true, Multipliers::Standard)] {
        let arc = |s: f64| [(2.0 * s).cos(), (2.0 * s).sin()];
        let slave = line(0, 9, quadratic, arc);
        let master = line(slave.nodes.len(), 13, quadratic, arc);
        let set = tied(&slave, &master, kind, 0.02)?;
        assert!(residual(&set, &vec![1.0; set.dofs()])? < 1e-14);
        let g = set.allocate().g().clone();
        let d: f64 = (0..g.rows()).flat_map(|i| g.row(i)).filter(|&(j, _)| j < slave.nodes.len()).map(|(_, v)| v).sum();
        assert!((d - 2.0).abs() < 0.02, "{d}");
    }
    Ok(())
}

/// A tie of lines turned in the plane has the coefficients that it had.
#[test]
fn ties_do_not_depend_on_direction() -> Outcome {
    for kind in [Multipliers::Standard, Multipliers::Dual] {
        let of = |angle: f64| -> Outcome<_> {
            let place = |s: f64| [s * angle.cos(), s * angle.sin()];
            let slave = line(0, 4, true, place);
            let mut master = line(slave.nodes.len(), 3, false, place);
            // In any order and direction.
            master.faces.reverse();
            master.faces[0].nodes.reverse();
            Ok(tied(&slave, &master, kind, 1e-9)?.allocate().g().clone())
        };
        let truth = of(0.0)?;
        for angle in [0.7, 1.0 + std::f64::consts::PI, std::f64::consts::FRAC_PI_2] {
            let g = of(angle)?;
            for i in 0..g.rows() {
                assert_eq!(
                    g.row(i).map(|(j, _)| j).collect::<Vec<_>>(),
                    truth.row(i).map(|(j, _)| j).collect::<Vec<_>>()
                );
                assert!(g.row(i).zip(truth.row(i)).all(|((_, a), (_, b))| (a - b).abs() < 1e-14), "{angle}, row {i}");
            }
        }
    }
    Ok(())
}

/// A plate of two rows of elements on the unit square that do not match: a constant flow passes the interface exactly, with insulated
/// sides, whichever row is the slave, turned, in every unit of length and of conductivity.
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
            // The upper edge of the lower row, and the lower one of the upper row.
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
            let system = crate::linkages::at_rest(&set, &held)?;
            let solution = Problem::new(&k, &vec![0.0; dofs], &system)?.transformation()?;
            let off = |i: usize| (solution.u[i] - truth(places[i])).abs();
            let most = (0..dofs).map(off).fold(0.0, f64::max);
            assert!(most < 20.0 * 1e-14, "{cells:?}, {kind:?}, {unit}, {angle}, {conductivity}: {most}");
        }
    }
    Ok(())
}
