use faer::Mat;
use qless_constraints::types::{Multipliers, Node, Shape};

use super::{line, pair, residual, tied};
use crate::common::Outcome;
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
