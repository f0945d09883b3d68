use std::array::from_fn;

use faer::Mat;
use qless_constraints::types::{
    Average, Axes, BeamToSolid, Body, Component, CouplingError, Node6, RigidBody, Section, ShellToSolid,
    SmallRigidBody, ThicknessLine,
};
use qless_constraints::{AddError, ConstraintSet};

use super::faces::{SECTIONS, points, square};
use super::{cloud, cross, dense, frame, masked, node, only, svd_rank, turned, values};
use crate::common::{Outcome, random};

/// Axes from the rows of a rotation.
fn axes(rows: [[f64; 3]; 3]) -> Axes {
    Axes::new(rows[0], rows[1]).expect("a frame")
}

fn listed(mask: usize) -> impl Iterator<Item = Component> {
    Component::ALL.into_iter().enumerate().filter(move |(k, _)| mask >> k & 1 == 1).map(|(_, component)| component)
}

/// `G blockdiag(Q)` with `u' = Q u` for each triple of DOFs.
fn turned_back(g: &Mat<f64>, q: [[f64; 3]; 3]) -> Mat<f64> {
    Mat::from_fn(g.nrows(), g.ncols(), |i, j| (0..3).map(|k| g[(i, j / 3 * 3 + k)] * q[k][j % 3]).sum())
}

fn assert_same(a: &Mat<f64>, b: &Mat<f64>, tolerance: f64, what: &str) {
    assert_eq!((a.nrows(), a.ncols()), (b.nrows(), b.ncols()), "{what}");
    for i in 0..a.nrows() {
        for kind in 0..2 {
            let columns = || (0..a.ncols()).filter(move |j| j % 6 / 3 == kind);
            let largest = columns().fold(0.0, |most: f64, j| most.max(b[(i, j)].abs()));
            let worst = columns().fold(0.0, |most: f64, j| most.max((a[(i, j)] - b[(i, j)]).abs()));
            assert!(worst <= tolerance * largest, "{what}, row {i}: {worst} of {largest}");
        }
    }
}

/// The whole model turned, with components along axes that turn along: the same equations, for any component lists, in every unit.
#[test]
fn turned_models_have_the_same_equations() {
    for seed in 0..20 {
        let q = frame(seed + 40);
        // Axis k of the model is now column k of the turn.
        let local = axes(from_fn(|k| from_fn(|i| q[i][k])));
        for scale in [1e-6, 1.0, 1e6] {
            let all = cloud(seed + 7, 6, scale, [0.0; 3]);
            let lists: [usize; 6] =
                from_fn(|i| if (1..4).contains(&i) { 0b111 } else { 1 + (31 * seed + 11 * i) % 63 });
            let here = |i: usize| masked(all[i], lists[i]);
            let there = |i: usize| Node6 { at: turned(q, all[i].at), ..all[i] }.along(local, listed(lists[i]));
            let lead = |i: usize| Node6 { at: turned(q, all[i].at), ..all[i] };
            let rigid = |reference: Node6, of: &dyn Fn(usize) -> Node6| {
                dense(&only(36, SmallRigidBody { reference, nodes: (1..6).map(of).collect() }))
            };
            let (one, two) = (rigid(all[0], &here), rigid(lead(0), &there));
            assert_same(&turned_back(&two, q), &one, 1e-14, "rigid");
            let mean = |of: &dyn Fn(usize) -> Node6| {
                let nodes = (1..6).map(|i| (of(i), i as f64)).collect();
                dense(&only(36, Average { reference: of(0), nodes }))
            };
            assert_same(&turned_back(&mean(&there), q), &mean(&here), 1e-11, "mean");
        }
    }
}

/// Beams and shells on faces that are turned, the beam with hinges about its own axes.
#[test]
fn turned_faces_have_the_same_equations() {
    for (seed, section) in (0..12).flat_map(|seed| SECTIONS.map(|section| (seed, section))) {
        let q = frame(seed + 90);
        let local = axes(from_fn(|k| from_fn(|i| q[i][k])));
        for scale in [1e-6, 1.0, 1e6] {
            let corners = [[0.0; 3], [1.0, 0.0, 0.0], [1.2, 1.0, 0.0], [0.0, 1.0, 0.0]].map(|x| x.map(|x| scale * x));
            let face = |place: &dyn Fn([f64; 3]) -> [f64; 3]| {
                let nodes = points(6, &corners.map(place));
                qless_constraints::types::Surface { nodes, ..square(0, 6) }
            };
            let list = if section == Section::Mean { 1 + (13 * seed) % 63 } else { 63 };
            let beam = node(0, [0.3 * scale, 0.4 * scale, 0.1 * scale]);
            let there = Node6 { at: turned(q, beam.at), ..beam }.along(local, listed(list));
            let one = only(18, BeamToSolid { beam: masked(beam, list), face: face(&|x| x), section });
            let two = only(18, BeamToSolid { beam: there, face: face(&|x| turned(q, x)), section });
            assert_eq!((one.equations(), svd_rank(&one)), (two.equations(), svd_rank(&two)));
            // Directions of the rows may differ within the plane and at nodes: together they say the same.
            let both = |a: &Mat<f64>, b: &Mat<f64>| {
                let unit = |j: usize| if j / 3 == 1 { scale } else { 1.0 };
                let row = |m: &Mat<f64>, i: usize, j: usize| {
                    let size = (0..18).map(|j| (m[(i, j)] / unit(j)).powi(2)).sum::<f64>().sqrt();
                    m[(i, j)] / unit(j) / size
                };
                let stacked = Mat::from_fn(a.nrows() + b.nrows(), 18, |i, j| {
                    if i < a.nrows() { row(a, i, j) } else { row(b, i - a.nrows(), j) }
                });
                let sizes = stacked.singular_values().expect("finite");
                sizes.iter().filter(|&&s| s > 1e-9).count()
            };
            assert_eq!(both(&dense(&one), &turned_back(&dense(&two), q)), one.equations(), "{seed} {section:?}");
        }
    }
}

/// All six components of a shell node along any axes are its motion: the equations are those without axes.
#[test]
fn axes_of_shell_nodes_do_not_matter() {
    for (seed, section) in (0..6).flat_map(|seed| SECTIONS.map(|section| (seed, section))) {
        let made = |own: &dyn Fn(Node6) -> Node6| {
            let line = |i: usize, nodes: Vec<usize>| ThicknessLine { shell: own(node(i, [i as f64, 0.4, 0.0])), nodes };
            let lines = vec![line(0, vec![0, 3]), line(1, vec![1, 2])];
            dense(&only(24, ShellToSolid { lines, face: square(0, 12), section }))
        };
        assert_same(&made(&|shell| shell.along(axes(frame(seed)), listed(63))), &made(&|shell| shell), 1e-14, "shell");
    }
}

/// A rigid body that turns as far as it likes: components along axes that turn with it, `e . (R^T (x_i - x_r) - r_i)`.
#[test]
fn axes_turn_with_the_body() {
    for seed in 0..20 {
        for scale in [1e-6, 1.0, 1e6] {
            let all = cloud(seed + 30, 3, scale, [0.0; 3]);
            let body = Body::with_vector([0, 1, 2], all[0].at, [3, 4, 5]);
            let own = [axes(frame(seed)), axes(frame(seed + 1))];
            let nodes = vec![all[1].along(own[0], listed(0b101)), all[2].along(own[1], listed(0b11_1010))];
            let set = only(18, RigidBody { body, nodes });
            assert_eq!(set.equations(), 6);
            let u: Vec<f64> =
                (0..18).map(|k| 4.0 * random(18 * seed + k) * if k / 3 % 2 == 0 { scale } else { 1.0 }).collect();
            let c = values(&set, &u);
            let theta: [f64; 3] = [u[3], u[4], u[5]];
            for (row, (node, k)) in [(1, 0), (1, 2), (2, 1)].into_iter().enumerate() {
                let e = own[node - 1].rows()[k];
                let r: [f64; 3] = from_fn(|i| all[node].at[i] - all[0].at[i]);
                let reach: [f64; 3] = from_fn(|i| r[i] + u[6 * node + i] - u[i]);
                let up = exponential(theta, e);
                let truth: f64 = (0..3).map(|i| up[i] * reach[i] - e[i] * r[i]).sum();
                assert!((c[row] - truth).abs() < 1e-14 * scale * 8.0, "{seed}, {row}: {} {truth}", c[row]);
            }
            let still = values(&set, &[0.0; 18]);
            assert!(still.iter().all(|c| c.abs() < 1e-15 * scale.max(1.0)));
        }
    }
}

/// Rodrigues' formula.
fn exponential(theta: [f64; 3], s: [f64; 3]) -> [f64; 3] {
    let angle = theta.iter().map(|t| t * t).sum::<f64>().sqrt();
    let e = theta.map(|t| t / angle);
    let (sin, cos) = angle.sin_cos();
    let (turn, along): (_, f64) = (cross(e, s), (0..3).map(|k| e[k] * s[k]).sum());
    from_fn(|k| cos * s[k] + sin * turn[k] + (1.0 - cos) * along * e[k])
}

/// A ring of nodes held outwards only, on a bore in any direction: it may turn about the bore and slide along it.
#[test]
fn radial_components_leave_turning_free() -> Outcome {
    for seed in 0..10 {
        let (q, origin) = (frame(seed + 5), [0.3, -0.2, 0.7]);
        let at = |i: usize| -> [f64; 3] {
            let (sin, cos) = (0.7 * i as f64).sin_cos();
            let x = turned(q, [2.0 * cos, 2.0 * sin, 0.4 * i as f64]);
            from_fn(|k| origin[k] + x[k])
        };
        let z: [f64; 3] = from_fn(|i| q[i][2]);
        let on_bore = |i: usize| -> Outcome<Node6> {
            let axes = Axes::cylindrical(origin, z, at(i))?;
            Ok(masked(node(i, at(i)), 0b111).along(axes, [Component::X]))
        };
        let nodes = (1..7).map(on_bore).collect::<Outcome<Vec<_>>>()?;
        let reference = node(0, origin);
        let set = only(42, SmallRigidBody { reference, nodes });
        assert_eq!((set.equations(), svd_rank(&set)), (6, 6));
        let motion = |shift: f64, angle: f64| -> Vec<f64> {
            let mut u = vec![0.0; 42];
            for i in 1..7 {
                let turn = cross(z, from_fn(|k| at(i)[k] - origin[k]));
                (0..3).for_each(|k| u[6 * i + k] = shift * z[k] + angle * turn[k]);
            }
            u
        };
        assert!(values(&set, &motion(0.4, 0.3)).iter().all(|c| c.abs() < 1e-14));
    }
    Ok(())
}

/// What local axes need and do not have is named; parallel directions are no axes.
#[test]
fn faults_of_axes_are_named() {
    let oblique = axes(frame(3));
    let flat = masked(node(1, [1.0, 0.0, 0.0]), 0b011).along(oblique, [Component::Y]);
    let add = |nodes: Vec<Node6>| {
        ConstraintSet::builder(30).add("it", SmallRigidBody { reference: node(0, [0.0; 3]), nodes }).map(|_| ())
    };
    let Err(AddError::Input { source, .. }) = add(vec![flat]) else { panic!("accepted") };
    assert_eq!(source, CouplingError::LocalAxis { node: 1, component: Component::Y });
    // In the plane nothing is missing.
    let planar = axes([[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, 1.0]]);
    assert!(add(vec![flat.along(planar, [Component::Y])]).is_ok());
    assert!(add(vec![flat.along(planar, [])]).is_err());
    assert!(Axes::new([1.0, 0.0, 0.0], [-2.0, 1e-12, 0.0]).is_err());
    assert!(Axes::new([0.0; 3], [1.0, 0.0, 0.0]).is_err() && Axes::new([1.0, 0.0, 0.0], [f64::NAN; 3]).is_err());
    assert!(Axes::cylindrical([0.0; 3], [0.0, 0.0, 1.0], [0.0, 0.0, 5.0]).is_err());
    let node_in = |list: &[Component]| node(1, [0.0; 3]).along(oblique, list.iter().copied());
    let some = node_in(&[Component::X, Component::Y]).only([Component::Y, Component::Z]);
    assert_eq!(some, node_in(&[Component::Y]));
    let lines = vec![
        ThicknessLine { shell: flat.along(oblique, [Component::Z]), nodes: vec![0, 3] },
        ThicknessLine { shell: node(2, [1.0, 0.5, 0.0]), nodes: vec![1, 2] },
    ];
    let shell = ShellToSolid { lines, face: square(0, 18), section: Section::Mean };
    assert!(ConstraintSet::builder(30).add("it", shell).is_err());
}
